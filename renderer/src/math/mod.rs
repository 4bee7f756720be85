//! Rank 0: pure mathematics; f32 for geometry, f64 where digits are lost.

pub mod rgb;

pub use rgb::Rgb;
