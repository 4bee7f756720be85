//! Microscopic mirrors of either distribution.

use glam::Vec3;

use super::beckmann::Beckmann;
use super::conductor::check_range;
use super::microfacet::Ggx;
use crate::error::ParamError;

/// Microscopic mirrors; what the functions mean is said at [`Ggx`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Facets {
    /// Trowbridge–Reitz: long tails.
    Ggx(Ggx),
    /// Normally distributed slopes.
    Beckmann(Beckmann),
}

impl Facets {
    /// Roughness along the two tangents.
    pub fn alpha(&self) -> [f32; 2] {
        match self {
            Self::Ggx(f) => f.alpha,
            Self::Beckmann(f) => f.alpha,
        }
    }

    /// Whether the surface is smooth: roughness 0 in both directions.
    pub fn is_smooth(&self) -> bool {
        self.alpha() == [0.0; 2]
    }

    /// Whether the two directions differ.
    pub fn is_anisotropic(&self) -> bool {
        let [u, v] = self.alpha();
        u != v
    }

    /// Checks that a rough surface can have them.
    ///
    /// # Errors
    /// [`ParamError`] for a roughness outside 0.0001 to 10.
    pub(super) fn check(&self) -> Result<(), ParamError> {
        let accepted = "0 (smooth, in both directions) or 0.0001 to 10";
        self.alpha().into_iter().try_for_each(|value| check_range("alpha", value, [1e-4, 10.0], accepted))
    }

    /// D(m), per steradian.
    pub fn d(&self, m: Vec3) -> f32 {
        match self {
            Self::Ggx(f) => f.d(m),
            Self::Beckmann(f) => f.d(m),
        }
    }

    /// G₁(w) for `w` above the surface.
    pub fn g1(&self, w: Vec3) -> f32 {
        match self {
            Self::Ggx(f) => f.g1(w),
            Self::Beckmann(f) => f.g1(w),
        }
    }

    /// G₁(w)/(2 cos θ), finite at grazing angles.
    pub fn g1_over_2cos(&self, w: Vec3) -> f32 {
        match self {
            Self::Ggx(f) => f.g1_over_2cos(w),
            Self::Beckmann(f) => f.g1_over_2cos(w),
        }
    }

    /// A normal as seen from `w`, for `u` in [0, 1)²: of density G₁(w) max(0, w·m) D(m)/cos θ per steradian.
    pub fn sample_visible(&self, w: Vec3, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Ggx(f) => f.sample_visible(w, u),
            Self::Beckmann(f) => f.sample_visible(w, u),
        }
    }
}

impl From<Ggx> for Facets {
    fn from(facets: Ggx) -> Self {
        Self::Ggx(facets)
    }
}

impl From<Beckmann> for Facets {
    fn from(facets: Beckmann) -> Self {
        Self::Beckmann(facets)
    }
}
