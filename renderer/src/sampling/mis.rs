//! Weights for samples of one integral that were drawn in more than one way.

/// The power heuristic with exponent 2 for two strategies of one sample each: a² / (a² + b²).
///
/// * `a`: density of the strategy that drew the sample, above 0; `b`: density of the other one there, at least 0;
///   both in the same measure, infinity included.
/// Returns: the weight of the sample, in [0, 1]; ½ where both are infinite.
///
/// # Precision, limits
/// The squares are never formed, so that densities from 1e-38 to infinity keep their ratio.
///
/// # Source
/// Veach 1997, "Robust Monte Carlo methods for light transport simulation", section 9.2.4.
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    if a == b {
        return 0.5;
    }
    let ratio = b / a;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_weights_add_up_to_one() {
        for (a, b) in [(1.0, 3.0), (1e-30, 1e-31), (1e30, 1e25), (7.0, 0.0)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() <= 2.0 * f32::EPSILON, "{a} {b}: {sum}"); // two quotients and a sum
        }
    }

    #[test]
    fn infinite_and_zero_densities_have_a_weight() {
        assert_eq!(power_heuristic(f32::INFINITY, 1.0), 1.0);
        assert_eq!(power_heuristic(1.0, f32::INFINITY), 0.0);
        assert_eq!(power_heuristic(f32::INFINITY, f32::INFINITY), 0.5);
        assert_eq!(power_heuristic(2.0, 0.0), 1.0);
    }
}
