//! Smooth metals.

use glam::Vec3;

use super::bsdf::BsdfSample;
use super::fresnel;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::texture::Texture;

/// A mirror that reflects what Fresnel's equations say for a complex index η − ik; black from below.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductor<C> {
    metal: Metal,
    reflectance: C,
}

/// The complex index of refraction η − ik of a metal, by channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metal {
    eta: Rgb,
    k: Rgb,
}

impl Metal {
    /// The metal of index `eta` and extinction `k`, each channel 0 to 1e6.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`], [`ParamError::OutOfRange`].
    pub fn new(eta: Rgb, k: Rgb) -> Result<Self, ParamError> {
        for (name, rgb) in [("eta", eta), ("k", k)] {
            for value in rgb.to_array() {
                check_range(name, value, [0.0, 1e6], "0 to 1e6")?;
            }
        }
        Ok(Self { eta, k })
    }

    /// The reflectance at the cosine `cos_i` in [0, 1].
    pub fn reflectance(&self, cos_i: f32) -> Rgb {
        fresnel::conductor(cos_i, self.eta, self.k)
    }
}

/// Checks that a parameter is finite and within its inclusive range.
pub(super) fn check_range(
    name: &'static str,
    value: f32,
    range: [f32; 2],
    accepted: &'static str,
) -> Result<(), ParamError> {
    if !value.is_finite() {
        return Err(ParamError::NotFinite { name, value: f64::from(value) });
    }
    if !(range[0]..=range[1]).contains(&value) {
        return Err(ParamError::OutOfRange { name, value: f64::from(value), accepted });
    }
    Ok(())
}

impl Conductor<Texture> {
    /// The smooth metal, its reflectance multiplied by `specular_reflectance`, each channel in [0, 1].
    ///
    /// # Errors
    /// [`ParamError`] for a reflectance outside [0, 1].
    pub fn new(metal: Metal, specular_reflectance: Texture) -> Result<Self, ParamError> {
        specular_reflectance.check_reflectance("specular_reflectance")?;
        Ok(Self { metal, reflectance: specular_reflectance })
    }

    /// Whether it looks at surface coordinates.
    pub(super) fn is_textured(&self) -> bool {
        self.reflectance.varies()
    }

    /// The metal at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Conductor<Rgb> {
        Conductor { metal: self.metal, reflectance: self.reflectance.eval(uv) }
    }
}

impl Conductor<Rgb> {
    /// The mirrored direction; its weight is ρ F(cos θ).
    pub fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        (wo.z > 0.0).then(|| BsdfSample::mirrored(wo, self.reflectance * self.metal.reflectance(wo.z)))
    }
}
