//! Window panes: two parallel boundaries so close together that light passes straight through.

use glam::Vec3;

use super::bsdf::{Branch, BsdfSample};
use super::dielectric::check_eta;
use super::fresnel;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::texture::Texture;

/// A thin pane seen from either side: L(wo) = ρ R L(wr) + τ (1 − R) L(−wo).
///
/// R = 2F/(1 + F) adds up the light that is reflected back and forth between the two faces.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
///
/// # Source
/// Stokes 1862, "On the Intensity of the Light Reflected from or Transmitted through a Pile of Plates": the sum of
/// F + (1 − F)² F (1 + F² + F⁴ + …).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinDielectric<C> {
    eta: f32,
    reflectance: C,
    transmittance: C,
}

impl ThinDielectric<Texture> {
    /// The pane of a medium with index `eta` relative to what is on both sides.
    ///
    /// * `eta`: interior over exterior index, 0.001 to 1000.
    /// * `specular_reflectance` ρ, `specular_transmittance` τ: factors that physics has at 1, in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for values outside these ranges.
    pub fn new(
        eta: f32,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        check_eta(eta)?;
        specular_reflectance.check_reflectance("specular_reflectance")?;
        specular_transmittance.check_reflectance("specular_transmittance")?;
        Ok(Self { eta, reflectance: specular_reflectance, transmittance: specular_transmittance })
    }

    /// Whether light passes as if nothing were there: index 1 and a transmittance of exactly 1.
    pub fn is_absent(&self) -> bool {
        self.eta == 1.0 && self.transmittance.range() == [1.0, 1.0]
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.reflectance.varies() || self.transmittance.varies()
    }

    /// The pane at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> ThinDielectric<Rgb> {
        let (reflectance, transmittance) = (self.reflectance.eval(uv), self.transmittance.eval(uv));
        ThinDielectric { eta: self.eta, reflectance, transmittance }
    }
}

impl ThinDielectric<Rgb> {
    /// R and 1 − R, seen from `wo`, without that difference.
    pub fn shares(&self, wo: Vec3) -> [f32; 2] {
        let face = fresnel::dielectric(wo.z.abs(), self.eta);
        let sum = 1.0 + face.reflectance;
        [2.0 * face.reflectance / sum, face.transmittance / sum]
    }

    /// Reflects when `u_lobe` < R, else lets pass: the weights are ρ and τ.
    pub fn sample(&self, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
        let [reflected, passed] = self.shares(wo);
        let (branch, share) =
            if u_lobe < reflected { (Branch::Reflect, reflected) } else { (Branch::Refract, passed) };
        Some(self.sample_branch(wo, branch)?.chosen_with(share))
    }

    /// The direction of one branch; the weights are ρ R and τ (1 − R).
    pub fn sample_branch(&self, wo: Vec3, branch: Branch) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let [reflected, passed] = self.shares(wo);
        match branch {
            Branch::Reflect => Some(BsdfSample::mirrored(wo, self.reflectance * reflected)),
            Branch::Refract => Some(BsdfSample::straight(wo, self.transmittance * passed)),
        }
    }
}
