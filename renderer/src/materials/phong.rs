//! Phong's highlight, made physically plausible.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3;

use super::bsdf::{BsdfSample, reflected};
use super::conductor::check_range;
use crate::error::ParamError;
use crate::math::{Frame, Rgb};
use crate::sampling::warp;
use crate::texture::Texture;

/// The modified Phong model: f = ρd/π + ρs (n + 2)/(2π) cosⁿα, α the angle between `wi` and the mirrored `wo`
/// where it is below 90°; black from below.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
///
/// # Source
/// Lafortune, Willems 1994: Using the modified Phong reflectance model for physically based rendering, equation 9.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phong<C> {
    diffuse: C,
    specular: C,
    exponent: f32,
    /// The probability of sampling the highlight.
    highlight: f32,
}

impl Phong<Texture> {
    /// The surface of diffuse reflectance ρd, specular reflectance ρs and exponent n.
    ///
    /// * `exponent`: 0 to 1e6.
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1], and where the largest ρd and the largest ρs add up to more
    /// than 1: such a surface could create light.
    pub fn new(diffuse: Texture, specular: Texture, exponent: f32) -> Result<Self, ParamError> {
        diffuse.check_reflectance("diffuse_reflectance")?;
        specular.check_reflectance("specular_reflectance")?;
        check_range("exponent", exponent, [0.0, 1e6], "0 to 1e6")?;
        let total = diffuse.max() + specular.max();
        check_range("diffuse_reflectance + specular_reflectance", total, [0.0, 1.0], "0 to 1")?;
        let (d, s) = (diffuse.mean(), specular.mean());
        let highlight = if s > 0.0 { s / (d + s) } else { 0.0 };
        Ok(Self { diffuse, specular, exponent, highlight })
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.diffuse.varies() || self.specular.varies()
    }

    /// The surface at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Phong<Rgb> {
        let (diffuse, specular) = (self.diffuse.eval(uv), self.specular.eval(uv));
        Phong { diffuse, specular, exponent: self.exponent, highlight: self.highlight }
    }
}

impl Phong<Rgb> {
    /// f \[1/sr\]; 0 unless both directions are above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let lobe = (self.exponent + 2.0) / TAU * self.power(wo, wi);
        self.diffuse * FRAC_1_PI + self.specular * lobe
    }

    /// The mixture of cos θ/π and the highlight's (n + 1)/(2π) cosⁿα.
    ///
    /// # Measure
    /// Per steradian; the integral falls short of 1 by the share of the highlight below the surface.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let lobe = (self.exponent + 1.0) / TAU * self.power(wo, wi);
        self.highlight * lobe + (1.0 - self.highlight) * wi.z * FRAC_1_PI
    }

    /// Draws from the highlight or the cosine; `None` for a direction below the surface.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = if u_lobe < self.highlight {
            self.sample_highlight(wo, u)
        } else {
            warp::square_to_cosine_hemisphere(u)
        };
        BsdfSample::drawn(wi, self.eval(wo, wi), self.pdf(wo, wi))
    }

    /// A direction with density (n + 1)/(2π) cosⁿα about the mirrored direction.
    fn sample_highlight(&self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        Frame::from_z(reflected(wo)).to_world(warp::square_to_phong(u, self.exponent)).normalize()
    }

    /// cosⁿα for cos α > 0, else 0; from |wi − r|², which keeps the digits of small angles.
    fn power(&self, wo: Vec3, wi: Vec3) -> f32 {
        let half_square = (wi - reflected(wo)).length_squared() / 2.0;
        if half_square >= 1.0 {
            return 0.0;
        }
        libm::expf(self.exponent * libm::log1pf(-half_square))
    }
}
