//! Rank 0: pure mathematics; f32 for geometry, f64 where digits are lost.

pub mod float;
pub mod frame;
pub mod rgb;
pub mod spherical;
pub mod spectrum;

pub use frame::Frame;
pub use rgb::Rgb;
