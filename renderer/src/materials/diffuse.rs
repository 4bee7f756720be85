//! Surfaces that look equally bright from everywhere.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use wide::f32x8;

use super::Material;
use super::bsdf::{BsdfSample, Lobe};
use crate::error::ParamError;
use crate::math::Rgb;
use crate::math::eight::Vec3x8;
use crate::sampling::warp;
use crate::texture::Texture;

/// An ideally diffuse reflector: f = ρ/π above the surface, 0 below it.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diffuse<C> {
    reflectance: C,
}

impl Diffuse<Texture> {
    /// The diffuse surface of reflectance ρ, each channel in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1].
    pub fn new(reflectance: Texture) -> Result<Self, ParamError> {
        reflectance.check_reflectance("reflectance")?;
        Ok(Self { reflectance })
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.reflectance.varies()
    }

    /// The reflector at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Diffuse<Rgb> {
        Diffuse { reflectance: self.reflectance.eval(uv) }
    }
}

impl Diffuse<Rgb> {
    /// f = ρ/π \[1/sr\]; 0 unless both directions are above the surface.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z > 0.0 && wi.z > 0.0 { self.reflectance * FRAC_1_PI } else { Rgb::BLACK }
    }

    /// cos θᵢ/π; 0 unless both directions are above the surface.
    ///
    /// # Measure
    /// Per steradian.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z > 0.0 && wi.z > 0.0 { wi.z * FRAC_1_PI } else { 0.0 }
    }

    /// A direction in proportion to its cosine; the weight is ρ.
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        let wi = warp::square_to_cosine_hemisphere(u);
        let pdf = self.pdf(wo, wi);
        let (weight, lobe) = (self.reflectance, Lobe::Spread);
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, transmitted: false, eta_rel: 1.0 })
    }
}

impl Material {
    /// What it is at the surface coordinates `uv` if it is diffuse, from one side or equally from both.
    #[inline]
    pub fn matte(&self, uv: [f32; 2]) -> Option<Matte> {
        match self {
            Self::Diffuse(m) => Some(Matte { diffuse: m.at(uv), two_sided: false }),
            Self::TwoSided(inner) => match &**inner {
                Self::Diffuse(m) => Some(Matte { diffuse: m.at(uv), two_sided: true }),
                _ => None,
            },
            _ => None,
        }
    }

    /// Whether it is diffuse, from one side or equally from both.
    pub fn is_matte(&self) -> bool {
        match self {
            Self::Diffuse(_) => true,
            Self::TwoSided(inner) => inner.is_matte(),
            _ => false,
        }
    }
}

/// A diffuse surface at one point, of which one side scatters, or both alike: what its [`super::Bsdf`] says, without asking
/// which material it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matte {
    pub(super) diffuse: Diffuse<Rgb>,
    pub(super) two_sided: bool,
}

impl Matte {
    /// The weight of every direction.
    #[inline]
    pub fn reflectance(&self) -> Rgb {
        self.diffuse.reflectance
    }

    /// f |cos θᵢ| \[1/sr\] and the density of the direction towards the light, by the cosines of both directions.
    #[inline]
    pub fn eval_cos(&self, cos_o: f32, cos_i: f32) -> (Rgb, f32) {
        let sign = if self.two_sided && cos_o < 0.0 { -1.0 } else { 1.0 };
        let [wo, wi] = [cos_o, cos_i].map(|cos| Vec3::new(0.0, 0.0, sign * cos));
        (self.diffuse.eval(wo, wi) * cos_i.abs(), self.diffuse.pdf(wo, wi))
    }

    /// Which side scatters light to an eye under the cosine `cos_o`: 1 that of the normal, −1 the other one, 0 none.
    #[inline]
    pub fn side(&self, cos_o: f32) -> f32 {
        if cos_o > 0.0 {
            1.0
        } else if self.two_sided && cos_o < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    /// Directions in proportion to their cosines on eight sides, bit for bit as `Bsdf::sample` takes them; the densities are 0 if nothing comes of it.
    ///
    /// # Measure
    /// Per steradian.
    #[inline]
    pub fn eight_directions(side: f32x8, u: [f32x8; 2]) -> (Vec3x8, f32x8) {
        let wi = warp::squares_to_cosine_hemisphere(u);
        let pdf = wi.0[2] * (side.abs() * FRAC_1_PI);
        (wi * side, pdf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matte_surface_is_what_its_bsdf_says() {
        let one = Material::new_diffuse(Rgb { r: 0.3, g: 0.6, b: 0.9 }.into()).unwrap();
        let both = Material::TwoSided(Box::new(one.clone()));
        let (up, aside) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.48, 0.64, 0.6));
        for material in [one, both] {
            let (matte, bsdf) = (material.matte([0.0; 2]).unwrap(), material.bsdf([0.0; 2]));
            for (wo, wi) in [(up, aside), (-up, aside), (up, -aside), (-up, -aside)] {
                assert_eq!(matte.eval_cos(wo.z, wi.z), (bsdf.eval_cos(wo, wi), bsdf.pdf(wo, wi)));
                let (side, u) = (f32x8::splat(matte.side(wo.z)), [0.3, 0.9].map(f32x8::splat));
                let (wi, pdf) = Matte::eight_directions(side, u);
                let (wi, pdf) = (wi.get(3), pdf.to_array()[3]);
                let sample = bsdf.sample(wo, 0.5, [0.3, 0.9]);
                assert_eq!((pdf > 0.0).then_some((wi, pdf)), sample.map(|s| (s.wi, s.pdf)));
                assert!(sample.is_none_or(|s| s.weight == matte.reflectance()));
            }
        }
        let mirror = Material::new_mirror(Rgb::WHITE.into()).unwrap();
        assert_eq!(Material::TwoSided(Box::new(mirror)).matte([0.0; 2]), None);
    }
}
