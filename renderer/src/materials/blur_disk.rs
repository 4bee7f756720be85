//! Fuzzy mirrors and frosted glass: ideal directions perturbed on a disk.

use std::f32::consts::PI;

use glam::Vec3;

use super::Material;
use super::bsdf::{Branch, BsdfSample, Lobe};
use super::conductor::check_range;
use super::dielectric::{check_eta, ideal};
use super::fresnel::{self, Interface};
use crate::error::ParamError;
use crate::math::float::round_f32;
use crate::math::{Frame, Rgb};
use crate::sampling::warp;
use crate::texture::Texture;

/// The classic blurred reflection and refraction: w = (r + f ξ)/|r + f ξ|, with r the ideal direction, f the blur
/// and ξ uniform on the unit disk perpendicular to r.
///
/// Without an index it is a fuzzy mirror, black from below; with one, reflection is weighted with Fresnel's F at
/// the ideal angle and refraction with (1 − F)/η². A direction that ends on the wrong side of the surface, by the
/// sign of its product with the normal, is dropped, and its light is lost.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
///
/// # Measure
/// Density per steradian of a branch: p(w) = 1/(π f² cos³γ) where tan γ ≤ f, γ the angle between w and r; the disk
/// at distance 1 has the density 1/(π f²) per area, and dA = dω/cos³γ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlurDisk<C> {
    blur: f32,
    eta: Option<f32>,
    reflectance: C,
    transmittance: C,
}

impl BlurDisk<Texture> {
    /// The blurred surface.
    ///
    /// * `blur` f: radius of the disk at distance 1, 0.0001 to 100.
    /// * `eta`: interior over exterior index, 0.001 to 1000; `None` for reflection only.
    /// * `specular_reflectance`, `specular_transmittance`: further factors of the two branches, in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for values outside these ranges.
    pub fn new(
        blur: f32,
        eta: Option<f32>,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        check_range("blur", blur, [1e-4, 100.0], "0 (sharp) or 0.0001 to 100")?;
        eta.map_or(Ok(()), check_eta)?;
        specular_reflectance.check_reflectance("specular_reflectance")?;
        specular_transmittance.check_reflectance("specular_transmittance")?;
        Ok(Self { blur, eta, reflectance: specular_reflectance, transmittance: specular_transmittance })
    }

    /// The same surface without blur.
    pub(super) fn sharp(&self) -> Option<Material> {
        Material::new_blur_disk(0.0, self.eta, self.reflectance.clone(), self.transmittance.clone()).ok()
    }

    /// Whether it refracts, too.
    pub fn forks(&self) -> bool {
        self.eta.is_some()
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.reflectance.varies() || self.transmittance.varies()
    }

    /// The surface at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> BlurDisk<Rgb> {
        let (reflectance, transmittance) = (self.reflectance.eval(uv), self.transmittance.eval(uv));
        BlurDisk { blur: self.blur, eta: self.eta, reflectance, transmittance }
    }
}

impl BlurDisk<Rgb> {
    /// Whether it refracts, too.
    pub fn forks(&self) -> bool {
        self.eta.is_some()
    }

    /// Fresnel's reflectance seen from `wo`; 1 without an index.
    pub fn reflect_probability(&self, wo: Vec3) -> f32 {
        self.interface(wo).reflectance
    }

    /// f \[1/sr\]: [`Self::eval_cos`] over |cos θᵢ|.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let value = self.eval_cos(wo, wi);
        if value.is_black() { value } else { value / wi.z.abs() }
    }

    /// f |cos θᵢ| \[1/sr\]: the branch's weight times its density.
    pub fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let branch = branch_of(wo, wi);
        let interface = self.interface(wo);
        self.weight(interface, branch) * self.density(wo, wi, interface, branch)
    }

    /// The density of `wi` after a choice that reflects with probability F.
    ///
    /// # Measure
    /// Per steradian; the integral falls short of 1 by the share of dropped directions.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let branch = branch_of(wo, wi);
        let interface = self.interface(wo);
        choice(interface, branch) * self.density(wo, wi, interface, branch)
    }

    /// The density of `wi` within its own branch.
    ///
    /// # Measure
    /// Per steradian; the integral over each side falls short of 1 by that side's share of dropped directions.
    pub fn branch_pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.density(wo, wi, self.interface(wo), branch_of(wo, wi))
    }

    /// Reflects when `u_lobe` < F, else refracts, and perturbs; the weights are ρ and τ/η².
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let interface = self.interface(wo);
        let branch = if u_lobe < interface.reflectance { Branch::Reflect } else { Branch::Refract };
        let sample = self.perturbed(wo, interface, branch, u)?;
        Some(sample.chosen_with(choice(interface, branch)))
    }

    /// A perturbed direction of one branch; the weights are ρ F and τ (1 − F)/η².
    pub fn sample_branch(&self, wo: Vec3, branch: Branch, u: [f32; 2]) -> Option<BsdfSample> {
        self.perturbed(wo, self.interface(wo), branch, u)
    }

    fn perturbed(&self, wo: Vec3, interface: Interface, branch: Branch, u: [f32; 2]) -> Option<BsdfSample> {
        let r = self.ideal(wo, interface, branch)?;
        let on_disk = warp::square_to_disk(u) * self.blur;
        let wi = Frame::from_z(r).to_world(on_disk.extend(1.0)).normalize();
        if wi.z * r.z <= 0.0 {
            return None;
        }
        let transmitted = branch == Branch::Refract;
        let pdf = self.peak() * inverse_cos_cubed(on_disk.length_squared());
        let weight = self.weight(interface, branch);
        let eta_rel = if transmitted { interface.eta_rel } else { 1.0 };
        Some(BsdfSample { wi, weight, pdf, lobe: Lobe::Spread, transmitted, eta_rel })
    }

    /// The density on the disk: 1/(π f²).
    fn peak(&self) -> f32 {
        1.0 / (PI * self.blur * self.blur)
    }

    fn density(&self, wo: Vec3, wi: Vec3, interface: Interface, branch: Branch) -> f32 {
        let Some(r) = self.ideal(wo, interface, branch) else { return 0.0 };
        // In f64: a cosine of 1/100 has few digits in f32, and a tangent of 1e-4 fewer.
        let (ideal, given) = (r.as_dvec3(), wi.as_dvec3());
        let cos = ideal.dot(given);
        let tan2 = ideal.cross(given).length_squared() / (cos * cos);
        let blur2 = f64::from(self.blur) * f64::from(self.blur);
        let inside = cos > 0.0 && wi.z * r.z > 0.0 && tan2 <= blur2;
        let density = (1.0 + tan2) * (1.0 + tan2).sqrt() / (std::f64::consts::PI * blur2);
        if inside { round_f32(density) } else { 0.0 }
    }

    /// The direction that is perturbed; `None` where the branch scatters nothing.
    fn ideal(&self, wo: Vec3, interface: Interface, branch: Branch) -> Option<Vec3> {
        let seen = if self.forks() { wo.z != 0.0 } else { wo.z > 0.0 };
        if seen { ideal(wo, interface, branch) } else { None }
    }

    fn weight(&self, interface: Interface, branch: Branch) -> Rgb {
        match branch {
            Branch::Reflect => self.reflectance * interface.reflectance,
            Branch::Refract => {
                self.transmittance * (interface.transmittance / (interface.eta_rel * interface.eta_rel))
            }
        }
    }

    fn interface(&self, wo: Vec3) -> Interface {
        match self.eta {
            Some(eta) => fresnel::dielectric(wo.z, eta),
            None => Interface { reflectance: 1.0, transmittance: 0.0, cos_t: None, eta_rel: 1.0 },
        }
    }
}

/// 1/cos³ of the angle whose squared tangent is `tan2`.
fn inverse_cos_cubed(tan2: f32) -> f32 {
    (1.0 + tan2) * (1.0 + tan2).sqrt()
}

/// The branch by which light from `wi` can reach `wo`.
fn branch_of(wo: Vec3, wi: Vec3) -> Branch {
    if wo.z * wi.z > 0.0 { Branch::Reflect } else { Branch::Refract }
}

/// The probability of a branch when reflection is chosen with probability F.
fn choice(interface: Interface, branch: Branch) -> f32 {
    match branch {
        Branch::Reflect => interface.reflectance,
        Branch::Refract => interface.transmittance,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(blur: f32, eta: Option<f32>) -> BlurDisk<Rgb> {
        BlurDisk::new(blur, eta, Rgb::WHITE.into(), Rgb::WHITE.into()).unwrap().at([0.0; 2])
    }

    fn tilted(angle: f32) -> Vec3 {
        Vec3::new(angle.sin(), 0.0, angle.cos())
    }

    #[test]
    fn the_density_is_that_of_the_disk_at_distance_one() {
        let fuzzy = surface(0.5, None);
        for (angle, expected) in [
            (0.0, 1.0 / (PI * 0.25)),
            (0.3, 1.0 / (PI * 0.25 * 0.3_f32.cos().powi(3))),
            (0.463, 1.0 / (PI * 0.25 * 0.463_f32.cos().powi(3))),
            (0.464, 0.0), // atan ½ = 0.46365
            (1.0, 0.0),
        ] {
            let got = fuzzy.pdf(Vec3::Z, tilted(angle));
            assert!((got - expected).abs() <= 1e-6 * expected, "{angle}: {got}"); // ten roundings of 2⁻²⁴
        }
    }

    #[test]
    fn the_density_adds_up_to_one_where_nothing_is_dropped() {
        for (blur, eta, angle) in [(0.5, None, 0.2), (0.1, None, 1.2), (0.3, Some(1.5), 0.4)] {
            let (surface, wo) = (surface(blur, eta), tilted(angle));
            for branch in [Branch::Reflect, Branch::Refract] {
                let Some(r) = ideal(wo, surface.interface(wo), branch) else { continue };
                let frame = Frame::from_z(r);
                let rows = 2000_u16;
                let mut sum = 0.0;
                for i in 0..rows {
                    // Rings of equal width up to the rim: tan γ = f x, dω = cos³γ f² x dx dφ.
                    let x = (f32::from(i) + 0.5) / f32::from(rows);
                    for phi in [0.1_f32, 1.7, 3.3, 4.9] {
                        let at = frame.to_world(Vec3::new(blur * x * phi.cos(), blur * x * phi.sin(), 1.0));
                        let cos = 1.0 / at.length();
                        let pdf = surface.branch_pdf(wo, at.normalize());
                        sum += f64::from(pdf * cos.powi(3) * blur * blur * x) / f64::from(rows) / 4.0;
                    }
                }
                let total = sum * std::f64::consts::TAU;
                // The midpoint rule is exact on x; each term has some ten roundings of 2⁻²⁴.
                assert!((total - 1.0).abs() < 1e-6, "{blur} {eta:?} {branch:?}: {total}");
            }
        }
    }

    #[test]
    fn a_direction_that_flips_is_dropped() {
        let wo = tilted(1.5); // 0.0708 above the horizon: more than half of a wide disk is below
        let fuzzy = surface(1.0, None);
        let n = 1000_u16;
        let kept = (0..n).filter_map(|i| {
            let u = [f32::from(i) / f32::from(n), (f32::from(i) * 0.618_034).fract()];
            fuzzy.sample(wo, 0.0, u)
        });
        let mut count = 0;
        for sample in kept {
            assert!(sample.wi.z > 0.0);
            count += 1;
        }
        // The chord at distance tan 0.0708 from the centre leaves ½ + (0.0709 √(1 − 0.0709²) + asin 0.0709)/π = 0.5451
        // of the disk; 1000 points of a spiral miss an area by less than their spacing, 1/√1000.
        assert!((f64::from(count) / 1000.0 - 0.5451).abs() < 0.032, "{count}");
    }
}
