//! The perfect mirror.

use glam::Vec3;

use super::bsdf::BsdfSample;
use crate::error::ParamError;
use crate::math::Rgb;
use crate::texture::Texture;

/// A mirror of the same reflectance ρ at every angle: L(wo) = ρ L(wi) with wi = 2 (n·wo) n − wo; black from below.
///
/// `C` is a [`Texture`] in a scene and an [`Rgb`] at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror<C> {
    reflectance: C,
}

impl Mirror<Texture> {
    /// The mirror of reflectance ρ, each channel in [0, 1].
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

    /// The mirror at the surface coordinates `uv`.
    pub fn at(&self, uv: [f32; 2]) -> Mirror<Rgb> {
        Mirror { reflectance: self.reflectance.eval(uv) }
    }
}

impl Mirror<Rgb> {
    /// The mirrored direction; its weight is ρ.
    pub fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        (wo.z > 0.0).then(|| BsdfSample::mirrored(wo, self.reflectance))
    }
}
