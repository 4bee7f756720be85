//! Rank 4: what surfaces do to light.
//!
//! A [`Material`] belongs to a scene; [`Material::bsdf`] looks its textures up and gives the [`Bsdf`] of one point,
//! which is evaluated and sampled in the local frame.

mod blur_disk;
mod bsdf;
mod conductor;
mod dielectric;
mod diffuse;
pub mod fresnel;
pub mod microfacet;
mod mirror;
mod phong;
mod rough;

pub use blur_disk::BlurDisk;
pub use bsdf::{Branch, Bsdf, BsdfSample, Lobe};
pub use conductor::{Conductor, Metal};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use mirror::Mirror;
pub use phong::Phong;
pub use rough::RoughConductor;

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
    /// A rough metal (GGX).
    RoughConductor(RoughConductor<Texture>),
    /// Smooth glass.
    Dielectric(Dielectric<Texture>),
    /// The classic blurred reflection and refraction.
    BlurDisk(BlurDisk<Texture>),
    /// The modified Phong model.
    Phong(Phong<Texture>),
    /// A material whose lower side scatters as its upper side does.
    TwoSided(Box<Self>),
}

/// Which random decisions a material makes, and which effects it calls for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Calls {
    /// It chooses among lobes: [`Bsdf::sample`] looks at `u_lobe`.
    pub lobe: bool,
    /// It chooses a direction in a lobe: [`Bsdf::sample`] looks at `u`.
    pub direction: bool,
    /// It has a lobe that is neither one direction nor diffuse.
    pub rough: bool,
    /// Light can pass through it.
    pub dielectric: bool,
    /// All its lobes are single directions: light sampling finds nothing.
    pub delta_only: bool,
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

    /// A metal with GGX roughness `alpha` along its two tangents; the smooth metal where both are 0.
    ///
    /// # Errors
    /// [`ParamError`] for a roughness that is neither 0 in both directions nor 0.0001 to 10, or a reflectance
    /// outside [0, 1].
    pub fn new_rough_conductor(
        alpha: [f32; 2],
        metal: Metal,
        specular_reflectance: Texture,
    ) -> Result<Self, ParamError> {
        if alpha == [0.0; 2] {
            return Self::new_conductor(metal, specular_reflectance);
        }
        RoughConductor::new(alpha, metal, specular_reflectance).map(Self::RoughConductor)
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

    /// The material at the surface coordinates `uv`.
    pub fn bsdf(&self, uv: [f32; 2]) -> Bsdf {
        let kind = match self {
            Self::Diffuse(m) => Kind::Diffuse(m.at(uv)),
            Self::Mirror(m) => Kind::Mirror(m.at(uv)),
            Self::Conductor(m) => Kind::Conductor(m.at(uv)),
            Self::RoughConductor(m) => Kind::RoughConductor(m.at(uv)),
            Self::Dielectric(m) => Kind::Dielectric(m.at(uv)),
            Self::BlurDisk(m) => Kind::BlurDisk(m.at(uv)),
            Self::Phong(m) => Kind::Phong(m.at(uv)),
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
            Self::RoughConductor(_) => Calls { direction: true, rough: true, ..none },
            Self::Dielectric(_) => Calls { lobe: true, dielectric: true, delta_only: true, ..none },
            Self::BlurDisk(m) => {
                Calls { lobe: m.forks(), direction: true, rough: true, dielectric: m.forks(), ..none }
            }
            Self::Phong(_) => Calls { lobe: true, direction: true, rough: true, ..none },
            Self::TwoSided(inner) => inner.calls_for(),
        }
    }

    /// The material with each rough lobe at its null value, alpha or blur 0.
    ///
    /// Returns: `None` for models without such a value.
    pub fn sharp(&self) -> Option<Self> {
        match self {
            Self::RoughConductor(m) => m.sharp(),
            Self::BlurDisk(m) => m.sharp(),
            Self::TwoSided(inner) => inner.sharp().map(|inner| Self::TwoSided(Box::new(inner))),
            other => (!other.calls_for().rough).then(|| other.clone()),
        }
    }

    /// Whether light passes as if the surface were not there: a dielectric of index 1 that lets all through.
    pub fn is_absent(&self) -> bool {
        matches!(self, Self::Dielectric(m) if m.is_absent())
    }
}
