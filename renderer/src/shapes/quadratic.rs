//! Distances at which a line comes within a radius of a centre: a circle in 2-D, a sphere in 3-D.

use wide::f64x8;

/// The two solutions of |f + t·d|² = r², smaller first, from a = d·d, b = −f·d, f·f and the remainder l² = |f + (b/a)d|².
///
/// The discriminant is r² − l² with l the line's closest approach, and the smaller root comes from c/q, so that neither
/// cancels for a far origin or a large radius. `None` if the line misses.
///
/// # Source
/// Haines, Günther, Akenine-Möller 2019, Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems
/// chapter 7.
#[inline]
pub(super) fn roots(a: f64, b: f64, ff: f64, ll: f64, r: f64) -> Option<[f64; 2]> {
    let discriminant = r * r - ll;
    if !(discriminant >= 0.0 && a > 0.0) {
        return None;
    }
    let c = ff - r * r;
    let q = b + (a * discriminant).sqrt().copysign(b);
    if q == 0.0 {
        // b = 0 and l = r: the line touches where it starts.
        return Some([0.0, 0.0]);
    }
    let (first, second) = (c / q, q / a);
    Some(if first <= second { [first, second] } else { [second, first] })
}

/// What `roots` gives for eight lines: the lanes of those that don't miss, as bits, and the solutions.
#[inline]
pub(super) fn roots_eight(a: f64x8, b: f64x8, ff: f64x8, ll: f64x8, r: f64) -> (u32, [f64x8; 2]) {
    let square = f64x8::splat(r * r);
    let discriminant = square - ll;
    let met = discriminant.simd_ge(0.0) & a.simd_gt(0.0);
    let q = b + (a * discriminant).sqrt().copysign(b);
    let touching = q.simd_eq(0.0);
    let [first, second] = [(ff - square) / q, q / a].map(|root| touching.select(f64x8::ZERO, root));
    let in_order = first.simd_le(second);
    (met.to_bitmask(), [in_order.select(first, second), in_order.select(second, first)])
}
