//! Surfaces that look equally bright from everywhere.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::bsdf::{BsdfSample, Lobe};
use crate::error::ParamError;
use crate::math::Rgb;
use crate::sampling::warp;
use crate::texture::Texture;

/// An ideally diffuse reflector: f = ρ/π above the surface, 0 below it.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diffuse<C> {
    reflectance: C,
}

impl Diffuse<Texture> {
    /// The diffuse surface of reflectance ρ, each channel in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1].
    pub fn new(reflectance: Texture) -> Result<Self, ParamError> {
        reflectance.check_reflectance("reflectance")?;
        Ok(Self { reflectance })
    }

    /// The reflector at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Diffuse<Rgb> {
        Diffuse { reflectance: self.reflectance.eval(uv) }
    }
}

impl Diffuse<Rgb> {
    /// f = ρ/π \[1/sr\]; 0 unless both directions are above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z > 0.0 && wi.z > 0.0 { self.reflectance * FRAC_1_PI } else { Rgb::BLACK }
    }

    /// cos θᵢ/π; 0 unless both directions are above the surface.
    ///
    /// # Measure
    /// Per steradian.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z > 0.0 && wi.z > 0.0 { wi.z * FRAC_1_PI } else { 0.0 }
    }

    /// A direction in proportion to its cosine; the weight is ρ.
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        let wi = warp::square_to_cosine_hemisphere(u);
        let pdf = self.pdf(wo, wi);
        let (weight, lobe) = (self.reflectance, Lobe::Spread);
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, transmitted: false, eta_rel: 1.0 })
    }
}
