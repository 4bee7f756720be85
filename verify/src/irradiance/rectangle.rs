use super::quadrant_sum;

/// Irradiance from an axis-aligned rectangle of radiance 1 in a plane parallel to the receiver's.
///
/// A corner above the receiver at height c with sides a and b gives
/// C = ½[X/√(1+X²)·atan(Y/√(1+X²)) + Y/√(1+Y²)·atan(X/√(1+Y²))], X = a/c, Y = b/c; C is odd in each side, so any rectangle is
/// C(x₁,y₁) − C(x₀,y₁) − C(x₁,y₀) + C(x₀,y₀).
///
/// * `x`, `y`: the rectangle's ranges relative to the point above the receiver; `height`: above 0.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹.
///
/// # Precision, limits
/// The four corners cancel for rectangles that are small and far to the side: an absolute error of 1e-16.
///
/// # Source
/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3, times π.
#[must_use]
pub fn from_parallel_rectangle(x: [f64; 2], y: [f64; 2], height: f64) -> f64 {
    quadrant_sum(x, y, |a, b| {
        let (p, q) = (a.hypot(height), b.hypot(height));
        0.5 * (a / p * (b / p).atan() + b / q * (a / q).atan())
    })
}

/// Irradiance from a rectangle of radiance 1 in a plane perpendicular to the receiver's.
///
/// From the foot of the perpendicular, at distance c, to width b and height a:
/// C = ½[atan(b/c) − c/√(a²+c²)·atan(b/√(a²+c²))], odd in b; what is below the receiver's horizon does not count.
///
/// * `width`: range along the receiver's plane, from the foot; `height`: range above the receiver's plane; `distance`: above 0.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹.
///
/// # Source
/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-4, times π.
#[must_use]
pub fn from_perpendicular_rectangle(width: [f64; 2], height: [f64; 2], distance: f64) -> f64 {
    quadrant_sum(width, height.map(|a| a.max(0.0)), |b, a| {
        let slant = a.hypot(distance);
        0.5 * ((b / distance).atan() - distance / slant * (b / slant).atan())
    })
}

/// Mean irradiance on an axis-aligned rectangle from another of radiance 1 in a parallel plane that faces it.
///
/// With u and v the differences of two edges in x and in y, and the receiver's area A, E = Σ ± G(u, v)/A over the four
/// differences in each axis: + between a lower and an upper edge, − between two lower or two upper ones. G is the integral over u and v
/// of the corner form of [`from_parallel_rectangle`]: G = ½[u·q·atan(u/q) + v·p·atan(v/p)] − ¼·h²·ln(u² + v² + h²), p = √(u² + h²), q = √(v² + h²).
///
/// * `receiver`, `light`: ranges of x and of y; `height`: distance of the planes, above 0.
///
/// Returns: W m⁻² per W m⁻² sr⁻¹.
///
/// # Source
/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", C-13, times π.
#[must_use]
pub fn between_parallel_rectangles(receiver: [[f64; 2]; 2], light: [[f64; 2]; 2], height: f64) -> f64 {
    let g = |u: f64, v: f64| {
        let (p, q) = (u.hypot(height), v.hypot(height));
        0.5 * (u * q * (u / q).atan() + v * p * (v / p).atan())
            - 0.25 * height * height * (u * u + v * v + height * height).ln()
    };
    let sign = |i: usize, j: usize| if i == j { -1.0 } else { 1.0 };
    let mut sum = 0.0;
    for [i, j, k, l] in (0..16).map(|n: usize| [n & 1, n >> 1 & 1, n >> 2 & 1, n >> 3 & 1]) {
        let (u, v) = (light[0][i] - receiver[0][j], light[1][k] - receiver[1][l]);
        sum += sign(i, j) * sign(k, l) * g(u, v);
    }
    let [width, depth] = receiver.map(|[low, high]| high - low);
    sum / (width * depth)
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::{kernel, over_square};
    use super::super::{Receiver, from_polygon};
    use super::*;
    use crate::quadrature::{Tolerance, integrate_2d};
    use proptest::prelude::*;

    const UP: Receiver = Receiver { position: [0.0; 3], normal: [0.0, 0.0, 1.0] };

    #[test]
    fn agrees_with_quadrature_over_the_rectangle() {
        let parallel =
            over_square(500, |s, t| 6.0 * kernel(UP, [2.0 * s - 0.5, 3.0 * t + 0.25, 1.5], UP.normal));
        // Midpoint rule, h = 1/500: h²/24·|f''| with |f''| below 30 per axis.
        assert!((from_parallel_rectangle([-0.5, 1.5], [0.25, 3.25], 1.5) - parallel).abs() < 1e-5);
        let upright =
            over_square(500, |s, t| 6.0 * kernel(UP, [2.0 * s - 0.5, 1.2, 3.0 * t + 0.25], [0.0, 1.0, 0.0]));
        assert!((from_perpendicular_rectangle([-0.5, 1.5], [0.25, 3.25], 1.2) - upright).abs() < 1e-5);
    }

    #[test]
    fn means_over_a_receiver_agree_with_quadrature_and_with_known_factors() {
        let (receiver, light) = ([[-0.6, 0.2], [0.0, 0.5]], [[0.1, 1.3], [0.2, 0.9]]);
        let at = |[x, y]: [f64; 2]| {
            from_parallel_rectangle(light[0].map(|edge| edge - x), light[1].map(|edge| edge - y), 0.7)
        };
        let tolerance = Tolerance { relative: 1e-12, absolute: 0.0, pieces: 1000 };
        let mean = integrate_2d(&at, receiver, tolerance).value / (0.8 * 0.5);
        // The quadrature's tolerance, and 16 terms below 1 that cancel to 0.1: 16·1.1e-16/0.1 = 2e-14.
        assert!((between_parallel_rectangles(receiver, light, 0.7) / mean - 1.0).abs() < 2e-12);
        // Two unit squares at distance 1: Howell's table of C-11 has 0.19982.
        let unit = [[0.0, 1.0]; 2];
        let factor = between_parallel_rectangles(unit, unit, 1.0) / std::f64::consts::PI;
        assert!((factor - 0.19982).abs() < 5e-6); // five digits
    }

    proptest! {
        #[test]
        fn agrees_with_the_polygon_formula(
            x in -3.0..3.0_f64, y in -3.0..3.0_f64, a in 0.1..4.0_f64, b in 0.1..4.0_f64, c in 0.1..4.0_f64,
        ) {
            let flat = [[x, y, c], [x + a, y, c], [x + a, y + b, c], [x, y + b, c]];
            let upright = [[x, c, y], [x + a, c, y], [x + a, c, y + b], [x, c, y + b]];
            let (wide, high) = ([x, x + a], [y, y + b]);
            // Rounding: eight terms of size 1 at 2.2e-16, and atan of ratios conditioned to 40 at c = 0.1.
            prop_assert!((from_parallel_rectangle(wide, high, c) - from_polygon(UP, &flat)).abs() < 1e-13);
            prop_assert!((from_perpendicular_rectangle(wide, high, c) - from_polygon(UP, &upright)).abs() < 1e-13);
        }

        /// Sizes from 1e-4 to 1e4 of the distance.
        #[test]
        fn agrees_with_the_polygon_formula_at_any_size(
            x in -3.0..3.0_f64, y in -3.0..3.0_f64, a in -4.0..4.0_f64, b in -4.0..4.0_f64,
        ) {
            let (a, b) = (10.0_f64.powf(a), 10.0_f64.powf(b));
            let flat = [[x, y, 1.0], [x + a, y, 1.0], [x + a, y + b, 1.0], [x, y + b, 1.0]];
            let upright = [[x, 1.0, y], [x + a, 1.0, y], [x + a, 1.0, y + b], [x, 1.0, y + b]];
            let (wide, high) = ([x, x + a], [y, y + b]);
            // Products of corners up to 1e4 away, 1e8, round by 1e-8; over an edge's sine, its length 1e4 times a distance of at
            // least 1, that is 1e-12, twelve times.
            prop_assert!((from_parallel_rectangle(wide, high, 1.0) - from_polygon(UP, &flat)).abs() < 2e-11);
            prop_assert!((from_perpendicular_rectangle(wide, high, 1.0) - from_polygon(UP, &upright)).abs() < 2e-11);
        }
    }
}
