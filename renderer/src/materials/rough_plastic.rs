//! Rough plastic: a diffuse body under a clear, rough coat.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::Material;
use super::bsdf::BsdfSample;
use super::dielectric::check_eta;
use super::facets::Facets;
use super::fresnel;
use super::microfacet::half_vector;
use super::plastic::{Body, highlight};
use crate::error::ParamError;
use crate::math::Rgb;
use crate::math::float::round_f32;
use crate::sampling::warp;
use crate::texture::Texture;

/// Cosines, from 0 to 1 in equal steps, at which the light that passes the coat is tabulated.
const NODES: u8 = 64;

/// A coat of microfacets of index η over a diffuse body: f = ρs F(wo·h) D(h) G₁(wo) G₁(wi)/(4 cos θₒ cos θᵢ) +
/// T(θₒ) T(θᵢ)/(π η²) · ρd/(1 − Fᵢ); black from below.
///
/// T is the share of light that microfacets refract to the other side, (1 − F) G₁ averaged over visible normals, linear
/// between 64 cosines. Fᵢ is twice the mean over the same cosines of what they reflect on the inside, F G₁ averaged,
/// times the cosine. Light that meets a second facet is lost.
///
/// # Source
/// The plugin `roughplastic` of Mitsuba 3.9.1, tables and Fᵢ included: the mean over cosines with both ends lets Fᵢ
/// fall 0.011 short of the integral at an index of 1.49, so that under a smooth coat the body would be 2.7 % darker.
#[derive(Debug, Clone, PartialEq)]
pub struct RoughPlastic {
    coat: Coat,
    diffuse: Texture,
    specular: Texture,
}

/// What is the same at every point of the surface.
#[derive(Debug, Clone, PartialEq)]
struct Coat {
    facets: Facets,
    body: Body,
    /// T at the nodes.
    passed: Vec<f32>,
    highlight: f32,
}

/// The rough plastic at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughPlasticAt<'m> {
    coat: &'m Coat,
    diffuse: Rgb,
    specular: Rgb,
}

impl RoughPlastic {
    /// The plastic of index `eta` with the microfacets `facets`.
    ///
    /// * `eta`: interior over exterior index, 0.001 to 1000.
    /// * `nonlinear`: whether colours saturate by internal reflection.
    ///
    /// # Errors
    /// [`ParamError`] for values outside these ranges, roughness outside 0.0001 to 10 and reflectances outside
    /// [0, 1].
    pub fn new(
        facets: Facets,
        eta: f32,
        nonlinear: bool,
        diffuse: Texture,
        specular: Texture,
    ) -> Result<Self, ParamError> {
        check_eta(eta)?;
        facets.check()?;
        diffuse.check_reflectance("diffuse_reflectance")?;
        specular.check_reflectance("specular_reflectance")?;
        let nodes = || (0..NODES).map(|i| f32::from(i) / f32::from(NODES - 1));
        let passed = nodes().map(|cos| round_f32(refracted(&facets, cos, eta))).collect();
        let inside = |cos: f32| reflected(&facets, cos, 1.0 / eta) * f64::from(cos);
        let internal = 2.0 * nodes().map(inside).sum::<f64>() / f64::from(NODES);
        let highlight = highlight(&diffuse, &specular);
        let coat = Coat {
            facets,
            body: Body { eta, escaping: round_f32(1.0 - internal), nonlinear },
            passed,
            highlight,
        };
        Ok(Self { coat, diffuse, specular })
    }

    /// The same body under a smooth coat.
    pub(super) fn sharp(&self) -> Option<Material> {
        let Body { eta, nonlinear, .. } = self.coat.body;
        Material::new_plastic(eta, nonlinear, self.diffuse.clone(), self.specular.clone()).ok()
    }

    /// Whether roughness differs along the two tangents.
    pub fn is_anisotropic(&self) -> bool {
        self.coat.facets.is_anisotropic()
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.diffuse.varies() || self.specular.varies()
    }

    /// The plastic at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> RoughPlasticAt<'_> {
        RoughPlasticAt { coat: &self.coat, diffuse: self.diffuse.eval(uv), specular: self.specular.eval(uv) }
    }
}

/// The share of light from the cosine `cos` that microfacets of index `eta` reflect: F(wo·h) G₁(wi).
fn reflected(facets: &Facets, cos: f32, eta: f32) -> f64 {
    over_visible(facets, cos, |wo, h, c| {
        let wi = h * (2.0 * c) - wo;
        if wi.z > 0.0 { fresnel::dielectric(c, eta).reflectance * facets.g1(wi) } else { 0.0 }
    })
}

/// The share of light from the cosine `cos` that microfacets of index `eta` refract: (1 − F(wo·h)) G₁(wi).
fn refracted(facets: &Facets, cos: f32, eta: f32) -> f64 {
    over_visible(facets, cos, |wo, h, c| {
        let interface = fresnel::dielectric(c, eta);
        let Some(cos_t) = interface.cos_t else { return 0.0 };
        let wi = h * (c / eta - cos_t) - wo / eta;
        if wi.z < 0.0 { interface.transmittance * facets.g1(-wi) } else { 0.0 }
    })
}

/// The mean of `f`(wo, h, wo·h) over visible normals h, by the midpoint rule on 48² of them.
fn over_visible(facets: &Facets, cos: f32, f: impl Fn(Vec3, Vec3, f32) -> f32) -> f64 {
    const SIDE: u8 = 48;
    // The limit of grazing light; its facets are seen from 1e-6 above the surface.
    let cos = cos.max(1e-6);
    let wo = Vec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
    let at = |i: u8| (f32::from(i) + 0.5) / f32::from(SIDE);
    let mut sum = 0.0;
    for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
        let h = facets.sample_visible(wo, [at(i), at(j)]);
        sum += f64::from(f(wo, h, wo.dot(h).clamp(0.0, 1.0)));
    }
    sum / (f64::from(SIDE) * f64::from(SIDE))
}

impl Coat {
    /// T at the cosine `z` in (0, 1].
    fn passed(&self, z: f32) -> f32 {
        let x = z.min(1.0) * f32::from(NODES - 1);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "x lies in (0, 63]")]
        let below = (x as usize).min(usize::from(NODES) - 2);
        let share = x - below as f32;
        self.passed[below] * (1.0 - share) + self.passed[below + 1] * share
    }

    /// The probability of the coat's reflection, and of the body.
    fn shares(&self, z: f32) -> [f32; 2] {
        let passed = self.passed(z);
        let (coat, body) = ((1.0 - passed) * self.highlight, passed * (1.0 - self.highlight));
        let sum = coat + body;
        if sum > 0.0 { [coat / sum, body / sum] } else { [0.0, 1.0] }
    }
}

impl RoughPlasticAt<'_> {
    /// f \[1/sr\]; 0 unless both directions are above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let Coat { facets, body, .. } = self.coat;
        let (h, cos) = half_vector(wo, wi);
        let fresnel = fresnel::dielectric(cos.clamp(0.0, 1.0), body.eta).reflectance;
        let shadowing = facets.g1_over_2cos(wo) * facets.g1_over_2cos(wi);
        let through = self.coat.passed(wo.z) * self.coat.passed(wi.z);
        self.specular * (fresnel * facets.d(h) * shadowing) + body.eval(self.diffuse) * through
    }

    /// The mixture of mirrored visible normals, G₁(wo) D(h)/(4 cos θₒ), and cos θᵢ/π.
    ///
    /// # Measure
    /// Per steradian; the integral falls short of 1 by the share of mirrored directions below the surface.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let facets = &self.coat.facets;
        let [coat, body] = self.coat.shares(wo.z);
        let mirrored = facets.d(half_vector(wo, wi).0) * facets.g1_over_2cos(wo) / 2.0;
        coat * mirrored + body * wi.z * FRAC_1_PI
    }

    /// Mirrors `wo` at a visible microfacet, or gives a direction in proportion to its cosine.
    ///
    /// Returns: `None` for a mirrored direction below the surface.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let [coat, _] = self.coat.shares(wo.z);
        let wi = if u_lobe < coat {
            let h = self.coat.facets.sample_visible(wo, u);
            (h * (2.0 * wo.dot(h)) - wo).normalize()
        } else {
            warp::square_to_cosine_hemisphere(u)
        };
        BsdfSample::drawn(wi, self.eval(wo, wi), self.pdf(wo, wi))
    }
}

#[cfg(test)]
mod tests {
    use super::super::beckmann::Beckmann;
    use super::super::microfacet::Ggx;
    use super::super::testing::direction;
    use super::*;

    /// f cos θᵢ and pdf that Mitsuba 3.9.1 (`scalar_rgb`) returned for its default indices.
    #[test]
    fn values_are_those_of_mitsuba() {
        let [a, b] = [[[0.3, 0.2], [0.5, 3.0]], [[1.2, 0.7], [1.3, 3.6]]];
        let (grey, orange) = (Rgb::splat(0.5), Rgb::new(0.8, 0.5, 0.2));
        let ggx: Facets = Ggx { alpha: [0.3; 2] }.into();
        let beckmann: Facets = Beckmann { alpha: [0.3; 2] }.into();
        let asked = [
            (ggx, grey, a, [0.123_288_95; 3], 0.317_399_68),
            (ggx, grey, b, [0.085_175_79; 3], 0.183_035_76),
            (beckmann, orange, a, [0.190_975_76, 0.110_015_85, 0.057_454_754], 0.319_635_84),
            (beckmann, orange, b, [0.155_812_73, 0.137_067_17, 0.124_897_115], 0.241_010_79),
        ];
        for (facets, diffuse, [wo, wi], value, pdf) in asked {
            let nonlinear = diffuse == orange;
            let eta = 1.49 / 1.000_277;
            let plastic =
                RoughPlastic::new(facets, eta, nonlinear, diffuse.into(), Rgb::WHITE.into()).unwrap();
            let bsdf = plastic.at([0.0; 2]);
            let (wo, wi) = (direction(wo), direction(wi));
            let got = bsdf.eval(wo, wi).to_array().map(|f| f * wi.z);
            // The integrals behind the tables, ours by midpoints and Mitsuba's by Gauss' rule, differ by some 1e-3;
            // Mitsuba's two G₁ of Beckmann are approximations within 0.35 %.
            let tolerance = if matches!(facets, Facets::Beckmann(_)) { 8e-3 } else { 2e-3 };
            for (got, expected) in got.into_iter().zip(value).chain([(bsdf.pdf(wo, wi), pdf)]) {
                assert!((got / expected - 1.0_f32).abs() < tolerance, "{facets:?}: {got} {expected}");
            }
        }
    }
}
