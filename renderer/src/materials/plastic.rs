//! Smooth plastic: a diffuse body under a clear, smooth coat.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::bsdf::BsdfSample;
use super::dielectric::check_eta;
use super::fresnel;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::math::float::round_f32;
use crate::sampling::warp;
use crate::texture::Texture;

/// The diffuse body under a coat of index η: what is scattered inside and comes out after any number of internal
/// reflections.
///
/// A share ρ of the light that enters is scattered; of it a share Fᵢ is reflected back inside by the coat, and so
/// on: ρ/(1 − ρFᵢ) in all, or ρ/(1 − Fᵢ) where colours are to stay what they are after many reflections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Body {
    /// Interior over exterior index.
    pub(super) eta: f32,
    /// 1 − Fᵢ: the share of diffuse light that gets out.
    pub(super) escaping: f32,
    /// Whether colours saturate by internal reflection.
    pub(super) nonlinear: bool,
}

impl Body {
    /// The BSDF of the body \[1/sr\] without the shares that pass the coat on the way in and out.
    pub(super) fn eval(&self, reflectance: Rgb) -> Rgb {
        let scale = FRAC_1_PI / (self.eta * self.eta);
        let scattered = |rho: f32| {
            // 1 − ρFᵢ without the difference of what may be near 1
            let lost = if self.nonlinear { (1.0 - rho) + rho * self.escaping } else { self.escaping };
            scale * rho / lost
        };
        reflectance.map(scattered)
    }
}

/// The share of the samples that a highlight of mean reflectance `specular` takes beside a body of mean `diffuse`,
/// where both let the same light through.
pub(super) fn highlight(diffuse: &Texture, specular: &Texture) -> f32 {
    let (d, s) = (diffuse.mean(), specular.mean());
    if s > 0.0 { s / (d + s) } else { 0.0 }
}

/// A smooth coat of index η over a diffuse body: L(wo) = ρs F L(wr) + ∫ f L cos θᵢ dω with
/// f = (1 − F(θₒ)) (1 − F(θᵢ))/(π η²) · ρd/(1 − Fᵢ); black from below.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
///
/// # Source
/// The plugin `plastic` of Mitsuba 3.9.1, which has a fit for Fᵢ (0.0005 too large at an index of 1.49) where this
/// has the integral; with it a white body that is `nonlinear` reflects all light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plastic<C> {
    body: Body,
    diffuse: C,
    specular: C,
    highlight: f32,
}

impl Plastic<Texture> {
    /// The plastic of index `eta`.
    ///
    /// * `eta`: interior over exterior index, 0.001 to 1000.
    /// * `nonlinear`: whether colours saturate by internal reflection.
    ///
    /// # Errors
    /// [`ParamError`] for values outside these ranges and reflectances outside [0, 1].
    pub fn new(eta: f32, nonlinear: bool, diffuse: Texture, specular: Texture) -> Result<Self, ParamError> {
        check_eta(eta)?;
        diffuse.check_reflectance("diffuse_reflectance")?;
        specular.check_reflectance("specular_reflectance")?;
        let escaping = round_f32(fresnel::diffuse_escaping(eta));
        let highlight = highlight(&diffuse, &specular);
        Ok(Self { body: Body { eta, escaping, nonlinear }, diffuse, specular, highlight })
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.diffuse.varies() || self.specular.varies()
    }

    /// The plastic at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Plastic<Rgb> {
        let (diffuse, specular) = (self.diffuse.eval(uv), self.specular.eval(uv));
        Plastic { body: self.body, diffuse, specular, highlight: self.highlight }
    }
}

impl Plastic<Rgb> {
    /// f of the body \[1/sr\]; 0 unless both directions are above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let passed = |z: f32| fresnel::dielectric(z, self.body.eta).transmittance;
        self.body.eval(self.diffuse) * (passed(wo.z) * passed(wi.z))
    }

    /// The probability of the mirrored direction, and of the body.
    fn shares(&self, reflected: f32, passed: f32) -> [f32; 2] {
        let (coat, body) = (reflected * self.highlight, passed * (1.0 - self.highlight));
        let sum = coat + body;
        if sum > 0.0 { [coat / sum, body / sum] } else { [0.0, 1.0] }
    }

    /// cos θᵢ/π times the probability of the body.
    ///
    /// # Measure
    /// Per steradian; the integral falls short of 1 by the probability of the mirrored direction.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let coat = fresnel::dielectric(wo.z, self.body.eta);
        self.shares(coat.reflectance, coat.transmittance)[1] * wi.z * FRAC_1_PI
    }

    /// The mirrored direction or one in proportion to its cosine.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let coat = fresnel::dielectric(wo.z, self.body.eta);
        let [mirrored, _] = self.shares(coat.reflectance, coat.transmittance);
        if u_lobe < mirrored {
            return Some(BsdfSample::mirrored(wo, self.specular * coat.reflectance).chosen_with(mirrored));
        }
        let wi = warp::square_to_cosine_hemisphere(u);
        BsdfSample::drawn(wi, self.eval(wo, wi), self.pdf(wo, wi))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::direction;
    use super::*;

    /// f cos θᵢ and pdf that Mitsuba 3.9.1 (`scalar_rgb`) returned for its default indices.
    #[test]
    fn values_are_those_of_mitsuba() {
        let [a, b] = [[[0.3, 0.2], [0.5, 3.0]], [[1.2, 0.7], [1.3, 3.6]]];
        let grey = Rgb::splat(0.5);
        let orange = Rgb::new(0.8, 0.5, 0.2);
        let asked = [
            (false, grey, a, [0.141_849_06; 3], 0.258_469_5),
            (false, grey, b, [0.030_093_31; 3], 0.062_401_414),
            (true, orange, a, [0.176_158_68, 0.082_425_41, 0.026_347_613], 0.258_469_5),
            (true, orange, b, [0.037_372_105, 0.017_486_57, 0.005_589_652_3], 0.062_401_414),
        ];
        for (nonlinear, diffuse, [wo, wi], value, pdf) in asked {
            let eta = 1.49 / 1.000_277;
            let plastic =
                Plastic::new(eta, nonlinear, diffuse.into(), Rgb::WHITE.into()).unwrap().at([0.0; 2]);
            let (wo, wi) = (direction(wo), direction(wi));
            let got = plastic.eval(wo, wi).to_array().map(|f| f * wi.z);
            for (got, expected) in got.into_iter().zip(value) {
                // Mitsuba's fit of Fᵢ is 0.00049 too large, on 1 − Fᵢ = 0.41.
                assert!((got / expected - 1.0_f32).abs() < 1.3e-3, "{got} {expected}");
            }
            if diffuse == grey {
                // Directions are rounded by 2⁻²⁴; Fresnel's reflectance turns by up to 4 per unit of the cosine.
                assert!((plastic.pdf(wo, wi) / pdf - 1.0_f32).abs() < 2e-6, "{} {pdf}", plastic.pdf(wo, wi));
            }
        }
    }
}
