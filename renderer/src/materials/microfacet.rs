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
    /// Dupuy, Benyoub 2023: Sampling Visible GGX Normals with Spherical Caps, listing 3; 1 + z and 1 − z of
    /// the spread direction are kept as (1 − u)(1 + cos θ) and with sin²θ/(1 + cos θ) rather than by differences.
    pub fn sample_visible(&self, w: Vec3, u: [f32; 2]) -> Vec3 {
        let [ax, ay] = self.alpha;
        let ws = Vec3::new(ax * w.x, ay * w.y, w.z).normalize();
        let below = u[1] * (1.0 + ws.z);
        // 2 − below, from 1 − u and from 1 − cos θ by the sine.
        let above = (1.0 - u[1]) * (1.0 + ws.z) + (ws.x * ws.x + ws.y * ws.y) / (1.0 + ws.z);
        let radius = (below * above).sqrt();
        let (sin, cos) = libm::sincosf(TAU * u[0]);
        let half = Vec3::new(radius * cos + ws.x, radius * sin + ws.y, (1.0 - u[1]) * (1.0 + ws.z));
        Vec3::new(ax * half.x, ay * half.y, half.z).normalize()
    }
}

/// The unit vector h half way between two directions above the surface, and the cosine |a + b|/2 between it and
/// either.
///
/// # Precision, limits
/// The same bits for both orders of the directions. Two opposite grazing directions may sum to less than the square
/// root of the smallest f32; such a sum is scaled up before its length is taken.
pub fn half_vector(a: Vec3, b: Vec3) -> (Vec3, f32) {
    let sum = a + b;
    let length_squared = sum.length_squared();
    if length_squared > f32::MIN_POSITIVE {
        let length = length_squared.sqrt();
        return (sum / length, length / 2.0);
    }
    let size = sum.abs().max_element();
    let scaled = sum / size;
    (scaled.normalize(), scaled.length() * size / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUGHNESS: [[f32; 2]; 4] = [[0.05, 0.05], [0.1, 0.4], [0.5, 0.5], [1.0, 2.0]];

    fn direction(cos: f64, phi: f64) -> Vec3 {
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        glam::DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3()
    }

    /// ∫ f(w) dw over cos θ in `from`..1 by the midpoint rule; the mesh is finer towards the pole, where lobes peak.
    fn integral(from: f64, f: impl Fn(Vec3) -> f32) -> f64 {
        let (rows, columns) = (1000_i32, 256_i32);
        let mut sum = 0.0;
        for i in 0..rows {
            let x = (f64::from(i) + 0.5) / f64::from(rows);
            let theta_max = from.acos();
            let theta = theta_max * x * x;
            let measure = theta.sin() * theta_max * 2.0 * x / f64::from(rows);
            for j in 0..columns {
                let phi = (f64::from(j) + 0.5) * std::f64::consts::TAU / f64::from(columns);
                sum += f64::from(f(direction(theta.cos(), phi))) * measure;
            }
        }
        sum * std::f64::consts::TAU / f64::from(columns)
    }

    #[test]
    fn microfacets_project_onto_the_surface_exactly() {
        for alpha in ROUGHNESS {
            let facets = Ggx { alpha };
            let area = integral(0.0, |m| facets.d(m) * m.z);
            // The midpoint rule on 1000 rows of a function of width above α: (π/2 / 1000 / 0.05)²/24 < 5e-5.
            assert!((area - 1.0).abs() < 5e-5, "{alpha:?}: {area}");
        }
    }

    #[test]
    fn visible_microfacets_fill_the_view_exactly() {
        for alpha in ROUGHNESS {
            for (cos, phi) in [(0.95, 0.3), (0.5, 1.0), (0.2, 2.0)] {
                let (facets, v) = (Ggx { alpha }, direction(cos, phi));
                let area = integral(0.0, |m| facets.g1(v) * facets.d(m) * v.dot(m).max(0.0));
                // As above, plus the kink of max(0, ·): one row or column's share of it, below 1e-4.
                assert!((area - cos).abs() < 1.5e-4, "{alpha:?} {cos}: {area}");
            }
        }
    }

    #[test]
    fn weak_white_furnace() {
        for alpha in [[0.3, 0.3], [0.5, 0.8], [1.0, 1.0]] {
            for (cos, phi) in [(0.95, 0.3), (0.5, 1.0), (0.2, 2.0)] {
                let (facets, v) = (Ggx { alpha }, direction(cos, phi));
                let total = integral(-1.0, |l| {
                    let h = v + l;
                    let length = h.length();
                    if h.z <= 0.0 { 0.0 } else { facets.g1(v) * facets.d(h / length) / (4.0 * v.z) }
                });
                // The cut at h.z = 0 passes through one cell in a row: at most 1/256 of its density's mass there.
                assert!((total - 1.0).abs() < 4e-3, "{alpha:?} {cos}: {total}");
            }
        }
    }

    #[test]
    fn half_vectors_of_opposite_grazing_directions_are_units() {
        for z in [1e-10_f32, 1e-20, 1e-30, 1e-44] {
            let half = half_vector(Vec3::new(1.0, 0.0, z), Vec3::new(-1.0, 0.0, z));
            assert_eq!(half, (Vec3::Z, z), "{z}");
        }
    }

    #[test]
    fn visible_normals_at_the_edges_of_the_square_are_units_above_the_surface() {
        let last = 1.0 - f32::EPSILON / 2.0;
        for alpha in [[1e-4, 1e-4], [1e-4, 10.0], [10.0, 10.0]] {
            for w in [Vec3::Z, Vec3::new(1.0, 0.0, 1e-30), direction(1e-4, 1.0), direction(0.7, 4.0)] {
                for u in [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last], [0.5, last]] {
                    let m = Ggx { alpha }.sample_visible(w, u);
                    assert!(m.is_normalized() && m.z >= 0.0, "{alpha:?} {w} {u:?}: {m}");
                }
            }
        }
    }
}
