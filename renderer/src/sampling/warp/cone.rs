//! Uniform directions in a cone about the local z axis: a sphere seen from outside, a spot.

use crate::math::spherical::{cos_theta, direction, sin2_theta, turn};
use glam::Vec3;
use std::f32::consts::TAU;

/// Computes 1 − cos θ of an angle θ ≤ π/2 from sin² θ, as sin² θ / (1 + √(1 − sin² θ)).
///
/// * `sin2`: sin² θ in [0, 1].
///
/// # Precision, limits
/// Relative error below 2e-7 at every angle; 1 − √(1 − sin² θ) has 7 % at 1e-3 rad and nothing left at 1e-4.
///
/// # Verified by
/// `sampling::warp::cone::tests::narrow_cones_keep_their_digits`
#[inline]
pub fn one_minus_cos(sin2: f32) -> f32 {
    sin2 / (1.0 + (1.0 - sin2).sqrt())
}

/// Maps the unit square onto the cone, uniformly in solid angle: 1 − cos θ = u·(1 − cos θmax), φ = 2πv.
///
/// * `one_minus_cos_max`: 1 − cos θmax in (0, 2]; see [`one_minus_cos`].
///
/// # Measure
/// Per steradian, [`cone_pdf`].
///
/// # Source
/// Archimedes: equal heights cut equal areas from a sphere.
///
/// # Verified by
/// `tests/properties.rs::cone_and_back`; claims `warp/cone/*`
#[inline]
pub fn square_to_cone(u: [f32; 2], one_minus_cos_max: f32) -> Vec3 {
    let height = u[0] * one_minus_cos_max;
    direction((height * (2.0 - height)).sqrt(), 1.0 - height, TAU * u[1])
}

/// The inverse of [`square_to_cone`].
pub fn cone_to_square(w: Vec3, one_minus_cos_max: f32) -> [f32; 2] {
    [height(w) / one_minus_cos_max, turn(w.x, w.y)]
}

/// The density of [`square_to_cone`]: 1/(2π(1 − cos θmax)) in the cone, 0 outside.
///
/// # Measure
/// Per steradian. A direction outside by rounding counts as inside: 6e-7 of the cone's height.
///
/// # Source
/// The cone's solid angle is 2π(1 − cos θmax).
#[inline]
pub fn cone_pdf(w: Vec3, one_minus_cos_max: f32) -> f32 {
    let inside = height(w) <= one_minus_cos_max * (1.0 + 6.0e-7);
    if inside { 1.0 / (TAU * one_minus_cos_max) } else { 0.0 }
}

/// 1 − cos θ, with its digits on the upper side.
#[inline]
fn height(w: Vec3) -> f32 {
    let cos = cos_theta(w);
    if cos > 0.0 { sin2_theta(w) / (1.0 + cos) } else { 1.0 - cos }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn narrow_cones_keep_their_digits() {
        for k in 0..400_u16 {
            let sin = libm::pow(10.0, -8.0 + f64::from(k) * 0.02);
            let sin2 = crate::math::float::round_f32(sin * sin);
            let exact_sin2 = f64::from(sin2);
            let exact = exact_sin2 / (1.0 + (1.0 - exact_sin2).sqrt());
            let relative = (f64::from(one_minus_cos(sin2)) - exact).abs() / exact;
            // Four roundings of 2⁻²⁴, and the root at most doubles none of them: below 2⁻²².
            assert!(relative < 2.0_f64.powi(-22), "{sin}: {relative}");
        }
        assert_eq!((one_minus_cos(0.0), one_minus_cos(1.0)), (0.0, 1.0));
    }

    #[test]
    fn axis_and_rim() {
        assert_eq!(square_to_cone([0.0, 0.4], 0.5), Vec3::Z);
        for one_minus_cos_max in [1.0e-12, 1.0e-6, 0.1, 1.0, 2.0] {
            let rim = square_to_cone([LAST, LAST], one_minus_cos_max);
            assert_eq!(
                cone_pdf(rim, one_minus_cos_max),
                1.0 / (TAU * one_minus_cos_max),
                "{one_minus_cos_max}"
            );
        }
        assert_eq!(cone_pdf(Vec3::X, 0.5), 0.0);
        assert_eq!(cone_pdf(Vec3::NEG_Z, 2.0), 1.0 / (2.0 * TAU));
    }
}
