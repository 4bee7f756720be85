//! Two materials mixed.

use glam::Vec3;

use super::bsdf::{Bsdf, BsdfSample, Lobe};
use super::{Calls, Material};
use crate::error::ParamError;
use crate::math::Rgb;
use crate::math::float::ONE_MINUS_EPSILON;
use crate::texture::Texture;

/// A share w of the second material and 1 − w of the first: f = (1 − w) f₁ + w f₂.
#[derive(Debug, Clone, PartialEq)]
pub struct Blend {
    weight: Texture,
    parts: Box<[Material; 2]>,
}

/// The blend at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlendAt<'m> {
    weight: f32,
    parts: &'m [Material; 2],
    uv: [f32; 2],
}

impl Blend {
    /// The share `weight` of the second of `parts`; of colours counts what [`Texture::eval_scalar`] says.
    ///
    /// # Errors
    /// [`ParamError`] for a weight outside [0, 1].
    pub fn new(weight: Texture, parts: [Material; 2]) -> Result<Self, ParamError> {
        weight.check_reflectance("weight")?;
        Ok(Self { weight, parts: Box::new(parts) })
    }

    /// The same mixture of both parts' sharp forms.
    pub(super) fn sharp(&self) -> Option<Material> {
        let [first, second] = &*self.parts;
        Material::new_blend(self.weight.clone(), [first.sharp()?, second.sharp()?]).ok()
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.weight.varies() || self.parts.iter().any(Material::is_textured)
    }

    /// What either part calls for, and a choice between them.
    pub fn calls_for(&self) -> Calls {
        Calls { lobe: true, ..self.parts[0].calls_for().or(self.parts[1].calls_for()) }
    }

    /// The blend at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> BlendAt<'_> {
        BlendAt { weight: self.weight.eval_scalar(uv), parts: &self.parts, uv }
    }
}

impl BlendAt<'_> {
    /// Both parts with their shares.
    fn parts(&self) -> [(Bsdf<'_>, f32); 2] {
        let [first, second] = self.parts;
        [(first.bsdf(self.uv), 1.0 - self.weight), (second.bsdf(self.uv), self.weight)]
    }

    /// (1 − w) f₁ + w f₂ \[1/sr\].
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let [(a, p), (b, q)] = self.parts();
        a.eval_share(p, wo, wi) + b.eval_share(q, wo, wi)
    }

    /// The same times |cos θᵢ|.
    pub fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let [(a, p), (b, q)] = self.parts();
        a.eval_cos(wo, wi) * p + b.eval_cos(wo, wi) * q
    }

    /// The mixture of both densities.
    ///
    /// # Measure
    /// Per steradian.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let [(a, p), (b, q)] = self.parts();
        a.pdf(wo, wi) * p + b.pdf(wo, wi) * q
    }

    /// One of the parts by its share; a direction that is one of many has the weight of both together.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let [(first, p), (second, q)] = self.parts();
        let (part, share, below) = if u_lobe < p { (first, p, 0.0) } else { (second, q, p) };
        let again = ((u_lobe - below) / share).min(ONE_MINUS_EPSILON);
        let sample = part.sample(wo, again, u)?;
        if sample.lobe == Lobe::Delta {
            return Some(BsdfSample { pdf: sample.pdf * share, ..sample });
        }
        let pdf = self.pdf(wo, sample.wi);
        (pdf > 0.0).then(|| BsdfSample { weight: self.eval_cos(wo, sample.wi) / pdf, pdf, ..sample })
    }
}
