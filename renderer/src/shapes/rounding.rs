//! From f64 to the f32 of surfaces and hits, with bounds on what that loses.

use glam::{DVec3, Vec3};
use wide::{f32x8, f64x8};

use crate::math::eight::{self, DVec3x8, Vec3x8};

/// Rounds an f64 point to f32 with the bound on its distance from the surface: half a unit in the last place of each
/// coordinate, and `extent` · 2⁻⁴⁶ for the f64 roundings of this evaluation and of the intersection (each has fewer
/// than a hundred, within 2⁻⁵³ of `extent`, the size of the numbers that went in).
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what the bound accounts for")]
pub(super) fn rounded(p: DVec3, extent: f64) -> (Vec3, Vec3) {
    let point = p.as_vec3();
    let small = (extent * 2f64.powi(-46)) as f32;
    let half_ulp = point.abs().map(|c| c * (0.5 * f32::EPSILON) + f32::MIN_POSITIVE);
    (point, half_ulp + small)
}

/// `rounded` of eight points, bit for bit.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "rounding to f32 is what the bound accounts for")]
pub(super) fn rounded_eight(p: DVec3x8, extent: f64) -> (Vec3x8, Vec3x8) {
    let point = p.rounded();
    let small = (extent * 2f64.powi(-46)) as f32;
    (point, point.map(|c| c.abs() * (0.5 * f32::EPSILON) + f32::MIN_POSITIVE + small))
}

/// What `rounded` gives for a surface of radius of curvature `radius`, of the size `extent`.
///
/// A step of e along the tangent leaves such a surface by e²/2r. The rounding of the point and the one of the start of a
/// ray from it (a whole unit in the last place) make e at most three times the length of the half units. It matters on the
/// inner side only, where a step of r is the last that can help: a body smaller than its rounding has no inside to start from.
#[expect(clippy::cast_possible_truncation, reason = "a bound, rounded far below its slack")]
pub(super) fn rounded_curved(p: DVec3, extent: f64, radius: f64) -> (Vec3, Vec3) {
    let (point, error) = rounded(p, extent);
    (point, error + (4.5 * error.as_dvec3().length_squared() / radius).min(radius) as f32)
}

/// A distance as f32, if it rounds to a number in (0, `t_max`).
#[expect(clippy::cast_possible_truncation, reason = "rounded first, compared after")]
pub(super) fn accept(t: f64, t_max: f32) -> Option<f32> {
    let t = t as f32;
    (t > 0.0 && t < t_max).then_some(t)
}

/// What `accept` says of eight distances: the lanes of those accepted, as bits, and all of them as f32.
#[inline]
pub(super) fn accept_eight(t: f64x8, t_max: f32x8) -> (u32, f32x8) {
    let t = eight::rounded(t);
    ((t.simd_gt(f32x8::ZERO) & t.simd_lt(t_max)).to_bitmask(), t)
}
