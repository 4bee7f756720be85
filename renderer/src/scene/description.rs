//! What a scene is made of, as plain data: what readers of files fill in and people write by hand.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use crate::camera::CameraSettings;
use crate::film::FilmSettings;
use crate::materials::Material;
use crate::math::Rgb;
use crate::math::transform::Motion;
use crate::sampling::SamplerKind;
use crate::shapes::ShapeSettings;
use crate::texture::Texture;

use super::transport::IntegratorSettings;

/// A whole scene with everything needed to render it.
#[derive(Debug, Clone)]
pub struct SceneDescription {
    /// The eye, its lens and its shutter.
    pub camera: CameraSettings,
    /// The image to make.
    pub film: FilmSettings,
    /// Where numbers come from, and how many samples a pixel takes.
    pub sampler: SamplerSettings,
    /// Which light paths are followed.
    pub integrator: IntegratorSettings,
    /// Shapes with their materials.
    pub objects: Vec<ObjectSettings>,
    /// Lights that are not shapes.
    pub lights: Vec<LightSettings>,
    /// Hash of the text and files that the description was read from; 0 if it was not read.
    pub hash: u64,
}

/// Where numbers come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SamplerSettings {
    /// The family of point sets.
    pub kind: SamplerKind,
    /// Samples per pixel, over all replicates; at least 1.
    pub spp: u32,
    /// Seed of every number.
    pub seed: u64,
}

/// A shape in its place.
#[derive(Debug, Clone)]
pub struct ObjectSettings {
    /// How messages name it.
    pub name: String,
    /// The geometry in object space.
    pub shape: ShapeSettings,
    /// Object space to the world, over time.
    pub to_world: Motion,
    /// Whether normals point the other way.
    pub flip_normals: bool,
    /// What it is made of.
    pub material: Arc<Material>,
    /// Radiance [W m⁻² sr⁻¹] emitted from the side of the normal, by surface coordinates; black for none.
    pub radiance: Texture,
}

/// A light that is not a shape.
#[derive(Debug, Clone, PartialEq)]
pub enum LightSettings {
    /// The same radiance [W m⁻² sr⁻¹] from every direction beyond all shapes.
    Constant {
        /// Radiance.
        radiance: Rgb,
    },
    /// Radiance [W m⁻² sr⁻¹] by direction from beyond all shapes: an image by latitude and longitude.
    Environment {
        /// Columns and rows.
        size: [usize; 2],
        /// Pixels row by row from the map's own +y.
        pixels: Arc<[Rgb]>,
        /// The map's own space to the world: a rotation, or a reflected one.
        to_world: DMat3,
    },
    /// The same intensity in every direction from one point.
    Point {
        /// Position in the world.
        position: DVec3,
        /// Intensity [W sr⁻¹].
        intensity: Rgb,
    },
    /// A cone of light from one point.
    Spot {
        /// Position in the world.
        position: DVec3,
        /// Along the middle of the cone, in the world; any length but 0.
        axis: DVec3,
        /// Intensity [W sr⁻¹] in the middle.
        intensity: Rgb,
        /// Half angles in degrees: of the whole intensity, and beyond which there is none.
        angles: [f64; 2],
    },
    /// Parallel light.
    Directional {
        /// The direction in which the light travels, in the world; any length but 0.
        direction: DVec3,
        /// Irradiance [W m⁻²] on a surface facing the light.
        irradiance: Rgb,
    },
}
