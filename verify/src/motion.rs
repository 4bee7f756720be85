//! Closed forms of motion blur under a box shutter: what moving edges and disks cover of a pixel or point over time.

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
    use crate::irradiance::quadrature::over_unit;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_edge_agrees_with_its_mean_over_time(start in -2.0..2.0_f64, velocity in -3.0..3.0_f64) {
            let mean = over_unit(300, |t| (start + velocity * t).clamp(0.0, 1.0));
            // Exact on straight parts; two kinks: velocity·h²/8 each, h = 1/300; near v = 0 the quotient keeps 1e-16/v.
            prop_assert!((moving_edge(start, velocity) - mean).abs() < 1e-5 + 1e-15 / velocity.abs());
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
