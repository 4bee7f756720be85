//! Materials with holes: opacity.

use glam::Vec3;

use super::Material;
use super::bsdf::BsdfSample;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::math::float::ONE_MINUS_EPSILON;
use crate::texture::Texture;

/// A share α of `inner`; the rest of the light goes on as if nothing were there: f = α f', and a delta lobe of
/// weight 1 − α straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    opacity: Texture,
    inner: Box<Material>,
}

/// The mask at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskAt<'m> {
    opacity: f32,
    inner: &'m Material,
    uv: [f32; 2],
}

impl Mask {
    /// The share `opacity` of `inner`; of colours counts what [`Texture::eval_scalar`] says.
    ///
    /// # Errors
    /// [`ParamError`] for an opacity outside [0, 1].
    pub fn new(opacity: Texture, inner: Material) -> Result<Self, ParamError> {
        opacity.check_reflectance("opacity")?;
        Ok(Self { opacity, inner: Box::new(inner) })
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.opacity.varies() || self.inner.is_textured()
    }

    /// The same share of the inner material's sharp form.
    pub(super) fn sharp(&self) -> Option<Material> {
        Material::new_mask(self.opacity.clone(), self.inner.sharp()?).ok()
    }

    /// What is left where the mask is opaque.
    pub fn inner(&self) -> &Material {
        &self.inner
    }

    /// Whether there is nothing but holes.
    pub fn is_absent(&self) -> bool {
        self.opacity.max() == 0.0
    }

    /// The mask at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> MaskAt<'_> {
        MaskAt { opacity: self.opacity.eval_scalar(uv), inner: &self.inner, uv }
    }
}

impl MaskAt<'_> {
    /// α f' \[1/sr\].
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.inner.bsdf(self.uv).eval_share(self.opacity, wo, wi)
    }

    /// α f' |cos θᵢ| \[1/sr\].
    pub fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.inner.bsdf(self.uv).eval_cos(wo, wi) * self.opacity
    }

    /// α times the inner density.
    ///
    /// # Measure
    /// Per steradian; the integral falls short of 1 by the probability of a hole, too.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.inner.bsdf(self.uv).pdf(wo, wi) * self.opacity
    }

    /// The inner material with the probability α, else straight on.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let alpha = self.opacity;
        if u_lobe < alpha {
            let again = (u_lobe / alpha).min(ONE_MINUS_EPSILON);
            let sample = self.inner.bsdf(self.uv).sample(wo, again, u)?;
            return Some(BsdfSample { pdf: sample.pdf * alpha, ..sample });
        }
        (wo.z != 0.0).then(|| BsdfSample::straight(wo, Rgb::splat(1.0 - alpha)).chosen_with(1.0 - alpha))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hole_shows_nothing_of_a_value_that_overflows() {
        let blurred = Material::new_blur_disk(1.0, None, Rgb::WHITE.into(), Rgb::WHITE.into()).unwrap();
        let (wo, grazing) = (Vec3::new(-0.8, 0.0, 0.6), Vec3::new(1.0, 0.0, 1e-44));
        assert_eq!(blurred.bsdf([0.0; 2]).eval(wo, grazing), Rgb::splat(f32::INFINITY));
        let hole = Mask::new(Rgb::BLACK.into(), blurred).unwrap();
        assert_eq!(hole.at([0.0; 2]).eval(wo, grazing), Rgb::BLACK);
    }
}
