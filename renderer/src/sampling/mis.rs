//! Weights that combine several ways of sampling the same integral.

use wide::f32x8;

/// The balance heuristic: `pdf` / (`pdf` + `other`).
///
/// * `pdf`: density of the sample by the way it was drawn; `other`: by the other way. Same measure, not negative;
///   infinity stands for a way that meets nothing else.
///
/// Returns: a weight in [0, 1]; those of both ways sum to 1. 0 where `pdf` is 0; ½ where both are infinite.
///
/// # Source
/// Veach 1997, "Robust Monte Carlo methods for light transport simulation", equation 9.8.
///
/// # Verified by
/// `sampling::mis::tests`
#[inline]
pub fn balance_heuristic(pdf: f32, other: f32) -> f32 {
    share(pdf, other, |ratio| ratio)
}

/// The power heuristic of exponent 2: `pdf`² / (`pdf`² + `other`²).
///
/// Arguments and edges as of [`balance_heuristic`]. The ratio is squared, not the densities, so that nothing overflows.
///
/// # Source
/// Veach 1997, "Robust Monte Carlo methods for light transport simulation", equation 9.13.
///
/// # Verified by
/// `sampling::mis::tests`
#[inline]
pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
    share(pdf, other, |ratio| ratio * ratio)
}

/// [`power_heuristic`] of eight pairs, bit for bit where `other` is finite and above 0.
#[inline]
pub fn power_heuristic_eight(pdf: f32x8, other: f32x8) -> f32x8 {
    let ratio = other / pdf;
    f32x8::ONE / (f32x8::ONE + ratio * ratio)
}

#[inline]
fn share(pdf: f32, other: f32, of_ratio: impl Fn(f32) -> f32) -> f32 {
    debug_assert!(pdf >= 0.0 && other >= 0.0, "densities {pdf} and {other}");
    if pdf == 0.0 {
        0.0
    } else if pdf == other {
        0.5
    } else {
        1.0 / (1.0 + of_ratio(other / pdf))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_values() {
        assert_eq!(balance_heuristic(3.0, 1.0), 0.75);
        assert_eq!(power_heuristic(3.0, 1.0), 0.9);
    }

    #[test]
    fn edges() {
        for heuristic in [balance_heuristic, power_heuristic] {
            assert_eq!(heuristic(0.0, 0.0), 0.0);
            assert_eq!(heuristic(0.0, 2.0), 0.0);
            assert_eq!(heuristic(2.0, 0.0), 1.0);
            assert_eq!(heuristic(f32::INFINITY, 2.0), 1.0);
            assert_eq!(heuristic(2.0, f32::INFINITY), 0.0);
            assert_eq!(heuristic(f32::INFINITY, f32::INFINITY), 0.5);
            assert_eq!(heuristic(0.0, f32::INFINITY), 0.0);
        }
    }

    #[test]
    fn eight_weights_are_made_as_one() {
        let pdf = [0.0, 1e-30, 0.3, 1.0, 1.7, 2e9, f32::MAX, f32::INFINITY];
        let eight = power_heuristic_eight(f32x8::new(pdf), f32x8::splat(1.7)).to_array();
        assert_eq!(eight, pdf.map(|pdf| power_heuristic(pdf, 1.7)));
    }

    #[test]
    fn both_weights_sum_to_one() {
        for heuristic in [balance_heuristic, power_heuristic] {
            for exponent in -40..40 {
                let (pdf, other) = (1.7 * 2.0_f32.powi(3 * exponent), 0.3);
                // Two quotients of two roundings each, of weights below 1: 4 · 2⁻²⁴.
                let sum = heuristic(pdf, other) + heuristic(other, pdf);
                assert!((sum - 1.0).abs() <= 2.0 * f32::EPSILON, "{pdf}: {sum}");
            }
        }
    }
}
