//! Smooth glass and water: light goes two ways.

use glam::Vec3;

use super::bsdf::{Branch, BsdfSample, Lobe, reflected};
use super::conductor::check_range;
use super::fresnel::{self, Interface};
use crate::error::ParamError;
use crate::math::Rgb;
use crate::texture::Texture;

/// A smooth boundary between two dielectrics, seen from either side.
///
/// L(wo) = ρ F L(wr) + τ (1 − F) L(wt)/η², with F Fresnel's reflectance, wr the mirrored and wt the refracted
/// direction, and η the index on the side of wt over that on the side of wo: radiance is squeezed into a smaller
/// solid angle in the denser medium.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric<C> {
    eta: f32,
    reflectance: C,
    transmittance: C,
}

/// Checks a ratio of indices of refraction.
pub(super) fn check_eta(eta: f32) -> Result<(), ParamError> {
    check_range("eta", eta, [1e-3, 1e3], "0.001 to 1000")
}

impl Dielectric<Texture> {
    /// The boundary of a medium with index `eta` relative to its outside.
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

    /// The boundary at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Dielectric<Rgb> {
        let (reflectance, transmittance) = (self.reflectance.eval(uv), self.transmittance.eval(uv));
        Dielectric { eta: self.eta, reflectance, transmittance }
    }
}

impl Dielectric<Rgb> {
    /// Fresnel's reflectance and Snell's cosine, seen from `wo`.
    pub fn interface(&self, wo: Vec3) -> Interface {
        fresnel::dielectric(wo.z, self.eta)
    }

    /// Reflects when `u_lobe` < F, else refracts: the weights are ρ and τ/η².
    pub fn sample(&self, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
        let interface = self.interface(wo);
        if u_lobe < interface.reflectance {
            let sample = self.branch(wo, interface, Branch::Reflect)?;
            Some(sample.chosen_with(interface.reflectance))
        } else {
            let sample = self.branch(wo, interface, Branch::Refract)?;
            Some(sample.chosen_with(interface.transmittance))
        }
    }

    /// The direction of one branch; the weights are ρ F and τ (1 − F)/η².
    pub fn sample_branch(&self, wo: Vec3, branch: Branch) -> Option<BsdfSample> {
        self.branch(wo, self.interface(wo), branch)
    }

    fn branch(&self, wo: Vec3, interface: Interface, branch: Branch) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        match branch {
            Branch::Reflect => Some(BsdfSample::mirrored(wo, self.reflectance * interface.reflectance)),
            Branch::Refract => {
                let eta_rel = interface.eta_rel;
                let wi = refracted(wo, interface)?;
                let weight = self.transmittance * (interface.transmittance / (eta_rel * eta_rel));
                Some(BsdfSample { wi, weight, pdf: 1.0, lobe: Lobe::Delta, transmitted: true, eta_rel })
            }
        }
    }
}

/// The direction that Snell's law gives to light seen along `wo`; `None` on total reflection.
pub(super) fn refracted(wo: Vec3, interface: Interface) -> Option<Vec3> {
    let cos_t = interface.cos_t?;
    let eta_rel = interface.eta_rel;
    Some(Vec3::new(-wo.x / eta_rel, -wo.y / eta_rel, -cos_t.copysign(wo.z)))
}

/// The direction mirrored or refracted at a boundary.
pub(super) fn ideal(wo: Vec3, interface: Interface, branch: Branch) -> Option<Vec3> {
    match branch {
        Branch::Reflect => Some(reflected(wo)),
        Branch::Refract => refracted(wo, interface),
    }
}
