//! Rank 10: files. Images go out and come in here, meshes and scene descriptions come in; nothing below knows a format.

pub mod exr;
pub mod image;
pub mod mesh;
pub mod mitsuba;
mod obj;
pub mod part;
mod ply;
pub mod png;
pub mod rendering;
mod serialized;

pub use image::{Image, MAX_PIXELS, Metadata, Provenance};
pub use mitsuba::read_scene;
