//! The non-central chi-square distribution: what a chi-square test sees of a defect, and which defects a
//! statistic leaves possible.
//!
//! Counts of n points in k + 1 cells whose probabilities are off by Δ give a statistic that follows, for
//! large n, the non-central chi-square distribution with k degrees of freedom and λ = n Σ Δ²/p. The RMS
//! relative error over cells is √(λ/n).

use statrs::distribution::{ChiSquared, ContinuousCDF};
use statrs::function::gamma::{gamma_lr, gamma_ur, ln_gamma};

/// Poisson weights below this share of the largest are left out; what is dropped is below 1e-16 of the whole.
const NEGLIGIBLE_WEIGHT: f64 = 1e-19;

/// Probability that a chi-square statistic without defect exceeds `x`.
///
/// * `x`: at least 0; `dof`: above 0.
pub fn chi_square_sf(x: f64, dof: f64) -> f64 {
    match ChiSquared::new(dof) {
        Ok(distribution) => distribution.sf(x),
        Err(_) => f64::NAN,
    }
}

/// The value that a chi-square statistic without defect exceeds with probability `p`.
///
/// * `p`: in (0, 1); `dof`: above 0.
pub fn chi_square_critical(p: f64, dof: f64) -> f64 {
    let mut above = dof + 1.0;
    while chi_square_sf(above, dof) > p {
        above *= 2.0;
    }
    solve([0.0, above], |x| (chi_square_sf(x, dof) / p).ln())
}

/// Probability that a non-central chi-square statistic is at most `x`.
///
/// F(x; k, λ) = Σⱼ Poisson(j; λ/2) P(k/2 + j, x/2) with the regularised incomplete gamma function P. One
/// value of P is computed, at the largest j that counts; the others follow from P(a, y) = P(a + 1, y) + yᵃ
/// e⁻ʸ/Γ(a + 1), a sum of positive terms, so nothing cancels.
///
/// * `x`: at least 0; `dof`: above 0; `lambda`: at least 0.
///
/// # Precision, limits
/// Relative error below 1e-8 for probabilities above 1e-12 and `dof` up to 2·10⁴; the work grows as √λ.
///
/// # Source
/// Johnson, Kotz, Balakrishnan 1995, "Continuous univariate distributions", volume 2, equation 29.3.
///
/// # Verified by
/// `power::tests::agrees_with_scipy`, `power::tests::agrees_with_quadrature_of_the_density`
pub fn noncentral_cdf(x: f64, dof: f64, lambda: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let y = x / 2.0;
    let (first, weights) = poisson_weights(lambda / 2.0);
    let last = dof / 2.0 + first + (weights.len() - 1) as f64;
    let (mut a, mut p, mut step) = (last, gamma_lr(last, y), gamma_step(last, y));
    let mut sum = 0.0;
    for weight in weights.iter().rev() {
        sum += weight * p;
        step *= a / y;
        a -= 1.0;
        p += step;
    }
    sum.min(1.0)
}

/// Probability that a non-central chi-square statistic exceeds `x`: the complement of [`noncentral_cdf`],
/// with its own full precision.
///
/// The same sum with Q = 1 − P, from the smallest j that counts upward: Q(a + 1, y) = Q(a, y) + yᵃ e⁻ʸ/Γ(a +
/// 1).
///
/// * `x`: at least 0; `dof`: above 0; `lambda`: at least 0.
pub fn noncentral_sf(x: f64, dof: f64, lambda: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let y = x / 2.0;
    let (first, weights) = poisson_weights(lambda / 2.0);
    let (mut a, mut sum) = (dof / 2.0 + first, 0.0);
    let (mut q, mut step) = (gamma_ur(a, y), gamma_step(a, y));
    for weight in &weights {
        sum += weight * q;
        q += step;
        a += 1.0;
        step *= y / a;
    }
    sum.min(1.0)
}

/// The largest λ that leaves a statistic of at most `x` with probability at least `p`: the upper limit of λ
/// at confidence 1 − p.
///
/// Returns: 0 where even λ = 0 leaves such a small statistic with less than `p`.
pub fn lambda_upper(x: f64, dof: f64, p: f64) -> f64 {
    let excess = |lambda| (noncentral_cdf(x, dof, lambda) / p).ln();
    if excess(0.0) > 0.0 { solve(bracket(x, excess), excess) } else { 0.0 }
}

/// The smallest λ that gives a statistic above `x` with probability at least `p`: the lower limit of λ at
/// confidence 1 − p, and, for a critical value `x`, the λ that is caught with power `p`.
///
/// Returns: 0 where no defect is needed.
pub fn lambda_lower(x: f64, dof: f64, p: f64) -> f64 {
    let excess = |lambda| (p / noncentral_sf(x, dof, lambda)).ln();
    if excess(0.0) > 0.0 { solve(bracket(x, excess), excess) } else { 0.0 }
}

/// Poisson probabilities from the first to the last that counts, and the first's index.
fn poisson_weights(mean: f64) -> (f64, Vec<f64>) {
    if mean <= 0.0 {
        return (0.0, vec![1.0]);
    }
    let mode = mean.floor();
    let largest = (mode * mean.ln() - mean - ln_gamma(mode + 1.0)).exp();
    let mut down = Vec::new();
    let (mut j, mut weight) = (mode, largest);
    while j > 0.0 && weight > largest * NEGLIGIBLE_WEIGHT {
        weight *= j / mean;
        j -= 1.0;
        down.push(weight);
    }
    let first = mode - down.len() as f64;
    let mut weights: Vec<f64> = down.into_iter().rev().collect();
    (j, weight) = (mode, largest);
    while weight > largest * NEGLIGIBLE_WEIGHT {
        weights.push(weight);
        j += 1.0;
        weight *= mean / j;
    }
    (first, weights)
}

/// yᵃ e⁻ʸ / Γ(a + 1): by how much P(a, y) exceeds P(a + 1, y).
fn gamma_step(a: f64, y: f64) -> f64 {
    (a * y.ln() - y - ln_gamma(a + 1.0)).exp()
}

/// An interval from 0 to a λ at which a decreasing function is no longer positive.
fn bracket(x: f64, excess: impl Fn(f64) -> f64) -> [f64; 2] {
    let mut high = x + 16.0;
    while excess(high) > 0.0 {
        high *= 2.0;
    }
    [0.0, high]
}

/// The root of a function that falls from positive to negative, to a relative 1e-10: by secants, with the value that stays behind
/// halved so that both ends move (the Illinois rule), and by bisection where a value is infinite.
///
/// # Source
/// Dowell and Jarratt 1971, 10.1007/BF01934364.
fn solve([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    let mut was_low = None;
    while high - low > 1e-10 * high {
        let secant = low + (high - low) * (at_low / (at_low - at_high));
        let next = if secant > low && secant < high { secant } else { 0.5 * (low + high) };
        if next <= low || next >= high {
            break;
        }
        let value = f(next);
        if value.abs() < 1e-13 {
            return next; // the probability is right to 1e-13 of itself, finer than it is computed
        }
        let is_low = value > 0.0;
        if is_low {
            (low, at_low) = (next, value);
            at_high *= if was_low == Some(true) { 0.5 } else { 1.0 };
        } else {
            (high, at_high) = (next, value);
            at_low *= if was_low == Some(false) { 0.5 } else { 1.0 };
        }
        was_low = Some(is_low);
    }
    0.5 * (low + high)
}

/// The place where a predicate turns from true to false, to a relative 1e-10.
pub(crate) fn bisect([mut low, mut high]: [f64; 2], is_below: impl Fn(f64) -> bool) -> f64 {
    while high - low > 1e-10 * high {
        let middle = 0.5 * (low + high);
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x, degrees of freedom, λ, cdf, sf: by the Poisson mixture in 40 digits (mpmath), and the same to 13
    /// digits by scipy 1.17.1 `ncx2`.
    const REFERENCE: [[f64; 5]; 8] = [
        [3.0, 5.0, 0.5, 0.25692939942805, 0.74307060057195],
        [1800.0, 5.0, 2000.0, 0.0096195229452068, 0.99038047705479],
        [300.0, 199.0, 60.0, 0.94273661433902, 0.057263385660979],
        [200.0, 199.0, 220.0, 3.820413959815e-14, 1.0],
        [310.0, 199.0, 0.01, 0.99999922766936, 7.7233064067215e-7],
        [20_500.0, 19_999.0, 300.0, 0.83900100962707, 0.16099899037293],
        [21_500.0, 19_999.0, 2000.0, 0.010961816286846, 0.98903818371315],
        [23_500.0, 19_999.0, 2000.0, 1.0, 1.0024891661591e-11],
    ];

    fn relative(value: f64, reference: f64) -> f64 {
        (value / reference - 1.0).abs()
    }

    #[test]
    fn agrees_with_scipy() {
        for [x, dof, lambda, cdf, sf] in REFERENCE {
            // statrs' gamma functions lose about a·ln(a)·ε = 2e-11 at a = 10⁴, and the tails at a + j no more than that again.
            let (c, s) = (noncentral_cdf(x, dof, lambda), noncentral_sf(x, dof, lambda));
            assert!(relative(c, cdf) < 1e-9, "cdf({x}, {dof}, {lambda}) = {c:e}, not {cdf:e}");
            assert!(relative(s, sf) < 1e-9, "sf({x}, {dof}, {lambda}) = {s:e}, not {sf:e}");
        }
    }

    #[test]
    fn critical_values_agree_with_scipy() {
        for (p, dof, x) in [
            (1e-3, 199.0, 266.38589537626),
            (1e-6, 199.0, 308.60096676885),
            (1e-3, 19_999.0, 20_622.73499782986),
        ] {
            assert!(relative(chi_square_critical(p, dof), x) < 2e-10, "p {p}, {dof} degrees of freedom"); // bisection stops at 1e-10
        }
    }

    #[test]
    fn agrees_with_quadrature_of_the_density() {
        // One degree of freedom: (z + √λ)² with z standard normal, so F(x) = ∫ φ(z) dz over |z + √λ| ≤ √x.
        let (x, lambda) = (7.0f64, 2.5f64);
        let (low, high) = (-x.sqrt() - lambda.sqrt(), x.sqrt() - lambda.sqrt());
        let (steps, density) = (2000, |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt());
        let h = (high - low) / f64::from(steps);
        let simpson = |i: i32| {
            h / 6.0
                * (density(low + h * f64::from(i))
                    + 4.0 * density(low + h * (f64::from(i) + 0.5))
                    + density(low + h * f64::from(i + 1)))
        };
        let cdf: f64 = (0..steps).map(simpson).sum();
        assert!((noncentral_cdf(x, 1.0, lambda) - cdf).abs() < 1e-12); // Simpson's error: h⁴/2880·max|φ''''|·length ≈ 1e-14
        assert!((noncentral_sf(x, 1.0, lambda) - (1.0 - cdf)).abs() < 1e-12); // the same
    }

    #[test]
    fn limits_of_lambda_invert_the_distribution() {
        for (x, dof) in [(250.0, 199.0), (20_500.0, 19_999.0)] {
            let upper = lambda_upper(x, dof, 1e-3);
            assert!(relative(noncentral_cdf(x, dof, upper), 1e-3) < 1e-7); // 1e-10 in λ times d ln F/d ln λ, below 1e3
        }
        let lower = lambda_lower(350.0, 199.0, 1e-3);
        assert!(relative(noncentral_sf(350.0, 199.0, lower), 1e-3) < 1e-7); // the same
        assert_eq!(lambda_lower(199.0, 199.0, 1e-3), 0.0);
        assert_eq!(lambda_upper(100.0, 199.0, 1e-3), 0.0);
    }

    #[test]
    fn power_of_200_cells_agrees_with_scipy() {
        // λ caught with power 0.9 at 1e-3 with 195 degrees of freedom, by scipy 1.17.1: brentq over ncx2.sf(chi2.isf(1e-3, 195), 195, λ).
        let lambda = lambda_lower(chi_square_critical(1e-3, 195.0), 195.0, 0.9);
        assert!(relative(lambda, 102.427906124) < 1e-8, "{lambda}"); // brentq's own tolerance of 2e-12 and the critical value's 1e-10
    }
}
