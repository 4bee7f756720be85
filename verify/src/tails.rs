//! Tail probabilities and quantiles of the normal and Student distributions, accurate far into the tail.

use crate::error::InputError;
use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf::{erfc, erfc_inv};
use std::f64::consts::SQRT_2;

/// Above this many degrees of freedom Student's t is replaced by the normal: at z = 5 the quantiles then differ by
/// (z³ + z)/(4ν) = 3.3e-5 at most.
const NORMAL_DOF: f64 = 1e6;

/// P(Z > z) of a standard normal Z.
pub(crate) fn normal_tail(z: f64) -> f64 {
    0.5 * erfc(z / SQRT_2)
}

/// z with P(Z > z) = `tail`, for a tail in (0, 1).
pub(crate) fn normal_quantile(tail: f64) -> f64 {
    SQRT_2 * erfc_inv(2.0 * tail)
}

/// P(T > t) of Student's t with `dof` > 0 degrees of freedom.
pub(crate) fn t_tail(t: f64, dof: f64) -> f64 {
    match StudentsT::new(0.0, 1.0, dof) {
        _ if t.is_infinite() => f64::from(u8::from(t < 0.0)),
        Ok(student) if dof < NORMAL_DOF => student.sf(t),
        _ => normal_tail(t),
    }
}

/// t with P(T > t) = `tail` for `dof` degrees of freedom and a tail in (0, ½], by bisection of [`t_tail`].
pub(crate) fn t_quantile(tail: f64, dof: f64) -> f64 {
    if dof >= NORMAL_DOF {
        return normal_quantile(tail);
    }
    let mut high = 1.0;
    while t_tail(high, dof) > tail {
        high *= 2.0;
    }
    bisect([0.0, high], |t| t_tail(t, dof) < tail)
}

/// The shift λ at which a two-sided t test at `level` finds a defect of λ standard errors with probability `power`.
///
/// The statistic is then non-central: P(T' > t) = E[Φ(λ − t·S)] with S² = χ²/ν, integrated over the density of S;
/// the other tail, below 1e-9 wherever power ≥ ½ and level ≤ 1e-2, is left out, which makes λ larger.
///
/// # Verified by
/// `tests::noncentrality_gives_its_power`
pub(crate) fn t_noncentrality(level: f64, power: f64, dof: f64) -> f64 {
    let critical = t_quantile(0.5 * level, dof);
    if dof >= NORMAL_DOF {
        return critical + normal_quantile(1.0 - power);
    }
    let spread = chi_over_root_dof(dof);
    let reached = |shift: f64| -> f64 {
        spread.iter().map(|[s, weight]| weight * normal_tail(critical * s - shift)).sum()
    };
    bisect([0.0, 2.0 * critical + 20.0], |shift| reached(shift) > power)
}

/// Nodes and normalised weights of the distribution of S = √(χ²/ν), on an even grid over mean ± 10 deviations.
fn chi_over_root_dof(dof: f64) -> Vec<[f64; 2]> {
    const NODES: u32 = 200;
    let deviation = 1.0 / (2.0 * dof).sqrt();
    let low = (1.0 - 10.0 * deviation).max(0.0);
    let step = (1.0 + 10.0 * deviation - low) / f64::from(NODES);
    let node = |i: u32| low + (f64::from(i) + 0.5) * step;
    let density = |s: f64| ((dof - 1.0) * s.ln() - 0.5 * dof * (s * s - 1.0)).exp();
    let total: f64 = (0..NODES).map(|i| density(node(i))).sum();
    (0..NODES).map(|i| [node(i), density(node(i)) / total]).collect()
}

/// The point of `range` where `above` turns from false to true, to the last bits.
fn bisect([mut low, mut high]: [f64; 2], above: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high || high - low <= 1e-13 * high {
            return high;
        }
        if above(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
}

/// The probability that the smallest of `tests` independent p-values is at most `smallest` (Šidák 1967, 10.2307/2283989).
pub(crate) fn any_of(tests: f64, smallest: f64) -> f64 {
    -(tests * (-smallest).ln_1p()).exp_m1()
}

/// [`any_of`] of a list of p-values; one that is not a number counts as 1.
pub(crate) fn any(p_values: &[f64]) -> f64 {
    any_of(p_values.len() as f64, p_values.iter().copied().fold(1.0, f64::min))
}

/// The level of each of `tests` independent tests that together have `level`: the inverse of [`any_of`].
pub(crate) fn shared_level(tests: f64, level: f64) -> f64 {
    -((-level).ln_1p() / tests).exp_m1()
}

/// Refuses a parameter that is not above zero and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), InputError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(InputError::Parameter { name, value, accepted: "a finite number above 0" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_published_tables() {
        // Student's t tables, printed to three decimals: half a unit of the last one.
        for (tail, dof, expected) in
            [(0.0005, 31.0, 3.633), (0.0005, 3.0, 12.924), (0.025, 10.0, 2.228), (0.0005, 1e9, 3.291)]
        {
            assert!((t_quantile(tail, dof) - expected).abs() < 5e-4, "{tail} {dof}");
        }
    }

    #[test]
    fn tails_keep_their_digits_far_out() {
        // Mills' ratio: φ(z)/z·(1 − 1/z²) < P(Z > z) < φ(z)/z.
        for z in [6.0_f64, 10.0, 30.0] {
            let upper = (-0.5 * z * z).exp() / (z * (2.0 * std::f64::consts::PI).sqrt());
            assert!(normal_tail(z) < upper && normal_tail(z) > upper * (1.0 - 1.0 / (z * z)));
        }
        // One degree of freedom is Cauchy: P(T > t) = atan(1/t)/π exactly; 1e-12 is the beta function's accuracy.
        for t in [1.0_f64, 1e3, 1e6] {
            let exact = (1.0 / t).atan() / std::f64::consts::PI;
            assert!((t_tail(t, 1.0) / exact - 1.0).abs() < 1e-12, "{t}");
        }
        assert_eq!((t_tail(f64::INFINITY, 5.0), t_tail(f64::NEG_INFINITY, 5.0)), (0.0, 1.0));
    }

    /// For many degrees of freedom λ tends to the sum of the level's and the power's normal quantiles.
    #[test]
    fn noncentrality_gives_its_power() {
        let many = t_noncentrality(1e-3, 0.9, 9e5);
        // Terms of order z³/(4ν) are left: 3.29³/3.6e6 = 1e-5.
        assert!((many - (normal_quantile(5e-4) + normal_quantile(0.1))).abs() < 2e-5);
        // Patnaik's relation at ν = 31: the mean of t·S is t·c₄, c₄ = 1 − 1/(4ν) to O(1/ν²); S is normal to O(1/√ν).
        let t = t_quantile(5e-4, 31.0);
        let rough = t * (1.0 - 1.0 / 124.0) + normal_quantile(0.1) * (1.0 + t * t / 62.0).sqrt();
        assert!((t_noncentrality(1e-3, 0.9, 31.0) - rough).abs() < 0.05); // skewness of S: 1/(6√(2ν)) = 0.02, times t·S' 2
    }
}
