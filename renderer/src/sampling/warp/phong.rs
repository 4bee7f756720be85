//! Directions about the local z axis with density proportional to a power of the cosine: Phong's lobe.

use crate::math::spherical::{cos_theta, direction, sin2_theta, turn};
use glam::Vec3;
use std::f32::consts::TAU;

/// Maps the unit square onto the upper hemisphere with density ∝ cosᵉ θ: cos θ = (1 − u)^(1/(e + 1)), φ = 2πv.
///
/// * `exponent`: e ≥ 0; 0 is uniform, 1 the cosine.
///
/// # Measure
/// Per steradian, [`phong_pdf`].
///
/// # Precision, limits
/// sin² θ = 1 − cos² θ is taken from `expm1`, so that lobes of any exponent keep their digits at the axis.
///
/// # Source
/// Lafortune and Willems 1994, "Using the modified Phong reflectance model for physically based rendering",
/// Report CW 197, equation 10.
///
/// # Verified by
/// `tests/properties.rs::phong_and_back`; claims `warp/phong/*`
#[inline]
pub fn square_to_phong(u: [f32; 2], exponent: f32) -> Vec3 {
    let log_cos = libm::log1pf(-u[0]) / (exponent + 1.0);
    direction((-libm::expm1f(2.0 * log_cos)).sqrt(), libm::expf(log_cos), TAU * u[1])
}

/// The inverse of [`square_to_phong`].
pub fn phong_to_square(w: Vec3, exponent: f32) -> [f32; 2] {
    [-libm::expm1f((exponent + 1.0) * log_cos(w)), turn(w.x, w.y)]
}

/// The density of [`square_to_phong`]: (e + 1)/(2π)·cosᵉ θ above the surface, 0 below.
///
/// # Measure
/// Per steradian.
///
/// # Source
/// ∫ cosᵉ θ dω = 2π/(e + 1) over the hemisphere.
#[inline]
pub fn phong_pdf(w: Vec3, exponent: f32) -> f32 {
    if cos_theta(w) <= 0.0 {
        return 0.0;
    }
    (exponent + 1.0) / TAU * libm::expf(exponent * log_cos(w))
}

/// ln cos θ, from the sine near the axis and from the cosine near the horizon.
#[inline]
fn log_cos(w: Vec3) -> f32 {
    let (cos, sin2) = (cos_theta(w), sin2_theta(w));
    if sin2 < 0.5 { 0.5 * libm::log1pf(-sin2) } else { libm::logf(cos) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn axis_and_edges() {
        for exponent in [0.0, 1.0, 50.0, 1.0e6] {
            assert_eq!(square_to_phong([0.0, 0.2], exponent), Vec3::Z);
            let w = square_to_phong([LAST, LAST], exponent);
            assert!(w.z > 0.0 && w.is_finite(), "{exponent}: {w}");
        }
        assert_eq!(phong_pdf(Vec3::Z, 3.0), 4.0 / TAU);
        assert_eq!(phong_pdf(Vec3::NEG_Z, 3.0), 0.0);
        assert_eq!(phong_pdf(Vec3::X, 0.0), 0.0);
    }

    #[test]
    fn a_sharp_lobe_is_a_narrow_one() {
        // Half of the lobe of exponent e lies within sin² θ = 1 − 2^(−2/(e + 1)).
        let w = square_to_phong([0.5, 0.0], 1.0e6);
        let exact = -libm::expm1(-2.0 * std::f64::consts::LN_2 / (1.0e6 + 1.0));
        let relative = f64::from(w.x) * f64::from(w.x) / exact - 1.0;
        // log1p, quotient, expm1 and root: at most 2, 1, 2 and 1 roundings of 2⁻²⁴, those of x twice in x².
        assert!(relative.abs() < 8.0 * 2.0_f64.powi(-24), "{relative}");
    }
}
