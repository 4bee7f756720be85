//! A distribution ray tracer: every effect of the classic lecture, each called for by the scene.
//!
//! The modules have ranks; a file imports lower ranks or its own folder (see ARCHITECTURE.md).

pub mod accel;
pub mod camera;
pub mod error;
pub mod film;
pub mod integrator;
pub mod interaction;
pub mod io;
pub mod lights;
pub mod materials;
pub mod math;
pub mod ray;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod shapes;
pub mod texture;

pub use error::{Error, ParamError};
