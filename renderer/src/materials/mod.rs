//! Rank 4: what surfaces do to light.
//!
//! A [`Material`] belongs to a scene; [`Material::bsdf`] looks its textures up and gives the [`Bsdf`] of one point,
//! which is evaluated and sampled in the local frame.

mod beckmann;
mod blend;
mod blur_disk;
mod bsdf;
mod calls;
mod conductor;
mod dielectric;
mod diffuse;
mod faces;
mod facets;
pub mod fresnel;
mod mask;
pub mod microfacet;
mod mirror;
mod phong;
mod plastic;
mod rough;
mod rough_dielectric;
mod rough_plastic;
mod thin_dielectric;

pub use beckmann::Beckmann;
pub use blend::Blend;
pub use blur_disk::BlurDisk;
pub use bsdf::{Branch, Bsdf, BsdfSample, Lobe};
pub use calls::Calls;
pub use conductor::{Conductor, Metal};
pub use dielectric::Dielectric;
pub use diffuse::{Diffuse, Matte};
pub use faces::Faces;
pub use facets::Facets;
pub use mask::Mask;
pub use microfacet::Ggx;
pub use mirror::Mirror;
pub use phong::Phong;
pub use plastic::Plastic;
pub use rough::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use thin_dielectric::ThinDielectric;

use crate::error::ParamError;
use crate::texture::Texture;
use bsdf::Kind;

/// What a surface does to light.
#[derive(Debug, Clone, PartialEq)]
pub enum Material {
    /// Equally bright from everywhere.
    Diffuse(Diffuse<Texture>),
    /// A perfect mirror.
    Mirror(Mirror<Texture>),
    /// A smooth metal.
    Conductor(Conductor<Texture>),
    /// A rough metal.
    RoughConductor(RoughConductor<Texture>),
    /// Smooth glass.
    Dielectric(Dielectric<Texture>),
    /// Ground glass.
    RoughDielectric(RoughDielectric<Texture>),
    /// A window pane.
    ThinDielectric(ThinDielectric<Texture>),
    /// The classic blurred reflection and refraction.
    BlurDisk(BlurDisk<Texture>),
    /// The modified Phong model.
    Phong(Phong<Texture>),
    /// A diffuse body under a smooth coat.
    Plastic(Plastic<Texture>),
    /// A diffuse body under a rough coat.
    RoughPlastic(Box<RoughPlastic>),
    /// A material with holes.
    Mask(Mask),
    /// A mixture of two materials.
    Blend(Blend),
    /// A material whose lower side scatters as its upper side does.
    TwoSided(Box<Self>),
    /// A material for each side.
    Faces(Faces),
}

impl Material {
    /// A diffuse surface: f = ρ/π.
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1].
    pub fn new_diffuse(reflectance: Texture) -> Result<Self, ParamError> {
        Diffuse::new(reflectance).map(Self::Diffuse)
    }

    /// A mirror of the same reflectance at every angle.
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1].
    pub fn new_mirror(reflectance: Texture) -> Result<Self, ParamError> {
        Mirror::new(reflectance).map(Self::Mirror)
    }

    /// A smooth metal.
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1].
    pub fn new_conductor(metal: Metal, specular_reflectance: Texture) -> Result<Self, ParamError> {
        Conductor::new(metal, specular_reflectance).map(Self::Conductor)
    }

    /// A metal with microfacets; the smooth metal where their roughness is 0 along both tangents.
    ///
    /// # Errors
    /// [`ParamError`] for a roughness that is neither 0 in both directions nor 0.0001 to 10, or a reflectance
    /// outside [0, 1].
    pub fn new_rough_conductor(
        facets: impl Into<Facets>,
        metal: Metal,
        specular_reflectance: Texture,
    ) -> Result<Self, ParamError> {
        let facets = facets.into();
        if facets.is_smooth() {
            return Self::new_conductor(metal, specular_reflectance);
        }
        RoughConductor::new(facets, metal, specular_reflectance).map(Self::RoughConductor)
    }

    /// A smooth boundary of interior over exterior index `eta`.
    ///
    /// # Errors
    /// [`ParamError`] for an index outside 0.001 to 1000 or a factor outside [0, 1].
    pub fn new_dielectric(
        eta: f32,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        Dielectric::new(eta, specular_reflectance, specular_transmittance).map(Self::Dielectric)
    }

    /// A boundary with microfacets; the smooth one where their roughness is 0 along both tangents, and where `eta` is
    /// 1: every facet then lets light pass straight on.
    ///
    /// # Errors
    /// [`ParamError`] for a roughness that is neither 0 in both directions nor 0.0001 to 10, an index outside 0.001
    /// to 1000 or a factor outside [0, 1].
    pub fn new_rough_dielectric(
        facets: impl Into<Facets>,
        eta: f32,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        let facets = facets.into();
        if facets.is_smooth() || eta == 1.0 {
            return Self::new_dielectric(eta, specular_reflectance, specular_transmittance);
        }
        RoughDielectric::new(facets, eta, specular_reflectance, specular_transmittance)
            .map(Self::RoughDielectric)
    }

    /// A thin pane of index `eta`.
    ///
    /// # Errors
    /// [`ParamError`] for an index outside 0.001 to 1000 or a factor outside [0, 1].
    pub fn new_thin_dielectric(
        eta: f32,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        ThinDielectric::new(eta, specular_reflectance, specular_transmittance).map(Self::ThinDielectric)
    }

    /// The classic blurred reflection (and refraction, where `eta` is given): the ideal direction perturbed on a
    /// disk of radius `blur` at distance 1. Blur 0 is the mirror or the smooth dielectric.
    ///
    /// # Errors
    /// [`ParamError`] for a blur that is neither 0 nor 0.0001 to 100, an index outside 0.001 to 1000, or a factor
    /// outside [0, 1].
    pub fn new_blur_disk(
        blur: f32,
        eta: Option<f32>,
        specular_reflectance: Texture,
        specular_transmittance: Texture,
    ) -> Result<Self, ParamError> {
        match eta {
            Some(eta) if blur == 0.0 => {
                Self::new_dielectric(eta, specular_reflectance, specular_transmittance)
            }
            None if blur == 0.0 => Self::new_mirror(specular_reflectance),
            _ => BlurDisk::new(blur, eta, specular_reflectance, specular_transmittance).map(Self::BlurDisk),
        }
    }

    /// The modified Phong model: f = ρd/π + ρs (n + 2)/(2π) cosⁿα.
    ///
    /// # Errors
    /// [`ParamError`] for reflectances that are outside [0, 1] or add up to more than 1, and for an exponent
    /// outside 0 to 1e6.
    pub fn new_phong(diffuse: Texture, specular: Texture, exponent: f32) -> Result<Self, ParamError> {
        Phong::new(diffuse, specular, exponent).map(Self::Phong)
    }

    /// A diffuse body under a smooth coat of index `eta`; colours saturate by internal reflection where `nonlinear`.
    ///
    /// # Errors
    /// [`ParamError`] for an index outside 0.001 to 1000 or a reflectance outside [0, 1].
    pub fn new_plastic(
        eta: f32,
        nonlinear: bool,
        diffuse: Texture,
        specular: Texture,
    ) -> Result<Self, ParamError> {
        Plastic::new(eta, nonlinear, diffuse, specular).map(Self::Plastic)
    }

    /// The same under a coat with microfacets; the smooth one where their roughness is 0.
    ///
    /// # Errors
    /// [`ParamError`] for a roughness that is neither 0 nor 0.0001 to 10, an index outside 0.001 to 1000 or a
    /// reflectance outside [0, 1].
    pub fn new_rough_plastic(
        facets: impl Into<Facets>,
        eta: f32,
        nonlinear: bool,
        diffuse: Texture,
        specular: Texture,
    ) -> Result<Self, ParamError> {
        let facets = facets.into();
        if facets.is_smooth() {
            return Self::new_plastic(eta, nonlinear, diffuse, specular);
        }
        let plastic = RoughPlastic::new(facets, eta, nonlinear, diffuse, specular)?;
        Ok(Self::RoughPlastic(Box::new(plastic)))
    }

    /// A share `opacity` of `inner`; `inner` itself where that is 1 everywhere.
    ///
    /// # Errors
    /// [`ParamError`] for an opacity outside [0, 1].
    pub fn new_mask(opacity: Texture, inner: Self) -> Result<Self, ParamError> {
        if opacity.range() == [1.0; 2] {
            return Ok(inner);
        }
        Mask::new(opacity, inner).map(Self::Mask)
    }

    /// A share `weight` of the second of `parts`, the rest of the first; one of them where that is 0 or 1 everywhere.
    ///
    /// # Errors
    /// [`ParamError`] for a weight outside [0, 1].
    pub fn new_blend(weight: Texture, parts: [Self; 2]) -> Result<Self, ParamError> {
        let [first, second] = parts;
        match weight.range() {
            [0.0, 0.0] => Ok(first),
            [1.0, 1.0] => Ok(second),
            _ => Blend::new(weight, [first, second]).map(Self::Blend),
        }
    }

    /// `inner` on both sides.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] when light can pass through `inner`.
    pub fn new_two_sided(inner: Self) -> Result<Self, ParamError> {
        if inner.calls_for().dielectric {
            let accepted = "a material that only reflects";
            return Err(ParamError::OutOfRange {
                name: "number of transmitting lobes",
                value: 1.0,
                accepted,
            });
        }
        Ok(Self::TwoSided(Box::new(inner)))
    }

    /// The first of `sides` above, the second below; [`Self::new_two_sided`] where they are the same.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] when light can pass through one of them.
    pub fn new_faces(sides: [Self; 2]) -> Result<Self, ParamError> {
        if sides[0] == sides[1] {
            let [side, _] = sides;
            return Self::new_two_sided(side);
        }
        Faces::new(sides).map(Self::Faces)
    }

    /// The material at the surface coordinates `uv`.
    pub fn bsdf(&self, uv: [f32; 2]) -> Bsdf<'_> {
        let kind = match self {
            Self::Diffuse(m) => Kind::Diffuse(m.at(uv)),
            Self::Mirror(m) => Kind::Mirror(m.at(uv)),
            Self::Conductor(m) => Kind::Conductor(m.at(uv)),
            Self::RoughConductor(m) => Kind::RoughConductor(m.at(uv)),
            Self::Dielectric(m) => Kind::Dielectric(m.at(uv)),
            Self::RoughDielectric(m) => Kind::RoughDielectric(m.at(uv)),
            Self::ThinDielectric(m) => Kind::ThinDielectric(m.at(uv)),
            Self::BlurDisk(m) => Kind::BlurDisk(m.at(uv)),
            Self::Phong(m) => Kind::Phong(m.at(uv)),
            Self::Plastic(m) => Kind::Plastic(m.at(uv)),
            Self::RoughPlastic(m) => Kind::RoughPlastic(m.at(uv)),
            Self::Mask(m) => Kind::Mask(m.at(uv)),
            Self::Blend(m) => Kind::Blend(m.at(uv)),
            Self::Faces(m) => Kind::Faces(m.at(uv)),
            Self::TwoSided(inner) => return Bsdf { two_sided: true, ..inner.bsdf(uv) },
        };
        Bsdf { kind, two_sided: false }
    }

    /// Which decisions it makes and which effects it calls for.
    pub fn calls_for(&self) -> Calls {
        let none = Calls::default();
        match self {
            Self::Diffuse(_) => Calls { direction: true, ..none },
            Self::Mirror(_) | Self::Conductor(_) => Calls { delta_only: true, ..none },
            Self::RoughConductor(m) => {
                Calls { direction: true, rough: true, anisotropic: m.is_anisotropic(), ..none }
            }
            Self::Dielectric(_) | Self::ThinDielectric(_) => {
                Calls { lobe: true, dielectric: true, delta_only: true, ..none }
            }
            Self::RoughDielectric(m) => Calls {
                lobe: true,
                direction: true,
                rough: true,
                dielectric: true,
                anisotropic: m.is_anisotropic(),
                ..none
            },
            Self::BlurDisk(m) => {
                Calls { lobe: m.forks(), direction: true, rough: true, dielectric: m.forks(), ..none }
            }
            Self::Phong(_) => Calls { lobe: true, direction: true, rough: true, ..none },
            Self::Plastic(_) => Calls { lobe: true, direction: true, ..none },
            Self::RoughPlastic(m) => {
                Calls { lobe: true, direction: true, rough: true, anisotropic: m.is_anisotropic(), ..none }
            }
            Self::Mask(m) => Calls { lobe: true, dielectric: true, ..m.inner().calls_for() },
            Self::Blend(m) => m.calls_for(),
            Self::Faces(m) => m.calls_for(),
            Self::TwoSided(inner) => inner.calls_for(),
        }
    }

    /// The material with each rough lobe at its null value, alpha or blur 0.
    ///
    /// Returns: `None` for models without such a value.
    pub fn sharp(&self) -> Option<Self> {
        match self {
            Self::RoughConductor(m) => m.sharp(),
            Self::RoughDielectric(m) => m.sharp(),
            Self::RoughPlastic(m) => m.sharp(),
            Self::BlurDisk(m) => m.sharp(),
            Self::Mask(m) => m.sharp(),
            Self::Blend(m) => m.sharp(),
            Self::Faces(m) => m.sharp(),
            Self::TwoSided(inner) => inner.sharp().map(|inner| Self::TwoSided(Box::new(inner))),
            other => (!other.calls_for().rough).then(|| other.clone()),
        }
    }

    /// Whether light passes as if the surface were not there: a dielectric of index 1 that lets all through, or a mask
    /// without opacity.
    pub fn is_absent(&self) -> bool {
        match self {
            Self::Dielectric(m) => m.is_absent(),
            Self::ThinDielectric(m) => m.is_absent(),
            Self::Mask(m) => m.is_absent(),
            _ => false,
        }
    }
}

#[cfg(test)]
mod testing {
    use glam::Vec3;

    /// The direction at the angle θ from the normal and φ around it, in radians.
    pub(super) fn direction([theta, phi]: [f32; 2]) -> Vec3 {
        Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    }
}
