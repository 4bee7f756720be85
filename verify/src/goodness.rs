//! One-dimensional goodness of fit: Kolmogorov–Smirnov and Anderson–Darling against the uniform distribution on [0, 1].
//!
//! Any continuous distribution comes here through its cumulative distribution function.

mod marginal;
mod tail;

pub use marginal::{Marginal, Sides, Statistic};

use crate::error::InputError;
use tail::{anderson_darling_tail, kolmogorov_tail};

/// A statistic and its p-value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The statistic.
    pub statistic: f64,
    /// Probability of so large a statistic under the hypothesis.
    pub p_value: f64,
}

/// Kolmogorov–Smirnov's greatest distance D between the sample's and the uniform distribution function.
///
/// p = 2 Σ (−1)^(k−1) exp(−2k²λ²), λ = D(√n + 0.12 + 0.11/√n); for small λ the theta-transformed series.
///
/// # Precision, limits
/// Within 1 % of the exact p at n ≥ 32 for p in 1e-4 to 1 (tested by simulation at 1e-3); at least 8 values.
///
/// # Errors
/// [`InputError::TooFew`] below 8 values, [`InputError::Parameter`] for a value outside [0, 1].
///
/// # Source
/// Kolmogorov 1933; the correction for finite n: Stephens 1970, 10.1111/j.2517-6161.1970.tb00821.x.
pub fn kolmogorov_smirnov(values: &[f64]) -> Result<Fit, InputError> {
    let sorted = sorted(values)?;
    let n = sorted.len() as f64;
    let distance = |(i, &u): (usize, &f64)| (u - i as f64 / n).max((i + 1) as f64 / n - u);
    let statistic = sorted.iter().enumerate().map(distance).fold(0.0, f64::max);
    let lambda = statistic * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    Ok(Fit { statistic, p_value: kolmogorov_tail(lambda) })
}

/// Anderson–Darling's A², which weighs the tails.
///
/// A² = −n − (1/n) Σ (2i − 1)(ln uᵢ + ln(1 − u₍n+1−i₎)).
///
/// # Precision, limits
/// The asymptotic p, within 10 % of the exact one at n ≥ 32 (tested by simulation at 1e-2); at least 8 values.
///
/// # Errors
/// As [`kolmogorov_smirnov`]; a value of exactly 0 or 1 gives an infinite statistic and p = 0.
///
/// # Source
/// Anderson and Darling 1954, 10.1080/01621459.1954.10501232; the series for A² → ∞: Marsaglia and Marsaglia 2004, 10.18637/jss.v009.i02.
pub fn anderson_darling(values: &[f64]) -> Result<Fit, InputError> {
    let sorted = sorted(values)?;
    let statistic = a_squared(&sorted);
    Ok(Fit { statistic, p_value: anderson_darling_tail(statistic) })
}

fn a_squared(sorted: &[f64]) -> f64 {
    let n = sorted.len();
    let term = |i: usize| (2 * i + 1) as f64 * (sorted[i].ln() + (-sorted[n - 1 - i]).ln_1p());
    -(n as f64) - (0..n).map(term).sum::<f64>() / n as f64
}

fn sorted(values: &[f64]) -> Result<Vec<f64>, InputError> {
    if values.len() < 8 {
        return Err(InputError::TooFew { what: "values", given: values.len() as u64, needed: 8 });
    }
    if let Some(&value) = values.iter().find(|u| !(0.0..=1.0).contains(*u)) {
        return Err(InputError::Parameter { name: "value", value, accepted: "0 to 1" });
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    Ok(sorted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::uniform;

    #[test]
    fn p_values_are_uniform_under_the_truth_also_in_the_tail() {
        let runs = 20_000;
        let sample = |seed: u64| (0..32).map(|i| uniform(seed, i)).collect::<Vec<_>>();
        let below = |level: f64, test: fn(&[f64]) -> Result<Fit, InputError>| {
            (0..runs).filter(|&seed| test(&sample(seed)).unwrap().p_value < level).count() as f64
        };
        // Six standard deviations of a binomial count (2e-9), and 5 % of the level for the correction to finite n.
        let expected = |level: f64| (runs as f64 * level, 6.0 * (runs as f64 * level).sqrt());
        let (mean, width) = expected(1e-2);
        assert!((below(1e-2, kolmogorov_smirnov) - mean).abs() < width + 0.05 * mean);
        let beyond = |seed: &u64| a_squared(&sorted(&sample(*seed)).unwrap()) > 3.878_125; // P = 0.01
        assert!(((0..runs).filter(beyond).count() as f64 - mean).abs() < width + 0.05 * mean);
        let (mean, width) = expected(1e-3);
        assert!((below(1e-3, kolmogorov_smirnov) - mean).abs() < width + 0.05 * mean);
    }

    #[test]
    fn a_wrong_distribution_is_rejected_and_the_right_one_kept() {
        let right: Vec<f64> = (0..2000).map(|i| uniform(5, i)).collect();
        let wrong: Vec<f64> = right.iter().map(|u| u.powf(1.2)).collect();
        for test in [kolmogorov_smirnov, anderson_darling] {
            assert!(test(&right).unwrap().p_value > 1e-6);
            assert!(test(&wrong).unwrap().p_value < 1e-6);
        }
        assert!(kolmogorov_smirnov(&[0.5; 7]).is_err() && anderson_darling(&[1.5; 9]).is_err());
        assert_eq!(anderson_darling(&[0.0; 9]).unwrap().p_value, 0.0);
    }
}
