//! A surface in the place of the camera, which measures the irradiance on it.

use std::f32::consts::PI;

use glam::Vec3;

use super::Scene;
use crate::math::Frame;
use crate::ray::Ray;

/// An irradiance meter: E = ∫ L cos θ dω over the hemisphere on the side of the surface's normal, averaged over the part of
/// the surface that a pixel covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Meter {
    /// Index of the object whose surface it is.
    pub object: u32,
}

impl Meter {
    /// What a unit of radiance along a ray counts: cos θ over the density cos θ/π of its direction.
    ///
    /// Returns: steradians, so that radiance [W m⁻² sr⁻¹] becomes irradiance [W m⁻²].
    pub const WEIGHT: f32 = PI;

    /// The ray from the surface at the point `p` of the film, uniform by area.
    ///
    /// * `p`: in [−1, 1)², rightwards and downwards; `zeta`: on the unit disk, the direction's coordinates in the tangent plane,
    ///   which makes directions cosine-distributed (Malley's method).
    ///
    /// # Measure
    /// Origins 1 / area per m², directions cos θ / π per steradian.
    ///
    /// # Source
    /// Mitsuba 3, plugin `irradiancemeter`; Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section A.5.3.
    ///
    /// # Verified by
    /// the claims irradiance/meter/*
    pub fn ray(self, scene: &Scene, p: [f32; 2], zeta: [f32; 2], time: f32) -> Ray {
        let object = &scene.accel.objects()[self.object as usize];
        let (surface, _) = object.sample_area(p.map(|p| 0.5 * p + 0.5), time);
        let [x, y] = zeta;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt(); // of the rim rounding makes a negative square
        surface.spawn(Frame::from_z(surface.ng).to_world(Vec3::new(x, y, z)), time)
    }
}
