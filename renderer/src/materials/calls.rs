//! What a material asks of a render.

use super::Material;

/// Which random decisions a material makes, and which effects it calls for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Calls {
    /// It chooses among lobes: [`Bsdf::sample`](super::Bsdf::sample) looks at `u_lobe`.
    pub lobe: bool,
    /// It chooses a direction in a lobe: [`Bsdf::sample`](super::Bsdf::sample) looks at `u`.
    pub direction: bool,
    /// It has a lobe that is neither one direction nor diffuse.
    pub rough: bool,
    /// Light can pass through it.
    pub dielectric: bool,
    /// All its lobes are single directions: light sampling finds nothing.
    pub delta_only: bool,
    /// It is not the same in all directions around the normal: the frame's first tangent must be the surface's.
    pub anisotropic: bool,
}

impl Calls {
    /// What one of two materials calls for.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            lobe: self.lobe || other.lobe,
            direction: self.direction || other.direction,
            rough: self.rough || other.rough,
            dielectric: self.dielectric || other.dielectric,
            delta_only: self.delta_only && other.delta_only,
            anisotropic: self.anisotropic || other.anisotropic,
        }
    }
}

impl Material {
    /// Whether it looks at surface coordinates.
    pub fn is_textured(&self) -> bool {
        match self {
            Self::Diffuse(m) => m.is_textured(),
            Self::Mirror(m) => m.is_textured(),
            Self::Conductor(m) => m.is_textured(),
            Self::RoughConductor(m) => m.is_textured(),
            Self::Dielectric(m) => m.is_textured(),
            Self::RoughDielectric(m) => m.is_textured(),
            Self::ThinDielectric(m) => m.is_textured(),
            Self::BlurDisk(m) => m.is_textured(),
            Self::Phong(m) => m.is_textured(),
            Self::Plastic(m) => m.is_textured(),
            Self::RoughPlastic(m) => m.is_textured(),
            Self::Mask(m) => m.is_textured(),
            Self::Blend(m) => m.is_textured(),
            Self::Faces(m) => m.is_textured(),
            Self::TwoSided(inner) => inner.is_textured(),
        }
    }
}
