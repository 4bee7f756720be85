//! Uniform points on a parallelogram given by a corner and its two neighbours.

use glam::Vec3;

/// Maps the unit square onto the parallelogram spanned at `p[0]` by its neighbours `p[1]` and `p[2]`.
///
/// The point is (1 − u − v)p0 + u·p1 + v·p2.
///
/// # Measure
/// Per m², [`parallelogram_pdf_area`].
///
/// # Source
/// Affine: every part of the square keeps its share of the area.
///
/// # Verified by
/// `tests/properties.rs::parallelogram_and_back`; claims `warp/parallelogram/*`
#[inline]
pub fn square_to_parallelogram(u: [f32; 2], p: [Vec3; 3]) -> Vec3 {
    p[0] + u[0] * (p[1] - p[0]) + u[1] * (p[2] - p[0])
}

/// The inverse of [`square_to_parallelogram`]; a point off the plane is first projected onto it.
pub fn parallelogram_to_square(point: Vec3, p: [Vec3; 3]) -> [f32; 2] {
    let (e1, e2, d) = (p[1] - p[0], p[2] - p[0], point - p[0]);
    let normal = e1.cross(e2);
    let scale = 1.0 / normal.length_squared();
    [d.cross(e2).dot(normal) * scale, e1.cross(d).dot(normal) * scale]
}

/// The density of a uniform point on the parallelogram: 1/|(p1 − p0) × (p2 − p0)|.
///
/// Returns: infinity for a parallelogram without area.
///
/// # Measure
/// Per m².
///
/// # Source
/// The length of the cross product is the area.
#[inline]
pub fn parallelogram_pdf_area(p: [Vec3; 3]) -> f32 {
    1.0 / (p[1] - p[0]).cross(p[2] - p[0]).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_density() {
        let p = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(3.0, 2.0, 3.0), Vec3::new(2.0, 6.0, 3.0)];
        assert_eq!(square_to_parallelogram([0.0, 0.0], p), p[0]);
        assert_eq!(square_to_parallelogram([1.0, 0.0], p), p[1]);
        assert_eq!(square_to_parallelogram([0.0, 1.0], p), p[2]);
        assert_eq!(square_to_parallelogram([0.5, 0.5], p), 0.5 * (p[1] + p[2]));
        assert_eq!(parallelogram_pdf_area(p), 1.0 / 8.0);
        assert_eq!(parallelogram_to_square(p[1], p), [1.0, 0.0]);
    }
}
