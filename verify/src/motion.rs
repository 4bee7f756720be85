//! Closed forms of motion blur: what moving edges, disks and turning sectors cover of a pixel or point over time.
//!
//! The shutter is open from 0 to 1: fully, unless a function says otherwise.

use crate::coverage::circle_in_rectangle;
use crate::quadrature::{Tolerance, integrate};
use std::f64::consts::TAU;

/// Share of pixel [0, 1] and shutter [0, 1] in which an edge at x₀ + v·t has passed: the mean of clamp(x₀ + v·t, 0, 1).
///
/// C = (P(x₀ + v) − P(x₀))/v, P(u) = 0 | u²/2 | u − ½ below, within and above [0, 1].
///
/// * `start`: x₀ in pixels; `velocity`: v in pixels per shutter; 0 gives the static edge.
///
/// Returns: the covered share, in [0, 1].
///
/// # Source
/// The integral of the clamped ramp.
#[must_use]
pub fn moving_edge(start: f64, velocity: f64) -> f64 {
    let integral = |u: f64| {
        if u <= 0.0 {
            0.0
        } else if u < 1.0 {
            0.5 * u * u
        } else {
            u - 0.5
        }
    };
    if velocity == 0.0 {
        return start.clamp(0.0, 1.0);
    }
    (integral(start + velocity) - integral(start)) / velocity
}

/// The same under a shutter that opens and closes linearly, fully open in the middle of its time only.
///
/// C = 4(K(x₀) − 2K(x₀ + v/2) + K(x₀ + v))/v², K(u) = 0 | u³/6 | u²/2 − u/2 + 1/6 below, within and above [0, 1].
///
/// # Precision, limits
/// An absolute error of 1e-15/v².
///
/// # Source
/// Two integrations by parts: the second derivative of the triangle is 4(δ₀ − 2δ½ + δ₁).
#[must_use]
pub fn moving_edge_triangle(start: f64, velocity: f64) -> f64 {
    let twice = |u: f64| match u {
        u if u <= 0.0 => 0.0,
        u if u < 1.0 => u.powi(3) / 6.0,
        u => 0.5 * u * (u - 1.0) + 1.0 / 6.0,
    };
    if velocity == 0.0 {
        return start.clamp(0.0, 1.0);
    }
    let sum = twice(start) - 2.0 * twice(start + 0.5 * velocity) + twice(start + velocity);
    4.0 * sum / (velocity * velocity)
}

/// Share of a rectangle and of the shutter that a disk covers which moves from (0, 0) to (l, 0).
///
/// The mean over time of [`circle_in_rectangle`], by quadrature to 1e-9.
///
/// # Source
/// Fubini.
#[must_use]
pub fn moving_disk_over_pixel(radius: f64, path: f64, [x, y]: [[f64; 2]; 2]) -> f64 {
    let area = |t: f64| circle_in_rectangle(radius, [x.map(|x| x - path * t), y]);
    let tolerance = Tolerance { relative: 0.0, absolute: 1e-9, pieces: 1000 };
    let whole = (x[1] - x[0]) * (y[1] - y[0]);
    integrate(&area, [0.0, 1.0], tolerance).value / whole
}

/// Share of the shutter in which a sector covers a direction: it lies between the angles θ and θ + `width` and θ turns from 0 to
/// `turn`.
///
/// |[φ − width, φ] ∩ [0, turn]|/turn for φ in [0, 2π), and the same for φ + 2π.
///
/// * `angle`: φ of the direction, in [0, 2π); `width` and `turn`: above 0, together at most 2π.
///
/// # Source
/// The sector covers φ while θ is in [φ − width, φ].
#[must_use]
pub fn turning_sector(width: f64, turn: f64, angle: f64) -> f64 {
    let overlap = |phi: f64| (phi.min(turn) - (phi - width).max(0.0)).max(0.0);
    (overlap(angle) + overlap(angle + TAU)) / turn
}

/// Share of the shutter in which a disk that moves from (0, 0) to (l, 0) covers a point: |[x − h, x + h] ∩ [0, l]|/l, h = √(r² − y²).
///
/// * `radius`: r; `path`: l ≥ 0; with l = 0 the disk stands still.
///
/// # Source
/// The disk covers the point while its centre is within h of x.
#[must_use]
pub fn moving_disk(radius: f64, path: f64, [x, y]: [f64; 2]) -> f64 {
    if y.abs() >= radius {
        return 0.0;
    }
    let h = ((radius - y) * (radius + y)).sqrt();
    if path == 0.0 {
        return f64::from(u8::from(x.abs() < h));
    }
    ((x + h).min(path) - (x - h).max(0.0)).max(0.0) / path
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance::quadrature::{over_square, over_unit};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_edge_agrees_with_its_mean_over_time(start in -2.0..2.0_f64, velocity in -3.0..3.0_f64) {
            let mean = over_unit(300, |t| (start + velocity * t).clamp(0.0, 1.0));
            // Exact on straight parts; two kinks: velocity·h²/8 each, h = 1/300; near v = 0 the quotient keeps 1e-16/v.
            prop_assert!((moving_edge(start, velocity) - mean).abs() < 1e-5 + 1e-15 / velocity.abs());
        }

        #[test]
        fn a_triangle_shutter_agrees_with_its_mean_over_time(start in -2.0..2.0_f64, v in 0.2..3.0_f64, sign in 0..2) {
            let velocity = if sign == 0 { v } else { -v };
            let weight = |t: f64| 4.0 * t.min(1.0 - t);
            let mean = over_unit(600, |t| weight(t) * (start + velocity * t).clamp(0.0, 1.0));
            // Midpoint rule, h = 1/600: h²/12·|f'| at each kink, |f'| below 8·3, three kinks.
            prop_assert!((moving_edge_triangle(start, velocity) - mean).abs() < 2e-5);
        }

        #[test]
        fn a_disk_over_a_pixel_agrees_with_its_points(x in -2.0..4.0_f64, y in -1.5..1.5_f64, path in 0.1..3.0_f64) {
            let pixel = over_square(100, |s, t| moving_disk(1.0, path, [x + s, y + t]));
            // Kinks along the rim's sweep: h²·|f'|, |f'| below 1/path along x and its root at the top: h^1.5/path.
            let whole = moving_disk_over_pixel(1.0, path, [[x, x + 1.0], [y, y + 1.0]]);
            prop_assert!((whole - pixel).abs() < 1e-3 + 1e-3 / path);
        }

        #[test]
        fn a_sector_agrees_with_its_mean_over_time(width in 0.1..2.0_f64, turn in 0.1..2.0_f64, angle in 0.0..TAU) {
            let covers = |t: f64| (angle - turn * t).rem_euclid(TAU) < width;
            let mean = over_unit(500, |t| f64::from(u8::from(covers(t))));
            prop_assert!((turning_sector(width, turn, angle) - mean).abs() <= 1.01 / 500.0); // two jumps, half a node each
        }

        #[test]
        fn a_disk_agrees_with_its_mean_over_time(x in -2.0..4.0_f64, y in -1.5..1.5_f64, path in 0.1..3.0_f64) {
            let covers = |t: f64| (x - path * t).powi(2) + y * y < 1.0;
            let mean = over_unit(500, |t| f64::from(u8::from(covers(t))));
            prop_assert!((moving_disk(1.0, path, [x, y]) - mean).abs() <= 1.01 / 500.0); // two jumps, half a node each
        }
    }

    #[test]
    fn what_stands_still_is_sharp() {
        assert_eq!((moving_edge(0.3, 0.0), moving_edge(-1.0, 0.0), moving_edge(2.0, 0.0)), (0.3, 0.0, 1.0));
        assert_eq!((moving_disk(1.0, 0.0, [0.5, 0.5]), moving_disk(1.0, 0.0, [0.5, 0.9])), (1.0, 0.0));
        assert_eq!(moving_disk(1.0, 2.0, [1.0, 1.0]), 0.0);
    }
}
