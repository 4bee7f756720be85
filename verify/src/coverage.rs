//! Closed forms of what shapes cover of a pixel: areas of circles, lenses and convex polygons.

use std::f64::consts::PI;

/// Area of the part of a disk about the origin that lies in a rectangle.
///
/// Σ over the corners, with signs, of the area G(a, b) of the disk left of a and below b.
///
/// * `radius`: above 0; `rectangle`: ranges of x and y.
///
/// # Precision, limits
/// An absolute error of about 1e-15 of the disk's area.
///
/// # Source
/// The integral of √(r² − x²) in pieces.
#[must_use]
pub fn circle_in_rectangle(radius: f64, rectangle: [[f64; 2]; 2]) -> f64 {
    let [[x0, x1], [y0, y1]] = rectangle.map(|range| range.map(|c| c / radius));
    let corner = quadrant;
    radius * radius * (corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0))
}

/// Area of the unit disk left of `a` and below `b`, up to a constant for each b, which the difference of two corners takes away:
/// ∫ min(b, h) + h over x < a where b > −h, h = √(1 − x²).
fn quadrant(a: f64, b: f64) -> f64 {
    let a = a.clamp(-1.0, 1.0);
    if b <= -1.0 {
        return 0.0;
    }
    // ∫ h from 0 to x.
    let half = |x: f64| 0.5 * (x * ((1.0 - x) * (1.0 + x)).sqrt() + x.asin());
    if b >= 1.0 {
        return 2.0 * half(a);
    }
    // |x| < c is where the line at b cuts the disk.
    let c = ((1.0 - b) * (1.0 + b)).sqrt();
    let inside = |x: f64| x.clamp(-c, c);
    let cut = half(inside(a)) + b * inside(a);
    if b < 0.0 {
        return cut;
    }
    // Beside the cut the whole height of the disk is below b.
    cut + 2.0 * (half(a.min(-c)) + half(a.max(c)))
}

/// Area common to two disks of the radii `r` and `s` whose middles are `distance` apart.
///
/// # Source
/// Two circular segments: r²(α − sin α cos α) + s²(β − sin β cos β), the half angles α and β from the cosine rule.
#[must_use]
pub fn lens_area(r: f64, s: f64, distance: f64) -> f64 {
    let d = distance;
    if d >= r + s {
        return 0.0;
    }
    if d <= (r - s).abs() {
        return PI * r.min(s).powi(2);
    }
    let segment = |r: f64, s: f64| {
        let cosine = ((d * d + r * r - s * s) / (2.0 * d * r)).clamp(-1.0, 1.0);
        r * r * (cosine.acos() - cosine * ((1.0 - cosine) * (1.0 + cosine)).sqrt())
    };
    segment(r, s) + segment(s, r)
}

/// The part of a flat polygon where a linear function is not negative.
///
/// * `vertices`: in order; `height`: the function's value at a point.
///
/// # Source
/// Sutherland and Hodgman 1974, 10.1145/360767.360802.
pub fn clip<const N: usize>(vertices: &[[f64; N]], height: impl Fn([f64; N]) -> f64) -> Vec<[f64; N]> {
    let mut kept = Vec::with_capacity(vertices.len() + 1);
    for (i, &a) in vertices.iter().enumerate() {
        let b = vertices[(i + 1) % vertices.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            kept.push(a);
        }
        if ha * hb < 0.0 {
            let t = ha / (ha - hb);
            kept.push(std::array::from_fn(|k| a[k] + t * (b[k] - a[k])));
        }
    }
    kept
}

/// The part of a flat polygon inside a convex one, both in a plane.
///
/// * `convex`: corners counter-clockwise.
#[must_use]
pub fn clip_to_convex(vertices: &[[f64; 2]], convex: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut part = vertices.to_vec();
    for (i, &a) in convex.iter().enumerate() {
        let b = convex[(i + 1) % convex.len()];
        part = clip(&part, |p| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]));
    }
    part
}

/// Area of a flat polygon, above 0 if its corners are counter-clockwise.
#[must_use]
pub fn polygon_area(vertices: &[[f64; 2]]) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (vertices[i], vertices[(i + 1) % vertices.len()]);
        a[0] * b[1] - a[1] * b[0]
    };
    0.5 * (0..vertices.len()).map(edge).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::Kernel;
    use crate::irradiance::quadrature::over_square;
    use proptest::prelude::*;

    /// A regular polygon of many corners in the place of a circle.
    fn circle(radius: f64, x: f64) -> Vec<[f64; 2]> {
        let corner = |i: u32| 2.0 * PI * f64::from(i) / 500.0;
        (0..500).map(corner).map(|t| [x + radius * t.cos(), radius * t.sin()]).collect()
    }

    proptest! {
        #[test]
        fn circles_agree_with_clipped_polygons(
            x in -3.0..2.0_f64, y in -3.0..2.0_f64, a in 0.01..3.0_f64, b in 0.01..3.0_f64, r in 0.2..2.5_f64,
        ) {
            let rectangle = [[x, y], [x + a, y], [x + a, y + b], [x, y + b]];
            let polygon = polygon_area(&clip_to_convex(&circle(r, 0.0), &rectangle));
            // The inscribed polygon of n = 500 corners lacks at most 2π³r²/(3n²) = 5.2e-4 of area at r = 2.5.
            prop_assert!((circle_in_rectangle(r, [[x, x + a], [y, y + b]]) - polygon).abs() < 5.2e-4);
        }

        #[test]
        fn lenses_agree_with_clipped_polygons(r in 0.1..2.0_f64, s in 0.1..2.0_f64, d in 0.0..4.0_f64) {
            let polygon = polygon_area(&clip_to_convex(&circle(r, 0.0), &circle(s, d)));
            // Both polygons are inscribed: each lacks at most 2π³·4/(3·500²) = 3.4e-4.
            prop_assert!((lens_area(r, s, d) - polygon).abs() < 6.8e-4);
        }

        #[test]
        fn a_clipped_square_is_the_box_filters_edge(distance in -0.8..0.8_f64, angle in 0.0..6.3_f64) {
            let square = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
            let part = clip(&square, |p| distance - p[0] * angle.cos() - p[1] * angle.sin());
            let edge = Kernel::Box { radius: 0.5 }.edge(distance, angle);
            prop_assert!((polygon_area(&part) - edge).abs() < 1e-8); // the filter's quadrature
        }
    }

    #[test]
    fn a_circle_agrees_with_quadrature() {
        let inside = |x: f64, y: f64| f64::from(u8::from(x * x + y * y < 0.49));
        let numeric = over_square(2000, |s, t| 1.5 * inside(1.5 * s - 0.5, t - 0.2));
        // A rim across 2,000 rows, off by half a node in each with random sign: 1.5/2000/√2000·5.
        assert!((circle_in_rectangle(0.7, [[-0.5, 1.0], [-0.2, 0.8]]) - numeric).abs() < 1e-4);
        assert!((circle_in_rectangle(1.0, [[-2.0, 2.0], [-2.0, 2.0]]) - PI).abs() < 1e-14); // a few roundings
    }
}
