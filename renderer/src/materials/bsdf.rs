//! What light does at one point of a surface: the material with its textures looked up.

use glam::Vec3;

use super::blend::BlendAt;
use super::blur_disk::BlurDisk;
use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::diffuse::Diffuse;
use super::faces::FacesAt;
use super::mask::MaskAt;
use super::mirror::Mirror;
use super::phong::Phong;
use super::plastic::Plastic;
use super::rough::RoughConductor;
use super::rough_dielectric::RoughDielectric;
use super::rough_plastic::RoughPlasticAt;
use super::thin_dielectric::ThinDielectric;
use crate::math::Rgb;

/// Whether a sampled direction is one of a few or one of a continuum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lobe {
    /// One of finitely many directions: light sampling cannot find it.
    Delta,
    /// One of a continuum, with a density per steradian.
    Spread,
}

/// The two ways light can go at the boundary of a dielectric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// Back into the medium it came from.
    Reflect,
    /// Into the other medium.
    Refract,
}

/// A direction drawn from a BSDF.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// Towards the light, unit, local frame.
    pub wi: Vec3,
    /// f·|cos θᵢ| / pdf: what the incident radiance is multiplied by; dimensionless.
    pub weight: Rgb,
    /// Per steradian for [`Lobe::Spread`]; the probability of the choice for [`Lobe::Delta`].
    pub pdf: f32,
    /// Which kind of direction it is.
    pub lobe: Lobe,
    /// Whether `wi` and `wo` are on different sides of the surface.
    pub transmitted: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`; 1 unless transmitted.
    pub eta_rel: f32,
}

impl BsdfSample {
    /// A reflected direction of a delta lobe that is the only one.
    pub(super) fn mirrored(wo: Vec3, weight: Rgb) -> Self {
        let wi = reflected(wo);
        Self { wi, weight, pdf: 1.0, lobe: Lobe::Delta, transmitted: false, eta_rel: 1.0 }
    }

    /// The direction straight on, of a delta lobe that is the only one.
    pub(super) fn straight(wo: Vec3, weight: Rgb) -> Self {
        Self { wi: -wo, weight, pdf: 1.0, lobe: Lobe::Delta, transmitted: true, eta_rel: 1.0 }
    }

    /// A direction above the surface, drawn with the density `pdf` where the value is `f`; `None` where nothing is drawn.
    pub(super) fn drawn(wi: Vec3, f: Rgb, pdf: f32) -> Option<Self> {
        let weight = f * (wi.z / pdf);
        (pdf > 0.0).then_some(Self { wi, weight, pdf, lobe: Lobe::Spread, transmitted: false, eta_rel: 1.0 })
    }

    /// By what refraction squeezes solid angles from the side of `wo` to that of `wi`: η², 1 where nothing is refracted.
    #[inline]
    pub fn squeezing(&self) -> f32 {
        if self.transmitted { self.eta_rel * self.eta_rel } else { 1.0 }
    }

    /// This sample after a choice that takes it with probability `p` in (0, 1].
    pub(super) fn chosen_with(self, p: f32) -> Self {
        Self { weight: self.weight / p, pdf: self.pdf * p, ..self }
    }
}

/// The mirror image of `w` about the local normal: (−x, −y, z).
pub(super) fn reflected(w: Vec3) -> Vec3 {
    Vec3::new(-w.x, -w.y, w.z)
}

/// The material at one point: a function of two directions in the local frame, z = `n`.
///
/// `wo` points to the eye and `wi` to the light, both away from the surface and of unit length. Values hold for
/// radiance: what is refracted is divided by the square of `eta_rel`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bsdf<'m> {
    pub(super) kind: Kind<'m>,
    /// Whether the lower side scatters as the upper side does.
    pub(super) two_sided: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind<'m> {
    Diffuse(Diffuse<Rgb>),
    Mirror(Mirror<Rgb>),
    Conductor(Conductor<Rgb>),
    RoughConductor(RoughConductor<Rgb>),
    Dielectric(Dielectric<Rgb>),
    RoughDielectric(RoughDielectric<Rgb>),
    ThinDielectric(ThinDielectric<Rgb>),
    BlurDisk(BlurDisk<Rgb>),
    Phong(Phong<Rgb>),
    Plastic(Plastic<Rgb>),
    RoughPlastic(RoughPlasticAt<'m>),
    Mask(MaskAt<'m>),
    Blend(BlendAt<'m>),
    Faces(FacesAt<'m>),
}

impl Bsdf<'_> {
    /// The value f(wo, wi), without the cosine; delta lobes give 0.
    ///
    /// A blur disk's value has the cosine in its denominator and overflows where that is below about 1e-31:
    /// estimators use [`Self::eval_cos`].
    ///
    /// Returns: 1/sr.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (wo, wi) = self.upward(wo, wi);
        match &self.kind {
            Kind::Diffuse(b) => b.eval(wo, wi),
            Kind::RoughConductor(b) => b.eval(wo, wi),
            Kind::RoughDielectric(b) => b.eval(wo, wi),
            Kind::BlurDisk(b) => b.eval(wo, wi),
            Kind::Phong(b) => b.eval(wo, wi),
            Kind::Plastic(b) => b.eval(wo, wi),
            Kind::RoughPlastic(b) => b.eval(wo, wi),
            Kind::Mask(b) => b.eval(wo, wi),
            Kind::Blend(b) => b.eval(wo, wi),
            Kind::Faces(b) => b.eval(wo, wi),
            Kind::Mirror(_) | Kind::Conductor(_) | Kind::Dielectric(_) | Kind::ThinDielectric(_) => {
                Rgb::BLACK
            }
        }
    }

    /// `share` times the value: nothing of what is absent, where the value itself overflows, too.
    pub(super) fn eval_share(&self, share: f32, wo: Vec3, wi: Vec3) -> Rgb {
        if share == 0.0 { Rgb::BLACK } else { self.eval(wo, wi) * share }
    }

    /// f(wo, wi) |cos θᵢ|, what incident radiance is multiplied by; finite for all directions.
    ///
    /// Returns: 1/sr; delta lobes give 0.
    pub fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let (up_o, up_i) = self.upward(wo, wi);
        match &self.kind {
            Kind::BlurDisk(b) => b.eval_cos(up_o, up_i),
            Kind::Mask(b) => b.eval_cos(up_o, up_i),
            Kind::Blend(b) => b.eval_cos(up_o, up_i),
            Kind::Faces(b) => b.eval_cos(up_o, up_i),
            _ => self.eval(wo, wi) * wi.z.abs(),
        }
    }

    /// The density with which [`Self::sample`] draws `wi`; delta lobes give 0.
    ///
    /// # Measure
    /// Per steradian. The integral over the sphere falls short of 1 by the probability that `sample` gives `None`
    /// or a delta lobe.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (wo, wi) = self.upward(wo, wi);
        match &self.kind {
            Kind::Diffuse(b) => b.pdf(wo, wi),
            Kind::RoughConductor(b) => b.pdf(wo, wi),
            Kind::RoughDielectric(b) => b.pdf(wo, wi),
            Kind::BlurDisk(b) => b.pdf(wo, wi),
            Kind::Phong(b) => b.pdf(wo, wi),
            Kind::Plastic(b) => b.pdf(wo, wi),
            Kind::RoughPlastic(b) => b.pdf(wo, wi),
            Kind::Mask(b) => b.pdf(wo, wi),
            Kind::Blend(b) => b.pdf(wo, wi),
            Kind::Faces(b) => b.pdf(wo, wi),
            Kind::Mirror(_) | Kind::Conductor(_) | Kind::Dielectric(_) | Kind::ThinDielectric(_) => 0.0,
        }
    }

    /// The density of `wi` in its own branch, as if that branch had been taken with certainty.
    ///
    /// Same as [`Self::pdf`] unless [`Self::forks`]; then the integral over each side is up to 1.
    ///
    /// # Measure
    /// Per steradian.
    pub fn branch_pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match &self.kind {
            Kind::BlurDisk(b) => {
                let (wo, wi) = self.upward(wo, wi);
                b.branch_pdf(wo, wi)
            }
            _ => self.pdf(wo, wi),
        }
    }

    /// Draws a direction towards the light.
    ///
    /// * `u_lobe`: in [0, 1), chooses the lobe; looked at only where [`super::Calls::lobe`] says so.
    /// * `u`: in [0, 1)², chooses the direction; looked at only where [`super::Calls::direction`] says so.
    ///
    /// Returns: `None` where nothing is scattered (below a one-sided surface, or a direction that was dropped).
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let flipped = self.two_sided && wo.z < 0.0;
        let wo = if flipped { -wo } else { wo };
        let sample = match &self.kind {
            Kind::Diffuse(b) => b.sample(wo, u),
            Kind::Mirror(b) => b.sample(wo),
            Kind::Conductor(b) => b.sample(wo),
            Kind::RoughConductor(b) => b.sample(wo, u),
            Kind::Dielectric(b) => b.sample(wo, u_lobe),
            Kind::RoughDielectric(b) => b.sample(wo, u_lobe, u),
            Kind::ThinDielectric(b) => b.sample(wo, u_lobe),
            Kind::BlurDisk(b) => b.sample(wo, u_lobe, u),
            Kind::Phong(b) => b.sample(wo, u_lobe, u),
            Kind::Plastic(b) => b.sample(wo, u_lobe, u),
            Kind::RoughPlastic(b) => b.sample(wo, u_lobe, u),
            Kind::Mask(b) => b.sample(wo, u_lobe, u),
            Kind::Blend(b) => b.sample(wo, u_lobe, u),
            Kind::Faces(b) => b.sample(wo, u_lobe, u),
        };
        sample.map(|s| BsdfSample { wi: if flipped { -s.wi } else { s.wi }, ..s })
    }

    /// Whether light can go two ways here, so that both may be followed: [`Self::sample_branch`]. Ground glass has a
    /// share of each for every facet, and masks and blends choose before: there one is followed, by its share.
    pub fn forks(&self) -> bool {
        match &self.kind {
            Kind::Dielectric(_) | Kind::ThinDielectric(_) => true,
            Kind::BlurDisk(b) => b.forks(),
            _ => false,
        }
    }

    /// Draws a direction of one branch; the weight is not divided by any probability of choosing that branch.
    ///
    /// * `u`: in [0, 1)², chooses the direction; looked at only where [`super::Calls::direction`] says so.
    ///
    /// Returns: `None` where that branch does not exist (total reflection), scatters nothing, or dropped its
    /// direction; always where [`Self::forks`] is false.
    pub fn sample_branch(&self, wo: Vec3, branch: Branch, u: [f32; 2]) -> Option<BsdfSample> {
        match &self.kind {
            Kind::Dielectric(b) => b.sample_branch(wo, branch),
            Kind::ThinDielectric(b) => b.sample_branch(wo, branch),
            Kind::BlurDisk(b) if b.forks() => b.sample_branch(wo, branch, u),
            _ => None,
        }
    }

    /// The Fresnel reflectance seen from `wo`: the probability with which [`Self::sample`] reflects; 1 for BSDFs
    /// that do not fork.
    pub fn branch_probability_fresnel(&self, wo: Vec3) -> f32 {
        match &self.kind {
            Kind::Dielectric(b) => b.interface(wo).reflectance,
            Kind::ThinDielectric(b) => b.shares(wo)[0],
            Kind::BlurDisk(b) => b.reflect_probability(wo),
            _ => 1.0,
        }
    }

    /// Both directions, turned upside down when the lower side of a two-sided surface is seen.
    fn upward(&self, wo: Vec3, wi: Vec3) -> (Vec3, Vec3) {
        if self.two_sided && wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) }
    }
}
