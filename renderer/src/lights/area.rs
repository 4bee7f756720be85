//! Shapes that emit.

use glam::Vec3;

use super::LightSample;
use crate::accel::{Accel, Object};
use crate::interaction::Interaction;
use crate::math::Rgb;
use crate::ray::{Hit, Ray};
use crate::shapes::Shape;

/// How points on a shape that emits are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LightSampling {
    /// Uniformly by area.
    Area,
    /// Uniformly in the solid angle, where the shape has a map for it: rectangles, triangles, and spheres from outside.
    SolidAngle,
    /// In the solid angle where that pays: spheres, and flat shapes close by.
    #[default]
    Auto,
}

impl LightSampling {
    /// Every way, with its name in scene files.
    pub const ALL: [(&'static str, Self); 3] =
        [("area", Self::Area), ("solid-angle", Self::SolidAngle), ("auto", Self::Auto)];
}

/// Distance, in units of the half diagonal of a flat light's box, up to which `Auto` takes its solid angle.
///
/// Measured on a square over a floor, as variance × time by solid angle over that by area: 0.55 at 1.8 half diagonals,
/// 1.2 at 3.5 and at 9.4, where less variance no longer pays for the longer map.
const NEAR: f32 = 2.5;

/// A shape that emits the same radiance in every direction from the side of its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaLight {
    /// Index of the shape.
    pub object: u32,
    /// Radiance [W m⁻² sr⁻¹].
    pub radiance: Rgb,
    middle: Vec3,
    /// Squared distance from the middle up to which points are taken by solid angle.
    near: f32,
}

impl AreaLight {
    /// The light that `shape`, the object of index `object`, is.
    pub fn new(object: u32, shape: &Object, radiance: Rgb, sampling: LightSampling) -> Self {
        let bounds = shape.bounds([0.0; 2]);
        let (middle, half) = (0.5 * (bounds.min + bounds.max), 0.5 * (bounds.max - bounds.min));
        let near = match (sampling, &shape.shape) {
            (LightSampling::Area, _) => 0.0,
            (LightSampling::SolidAngle, _) | (LightSampling::Auto, Shape::Sphere(_)) => f32::INFINITY,
            (LightSampling::Auto, _) => half.as_vec3().length_squared() * NEAR * NEAR,
        };
        Self { object, radiance, middle: middle.as_vec3(), near }
    }

    /// Whether points are taken by solid angle where `from` sees them.
    fn is_near(&self, from: Vec3) -> bool {
        (from - self.middle).length_squared() < self.near
    }

    /// A point on the light for `u` in [0, 1)², as seen from `from`.
    ///
    /// By solid angle its density is 1 / Ω. By area it is, with the distance d and the cosine at the light cos θ',
    /// d² / (A·cos θ'), so that L / pdf = L·A·cos θ' / d².
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
        let object = &accel.objects()[self.object as usize];
        let eye = from.surface.point;
        let by_angle = if self.is_near(eye) { object.sample_solid_angle(eye, u) } else { None };
        let (target, known) = match by_angle {
            Some((target, pdf)) => (target, Ok(pdf)),
            None => {
                let (target, pdf_area) = object.sample_area(u, from.time);
                (target, Err(pdf_area))
            }
        };
        let d = target.point - eye;
        let wi = d.try_normalize()?;
        let cos = -wi.dot(target.ng);
        if cos <= 0.0 {
            return None;
        }
        let pdf = known.unwrap_or_else(|pdf_area| per_steradian(pdf_area, d.length_squared(), cos));
        let shadow_ray = from.spawn_to(&target);
        Some(LightSample { wi, shadow_ray, radiance: self.radiance, pdf, delta: false })
    }

    /// Density per steradian with which [`Self::sample`] would have drawn the point `hit` of this light from the
    /// origin of `ray`.
    ///
    /// * `ng`: geometric normal at the hit.
    pub fn pdf(&self, accel: &Accel, ray: &Ray, hit: &Hit, ng: Vec3) -> f32 {
        let object = &accel.objects()[self.object as usize];
        let by_angle =
            if self.is_near(ray.origin) { object.pdf_solid_angle(hit.element, ray.origin) } else { None };
        by_angle.unwrap_or_else(|| {
            per_steradian(object.pdf_area(ng, ray.time), hit.t * hit.t, -ng.dot(ray.direction))
        })
    }
}

/// A density per m² at squared distance `d2`, seen under the cosine `cos`, as one per steradian: p·d² / cos.
fn per_steradian(pdf_area: f32, d2: f32, cos: f32) -> f32 {
    pdf_area * d2 / cos
}
