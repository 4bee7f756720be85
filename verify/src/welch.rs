//! Welch's test: two means that are known with errors of their own.

use crate::claim::{Evidence, REJECTION_LEVEL, Resolution, Run};
use crate::error::InputError;
use crate::estimate::{Estimate, Moments, Replicate};
use crate::mean::{CONTROL_FACTOR, FEWEST_REPLICATES};
use crate::seeds::derive;
use crate::tails::{normal_quantile, positive, t_noncentrality, t_quantile, t_tail};

/// Power for which the resolution is stated.
const POWER: f64 = 0.9;

/// The claim that two estimators have the same mean.
///
/// The defect is |mean A − mean B|/unit. Low-discrepancy points inside a replicate are welcome, since the errors come from the
/// replicates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EqualMeans {
    /// What the defect is measured in.
    pub unit: f64,
    /// Number of replicates a side at effort 1, at least 32.
    pub replicates: u64,
    /// Bound on the defect.
    pub bound: f64,
}

impl EqualMeans {
    /// Runs the claim on two subjects that each give one replicate's mean from a seed; no seed is used twice.
    ///
    /// # Errors
    /// [`InputError`] for fewer than 32 replicates, a unit or bound that is not above 0, or a mean that is not finite.
    pub fn evidence<A: Into<Replicate>, B: Into<Replicate>>(
        &self,
        run: &Run,
        a: impl Fn(u64) -> A,
        b: impl Fn(u64) -> B,
    ) -> Result<Evidence, InputError> {
        let seed = |side: u64, i: u64| derive(run.seed, side, i);
        let count = self.replicates * run.effort;
        let a: Vec<Replicate> = (0..count).map(|i| a(seed(0, i)).into()).collect();
        let b: Vec<Replicate> = (0..count).map(|i| b(seed(1, i)).into()).collect();
        self.judge(&a, &b)
    }

    /// Runs the claim with A moved by 2.2 resolutions: evidence that must reject.
    ///
    /// # Errors
    /// As [`Self::evidence`].
    pub fn control<A: Into<Replicate>, B: Into<Replicate>>(
        &self,
        run: &Run,
        a: impl Fn(u64) -> A,
        b: impl Fn(u64) -> B,
    ) -> Result<Evidence, InputError> {
        let shift = CONTROL_FACTOR * self.evidence(run, &a, &b)?.resolution.value * self.unit;
        let moved = |seed: u64| {
            let replicate: Replicate = a(seed).into();
            Replicate { mean: replicate.mean + shift, ..replicate }
        };
        self.evidence(run, moved, b)
    }

    /// Judges replicates that were drawn already.
    ///
    /// # Errors
    /// As [`Self::evidence`].
    pub fn judge(&self, a: &[Replicate], b: &[Replicate]) -> Result<Evidence, InputError> {
        positive("unit", self.unit)?;
        positive("bound", self.bound)?;
        let sides = [a, b];
        for side in sides {
            let given = side.len() as u64;
            if given < FEWEST_REPLICATES {
                return Err(InputError::TooFew { what: "replicates", given, needed: FEWEST_REPLICATES });
            }
            if let Some(i) = side.iter().position(|r| !r.mean.is_finite() || r.largest.is_nan()) {
                return Err(InputError::Subject(format!("replicate {i} is {}", side[i].mean)));
            }
        }
        let estimates = sides.map(Estimate::of);
        let [sum_a, sum_b] =
            sides.map(|s| Sum::over_replicates(&s.iter().map(|r| r.mean).collect::<Vec<_>>()));
        // Sums of f64 round by ε/2 of the larger mean a few times.
        let rounding = 8.0 * f64::EPSILON * sum_a.mean.abs().max(sum_b.mean.abs());
        let difference = Difference::of(sum_a, sum_b, rounding);
        let (defect, error) = (difference.value.abs() / self.unit, difference.error / self.unit);
        let half = difference.half_width(REJECTION_LEVEL) / self.unit;
        let shift = t_noncentrality(REJECTION_LEVEL, POWER, difference.dof);
        Ok(Evidence {
            method: format!("two means of {} and {} replicates, Welch's t", a.len(), b.len()),
            n: (a.len() + b.len()) as u64,
            statistic: difference.t,
            dof: Some(difference.dof),
            p_value: difference.p_value(),
            estimate: defect,
            interval: [(defect - half).max(0.0), defect + half],
            bound: self.bound,
            resolution: Resolution {
                quantity: "difference of the means",
                value: rounding / self.unit + shift * error,
                power: POWER,
            },
            doubts: estimates.iter().filter_map(Estimate::doubt).collect(),
            pictures: Vec::new(),
        })
    }
}

/// A sum over pixels with the variance of that sum and the degrees of freedom with which the variance is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Sum {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
    /// While pixels are added: the sum of squared variances.
    pub(crate) dof: f64,
}

impl Sum {
    /// The mean over replicates of the whole sum.
    pub(crate) fn over_replicates(replicates: &[f64]) -> Self {
        let moments: Moments = replicates.iter().copied().collect();
        let count = moments.count() as f64;
        Self { mean: moments.mean(), variance: moments.variance() / count, dof: count - 1.0 }
    }

    /// Adds an independent pixel.
    pub(crate) fn add(&mut self, [mean, variance]: [f64; 2]) {
        self.mean += mean;
        self.variance += variance;
        self.dof += variance * variance;
    }

    /// Turns the sum of squared variances into degrees of freedom, ν(Σv)²/Σv² (Satterthwaite 1946, 10.2307/3002019).
    ///
    /// With ν degrees of freedom a pixel, E[v²] = σ⁴(1 + 2/ν), so the result is too small by up to that factor: on the safe side.
    pub(crate) fn finish(&mut self, dof: f64) {
        self.dof = if self.variance > 0.0 { dof * self.variance * self.variance / self.dof } else { dof };
    }

    /// The sum over channels whose dependence is unknown: its standard error is at most the sum of the channels'.
    pub(crate) fn of_dependent(channels: &[Self]) -> Self {
        let error: f64 = channels.iter().map(|sum| sum.variance.sqrt()).sum();
        Self {
            mean: channels.iter().map(|sum| sum.mean).sum(),
            variance: error * error,
            dof: channels.iter().map(|sum| sum.dof).fold(f64::INFINITY, f64::min),
        }
    }
}

/// The difference of two independent sums.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Difference {
    pub(crate) value: f64,
    pub(crate) error: f64,
    pub(crate) dof: f64,
    pub(crate) t: f64,
}

impl Difference {
    /// Welch's difference of two means; a difference of at most `rounding` counts as none.
    ///
    /// # Source
    /// Welch 1947, 10.1093/biomet/34.1-2.28.
    pub(crate) fn of(a: Sum, b: Sum, rounding: f64) -> Self {
        let variance = a.variance + b.variance;
        let dof = if variance > 0.0 {
            variance * variance / (a.variance * a.variance / a.dof + b.variance * b.variance / b.dof)
        } else {
            a.dof.min(b.dof)
        };
        let value = a.mean - b.mean;
        let beyond = (value.abs() - rounding).max(0.0);
        let t = if beyond > 0.0 { (beyond / variance.sqrt()).copysign(value) } else { 0.0 };
        Self { value, error: variance.sqrt(), dof, t }
    }

    /// Two-sided probability of so large a difference between equal means.
    pub(crate) fn p_value(&self) -> f64 {
        2.0 * t_tail(self.t.abs(), self.dof)
    }

    /// The standard normal number with the same tail as t; capped where the tail underflows.
    pub(crate) fn normal_score(&self) -> f64 {
        // The cap is the score of the smallest normal f64: 37.5.
        normal_quantile(t_tail(self.t.abs(), self.dof).max(f64::MIN_POSITIVE))
    }

    /// Half the width of the interval that covers the difference with probability 1 − `level`.
    pub(crate) fn half_width(&self, level: f64) -> f64 {
        t_quantile(0.5 * level, self.dof) * self.error
    }
}

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, StudentsT};

    use super::*;
    use crate::seeds::uniform;

    const RUN: Run = Run { seed: 0, effort: 1 };
    const CLAIM: EqualMeans = EqualMeans { unit: 0.5, replicates: 64, bound: 0.5 };

    fn noisy(width: f64) -> impl Fn(u64) -> f64 {
        move |seed| 0.5 + width * (uniform(seed, 0) - 0.5)
    }

    #[test]
    fn equal_means_of_unequal_noise_are_kept_and_the_control_is_rejected() {
        let evidence = CLAIM.evidence(&RUN, noisy(0.9), noisy(0.1)).unwrap();
        assert!(evidence.p_value > 1e-6 && evidence.is_within_bound(), "{evidence:?}");
        // Nearly all of the error is A's: its degrees of freedom.
        assert!(evidence.dof.is_some_and(|dof| (63.0..67.0).contains(&dof)));
        assert!(CLAIM.control(&RUN, noisy(0.9), noisy(0.1)).unwrap().p_value < 1e-3);
    }

    #[test]
    fn the_control_is_so_many_resolutions_away() {
        // A is larger by 0.2 and seven standard errors of 0.9/√(12·64): the difference keeps its sign.
        let larger = |seed: u64| 0.2 + noisy(0.9)(seed);
        let estimate = |evidence: Evidence| (evidence.estimate, evidence.resolution.value);
        let (right, resolution) = estimate(CLAIM.evidence(&RUN, larger, noisy(0.1)).unwrap());
        let (moved, _) = estimate(CLAIM.control(&RUN, larger, noisy(0.1)).unwrap());
        // A few roundings of numbers near 1.
        assert!(
            ((moved - right) / resolution - CONTROL_FACTOR).abs() < 1e-12,
            "{right} {moved} {resolution}"
        );
    }

    #[test]
    fn interval_and_resolution_are_those_of_welchs_t() {
        let around = |mean: f64, deviation: f64| -> Vec<Replicate> {
            (0..32).map(|i| (mean + if i % 2 == 0 { deviation } else { -deviation }).into()).collect()
        };
        let evidence = CLAIM.judge(&around(0.5, 0.1), &around(0.2, 0.3)).unwrap();
        // Variances of the means: 0.1²·32/31/32 and 0.3²/31, with 31 degrees of freedom each; a unit is 0.5.
        let (defect, error) = (0.3 / 0.5, (0.1f64 / 31.0).sqrt() / 0.5);
        let dof = 31.0 * 0.1f64.powi(2) / (0.01f64.powi(2) + 0.09f64.powi(2));
        let half = error * StudentsT::new(0.0, 1.0, dof).unwrap().inverse_cdf(1.0 - 0.5 * REJECTION_LEVEL);
        let found = [evidence.dof.unwrap(), evidence.estimate, evidence.interval[0], evidence.interval[1]];
        for (found, expected) in found.into_iter().zip([dof, defect, defect - half, defect + half]) {
            assert!((found - expected).abs() < 1e-9 * expected, "{found} is not {expected}"); // inverse_cdf is exact to 1e-10
        }
        let shift = t_noncentrality(REJECTION_LEVEL, POWER, dof);
        assert!((evidence.resolution.value / (shift * error) - 1.0).abs() < 1e-12); // rounding of sums, 1e-15, over 0.3
    }

    #[test]
    fn means_without_variance_are_equal_or_different() {
        assert_eq!(CLAIM.evidence(&RUN, |_| 1.0, |_| 1.0).unwrap().p_value, 1.0);
        assert_eq!(CLAIM.evidence(&RUN, |_| 1.0, |_| 1.0 + 1e-9).unwrap().p_value, 0.0);
    }

    #[test]
    fn what_cannot_be_judged_is_refused() {
        assert!(EqualMeans { replicates: 31, ..CLAIM }.evidence(&RUN, |_| 1.0, |_| 1.0).is_err());
        assert!(EqualMeans { unit: 0.0, ..CLAIM }.evidence(&RUN, |_| 1.0, |_| 1.0).is_err());
        assert!(CLAIM.evidence(&RUN, |_| f64::NAN, |_| 1.0).is_err());
    }
}
