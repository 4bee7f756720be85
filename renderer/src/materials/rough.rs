//! Rough metals.

use glam::Vec3;

use super::bsdf::{BsdfSample, Lobe};
use super::conductor::{Metal, check_range};
use super::microfacet::Ggx;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::texture::Texture;

/// A metal of microscopic mirrors: f = ρ F(wo·h) D(h) G₁(wo) G₁(wi)/(4 cos θₒ cos θᵢ), black from below.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
///
/// # Source
/// Walter, Marschner, Li, Torrance 2007, equation 20, with the product of the two G₁ for the joint shadowing, as
/// the plugin `roughconductor` of Mitsuba 3.9.1 has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughConductor<C> {
    facets: Ggx,
    metal: Metal,
    reflectance: C,
}

impl RoughConductor<Texture> {
    /// The rough metal, its reflectance multiplied by `specular_reflectance`, each channel in [0, 1].
    ///
    /// * `alpha`: GGX roughness along the two tangents, 0.0001 to 10.
    ///
    /// # Errors
    /// [`ParamError`] for values outside these ranges.
    pub fn new(alpha: [f32; 2], metal: Metal, specular_reflectance: Texture) -> Result<Self, ParamError> {
        for value in alpha {
            check_range("alpha", value, [1e-4, 10.0], "0 (smooth, in both directions) or 0.0001 to 10")?;
        }
        specular_reflectance.check_reflectance("specular_reflectance")?;
        Ok(Self { facets: Ggx { alpha }, metal, reflectance: specular_reflectance })
    }

    /// The metal at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> RoughConductor<Rgb> {
        RoughConductor { facets: self.facets, metal: self.metal, reflectance: self.reflectance.eval(uv) }
    }
}

impl RoughConductor<Rgb> {
    /// f \[1/sr\]; 0 unless both directions are above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let h = (wo + wi).normalize();
        let shadowing = self.facets.g1_over_2cos(wo) * self.facets.g1_over_2cos(wi);
        self.reflectance * self.fresnel(wo, h) * (self.facets.d(h) * shadowing)
    }

    /// G₁(wo) D(h)/(4 cos θₒ): the density of visible normals, carried over to mirrored directions.
    ///
    /// # Measure
    /// Per steradian. The integral falls short of 1 by the share of mirrored directions below the surface.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        self.facets.d((wo + wi).normalize()) * self.facets.g1_over_2cos(wo) / 2.0
    }

    /// Mirrors `wo` at a visible microfacet; the weight is ρ F G₁(wi).
    ///
    /// Returns: `None` when the mirrored direction is below the surface; its light would be scattered again by the
    /// microfacets, which this model leaves out.
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let h = self.facets.sample_visible(wo, u);
        let wi = (h * (2.0 * wo.dot(h)) - wo).normalize();
        let pdf = self.pdf(wo, wi);
        let weight = self.reflectance * self.fresnel(wo, h) * self.facets.g1(wi);
        let lobe = Lobe::Spread;
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, transmitted: false, eta_rel: 1.0 })
    }

    /// Fresnel's reflectance at a microfacet of normal `h`; rounding can put the cosine of unit vectors above 1.
    fn fresnel(&self, wo: Vec3, h: Vec3) -> Rgb {
        self.metal.reflectance(wo.dot(h).clamp(0.0, 1.0))
    }
}
