//! Closed forms of depth of field with a round lens whose points are uniform: circles of confusion and blurred edges.

use std::f64::consts::PI;

/// Radius of the circle of confusion on the plane of focus: A·|1 − Sf/S|.
///
/// * `aperture`: radius A of the lens; `focus`: distance Sf of the plane in focus; `depth`: distance S of the point, above 0.
///
/// Returns: in the unit of the aperture; 0 in focus.
///
/// # Source
/// Similar triangles through the lens.
#[must_use]
pub fn circle_of_confusion(aperture: f64, focus: f64, depth: f64) -> f64 {
    aperture * (1.0 - focus / depth).abs()
}

/// What a point sees of a half-plane that is brighter by 1 to its right, through a uniform disk of confusion.
///
/// ESF = ½ + (u√(1 − u²) + asin u)/π, u = distance to the edge over the disk's radius, in [−1, 1]; 0 and 1 outside.
///
/// # Source
/// The area of a disk's segment.
#[must_use]
pub fn edge_spread(u: f64) -> f64 {
    let u = u.clamp(-1.0, 1.0);
    0.5 + (u * ((1.0 - u) * (1.0 + u)).sqrt() + u.asin()) / PI
}

/// Mean of [`edge_spread`] over a pixel that reaches from `from` to `to`, in radii of the disk: a box filter's value.
///
/// (P(u₁) − P(u₀))/(u₁ − u₀), P = u/2 + [u asin u + √(1 − u²) − (1 − u²)^(3/2)/3]/π within, 0 before and u after.
///
/// # Precision, limits
/// An absolute error of 1e-16/(u₁ − u₀).
///
/// # Source
/// The integral of the edge spread function.
#[must_use]
pub fn edge_spread_over_pixel(from: f64, to: f64) -> f64 {
    (edge_spread_integral(to) - edge_spread_integral(from)) / (to - from)
}

fn edge_spread_integral(u: f64) -> f64 {
    if u <= -1.0 {
        return 0.0;
    }
    if u >= 1.0 {
        return u;
    }
    let square = (1.0 - u) * (1.0 + u);
    0.5 * u + (u * u.asin() + square.sqrt() * (1.0 - square / 3.0)) / PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance::quadrature::{over_square, over_unit};
    use proptest::prelude::*;

    #[test]
    fn the_edge_agrees_with_quadrature_over_the_disk() {
        for u in [-0.9, -0.3, 0.0, 0.5, 0.99] {
            let seen = over_square(2000, |r, t| {
                let x = u + r * (2.0 * PI * t).cos();
                2.0 * r * f64::from(u8::from(x > 0.0))
            });
            // A jump across 2,000 rows, wrong by half a node in each, with random sign: 1/2000/√2000·10.
            assert!((seen - edge_spread(u)).abs() < 3e-4, "{u}: {seen}");
        }
        assert_eq!((edge_spread(-2.0), edge_spread(0.0), edge_spread(3.0)), (0.0, 0.5, 1.0));
    }

    #[test]
    fn confusion_vanishes_in_focus_and_tends_to_the_aperture() {
        assert_eq!(circle_of_confusion(0.3, 4.0, 4.0), 0.0);
        assert_eq!(circle_of_confusion(0.3, 4.0, 2.0), 0.3);
        assert!((circle_of_confusion(0.3, 4.0, 4e12) - 0.3).abs() < 1e-12);
        // A ray from lens point x = A through the point (0, S) meets z = Sf at A(1 − Sf/S).
        let (aperture, focus, depth) = (0.3, 4.0, 7.0);
        assert_eq!(circle_of_confusion(aperture, focus, depth), aperture + focus / depth * (0.0 - aperture));
    }

    proptest! {
        #[test]
        fn the_pixel_is_the_mean_of_its_points(from in -1.5..1.5_f64, width in 0.05..1.0_f64) {
            let mean = over_unit(400, |s| edge_spread(from + s * width));
            // Midpoint rule, h = 1/400 with √ ends: h^1.5·width.
            prop_assert!((edge_spread_over_pixel(from, from + width) - mean).abs() < 1.3e-4);
        }
    }
}
