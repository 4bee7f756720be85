use super::{Receiver, along, cross, dot, length, minus};

/// Irradiance from a flat polygon of radiance 1, clipped to the receiver's horizon.
///
/// E = ½|Σ Θᵢ Γᵢ·n|, Θᵢ the angle between the directions to neighbouring vertices and Γᵢ the unit normal of their plane.
///
/// * `vertices`: corners in order, either way round; the receiver is not in the polygon's plane.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹; 0 for fewer than three vertices above the horizon.
///
/// # Precision, limits
/// The edges' terms cancel for small polygons: relative to the result, about 2e-16 over the polygon's size in radians.
///
/// # Source
/// Lambert 1760; Arvo 1995, "Analytic Methods for Simulated Light Transport", chapter 4. Clipping: Sutherland and Hodgman 1974,
/// 10.1145/360767.360802.
#[must_use]
pub fn from_polygon(receiver: Receiver, vertices: &[[f64; 3]]) -> f64 {
    let seen = above_horizon(receiver, vertices);
    let edge = |i: usize| {
        let (a, b) = (seen[i], seen[(i + 1) % seen.len()]);
        // a × (b − a) = a × b, without the cancellation of two long products where the edge is short
        let normal = cross(a, minus(b, a));
        let sine = length(normal);
        if sine == 0.0 { 0.0 } else { sine.atan2(dot(a, b)) / sine * dot(normal, receiver.normal) }
    };
    0.5 * (0..seen.len()).map(edge).sum::<f64>().abs()
}

/// The polygon relative to the receiver, without what is below its horizon.
fn above_horizon(receiver: Receiver, vertices: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let relative: Vec<_> = vertices.iter().map(|&v| minus(v, receiver.position)).collect();
    let mut seen = Vec::with_capacity(vertices.len() + 2);
    for (i, &a) in relative.iter().enumerate() {
        let b = relative[(i + 1) % relative.len()];
        let (height_a, height_b) = (dot(a, receiver.normal), dot(b, receiver.normal));
        if height_a >= 0.0 {
            seen.push(a);
        }
        if height_a * height_b < 0.0 {
            seen.push(along(a, height_a / (height_a - height_b), minus(b, a)));
        }
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::{kernel, over_square};
    use super::*;
    use proptest::prelude::*;

    /// Quadrature over the parallelogram from `origin` along `u` and `v`.
    fn by_area(receiver: Receiver, origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> f64 {
        let scaled = cross(u, v);
        let area = length(scaled);
        let normal = scaled.map(|c| c / area);
        over_square(400, |s, t| area * kernel(receiver, along(along(origin, s, u), t, v), normal))
    }

    #[test]
    fn agrees_with_quadrature_also_across_the_horizon() {
        let receiver = Receiver { position: [0.1, 0.2, 0.3], normal: [0.0, 0.6, 0.8] };
        for (origin, u, v) in [
            ([-1.0, -1.0, 2.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.5]),
            ([-1.0, 1.0, -2.0], [2.0, 0.0, 0.3], [0.0, 0.5, 4.0]),
            ([0.5, -3.0, 0.5], [0.0, 5.0, 0.0], [1.0, 0.0, 1.0]),
        ] {
            let corners =
                [origin, along(origin, 1.0, u), along(along(origin, 1.0, u), 1.0, v), along(origin, 1.0, v)];
            let exact = from_polygon(receiver, &corners);
            let numeric = by_area(receiver, origin, u, v);
            // Midpoint rule, h = 1/400: h²/24·|f''| with |f''| below 30, doubled where the horizon makes a kink.
            assert!((exact - numeric).abs() < 2e-5, "{exact} {numeric}");
            let turned: Vec<_> = corners.iter().rev().copied().collect();
            assert!((from_polygon(receiver, &turned) - exact).abs() < 1e-14); // rounding of sums of size 1
        }
    }

    #[test]
    fn below_the_horizon_is_dark_and_a_huge_ceiling_gives_pi() {
        let receiver = Receiver { position: [0.0; 3], normal: [0.0, 0.0, 1.0] };
        let square =
            |half: f64, z: f64| [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
        assert_eq!(from_polygon(receiver, &square(1.0, -1.0)), 0.0);
        // A square of half-width x at height 1 misses less than a disk of radius x does: π/(1 + x²).
        let missing = std::f64::consts::PI - from_polygon(receiver, &square(1e4, 1.0));
        assert!(missing > 0.0 && missing < std::f64::consts::PI * 1e-8);
    }

    #[test]
    fn a_small_square_keeps_its_digits() {
        let receiver = Receiver { position: [0.0; 3], normal: [0.0, 0.0, 1.0] };
        let (h, x) = (1e-5, 0.75);
        let square = [[x - h, -h, 1.0], [x + h, -h, 1.0], [x + h, h, 1.0], [x - h, h, 1.0]];
        // Area·cos²θ/r² = 4h²/(1 + x²)², off by the squared size: 1e-10; corners are rounded by 1e-16/1e-5.
        let ratio = from_polygon(receiver, &square) / (4.0 * h * h / (1.0 + x * x).powi(2));
        assert!((ratio - 1.0).abs() < 2e-10, "{ratio}");
    }

    proptest! {
        /// A polygon cut in two gives the sum of its halves, wherever the horizon passes.
        #[test]
        fn a_cut_adds_up(cut in 0.01..0.99_f64, tilt in 0.0..3.1_f64, height in 0.2..3.0_f64) {
            let receiver = Receiver { position: [0.3, -0.2, 0.0], normal: [tilt.sin(), 0.0, tilt.cos()] };
            let at = |x: f64, y: f64| [x, y, height];
            let whole = from_polygon(receiver, &[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]);
            let x = 2.0 * cut - 1.0;
            let left = from_polygon(receiver, &[at(-1.0, -1.0), at(x, -1.0), at(x, 1.0), at(-1.0, 1.0)]);
            let right = from_polygon(receiver, &[at(x, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(x, 1.0)]);
            prop_assert!((whole - left - right).abs() < 1e-14); // rounding: twelve terms of size 1, 2.2e-16 each
        }
    }
}
