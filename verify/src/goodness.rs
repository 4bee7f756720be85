//! One-dimensional goodness of fit: Kolmogorov–Smirnov and Anderson–Darling against the uniform distribution on [0, 1].
//!
//! Any continuous distribution comes here through its cumulative distribution function.

use crate::error::InputError;

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

fn kolmogorov_tail(lambda: f64) -> f64 {
    use std::f64::consts::PI;
    // Either series has terms below 1e-16 after the fifth on its side of 1.
    if lambda < 1.0 {
        let term = |k: i32| (-(f64::from(2 * k - 1) * PI / lambda).powi(2) / 8.0).exp();
        return 1.0 - (2.0 * PI).sqrt() / lambda * (1..=5).map(term).sum::<f64>();
    }
    let term = |k: i32| 2.0 * (-2.0 * (f64::from(k) * lambda).powi(2)).exp();
    (1..=5).map(|k| if k % 2 == 1 { term(k) } else { -term(k) }).sum()
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

/// P(A² > z) in the limit of many values.
///
/// A² = Σ χ²₁/(j(j + 1)), so Imhof's inversion gives P(A² > z) = ½ + (1/π)∫₀^∞ sin θ(u)/(u ρ(u)) du,
/// θ = ½ Σ atan(u/(j(j + 1))) − ½ z u, ρ = Π (1 + u²/(j(j + 1))²)^¼.
fn anderson_darling_tail(z: f64) -> f64 {
    if z.is_infinite() {
        return 0.0;
    }
    if z > 8.0 {
        // ½χ²₁ + W with W the rest of the sum: P = E[P(χ²₁ > 2z − 2W)] = P(χ²₁ > 2z)·E[exp W]·(1 + E*[W]/(2z) + O(1/z²)), where
        // E[exp W] = Π_{j≥2} (1 − 2/(j(j + 1)))^−½ = √3 and the tilted mean E*[W] = Σ_{j≥2} 1/((j − 1)(j + 2)) = 11/18.
        let first = 2.0 * crate::tails::normal_tail((2.0 * z).sqrt());
        return 3.0_f64.sqrt() * first * (1.0 + 11.0 / (36.0 * z));
    }
    const TERMS: u32 = 200;
    let weights: Vec<f64> = (1..=TERMS).map(|j| 1.0 / f64::from(j * (j + 1))).collect();
    // Weights beyond the last sum to 1/(TERMS + 1): they act as their mean.
    let shift = z - 1.0 / f64::from(TERMS + 1);
    let integrand = |u: f64| {
        let theta = 0.5 * weights.iter().map(|w| (w * u).atan()).sum::<f64>() - 0.5 * shift * u;
        let log_rho = 0.25 * weights.iter().map(|w| (w * w * u * u).ln_1p()).sum::<f64>();
        theta.sin() * (-log_rho).exp() / u
    };
    // At u = 400 ρ exceeds 1e8. The integrand is even and analytic, so the midpoint rule errs only by P(A² > 2π/step − z), 1e-18.
    let (step, nodes) = (0.125, 3200);
    let sum: f64 = (0..nodes).map(|i| integrand((f64::from(i) + 0.5) * step)).sum();
    (0.5 + sum * step / std::f64::consts::PI).clamp(0.0, 1.0)
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
    fn tails_agree_with_published_quantiles() {
        // Asymptotic Kolmogorov quantiles, printed to three decimals: d ln p = 4λ·5e-4 = 0.4 %.
        for (lambda, p) in [(1.358, 0.05), (1.628, 0.01), (1.949, 0.001)] {
            assert!((kolmogorov_tail(lambda) / p - 1.0).abs() < 4e-3, "{lambda}");
        }
        assert!((kolmogorov_tail(0.999_999) - kolmogorov_tail(1.000_001)).abs() < 1e-5); // slope near 1 is below 2
        // Anderson–Darling quantiles by Marsaglia and Marsaglia; the quadrature is good to 1e-5 of these p.
        for (z, p) in
            [(1.932_957_832_741_593_7, 0.1), (2.492_367_160_049_41, 0.05), (3.878_125_021_605_395, 0.01)]
        {
            assert!((anderson_darling_tail(z) / p - 1.0).abs() < 1e-5, "{z}: {}", anderson_darling_tail(z));
        }
        // Where the far tail takes over its neglected O(1/z²) is below half a percent: (3·E*[W²]/2 − 2·E*[W])/(2z)² = −0.2 %.
        assert!((anderson_darling_tail(7.9999) / anderson_darling_tail(8.0001) - 1.0).abs() < 5e-3);
    }

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
