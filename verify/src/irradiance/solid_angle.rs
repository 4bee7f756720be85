use super::{cross, dot, length, minus, quadrant_sum};
use std::f64::consts::PI;

/// Solid angle of an axis-aligned rectangle in a plane at distance `height` > 0.
///
/// From the foot to a corner: atan(ab/(h√(a² + b² + h²))), odd in each side, summed over corners with signs.
///
/// * `x`, `y`: the rectangle's ranges relative to the foot of the perpendicular.
///
/// Returns: steradians.
///
/// # Source
/// Textbook formula; derived by integrating h/(x² + y² + h²)^(3/2).
#[must_use]
pub fn parallel_rectangle_solid_angle(x: [f64; 2], y: [f64; 2], height: f64) -> f64 {
    quadrant_sum(x, y, |a, b| (a * b / (height * a.hypot(b).hypot(height))).atan())
}

/// Solid angle of a sphere seen from `distance` > `radius`: 2π(1 − √(1 − s²)) = 2πs²/(1 + √(1 − s²)), s = R/d.
///
/// Returns: steradians, with full precision for small spheres.
///
/// # Source
/// The cap's area; the second form avoids the cancellation of the first.
#[must_use]
pub fn sphere_solid_angle(radius: f64, distance: f64) -> f64 {
    let s = radius / distance;
    2.0 * PI * s * s / (1.0 + ((1.0 - s) * (1.0 + s)).sqrt())
}

/// Solid angle of a disk seen from its axis at `height` > 0: 2π(1 − h/√(h² + R²)).
///
/// Returns: steradians, computed as 2πR²/(l(l + h)), l = √(h² + R²), with full precision for small disks.
///
/// # Source
/// The cap's area, rearranged.
#[must_use]
pub fn disk_solid_angle(radius: f64, height: f64) -> f64 {
    let slant = radius.hypot(height);
    2.0 * PI * radius * radius / (slant * (slant + height))
}

/// Solid angle of a triangle seen from `from`: tan(Ω/2) = |a·((b−a)×(c−a))|/(abc + (a·b)c + (b·c)a + (c·a)b).
///
/// Returns: steradians in [0, 2π); the differences keep the digits of small triangles.
///
/// # Source
/// van Oosterom and Strackee 1983, 10.1109/TBME.1983.325207.
#[must_use]
pub fn triangle_solid_angle(from: [f64; 3], vertices: [[f64; 3]; 3]) -> f64 {
    signed_triangle(from, vertices).abs()
}

/// Solid angle of a flat polygon, as a fan of signed triangles; also for polygons that are not convex.
///
/// Returns: steradians; 0 for fewer than three vertices.
///
/// # Source
/// As [`triangle_solid_angle`].
#[must_use]
pub fn polygon_solid_angle(from: [f64; 3], vertices: &[[f64; 3]]) -> f64 {
    let fan = |pair: &[[f64; 3]]| signed_triangle(from, [vertices[0], pair[0], pair[1]]);
    vertices.get(1..).unwrap_or_default().windows(2).map(fan).sum::<f64>().abs()
}

fn signed_triangle(from: [f64; 3], vertices: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = vertices.map(|v| minus(v, from));
    let volume = dot(a, cross(minus(b, a), minus(c, a)));
    let (la, lb, lc) = (length(a), length(b), length(c));
    2.0 * volume.atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::over_unit;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_octant_is_half_pi_and_a_cube_face_a_sixth_of_the_sphere() {
        let octant = triangle_solid_angle([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!((octant - 0.5 * PI).abs() < 1e-15); // one rounding
        let face = parallel_rectangle_solid_angle([-1.0, 1.0], [-1.0, 1.0], 1.0);
        assert!((face - 4.0 * PI / 6.0).abs() < 1e-15);
        assert!((sphere_solid_angle(1.0, 1.0) - 2.0 * PI).abs() < 1e-15);
    }

    #[test]
    fn a_disk_and_its_touching_sphere_agree_with_quadrature() {
        let numeric = over_unit(2000, |s| {
            let r = 0.7 * s;
            2.0 * PI * 0.7 * r * 1.2 / (r * r + 1.44).powf(1.5)
        });
        assert!((disk_solid_angle(0.7, 1.2) - numeric).abs() < 1e-6); // midpoint, h²/24·|f''| with |f''| below 60
        // A sphere fills the cone of the disk in which the cone touches it: radius R cos σ at distance d − R sin σ.
        let sine = 0.4;
        let disk = disk_solid_angle(0.4 * (1.0_f64 - sine * sine).sqrt(), 1.0 - 0.4 * sine);
        assert!((sphere_solid_angle(0.4, 1.0) - disk).abs() < 1e-15); // roundings of numbers below 1
    }

    #[test]
    fn small_shapes_keep_their_digits() {
        let side = 1e-6;
        let small = [[0.0, 0.0, 1.0], [side, 0.0, 1.0], [0.0, side, 1.0]];
        // Area/distance², off by the square of the side: 1e-12.
        assert!((triangle_solid_angle([0.0; 3], small) / (0.5e-12) - 1.0).abs() < 2e-12);
        assert!((sphere_solid_angle(1e-9, 1.0) / (PI * 1e-18) - 1.0).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn rectangle_polygon_and_triangles_agree(
            x in -3.0..3.0_f64, y in -3.0..3.0_f64, a in 0.1..4.0_f64, b in 0.1..4.0_f64, h in 0.1..4.0_f64,
        ) {
            let corners = [[x, y, h], [x + a, y, h], [x + a, y + b, h], [x, y + b, h]];
            let rectangle = parallel_rectangle_solid_angle([x, x + a], [y, y + b], h);
            // Rounding of four terms of size 1, conditioned to 40 at h = 0.1.
            prop_assert!((rectangle - polygon_solid_angle([0.0; 3], &corners)).abs() < 1e-13);
            let half = |k: usize| triangle_solid_angle([0.0; 3], [corners[0], corners[k], corners[k + 1]]);
            prop_assert!((rectangle - half(1) - half(2)).abs() < 1e-13);
        }
    }
}
