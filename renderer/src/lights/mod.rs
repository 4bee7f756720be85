//! Rank 4: where light comes from, and points on lights to connect to.

use std::f32::consts::PI;

use glam::Vec3;

use crate::accel::Accel;
use crate::interaction::Interaction;
use crate::math::Rgb;
use crate::ray::Ray;
use crate::sampling::warp;

pub mod select;

pub use select::Lights;

/// A source of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// A shape that emits the same radiance in every direction from the side of its normal.
    Area {
        /// Index of the shape.
        object: u32,
        /// Radiance [W m⁻² sr⁻¹].
        radiance: Rgb,
        /// The shape's area [m²].
        area: f32,
    },
    /// The same radiance from every direction beyond all shapes.
    Constant {
        /// Radiance [W m⁻² sr⁻¹].
        radiance: Rgb,
    },
    /// The same intensity in every direction from one point.
    Point {
        /// Position in the render frame.
        position: Vec3,
        /// Intensity [W sr⁻¹].
        intensity: Rgb,
    },
    /// Parallel light.
    Directional {
        /// Unit vector towards the light.
        wi: Vec3,
        /// Irradiance [W m⁻²] on a surface that faces it.
        irradiance: Rgb,
    },
}

/// A point on a light, seen from a surface.
#[derive(Debug, Clone, Copy)]
pub struct LightSample {
    /// Unit direction towards it.
    pub wi: Vec3,
    /// The segment that must be free, from the surface to just before the point.
    pub shadow_ray: Ray,
    /// Radiance arriving per unit density: L [W m⁻² sr⁻¹], or for lights without extent the irradiance [W m⁻²] on a
    /// surface that faces them.
    pub radiance: Rgb,
    /// Density per steradian; 1 for lights without extent.
    pub pdf: f32,
    /// Whether the light has no extent, so that no other way of sampling can find it.
    pub delta: bool,
}

impl Light {
    /// A point on the light for `u` in [0, 1)², as seen from `from`.
    ///
    /// An area light gives a uniform point on its surface. With the distance d and the cosine at the light cos θ'
    /// its density becomes d² / (A·cos θ') per steradian, so that L / pdf = L·A·cos θ' / d².
    ///
    /// Returns: `None` where the light sends nothing this way.
    ///
    /// # Measure
    /// per steradian at `from`.
    ///
    /// # Source
    /// Shirley, Wang and Zimmerman 1996, "Monte Carlo techniques for direct lighting calculations", section 3
    /// (doi:10.1145/226150.226151).
    pub fn sample(&self, accel: &Accel, from: &Interaction, u: [f32; 2]) -> Option<LightSample> {
        match *self {
            Self::Area { object, radiance, area } => {
                let target = accel.objects()[object as usize].sample_area(u, from.time);
                let (wi, pdf) = towards(from.point, target.point, target.ng, area)?;
                let shadow_ray = from.spawn_to(&target);
                Some(LightSample { wi, shadow_ray, radiance, pdf, delta: false })
            }
            Self::Constant { radiance } => {
                let wi = warp::square_to_sphere(u).into();
                Some(LightSample { wi, shadow_ray: from.spawn(wi), radiance, pdf: 0.25 / PI, delta: false })
            }
            Self::Point { position, intensity } => {
                let d = position - from.point;
                let wi = d.try_normalize()?;
                let shadow_ray = from.spawn_to_position(position);
                Some(LightSample { wi, shadow_ray, radiance: intensity / d.length_squared(), pdf: 1.0, delta: true })
            }
            Self::Directional { wi, irradiance } => {
                Some(LightSample { wi, shadow_ray: from.spawn(wi), radiance: irradiance, pdf: 1.0, delta: true })
            }
        }
    }

    /// What it sends towards whoever sees it: radiance, or intensity or irradiance for a light without extent.
    pub fn radiance(&self) -> Rgb {
        match *self {
            Self::Area { radiance, .. } | Self::Constant { radiance } => radiance,
            Self::Point { intensity, .. } => intensity,
            Self::Directional { irradiance, .. } => irradiance,
        }
    }

    /// Density per steradian with which [`Self::sample`] would have drawn a hit of this light.
    ///
    /// * `distance`: to the hit; without meaning for a constant light.
    /// * `cos`: the cosine at the light, above 0.
    pub fn pdf(&self, distance: f32, cos: f32) -> f32 {
        match *self {
            Self::Area { area, .. } => distance * distance / (area * cos),
            Self::Constant { .. } => 0.25 / PI,
            Self::Point { .. } | Self::Directional { .. } => 0.0,
        }
    }
}

/// Unit direction from `from` to `to`, and the density per steradian of a point uniform on `area`; `None` where the
/// light is seen from behind, edge-on, or from its own surface.
fn towards(from: Vec3, to: Vec3, ng: Vec3, area: f32) -> Option<(Vec3, f32)> {
    let d = to - from;
    let distance = d.length();
    let wi = d / distance;
    let cos = -wi.dot(ng);
    (distance > 0.0 && cos > 0.0).then(|| (wi, distance * distance / (area * cos)))
}
