//! A mean against its exact value: Student's t over independent replicates.

use crate::claim::{Evidence, Picture, Resolution, Run};
use crate::error::InputError;
use crate::estimate::{Estimate, Replicate};
use crate::seeds::derive;
use crate::tails::{any_of, positive, shared_level, t_noncentrality, t_quantile, t_tail};
use statrs::distribution::{Beta, ContinuousCDF};

/// Level at which one run rejects "exactly right", and one minus the confidence of the interval.
const LEVEL: f64 = 1e-3;
/// Power for which the resolution is stated.
const POWER: f64 = 0.9;
/// Fewest replicates that a claim on a mean accepts.
pub const FEWEST_REPLICATES: u64 = 32;
/// Factor on the resolution at which the automatic control plants its defect.
///
/// With λ standard errors at the resolution (5.0 for 32 replicates), 2.2·λ is missed only when Z < t − 2.2·λ = −7.
pub const CONTROL_FACTOR: f64 = 2.2;
/// Probability that a replicate which normal theory explains is called an outlier.
const OUTLIER_LEVEL: f64 = 1e-6;
/// The expected number of events of which at most one is seen with probability 0.1 %: e^−λ·(1 + λ) = 1e-3.
const MOST_FOR_ONE: f64 = 9.234;

/// The claim that an estimator's mean is a known value.
///
/// The defect is |m − exact|/unit. Its limits and its test are Student's with R − 1 degrees of freedom; low-discrepancy
/// points inside a replicate are welcome, since the error comes from the replicates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanClaim {
    /// The exact value.
    pub exact: f64,
    /// What the defect is measured in: |exact| for a relative error.
    pub unit: f64,
    /// Number of replicates at effort 1, at least 32.
    pub replicates: u64,
    /// Bound on the defect.
    pub bound: f64,
    /// Bound on the subject's own rounding, in the quantity of the defect: a mean as near as this counts as exact.
    pub rounding: f64,
}

impl MeanClaim {
    /// A claim on the relative error |m/exact − 1|, with 32 replicates in f64 arithmetic.
    #[must_use]
    pub fn relative(exact: f64, bound: f64) -> Self {
        Self::in_units_of(exact.abs(), exact, bound)
    }

    /// A claim on |m − exact|/unit, for exact values that may be zero.
    #[must_use]
    pub fn in_units_of(unit: f64, exact: f64, bound: f64) -> Self {
        // A mean, a difference and a quotient round three times, each by ε/2 of a value near 1; times a margin of 5.
        Self { exact, unit, replicates: FEWEST_REPLICATES, bound, rounding: 8.0 * f64::EPSILON }
    }

    /// Runs the claim on a subject that gives one replicate's mean from a seed.
    ///
    /// # Errors
    /// [`InputError`] for fewer than 32 replicates, a unit or bound that is not above 0, or a mean that is not finite.
    pub fn evidence<R: Into<Replicate>>(
        &self,
        run: &Run,
        subject: impl Fn(u64) -> R,
    ) -> Result<Evidence, InputError> {
        joint_evidence(&[*self], run, |_, seed| subject(seed))
    }

    /// Runs the claim on the subject's values times 1 + 2.2 resolutions: evidence that must reject.
    ///
    /// # Errors
    /// As [`Self::evidence`].
    pub fn control<R: Into<Replicate>>(
        &self,
        run: &Run,
        subject: impl Fn(u64) -> R,
    ) -> Result<Evidence, InputError> {
        joint_control(&[*self], run, |_, seed| subject(seed))
    }
}

/// Runs several claims, such as ten positions of a light, as one; the subject gets the configuration's index and a seed.
///
/// # Errors
/// As [`MeanClaim::evidence`]; also without any claim.
pub fn joint_evidence<R: Into<Replicate>>(
    claims: &[MeanClaim],
    run: &Run,
    subject: impl Fn(usize, u64) -> R,
) -> Result<Evidence, InputError> {
    judge(claims, &draw(claims, run, subject))
}

/// Runs several claims on the subject's values, each moved by 2.2 resolutions: evidence that must reject.
///
/// # Errors
/// As [`joint_evidence`].
pub fn joint_control<R: Into<Replicate>>(
    claims: &[MeanClaim],
    run: &Run,
    subject: impl Fn(usize, u64) -> R,
) -> Result<Evidence, InputError> {
    judge_moved(claims, draw(claims, run, subject))
}

/// Judges replicates that were drawn already, each moved by 2.2 resolutions: evidence that must reject.
///
/// # Errors
/// As [`joint_evidence`].
pub fn judge_moved(claims: &[MeanClaim], mut values: Vec<Vec<Replicate>>) -> Result<Evidence, InputError> {
    let resolution = judge(claims, &values)?.resolution.value;
    for (claim, replicates) in claims.iter().zip(&mut values) {
        for replicate in replicates {
            replicate.mean += CONTROL_FACTOR * resolution * claim.unit;
        }
    }
    judge(claims, &values)
}

fn draw<R: Into<Replicate>>(
    claims: &[MeanClaim],
    run: &Run,
    subject: impl Fn(usize, u64) -> R,
) -> Vec<Vec<Replicate>> {
    let all = |(stream, claim): (usize, &MeanClaim)| {
        let count = claim.replicates * run.effort;
        (0..count).map(|i| subject(stream, derive(run.seed, stream as u64, i)).into()).collect()
    };
    claims.iter().enumerate().map(all).collect()
}

/// What one configuration shows, at its share of the level.
struct Finding {
    t: f64,
    p_value: f64,
    defect: f64,
    half_width: f64,
    resolution: f64,
    dof: f64,
}

/// Judges replicates that were drawn already, one list for each claim, each from its own seeds.
///
/// The m claims have seeds of their own, so their p-values are independent: each is tested, and has its limits, at the level
/// 1 − (1 − 1e-3)^(1/m), and p = 1 − (1 − min p)ᵐ (Šidák). The estimate is the largest defect and the interval's upper end the largest
/// upper limit. The resolution is the defect that is found with
/// power 0.9 when a single claim, the noisiest, has it: rounding + λ·s/(√R·unit), λ from the non-central t. Where all are equally noisy
/// the largest of m estimated errors overstates it by a share of √(ln m/(R − 1)) at most.
///
/// # Errors
/// As [`joint_evidence`].
pub fn judge(claims: &[MeanClaim], values: &[Vec<Replicate>]) -> Result<Evidence, InputError> {
    let needed = claims.len().max(1) as u64;
    if values.len() as u64 != needed || claims.is_empty() {
        return Err(InputError::TooFew { what: "lists of replicates", given: values.len() as u64, needed });
    }
    let mut findings = Vec::with_capacity(claims.len());
    let mut doubts = Vec::new();
    let tests = claims.len() as f64;
    let mut scale = Scale::at(shared_level(tests, LEVEL), FEWEST_REPLICATES);
    for (claim, replicates) in claims.iter().zip(values) {
        if replicates.len() as u64 != scale.replicates {
            scale = Scale::at(scale.level, replicates.len() as u64);
        }
        findings.push(claim.finding(replicates, &scale)?);
        doubts.extend(claim.doubts(replicates));
    }
    let largest = |value: fn(&Finding) -> f64| findings.iter().map(value).fold(0.0, f64::max);
    let worst = findings
        .iter()
        .min_by(|a, b| a.p_value.total_cmp(&b.p_value).then(b.t.total_cmp(&a.t)))
        .ok_or(InputError::TooFew { what: "claims", given: 0, needed: 1 })?;
    let per_claim = values[0].len();
    let method = match claims.len() {
        1 => format!("mean of {per_claim} replicates, Student's t"),
        many => format!("{many} means of {per_claim} replicates, Student's t, Šidák"),
    };
    Ok(Evidence {
        method,
        n: values.iter().map(|replicates| replicates.len() as u64).sum(),
        statistic: worst.t,
        dof: Some(worst.dof),
        p_value: any_of(tests, worst.p_value),
        estimate: largest(|f| f.defect),
        interval: [largest(|f| f.defect - f.half_width), largest(|f| f.defect + f.half_width)],
        bound: claims.iter().map(|claim| claim.bound).fold(f64::INFINITY, f64::min),
        resolution: Resolution {
            quantity: "error of the mean",
            value: largest(|f| f.resolution),
            power: POWER,
        },
        doubts,
        pictures: vec![picture(claims, values)],
    })
}

/// Parts in which the replicates of a single mean are drawn.
const PARTS: usize = 8;

/// The means in order, each with its error and rounding, on the exact values; of a single claim, those of eight parts of its replicates.
fn picture(claims: &[MeanClaim], values: &[Vec<Replicate>]) -> Picture {
    let (what, rows): (_, Vec<(&MeanClaim, &[Replicate])>) = match (claims, values) {
        ([claim], [all]) => (
            "part of the replicates",
            all.chunks(all.len().div_ceil(PARTS)).map(|part| (claim, part)).collect(),
        ),
        _ => ("configuration", claims.iter().zip(values.iter().map(Vec::as_slice)).collect()),
    };
    let number = |i: usize| (i + 1) as f64;
    let point = |(i, (claim, replicates)): (usize, &(&MeanClaim, &[Replicate]))| {
        let estimate = Estimate::of(replicates);
        [number(i), estimate.mean, estimate.standard_error.hypot(claim.rounding * claim.unit)]
    };
    Picture::Curve {
        axes: [what, "mean"],
        exact: rows.iter().enumerate().map(|(i, (claim, _))| [number(i), claim.exact]).collect(),
        measured: rows.iter().enumerate().map(point).collect(),
    }
}

/// Quantiles for one level and number of replicates, in standard errors.
struct Scale {
    level: f64,
    replicates: u64,
    half_width: f64,
    resolution: f64,
}

impl Scale {
    fn at(level: f64, replicates: u64) -> Self {
        let dof = replicates.max(2) as f64 - 1.0;
        let resolution = t_noncentrality(level, POWER, dof);
        Self { level, replicates, half_width: t_quantile(0.5 * level, dof), resolution }
    }
}

impl MeanClaim {
    fn finding(&self, replicates: &[Replicate], scale: &Scale) -> Result<Finding, InputError> {
        positive("unit", self.unit)?;
        positive("bound", self.bound)?;
        let given = replicates.len() as u64;
        if given < FEWEST_REPLICATES {
            return Err(InputError::TooFew { what: "replicates", given, needed: FEWEST_REPLICATES });
        }
        if let Some(i) = replicates.iter().position(|r| !r.mean.is_finite() || r.largest.is_nan()) {
            return Err(InputError::Subject(format!("replicate {i} is {}", replicates[i].mean)));
        }
        let estimate = Estimate::of(replicates);
        let error = estimate.standard_error / self.unit;
        let defect = (estimate.mean - self.exact).abs() / self.unit;
        let beyond = (defect - self.rounding).max(0.0);
        let t = if beyond > 0.0 { beyond / error } else { 0.0 };
        let dof = (given - 1) as f64;
        let half_width = scale.half_width * error;
        let resolution = self.rounding + scale.resolution * error;
        Ok(Finding { t, p_value: 2.0 * t_tail(t, dof), defect, half_width, resolution, dof })
    }

    /// Reasons not to trust Student's t: one sample too heavy, or one replicate too far from the others.
    ///
    /// For normal replicates (x − m)²/Σ(x − m)²·R/(R − 1) has the beta distribution (½, (R − 2)/2) (Thompson 1935,
    /// 10.1214/aoms/1177732567); the largest of R is an outlier at R·P < 1e-6. It matters only where more like it could bring the defect
    /// to the bound: one event in R replicates allows 9.23 at 99.9 % (Poisson).
    fn doubts(&self, replicates: &[Replicate]) -> Vec<String> {
        let estimate = Estimate::of(replicates);
        let mut doubts: Vec<String> = estimate.doubt().into_iter().collect();
        let count = replicates.len() as f64;
        let squares = count * (count - 1.0) * estimate.standard_error.powi(2);
        let farthest = replicates.iter().map(|r| (r.mean - estimate.mean).abs()).fold(0.0, f64::max);
        let share = (farthest * farthest / squares * count / (count - 1.0)).min(1.0);
        let with_more = (estimate.mean - self.exact).abs() + (MOST_FOR_ONE - 1.0) * farthest / count;
        if farthest <= self.rounding * self.unit || with_more <= self.bound * self.unit {
            return doubts;
        }
        if Beta::new(0.5, 0.5 * (count - 2.0)).is_ok_and(|beta| count * beta.sf(share) < OUTLIER_LEVEL) {
            let percent = 100.0 * farthest * farthest / squares;
            doubts.push(format!("one replicate makes up {percent:.0} % of the variance of all"));
        }
        doubts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::uniform;

    const RUN: Run = Run { seed: 0, effort: 1 };

    /// Mean of twelve uniform numbers: exactly ½, close to normal.
    fn dozen(seed: u64) -> f64 {
        (0..12).map(|i| uniform(seed, i)).sum::<f64>() / 12.0
    }

    #[test]
    fn the_truth_is_kept_and_the_control_rejected() {
        let claim = MeanClaim::relative(0.5, 0.3);
        let evidence = claim.evidence(&RUN, dozen).unwrap();
        assert!(evidence.p_value > 1e-6 && evidence.interval[1] < 0.3 && evidence.doubts.is_empty());
        assert!(evidence.interval[0] <= evidence.estimate && evidence.estimate <= evidence.interval[1]);
        assert!(claim.control(&RUN, dozen).unwrap().p_value < 1e-3);
        let harder = claim.evidence(&Run { seed: 0, effort: 16 }, dozen).unwrap();
        assert_eq!((evidence.n, harder.n), (32, 512));
    }

    #[test]
    fn a_mean_without_variance_is_right_or_wrong() {
        let claim = MeanClaim::relative(1.0, 0.002);
        let right = claim.evidence(&RUN, |_| 1.0 + f64::EPSILON).unwrap();
        assert_eq!((right.p_value, right.doubts.len()), (1.0, 0));
        let wrong = claim.evidence(&RUN, |_| 1.0 + 1e-9).unwrap();
        assert_eq!((wrong.p_value, wrong.statistic), (0.0, f64::INFINITY));
        assert_eq!(claim.control(&RUN, |_| 1.0).unwrap().p_value, 0.0);
    }

    #[test]
    fn of_many_configurations_the_worst_decides() {
        let claims = [MeanClaim::relative(0.5, 0.3); 10];
        let right = joint_evidence(&claims, &RUN, |_, seed| dozen(seed)).unwrap();
        let one = 0.2 * 0.5; // 20 %; the standard error of 32 dozens is 0.289/√384/0.5 = 2.9 %
        let wrong = joint_evidence(&claims, &RUN, |k, seed| dozen(seed) + if k == 7 { one } else { 0.0 });
        assert!(right.p_value > 1e-6 && wrong.unwrap().p_value < 1e-3);
        assert!(
            right.resolution.value > MeanClaim::relative(0.5, 0.3).evidence(&RUN, dozen).unwrap().estimate
        );
    }

    #[test]
    fn a_single_mean_is_drawn_in_parts_and_many_in_their_order() {
        let drawn = |claims: &[MeanClaim]| {
            let evidence = joint_evidence(claims, &RUN, |_, seed| dozen(seed)).unwrap();
            match evidence.pictures.as_slice() {
                [Picture::Curve { exact, measured, .. }] => (exact.len(), measured.len()),
                other => panic!("{other:?}"),
            }
        };
        let claim = MeanClaim::relative(0.5, 0.3);
        assert_eq!((drawn(&[claim]), drawn(&[claim; 3])), ((8, 8), (3, 3)));
    }

    #[test]
    fn heavy_tails_raise_a_doubt() {
        let claim = MeanClaim::relative(1.0, 1.0);
        let rare = |seed| if uniform(seed, 0) < 1.0 / 32.0 { 32.0 } else { uniform(seed, 1) };
        let found = (0..50).filter(|&seed| {
            let evidence = claim.evidence(&Run { seed, effort: 1 }, rare).unwrap();
            !evidence.doubts.is_empty()
        });
        // Exactly one of 32 is heavy with probability 0.37; 50 runs show at least 3 but for P < 1e-6.
        assert!(found.count() >= 3);
    }

    #[test]
    fn rare_events_that_are_too_small_for_the_bound_raise_none() {
        // One of 4096 samples in a replicate of 64, as a direction on the horizon that is dropped; ten such would be 7.6e-5.
        let event = 1.0 / 4096.0;
        let claim = MeanClaim::in_units_of(1.0, event / 64.0, 0.002);
        let rare = |seed| if uniform(seed, 0) < 1.0 / 64.0 { event } else { 0.0 };
        let tight = MeanClaim { bound: 3e-5, ..claim };
        let doubts =
            |claim: &MeanClaim, seed| claim.evidence(&Run { seed, effort: 1 }, rare).unwrap().doubts.len();
        assert!((0..50).all(|seed| doubts(&claim, seed) == 0));
        // Exactly one of 32 is rare with probability 0.31: at least 2 of 50 but for P < 1e-6.
        assert!((0..50).filter(|&seed| doubts(&tight, seed) > 0).count() >= 2);
    }

    #[test]
    fn what_cannot_be_judged_is_refused() {
        let claim = MeanClaim::relative(1.0, 0.1);
        assert!(MeanClaim { replicates: 31, ..claim }.evidence(&RUN, |_| 1.0).is_err());
        assert!(MeanClaim::relative(0.0, 0.1).evidence(&RUN, |_| 1.0).is_err());
        assert!(claim.evidence(&RUN, |_| f64::NAN).is_err());
        assert!(joint_evidence(&[], &RUN, |_, _| 1.0).is_err());
    }
}
