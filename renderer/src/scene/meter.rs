//! A surface in the place of the camera, which measures the irradiance on it.

use std::f32::consts::PI;

use super::Scene;
use crate::math::Frame;
use crate::ray::Ray;
use crate::sampling::warp::square_to_cosine_hemisphere;

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
    /// * `p`: in [−1, 1)², rightwards and downwards; `u`: in [0, 1)², for the direction.
    ///
    /// # Measure
    /// Origins 1 / area per m², directions cos θ / π per steradian.
    ///
    /// # Source
    /// Mitsuba 3, plugin `irradiancemeter`.
    ///
    /// # Verified by
    /// the claims irradiance/meter/*
    pub fn ray(self, scene: &Scene, p: [f32; 2], u: [f32; 2], time: f32) -> Ray {
        let object = &scene.accel.objects()[self.object as usize];
        let (surface, _) = object.sample_area(p.map(|p| 0.5 * p + 0.5), time);
        surface.spawn(Frame::from_z(surface.ng).to_world(square_to_cosine_hemisphere(u)), time)
    }
}
