//! Directions about the local z axis: uniform, and proportional to the cosine.

use super::disk::{disk_to_square, square_to_disk, squares_to_disk};
use crate::math::eight::{Eight, Vec3x8};
use crate::math::spherical::{cos_theta, direction, sin2_theta, turn};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};
use wide::f32x8;

/// Maps the unit square onto the upper hemisphere, uniformly in solid angle: cos θ = 1 − u, φ = 2πv.
///
/// # Measure
/// Per steradian, [`hemisphere_pdf`].
///
/// # Source
/// Archimedes: equal heights cut equal areas from a sphere.
///
/// # Verified by
/// `tests/properties.rs::hemisphere_and_back`; claims `warp/hemisphere/*`
#[inline]
pub fn square_to_hemisphere(u: [f32; 2]) -> Vec3 {
    // sin² = (1 − cos)(1 + cos) with 1 − cos = u keeps the digits near the axis.
    direction((u[0] * (2.0 - u[0])).sqrt(), 1.0 - u[0], TAU * u[1])
}

/// The inverse of [`square_to_hemisphere`].
pub fn hemisphere_to_square(w: Vec3) -> [f32; 2] {
    [sin2_theta(w) / (1.0 + cos_theta(w)), turn(w.x, w.y)]
}

/// The density of [`square_to_hemisphere`]: 1/(2π) above the surface, 0 below.
///
/// # Measure
/// Per steradian.
///
/// # Source
/// The hemisphere's solid angle is 2π.
#[inline]
pub fn hemisphere_pdf(w: Vec3) -> f32 {
    if cos_theta(w) >= 0.0 { 1.0 / TAU } else { 0.0 }
}

/// Maps the unit square onto the upper hemisphere with density cos θ / π.
///
/// A uniform point on the unit disk, lifted to the sphere. The height is √((1 − r)(1 + r)) with the exact r of the
/// concentric map, so that it keeps its digits at the horizon.
///
/// Returns: a unit vector; its z is 0 only where a coordinate of `u` is 0 exactly, and the density there is 0 too.
///
/// # Measure
/// Per steradian, [`cosine_hemisphere_pdf`].
///
/// # Source
/// Malley's method: Shirley and Morley 2003, "Realistic Ray Tracing", 2nd edition, chapter 12.
///
/// # Verified by
/// `tests/properties.rs::cosine_hemisphere_and_back`; claims `warp/cosine-hemisphere/*`
#[inline]
pub fn square_to_cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let radius = (2.0 * u[0] - 1.0).abs().max((2.0 * u[1] - 1.0).abs());
    square_to_disk(u).extend(((1.0 - radius) * (1.0 + radius)).sqrt())
}

/// [`square_to_cosine_hemisphere`] of eight points, bit for bit.
#[inline]
pub fn squares_to_cosine_hemisphere([u, v]: [f32x8; 2]) -> Vec3x8 {
    let one = f32x8::ONE;
    let radius = (u * 2.0 - one).abs().fast_max((v * 2.0 - one).abs());
    let [x, y] = squares_to_disk([u, v]);
    Eight([x, y, ((one - radius) * (one + radius)).sqrt()])
}

/// The inverse of [`square_to_cosine_hemisphere`].
pub fn cosine_hemisphere_to_square(w: Vec3) -> [f32; 2] {
    disk_to_square(Vec2::new(w.x, w.y))
}

/// The density of [`square_to_cosine_hemisphere`]: cos θ / π above the surface, 0 below.
///
/// # Measure
/// Per steradian.
///
/// # Source
/// ∫ cos θ dω = π over the hemisphere.
#[inline]
pub fn cosine_hemisphere_pdf(w: Vec3) -> f32 {
    cos_theta(w).max(0.0) * FRAC_1_PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn axis_and_horizon() {
        assert_eq!(square_to_hemisphere([0.0, 0.7]), Vec3::Z);
        assert_eq!(square_to_cosine_hemisphere([0.5, 0.5]), Vec3::Z);
        assert!(square_to_hemisphere([LAST, LAST]).z > 0.0);
        assert!(square_to_cosine_hemisphere([LAST, 0.5]).z > 0.0);
        assert_eq!(square_to_cosine_hemisphere([0.0, 0.5]), Vec3::NEG_X);
    }

    #[test]
    fn nothing_below() {
        assert_eq!(hemisphere_pdf(Vec3::NEG_Z), 0.0);
        assert_eq!(cosine_hemisphere_pdf(Vec3::NEG_Z), 0.0);
        assert_eq!(cosine_hemisphere_pdf(Vec3::Z), FRAC_1_PI);
    }
}
