//! The Beckmann distribution of microscopic mirrors.

use std::f32::consts::PI;
use std::f64::consts::PI as PI_64;

use glam::Vec3;

use crate::math::float::round_f32;

/// Beckmann microfacets, rough by `alpha` along the local x and y: slopes are normally distributed.
///
/// D(m) = exp(−t)/(π αx αy cos⁴θ) with t = ((mx/αx)² + (my/αy)²)/mz². Smith's shadowing for one direction is
/// G₁(w) = 2/(1 + erf a + exp(−a²)/(a√π)), 1/a² = (αx²wx² + αy²wy²)/wz². All directions are on the upper side.
///
/// # Precision, limits
/// G₁ has the error function, not the rational approximation of Walter et al. (0.35 %) that Mitsuba 3.9.1 uses, so
/// that `sample_visible`'s density is exact. An exponent −t has t·2⁻²⁴ of relative error.
///
/// # Source
/// Walter, Marschner, Li, Torrance 2007, equations 25 and 26; anisotropy: Heitz 2014, section 5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beckmann {
    /// Roughness along x and y, positive.
    pub alpha: [f32; 2],
}

/// Beyond this slope (in units of the roughness) there is less than a share of 1e-15 of the microfacets.
const STEEPEST: f64 = 6.0;

/// 2⁻²⁵, the middle of the first of the 2²⁴ equal parts that numbers in [0, 1) stand for.
const FIRST: f64 = 1.0 / (1_u32 << 25) as f64;

impl Beckmann {
    /// D(m): the area of microfacets with normal `m`, per area of the surface.
    ///
    /// # Measure
    /// Per steradian; ∫ D(m) cos θₘ dm = 1.
    pub fn d(&self, m: Vec3) -> f32 {
        let [ax, ay] = self.alpha;
        let (x, y, z2) = (m.x / ax, m.y / ay, m.z * m.z);
        let share = libm::expf(-(x * x + y * y) / z2);
        // Where z⁴ underflows the exponential has long been zero.
        if share > 0.0 { share / (PI * ax * ay * z2 * z2) } else { 0.0 }
    }

    /// √(αx²wx² + αy²wy²).
    fn across(&self, w: Vec3) -> f32 {
        let (x, y) = (self.alpha[0] * w.x, self.alpha[1] * w.y);
        (x * x + y * y).sqrt()
    }

    /// G₁(w): the visible share of the microfacets that face `w`, which is above the surface.
    pub fn g1(&self, w: Vec3) -> f32 {
        2.0 * w.z * self.g1_over_2cos(w)
    }

    /// G₁(w)/(2 cos θ) without the quotient, finite at grazing angles.
    pub fn g1_over_2cos(&self, w: Vec3) -> f32 {
        let across = self.across(w);
        let a = w.z / across;
        let sqrt_pi = PI.sqrt();
        1.0 / (w.z * (1.0 + libm::erff(a)) + across * libm::expf(-a * a) / sqrt_pi)
    }

    /// Draws a normal as seen from `w`: in proportion to G₁(w) max(0, w·m) D(m)/cos θ.
    ///
    /// Slopes in units of the roughness are normally distributed across the plane of incidence, by `u[1]`; along
    /// it, by `u[0]`, the slope x has the density (cos θ − x sin θ) exp(−x²), x ≤ cot θ. Both are found by
    /// inversion.
    ///
    /// # Measure
    /// Per steradian of normals.
    ///
    /// # Source
    /// Heitz, d'Eon 2014: Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals,
    /// section 3; the distribution is inverted by safeguarded Newton steps rather than by a fit.
    pub fn sample_visible(&self, w: Vec3, u: [f32; 2]) -> Vec3 {
        let [ax, ay] = self.alpha;
        let seen = glam::DVec3::new(f64::from(ax * w.x), f64::from(ay * w.y), f64::from(w.z)).normalize();
        let sin = seen.truncate().length();
        let [cos_phi, sin_phi] = if sin > 0.0 { [seen.x / sin, seen.y / sin] } else { [1.0, 0.0] };
        let along = visible_slope(seen.z, sin, f64::from(u[0]));
        let across = visible_slope(1.0, 0.0, f64::from(u[1]));
        let slope = [along * cos_phi - across * sin_phi, along * sin_phi + across * cos_phi].map(round_f32);
        Vec3::new(-ax * slope[0], -ay * slope[1], 1.0).normalize()
    }
}

/// The slope x ≤ cos/sin below which the share `u` of the density (cos − x·sin) exp(−x²) lies.
///
/// Its distribution is cos·(1 + erf x)/2 + sin·exp(−x²)/(2√π), up to a factor.
fn visible_slope(cos: f64, sin: f64, u: f64) -> f64 {
    let sqrt_pi = PI_64.sqrt();
    let below = |x: f64| 0.5 * (cos * libm::erfc(-x) + sin * libm::exp(-x * x) / sqrt_pi);
    let steepest = if cos < STEEPEST * sin { cos / sin } else { STEEPEST };
    let target = u.max(FIRST) * below(steepest);
    let (mut low, mut high) = (-STEEPEST, steepest);
    let mut x = 0.5 * (low + high);
    // Newton's steps, and halvings where they leave the interval: 50 halvings alone would be enough.
    for _ in 0..50 {
        let excess = below(x) - target;
        *if excess > 0.0 { &mut high } else { &mut low } = x;
        let step = excess * sqrt_pi * libm::exp(x * x) / (cos - x * sin);
        let next = if low < x - step && x - step < high { x - step } else { 0.5 * (low + high) };
        if (next - x).abs() < 1e-12 {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_seen_from_above_are_normally_distributed() {
        // (1 + erf x)/2 with erf 1 = 0.842700792949715; the last step is below 1e-12
        for (u, slope) in [(0.5, 0.0), (0.078_649_603_525_142_5, -1.0), (0.921_350_396_474_857_5, 1.0)] {
            assert!((visible_slope(1.0, 0.0, u) - slope).abs() < 1e-10, "{u}");
        }
    }

    #[test]
    fn slopes_seen_at_a_grazing_angle_are_rayleigh_distributed_on_the_facing_side() {
        for u in [1e-6, 0.1, 0.5, 0.9] {
            let exact = -(-f64::ln(u)).sqrt();
            assert!((visible_slope(0.0, 1.0, u) - exact).abs() < 1e-9, "{u}"); // the last step is below 1e-12
        }
    }

    #[test]
    fn the_distribution_at_the_slope_is_u() {
        for (cos, sin) in [(0.8, 0.6), (0.1, 0.995), (0.999, 0.0447), (1e-9, 1.0)] {
            let below = |x: f64| 0.5 * (cos * libm::erfc(-x) + sin * libm::exp(-x * x) / PI_64.sqrt());
            for i in 1..100_u8 {
                let u = f64::from(i) / 100.0;
                let got = below(visible_slope(cos, sin, u)) / below(f64::min(cos / sin, 6.0));
                assert!((got - u).abs() < 1e-10, "{cos} {u}: {got}"); // a slope to 1e-12, a density below 1
            }
        }
    }

    #[test]
    fn edges_give_units_above_the_surface_and_finite_values() {
        let last = 1.0 - f32::EPSILON / 2.0;
        for alpha in [[1e-4, 1e-4], [1e-4, 10.0], [10.0, 10.0]] {
            let facets = Beckmann { alpha };
            for w in
                [Vec3::Z, Vec3::new(1.0, 0.0, 1e-30), Vec3::new(0.6, 0.8, 1e-4), Vec3::new(0.6, 0.0, 0.8)]
            {
                assert!(facets.g1_over_2cos(w).is_finite() && facets.d(w).is_finite());
                for u in [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last], [0.5, last]] {
                    let m = facets.sample_visible(w, u);
                    assert!(m.is_normalized() && m.z >= 0.0, "{alpha:?} {w} {u:?}: {m}");
                }
            }
            assert_eq!(facets.d(Vec3::X), 0.0);
        }
    }
}
