//! Ground glass: a boundary of microscopic windows.

use glam::Vec3;

use super::Material;
use super::bsdf::{BsdfSample, Lobe};
use super::dielectric::check_eta;
use super::facets::Facets;
use super::fresnel;
use super::microfacet::half_vector;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::math::float::round_f32;
use crate::texture::Texture;

/// A boundary between two dielectrics made of microfacets that reflect and refract, seen from either side.
///
/// With h the normal of the facet that joins the directions, c = wo·h and η the index on the side of `wi` over that
/// on the side of `wo`: reflection f = ρ F(c) D(h) G₁(wo) G₁(wi)/(4 cos θₒ cos θᵢ), h half way between; refraction
/// f = τ (1 − F(c)) D(h) G₁(wo) G₁(wi) c |wi·h| / (cos θₒ |cos θᵢ| ℓ²), ℓh = ±(wo + η wi). This is radiance: Walter's
/// value has a further η², and f·η² is the same in both directions.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
///
/// # Precision, limits
/// ℓ is about |η − 1|, so that h turns by 1/|η − 1| times what its directions do; `eval` and `pdf` lose nothing beside that:
/// h and the share that passes come from both directions in f64, and are the same bits for either order of them.
///
/// # Source
/// Walter, Marschner, Li, Torrance 2007: Microfacet Models for Refraction through Rough Surfaces, equations 16 to
/// 21, with the product of the two G₁ for the joint shadowing, as the plugin `roughdielectric` of Mitsuba 3.9.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughDielectric<C> {
    facets: Facets,
    eta: f32,
    reflectance: C,
    transmittance: C,
}

impl RoughDielectric<Texture> {
    /// The boundary of a medium with index `eta` relative to its outside, with microfacets `facets`.
    ///
    /// * `eta`: interior over exterior index, 0.001 to 1000, not 1.
    /// * `specular_reflectance` ρ, `specular_transmittance` τ: factors that physics has at 1, in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for values outside these ranges and roughness outside 0.0001 to 10.
    pub fn new(
        facets: Facets,
        eta: f32,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        check_eta(eta)?;
        facets.check()?;
        specular_reflectance.check_reflectance("specular_reflectance")?;
        specular_transmittance.check_reflectance("specular_transmittance")?;
        Ok(Self { facets, eta, reflectance: specular_reflectance, transmittance: specular_transmittance })
    }

    /// The smooth boundary.
    pub(super) fn sharp(&self) -> Option<Material> {
        let [reflected, passed] = [&self.reflectance, &self.transmittance].map(Texture::clone);
        Material::new_dielectric(self.eta, reflected, passed).ok()
    }

    /// Whether roughness differs along the two tangents.
    pub fn is_anisotropic(&self) -> bool {
        self.facets.is_anisotropic()
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.reflectance.varies() || self.transmittance.varies()
    }

    /// The boundary at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> RoughDielectric<Rgb> {
        let (reflectance, transmittance) = (self.reflectance.eval(uv), self.transmittance.eval(uv));
        RoughDielectric { facets: self.facets, eta: self.eta, reflectance, transmittance }
    }
}

/// A facet that lets light pass between two directions on either side of the surface.
struct Window {
    /// Its normal h, above the surface.
    h: Vec3,
    /// a·h and −b·h of the directions a above and b below, positive.
    cos: [f64; 2],
    /// The share of light that passes, over |a + η b|².
    passed: f64,
}

impl Window {
    /// The facet between `above` and `below`; `None` where none lets light pass that way.
    ///
    /// In f64, where the sum is exact but for one rounding: what cancels in it, and what the critical angle makes of a
    /// cosine, is not lost.
    fn between([above, below]: [Vec3; 2], eta: f32) -> Option<Self> {
        let (a, b, eta) = (above.as_dvec3(), below.as_dvec3(), f64::from(eta));
        let sum = a + eta * b;
        let length_squared = sum.length_squared();
        let h = sum.try_normalize()?;
        let h = if h.z < 0.0 { -h } else { h };
        let cos = [a.dot(h), -b.dot(h)];
        if !(cos[0] > 0.0 && cos[1] > 0.0) {
            return None;
        }
        let passed = fresnel::transmittance([cos[0], eta * cos[1]], [1.0, eta]) / length_squared;
        Some(Self { h: h.as_vec3(), cos, passed })
    }
}

impl RoughDielectric<Rgb> {
    /// What a facet under the cosine `cos` does to light from `wo`.
    fn interface(&self, wo: Vec3, cos: f32) -> fresnel::Interface {
        fresnel::dielectric(cos.clamp(0.0, 1.0).copysign(wo.z), self.eta)
    }

    /// The normal half way between two directions on one side of the surface, above it, and the share that it reflects.
    fn reflected(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (h, cos) = half_vector(wo, wi);
        (h * wo.z.signum(), self.interface(wo, cos).reflectance)
    }

    /// f \[1/sr\].
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z == 0.0 || wi.z == 0.0 {
            return Rgb::BLACK;
        }
        let facets = &self.facets;
        let shadowing = [wo, wi].map(|w| facets.g1_over_2cos(w * w.z.signum()));
        let shadowing = shadowing[0] * shadowing[1];
        if (wo.z > 0.0) == (wi.z > 0.0) {
            let (h, reflected) = self.reflected(wo, wi);
            return self.reflectance * (reflected * facets.d(h) * shadowing);
        }
        let Some(window) = Window::between(sorted(wo, wi), self.eta) else { return Rgb::BLACK };
        // From below the facet's |wo + wi/η|² is smaller by η².
        let carried = window.cos[0] * window.cos[1] * window.passed * self.squeezed(wo);
        // D last: what may be too small for all its digits is rounded once.
        self.transmittance * (4.0 * round_f32(carried) * shadowing * facets.d(window.h))
    }

    /// The square of the index on the side of `w`.
    fn squeezed(&self, w: Vec3) -> f64 {
        if w.z < 0.0 { f64::from(self.eta) * f64::from(self.eta) } else { 1.0 }
    }

    /// The density of visible normals, carried over to mirrored and refracted directions, times F or 1 − F.
    ///
    /// # Measure
    /// Per steradian. The integral falls short of 1 by the share of directions on the wrong side of the surface.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z == 0.0 || wi.z == 0.0 {
            return 0.0;
        }
        if (wo.z > 0.0) == (wi.z > 0.0) {
            let (h, reflected) = self.reflected(wo, wi);
            return self.pdf_reflected(wo, h, reflected);
        }
        let Some(window) = Window::between(sorted(wo, wi), self.eta) else { return 0.0 };
        // dh/dwi = |wi·h|/|wi + wo/η|², from above, where |wo + η wi|² is larger by η².
        let carried = window.cos[0] * window.cos[1] * window.passed * self.squeezed(wi);
        self.pdf_refracted(wo, window.h, round_f32(carried))
    }

    fn pdf_reflected(&self, wo: Vec3, h: Vec3, reflected: f32) -> f32 {
        let wo = wo * wo.z.signum();
        reflected * self.facets.d(h) * self.facets.g1_over_2cos(wo) / 2.0
    }

    /// * `carried`: (wo·h) (1 − F) dh/dwi.
    fn pdf_refracted(&self, wo: Vec3, h: Vec3, carried: f32) -> f32 {
        let wo = wo * wo.z.signum();
        2.0 * self.facets.g1_over_2cos(wo) * self.facets.d(h) * carried
    }

    /// Mirrors or refracts `wo` at a visible facet, with the probability of its Fresnel reflectance; the weight is
    /// ρ G₁(wi) or τ G₁(wi)/η².
    ///
    /// Returns: `None` when the direction is on the wrong side of the surface.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let side = wo.z.signum();
        let up = wo * side;
        let h = self.facets.sample_visible(up, u);
        let cos = up.dot(h).clamp(0.0, 1.0);
        let interface = self.interface(wo, cos);
        let eta_rel = interface.eta_rel;
        let sample = if u_lobe < interface.reflectance {
            let wi = (h * (2.0 * cos) - up).normalize();
            let pdf = self.pdf_reflected(wo, h, interface.reflectance);
            let weight = self.reflectance * self.facets.g1(wi);
            (wi.z > 0.0).then_some((wi, weight, pdf, false))?
        } else {
            let cos_t = interface.cos_t?;
            let wi = (h * (cos / eta_rel - cos_t) - up / eta_rel).normalize();
            // η/ℓ with ℓ = |c − η cos θₜ|, without the difference and without that of 1 and a rounded 1/η.
            let eta = self.eta;
            let sum = if wo.z > 0.0 { eta * (cos + eta * cos_t) } else { eta * cos + cos_t };
            let stretch = sum / ((eta - 1.0) * (eta + 1.0));
            let carried = cos * cos_t * interface.transmittance * stretch * stretch;
            let pdf = self.pdf_refracted(wo, h, carried);
            let weight = self.transmittance * (self.facets.g1(-wi) / (eta_rel * eta_rel));
            (wi.z < 0.0).then_some((wi, weight, pdf, true))?
        };
        let (wi, weight, pdf, transmitted) = sample;
        let eta_rel = if transmitted { eta_rel } else { 1.0 };
        let lobe = Lobe::Spread;
        (pdf > 0.0).then_some(BsdfSample { wi: wi * side, weight, pdf, lobe, transmitted, eta_rel })
    }
}

/// Two directions on different sides, the upper one first.
fn sorted(a: Vec3, b: Vec3) -> [Vec3; 2] {
    if a.z > 0.0 { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::super::beckmann::Beckmann;
    use super::super::microfacet::Ggx;
    use super::super::testing::direction;
    use super::*;

    /// f cos θᵢ and pdf that Mitsuba 3.9.1 (`scalar_rgb`) returned for an index of 1.5.
    #[test]
    fn values_are_those_of_mitsuba() {
        let [a, b] = [[[0.3, 0.2], [0.5, 3.0]], [[1.2, 0.7], [1.3, 3.6]]];
        let [c, d] = [[[0.9, 1.0], [2.7, 5.0]], [[2.4, 1.0], [2.0, 4.5]]];
        let round: Facets = Ggx { alpha: [0.3; 2] }.into();
        let brushed: Facets = Ggx { alpha: [0.2, 0.5] }.into();
        let beckmann: Facets = Beckmann { alpha: [0.3; 2] }.into();
        let asked = [
            (round, a, [0.028_113_75, 0.028_301_284]),
            (round, b, [0.063_850_984, 0.078_930_43]),
            (round, c, [0.019_625_233, 0.044_377_692]),
            (round, d, [0.291_765_1, 0.320_314_2]),
            (brushed, a, [0.021_297_442, 0.021_367_42]),
            (brushed, b, [0.046_051_946, 0.056_014_914]),
            (brushed, c, [0.003_859_279_2, 0.008_795_027]),
            (brushed, d, [0.290_711_97, 0.358_442_57]),
            (beckmann, a, [0.032_662_023, 0.032_662_03]),
            (beckmann, b, [0.120_253_28, 0.124_326_095]),
            (beckmann, c, [0.000_766_241, 0.001_724_042_3]),
            (beckmann, d, [0.478_683_47, 0.478_726_8]),
        ];
        for (facets, [wo, wi], [value, pdf]) in asked {
            let white = || Rgb::WHITE.into();
            let glass = RoughDielectric::new(facets, 1.5, white(), white()).unwrap().at([0.0; 2]);
            let (wo, wi) = (direction(wo), direction(wi));
            // As for the rough conductor; refraction triples the error of the half vector. Mitsuba's G₁ of Beckmann is
            // an approximation within 0.35 %, and a value has two.
            let tolerance = if matches!(facets, Facets::Beckmann(_)) { 7e-3 } else { 1.5e-5 };
            let got = [glass.eval(wo, wi).g * wi.z.abs(), glass.pdf(wo, wi)];
            for (got, expected) in got.into_iter().zip([value, pdf]) {
                assert!(
                    (got / expected - 1.0_f32).abs() < tolerance,
                    "{facets:?} {wo} {wi}: {got} {expected}"
                );
            }
        }
    }
}
