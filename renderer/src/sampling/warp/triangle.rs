//! Uniform points on a triangle, as barycentric weights of its second and third vertex.

/// Maps the unit square onto the triangle with an even density: s = √u gives weights s(1 − v) and s·v.
///
/// One-to-one, so that a well spread set of `u` stays well spread.
///
/// Returns: the weights `[b1, b2]` of the point (1 − b1 − b2)p0 + b1·p1 + b2·p2.
///
/// # Measure
/// Per unit of b1 and b2, [`triangle_pdf_uv`]; per m² 1/area.
///
/// # Source
/// Turk 1990, "Generating random points in triangles", Graphics Gems I, method 2.
///
/// # Verified by
/// `tests/properties.rs::triangle_and_back`; claims `warp/triangle/*`
#[inline]
pub fn square_to_triangle(u: [f32; 2]) -> [f32; 2] {
    let s = u[0].sqrt();
    let b2 = s * u[1];
    [s - b2, b2]
}

/// The inverse of [`square_to_triangle`].
pub fn triangle_to_square(b: [f32; 2]) -> [f32; 2] {
    let s = b[0] + b[1];
    let v = if s > 0.0 { b[1] / s } else { 0.0 };
    [s * s, v]
}

/// Maps the unit square onto the triangle with an even density by folding: where u + v > 1, (1 − u, 1 − v).
///
/// Two points of the square share each point of the triangle, so there is no inverse.
///
/// Returns: the weights `[b1, b2]` as [`square_to_triangle`] does.
///
/// # Measure
/// Per unit of b1 and b2, [`triangle_pdf_uv`]; per m² 1/area.
///
/// # Source
/// Turk 1990, "Generating random points in triangles", Graphics Gems I, method 1.
///
/// # Verified by
/// Claims `warp/triangle/*`
#[inline]
pub fn square_to_triangle_folded(u: [f32; 2]) -> [f32; 2] {
    if u[0] + u[1] > 1.0 { [1.0 - u[0], 1.0 - u[1]] } else { u }
}

/// The density of a uniform point on the triangle: 2 where no weight is negative, else 0.
///
/// # Measure
/// Per unit of b1 and b2.
///
/// # Source
/// The area of the triangle b1, b2 ≥ 0, b1 + b2 ≤ 1 is ½.
#[inline]
pub fn triangle_pdf_uv(b: [f32; 2]) -> f32 {
    if b[0] >= 0.0 && b[1] >= 0.0 && b[0] + b[1] <= 1.0 { 2.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn vertices() {
        assert_eq!(square_to_triangle([0.0, 0.5]), [0.0, 0.0]);
        assert_eq!(square_to_triangle([0.25, 0.0]), [0.5, 0.0]);
        assert_eq!(square_to_triangle([0.25, 0.5]), [0.25, 0.25]);
        assert_eq!(triangle_to_square([0.0, 0.0]), [0.0, 0.0]);
    }

    #[test]
    fn folding() {
        assert_eq!(square_to_triangle_folded([0.25, 0.5]), [0.25, 0.5]);
        assert_eq!(square_to_triangle_folded([0.75, 0.5]), [0.25, 0.5]);
        assert_eq!(square_to_triangle_folded([0.5, 0.5]), [0.5, 0.5]);
    }

    #[test]
    fn edges_are_inside() {
        for u in [[0.0, 0.0], [0.0, LAST], [LAST, 0.0], [LAST, LAST]] {
            assert_eq!(triangle_pdf_uv(square_to_triangle(u)), 2.0, "{u:?}");
            assert_eq!(triangle_pdf_uv(square_to_triangle_folded(u)), 2.0, "{u:?}");
        }
        assert_eq!(triangle_pdf_uv([0.6, 0.6]), 0.0);
        assert_eq!(triangle_pdf_uv([-0.1, 0.6]), 0.0);
    }
}
