//! The GGX distribution of microscopic mirrors.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

/// GGX (Trowbridge–Reitz) microfacets, rough by `alpha` along the local x and y.
///
/// D(m) = 1/(π αx αy ((mx/αx)² + (my/αy)² + mz²)²); Smith's shadowing for one direction is
/// G₁(w) = 2/(1 + √(1 + tan²)) with tan² = (αx²wx² + αy²wy²)/wz². All directions are on the upper side.
///
/// # Precision, limits
/// Nothing is divided by a cosine, and tangents come from x and y rather than from 1 − z²: roughness from 1e-4
/// keeps its digits, up to those that the half vector has lost.
///
/// # Source
/// Walter, Marschner, Li, Torrance 2007, equations 33 and 34; anisotropy: Heitz 2014, section 5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    /// Roughness along x and y, positive.
    pub alpha: [f32; 2],
}

impl Ggx {
    /// D(m): the area of microfacets with normal `m`, per area of the surface.
    ///
    /// # Measure
    /// Per steradian; ∫ D(m) cos θₘ dm = 1.
    pub fn d(&self, m: Vec3) -> f32 {
        let [ax, ay] = self.alpha;
        let (x, y) = (m.x / ax, m.y / ay);
        let r = x * x + y * y + m.z * m.z;
        1.0 / (PI * ax * ay * r * r)
    }

    /// √(αx²wx² + αy²wy² + wz²): the length of `w` where the surface is stretched to roughness 1.
    fn stretched_length(&self, w: Vec3) -> f32 {
        let (x, y) = (self.alpha[0] * w.x, self.alpha[1] * w.y);
        (x * x + y * y + w.z * w.z).sqrt()
    }

    /// G₁(w): the visible share of the microfacets that face `w`, which is above the surface.
    pub fn g1(&self, w: Vec3) -> f32 {
        2.0 * w.z / (w.z + self.stretched_length(w))
    }

    /// G₁(w)/(2 cos θ) without the quotient, finite at grazing angles.
    pub fn g1_over_2cos(&self, w: Vec3) -> f32 {
        1.0 / (w.z + self.stretched_length(w))
    }

    /// Draws a normal as seen from `w`: in proportion to G₁(w) max(0, w·m) D(m)/cos θ.
    ///
    /// In the space stretched to roughness 1 the visible microfacets are a hemisphere, and a mirror on it spreads
    /// `w` evenly over the spherical cap above −w; the normal is half way between.
    ///
    /// # Measure
    /// Per steradian of normals.
    ///
    /// # Source
    /// Dupuy, Benyoub 2023: Sampling Visible GGX Normals with Spherical Caps, listing 3; 1 + z is kept as
    /// (1 − u)(1 + cos θ) rather than by difference.
    pub fn sample_visible(&self, w: Vec3, u: [f32; 2]) -> Vec3 {
        let [ax, ay] = self.alpha;
        let ws = Vec3::new(ax * w.x, ay * w.y, w.z).normalize();
        let below = u[1] * (1.0 + ws.z);
        let radius = (below * (2.0 - below)).sqrt();
        let (sin, cos) = libm::sincosf(TAU * u[0]);
        let half = Vec3::new(radius * cos + ws.x, radius * sin + ws.y, (1.0 - u[1]) * (1.0 + ws.z));
        Vec3::new(ax * half.x, ay * half.y, half.z).normalize()
    }
}
