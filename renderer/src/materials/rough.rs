//! Rough metals.

use glam::Vec3;

use super::Material;
use super::bsdf::{BsdfSample, Lobe};
use super::conductor::Metal;
use super::facets::Facets;
use super::microfacet::half_vector;
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
    facets: Facets,
    metal: Metal,
    reflectance: C,
}

impl RoughConductor<Texture> {
    /// The rough metal, its reflectance multiplied by `specular_reflectance`, each channel in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside that range and roughness outside 0.0001 to 10.
    pub fn new(facets: Facets, metal: Metal, specular_reflectance: Texture) -> Result<Self, ParamError> {
        facets.check()?;
        specular_reflectance.check_reflectance("specular_reflectance")?;
        Ok(Self { facets, metal, reflectance: specular_reflectance })
    }

    /// Whether roughness differs along the two tangents.
    pub fn is_anisotropic(&self) -> bool {
        self.facets.is_anisotropic()
    }

    /// The same metal without roughness.
    pub(super) fn sharp(&self) -> Option<Material> {
        Material::new_conductor(self.metal, self.reflectance.clone()).ok()
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.reflectance.varies()
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
        let (h, cos) = half_vector(wo, wi);
        let shadowing = self.facets.g1_over_2cos(wo) * self.facets.g1_over_2cos(wi);
        self.reflectance * self.fresnel(cos) * (self.facets.d(h) * shadowing)
    }

    /// G₁(wo) D(h)/(4 cos θₒ): the density of visible normals, carried over to mirrored directions.
    ///
    /// # Measure
    /// Per steradian. The integral falls short of 1 by the share of mirrored directions below the surface.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        self.facets.d(half_vector(wo, wi).0) * self.facets.g1_over_2cos(wo) / 2.0
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
        let cos = wo.dot(h);
        let wi = (h * (2.0 * cos) - wo).normalize();
        let pdf = self.pdf(wo, wi);
        let weight = self.reflectance * self.fresnel(cos) * self.facets.g1(wi);
        let lobe = Lobe::Spread;
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, transmitted: false, eta_rel: 1.0 })
    }

    /// Fresnel's reflectance of a microfacet; rounding can put the cosine of unit vectors above 1, or below 0.
    fn fresnel(&self, cos: f32) -> Rgb {
        self.metal.reflectance(cos.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::microfacet::Ggx;
    use super::super::testing::direction;
    use super::*;

    /// f cos θᵢ and pdf that Mitsuba 3.9.1 (`scalar_rgb`) returned for gold.
    #[test]
    fn values_are_those_of_mitsuba() {
        let [a, b, c] = [[[0.3, 0.2], [0.5, 3.0]], [[1.2, 0.7], [1.3, 3.6]], [[0.9, 1.0], [0.2, 5.0]]];
        let asked = [
            ([0.3, 0.3], a, [0.67189157, 0.5573911, 0.22574273], 0.69974756),
            ([0.3, 0.3], b, [0.34741, 0.29774517, 0.15909734], 0.44769034),
            ([0.1, 0.4], a, [0.49349153, 0.40939313, 0.16580373], 0.5110399),
            ([0.1, 0.4], b, [0.10460348, 0.08964963, 0.04790344], 0.121540055),
            ([0.1, 0.4], c, [0.037048567, 0.030731436, 0.0125015415], 0.038393855),
            ([0.8, 0.8], c, [0.13510941, 0.11207199, 0.045590863], 0.14071651),
        ];
        for (alpha, [wo, wi], value, pdf) in asked {
            let eta = Rgb::new(0.143036, 0.3753071, 1.4420453);
            let gold = Metal::new(eta, Rgb::new(3.982997, 2.3855565, 1.6033592)).unwrap();
            let bsdf =
                RoughConductor::new(Ggx { alpha }.into(), gold, Rgb::WHITE.into()).unwrap().at([0.0; 2]);
            let (wo, wi) = (direction(wo), direction(wi));
            let got = (bsdf.eval(wo, wi) * wi.z).to_array();
            let pairs = got.into_iter().zip(value).chain([(bsdf.pdf(wo, wi), pdf)]);
            for (got, expected) in pairs {
                // Directions are rounded by 2⁻²⁴ and ln D turns by 2/α < 20 per unit: 20 × 2⁻²³, and as much again
                // for Mitsuba's own rounding.
                assert!((got / expected - 1.0_f32).abs() < 5e-6, "{alpha:?} {wo} {wi}: {got} {expected}");
            }
        }
    }
}
