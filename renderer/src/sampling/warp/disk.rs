//! Uniform points on the unit disk.

use crate::math::spherical::turn;
use glam::Vec2;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};
use std::ops::{Add, Mul};
use wide::f32x8;

/// Maps the unit square onto the unit disk, uniformly, keeping neighbours together.
///
/// Squares around the centre become circles: with a = 2u − 1, b = 2v − 1 the radius is the larger of |a| and |b|.
///
/// Returns: a point whose length passes 1 by rounding only (2e-7).
///
/// # Measure
/// Per unit area of the disk, [`disk_pdf`].
///
/// # Source
/// Shirley and Chiu 1997, "A low distortion map between disk and square", doi 10.1080/10867651.1997.10487479; with
/// signed radii (D. Cline's form) there are two cases instead of four.
///
/// # Verified by
/// `tests/properties.rs::disk_and_back`; claims `warp/disk/*`
#[inline]
pub fn square_to_disk(u: [f32; 2]) -> Vec2 {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let is_flat = a.abs() > b.abs();
    let (radius, other) = if is_flat { (a, b) } else { (b, a) };
    let turn = other / if radius == 0.0 { 1.0 } else { radius };
    // From the nearer axis: the angle to the other one is π/2 less that.
    let (sin, cos) = octant(FRAC_PI_4 * turn);
    radius * if is_flat { Vec2::new(cos, sin) } else { Vec2::new(sin, cos) }
}

/// [`square_to_disk`] of eight points, bit for bit.
#[inline]
pub(super) fn squares_to_disk([u, v]: [f32x8; 2]) -> [f32x8; 2] {
    let one = f32x8::ONE;
    let (a, b) = (u * 2.0 - one, v * 2.0 - one);
    let is_flat = a.abs().simd_gt(b.abs());
    let (radius, other) = (is_flat.select(a, b), is_flat.select(b, a));
    let turn = other / radius.simd_eq(0.0).select(one, radius);
    let (sin, cos) = octant(f32x8::splat(FRAC_PI_4) * turn);
    [radius * is_flat.select(cos, sin), radius * is_flat.select(sin, cos)]
}

/// Sine and cosine of an angle in [−π/4, π/4], right to a unit in the last place.
///
/// # Source
/// Moshier's Cephes library, `sinf.c`, whose polynomials err by 2⁻²⁶; without the branches of `libm::sincosf`.
#[inline]
fn octant<T: Copy + Add<f32, Output = T> + Mul<f32, Output = T> + Add<Output = T> + Mul<Output = T>>(
    x: T,
) -> (T, T) {
    let z = x * x;
    let sin = ((z * -1.951_529_6e-4 + 8.332_161e-3) * z + -0.166_666_55) * z * x + x;
    let cos = ((z * 2.443_315_7e-5 + -1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z + z * -0.5 + 1.0;
    (sin, cos)
}

/// The inverse of [`square_to_disk`].
pub fn disk_to_square(p: Vec2) -> [f32; 2] {
    let radius = p.length();
    if radius == 0.0 {
        return [0.5; 2];
    }
    // Within 45° of the x axis the first coordinate carries the radius, else the second.
    let (a, b) = if p.x.abs() > p.y.abs() {
        let a = radius.copysign(p.x);
        (a, a * libm::atanf(p.y / p.x) / FRAC_PI_4)
    } else {
        let b = radius.copysign(p.y);
        (b * libm::atanf(p.x / p.y) / FRAC_PI_4, b)
    };
    [0.5 * (a + 1.0), 0.5 * (b + 1.0)]
}

/// Maps the unit square onto the unit disk, uniformly, by polar coordinates: r = √u, φ = 2πv.
///
/// The square root makes it uniform: the share of the disk within r is r².
///
/// # Measure
/// Per unit area of the disk, [`disk_pdf`].
///
/// # Source
/// Shirley and Morley 2003, "Realistic Ray Tracing", 2nd edition, chapter 12.
///
/// # Verified by
/// `tests/properties.rs::polar_disk_and_back`; claims `warp/disk/*`
#[inline]
pub fn square_to_disk_polar(u: [f32; 2]) -> Vec2 {
    let (sin, cos) = libm::sincosf(TAU * u[1]);
    u[0].sqrt() * Vec2::new(cos, sin)
}

/// The inverse of [`square_to_disk_polar`].
pub fn disk_polar_to_square(p: Vec2) -> [f32; 2] {
    [p.length_squared(), turn(p.x, p.y)]
}

/// The density of a uniform point on the unit disk: 1/π on it, 0 off it.
///
/// # Measure
/// Per unit area. A point off the disk by rounding counts as on it: 1 is passed by 4e-7 in the square.
///
/// # Source
/// The area of the unit disk is π.
#[inline]
pub fn disk_pdf(p: Vec2) -> f32 {
    if p.length_squared() <= 1.0 + 4.0e-7 { FRAC_1_PI } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn centre_sides_and_corners() {
        assert_eq!(square_to_disk([0.5, 0.5]), Vec2::ZERO);
        assert_eq!(square_to_disk([0.0, 0.5]), Vec2::NEG_X);
        assert_eq!(square_to_disk([0.75, 0.5]), 0.5 * Vec2::X);
        for corner in [[0.0, 0.0], [0.0, LAST], [LAST, 0.0], [LAST, LAST]] {
            let p = square_to_disk(corner);
            // 2⁻²³ by which LAST falls short of the corner, and three roundings of 2⁻²⁴.
            assert!((p.length() - 1.0).abs() <= 2.5 * f32::EPSILON, "{corner:?}: {p}");
            assert_eq!(disk_pdf(p), FRAC_1_PI, "{corner:?}");
        }
    }

    #[test]
    fn eight_points_are_mapped_as_one() {
        let numbers = [0.0, 0.25, 0.3, 0.5, 0.6, 0.75, 0.9, LAST];
        for v in numbers {
            let [x, y] = squares_to_disk([f32x8::new(numbers), f32x8::splat(v)]).map(|c| c.to_array());
            for (lane, u) in numbers.into_iter().enumerate() {
                assert_eq!([x[lane], y[lane]], square_to_disk([u, v]).to_array(), "{u} {v}");
            }
        }
    }

    #[test]
    fn sine_and_cosine_within_an_octant() {
        for n in -1000..=1000 {
            let angle = FRAC_PI_4 * (n as f32 / 1000.0);
            let (sin, cos) = octant(angle);
            let exact = f64::from(angle).sin_cos();
            for (found, exact) in [(sin, exact.0), (cos, exact.1)] {
                // A unit in the last place is at most 2⁻²³ of the number.
                let bound = exact.abs() * f64::from(f32::EPSILON);
                assert!((f64::from(found) - exact).abs() <= bound, "{angle} {found} {exact}");
            }
        }
    }

    #[test]
    fn polar_edges() {
        assert_eq!(square_to_disk_polar([0.0, 0.3]), Vec2::ZERO);
        assert_eq!(square_to_disk_polar([0.25, 0.0]), Vec2::new(0.5, 0.0));
        assert_eq!(disk_pdf(square_to_disk_polar([LAST, LAST])), FRAC_1_PI);
    }

    #[test]
    fn nothing_outside() {
        assert_eq!(disk_pdf(Vec2::new(0.8, 0.8)), 0.0);
    }
}
