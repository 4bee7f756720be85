//! Rank 6: where light comes from, and points on lights to connect to.

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
            Self::Area { object, radiance } => {
                let (target, pdf_area) = accel.objects()[object as usize].sample_area(u, from.time);
                let d = target.point - from.surface.point;
                let wi = d.try_normalize()?;
                let cos = -wi.dot(target.ng);
                if cos <= 0.0 {
                    return None;
                }
                let pdf = per_steradian(pdf_area, d.length_squared(), cos);
                Some(LightSample { wi, shadow_ray: from.spawn_to(&target), radiance, pdf, delta: false })
            }
            Self::Constant { radiance } => {
                let wi = warp::square_to_sphere(u);
                Some(LightSample { wi, shadow_ray: from.spawn(wi), radiance, pdf: 0.25 / PI, delta: false })
            }
            Self::Point { position, intensity } => {
                let d = position - from.surface.point;
                let wi = d.try_normalize()?;
                let shadow_ray = from.spawn_to_point(position);
                Some(LightSample {
                    wi,
                    shadow_ray,
                    radiance: intensity / d.length_squared(),
                    pdf: 1.0,
                    delta: true,
                })
            }
            Self::Directional { wi, irradiance } => Some(LightSample {
                wi,
                shadow_ray: from.spawn(wi),
                radiance: irradiance,
                pdf: 1.0,
                delta: true,
            }),
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

    /// Density per steradian with which [`Self::sample`] would have drawn the point `hit` of this light.
    ///
    /// * `distance`: from where the light is seen to `hit`.
    pub fn pdf(&self, accel: &Accel, hit: &Interaction, distance: f32) -> f32 {
        match *self {
            Self::Area { object, .. } => {
                let pdf_area = accel.objects()[object as usize].pdf_area(hit.surface.ng, hit.time);
                per_steradian(pdf_area, distance * distance, hit.surface.ng.dot(hit.wo))
            }
            Self::Constant { .. } | Self::Point { .. } | Self::Directional { .. } => self.pdf_escaped(),
        }
    }

    /// Density per steradian with which [`Self::sample`] would have drawn a direction that meets no shape.
    pub fn pdf_escaped(&self) -> f32 {
        match self {
            Self::Constant { .. } => 0.25 / PI,
            Self::Area { .. } | Self::Point { .. } | Self::Directional { .. } => 0.0,
        }
    }
}

/// A density per m² at squared distance `d2`, seen under the cosine `cos`, as one per steradian: p·d² / cos.
fn per_steradian(pdf_area: f32, d2: f32, cos: f32) -> f32 {
    pdf_area * d2 / cos
}
