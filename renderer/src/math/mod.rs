//! Rank 0: pure mathematics; f32 for geometry, f64 where digits are lost.

pub mod bounds;
pub mod eight;
pub mod float;
pub mod frame;
pub mod rgb;
pub mod spectrum;
pub mod spherical;
pub mod transform;

pub use frame::Frame;
pub use rgb::Rgb;
