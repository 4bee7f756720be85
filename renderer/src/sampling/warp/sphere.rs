//! Uniform directions.

use crate::math::spherical::{direction, sin2_theta, turn};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Maps the unit square onto the unit sphere, uniformly: cos θ = 1 − 2u, φ = 2πv.
///
/// # Measure
/// Per steradian, [`sphere_pdf`].
///
/// # Source
/// Archimedes: equal heights cut equal areas from a sphere.
///
/// # Verified by
/// `tests/properties.rs::sphere_and_back`; claims `warp/sphere/*`
#[inline]
pub fn square_to_sphere(u: [f32; 2]) -> Vec3 {
    // sin² = (1 − cos)(1 + cos) = 4u(1 − u) keeps the digits near both poles.
    direction(2.0 * (u[0] * (1.0 - u[0])).sqrt(), 1.0 - 2.0 * u[0], TAU * u[1])
}

/// The inverse of [`square_to_sphere`].
pub fn sphere_to_square(w: Vec3) -> [f32; 2] {
    // Half of 1 − cos, of which the first form keeps the digits near the north pole.
    let share = if w.z > 0.0 { sin2_theta(w) / (1.0 + w.z) } else { 1.0 - w.z };
    [0.5 * share, turn(w.x, w.y)]
}

/// The density of [`square_to_sphere`]: 1/(4π).
///
/// # Measure
/// Per steradian.
///
/// # Source
/// The sphere's solid angle is 4π.
#[inline]
pub const fn sphere_pdf() -> f32 {
    1.0 / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn poles_and_equator() {
        assert_eq!(square_to_sphere([0.0, 0.3]), Vec3::Z);
        assert_eq!(square_to_sphere([0.5, 0.0]), Vec3::X);
        let last = square_to_sphere([LAST, LAST]);
        assert!(
            last.z > -1.0 && (last.length() - 1.0).abs() <= 2.0 * f32::EPSILON,
            "one rounding each: {last}"
        );
    }
}
