//! The share of trials at which something goes wrong that should never go wrong.

use crate::claim::{Evidence, Resolution};
use crate::error::InputError;
use crate::power::chi_square_critical;

/// Probability on either side of the 99.9 % limits.
const TAIL: f64 = 1e-3;

/// Power at which the resolution is stated.
const POWER: f64 = 0.9;

/// How many trials without a miss put the upper limit of the share of misses below `bound`.
///
/// No miss in n trials has probability (1 − s)ⁿ ≤ e^(−sn); the limit on s is where that is 1e-3. A tenth more keeps the limit off the bound.
///
/// # Errors
/// `Parameter` if the bound is not in (0, 1).
pub fn trials_for(bound: f64) -> Result<u64, InputError> {
    if !(bound > 0.0 && bound < 1.0) {
        return Err(InputError::Parameter {
            name: "bound",
            value: bound,
            accepted: "a share above 0 and below 1",
        });
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "above 0; saturates beyond 10^18 trials"
    )]
    let trials = (1.1 * -TAIL.ln() / bound).ceil() as u64;
    Ok(trials)
}

/// The evidence of independent trials of which a right subject never misses one: a single miss rejects it.
///
/// The limits of the share are those of a Poisson variable, which contain the binomial ones.
///
/// * `quantity`: what the share is of.
/// * `bound`: share of misses that is tolerated.
///
/// # Errors
/// `TooFew` without a trial; `Parameter` if there are more misses than trials.
///
/// # Source
/// Garwood 1936, "Fiducial limits for the Poisson distribution", doi 10.1093/biomet/28.3-4.437.
pub fn judge(quantity: &'static str, misses: u64, trials: u64, bound: f64) -> Result<Evidence, InputError> {
    if trials == 0 {
        return Err(InputError::TooFew { what: "trials", given: 0, needed: 1 });
    }
    let (k, n) = (misses as f64, trials as f64);
    if misses > trials {
        return Err(InputError::Parameter {
            name: "number of misses",
            value: k,
            accepted: "at most the trials",
        });
    }
    let lower = if misses == 0 { 0.0 } else { 0.5 * chi_square_critical(1.0 - TAIL, 2.0 * k) / n };
    let upper = (0.5 * chi_square_critical(TAIL, 2.0 * k + 2.0) / n).min(1.0);
    Ok(Evidence {
        method: String::from("misses among independent trials"),
        n: trials,
        statistic: k,
        dof: None,
        p_value: if misses == 0 { 1.0 } else { 0.0 },
        estimate: k / n,
        interval: [lower, upper],
        bound,
        resolution: Resolution { quantity, value: -(1.0 - POWER).ln() / n, power: POWER },
        doubts: Vec::new(),
        pictures: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_miss_holds_and_one_miss_rejects() {
        let n = trials_for(1e-4).expect("a share");
        let clean = judge("share", 0, n, 1e-4).expect("runs");
        assert!(clean.is_within_bound() && clean.p_value == 1.0);
        // P(no miss) at the upper limit is 1e-3, to the error of (1 − s)ⁿ = e^(−sn) at s = 6e-5: n·s²/2 = 2e-4 relative.
        let none = (1.0 - clean.interval[1]).powf(n as f64);
        assert!((none / 1e-3 - 1.0).abs() < 1e-3, "{none}");
        let missed = (1.0 - clean.resolution.value).powf(n as f64);
        assert!((missed / 0.1 - 1.0).abs() < 1e-3, "{missed}");
        assert_eq!(judge("share", 1, n, 1e-4).expect("runs").p_value, 0.0);
    }

    #[test]
    fn limits_leave_a_thousandth_on_either_side() {
        let (misses, n) = (10, 1000);
        let [lower, upper] =
            judge("share", misses, n, 0.5).expect("runs").interval.map(|share| share * n as f64);
        let at_most = |count: u64, mean: f64| {
            let next = |term: &mut f64, k: u64| {
                *term *= if k == 0 { 1.0 } else { mean / k as f64 };
                Some(*term)
            };
            (0..=count).scan((-mean).exp(), next).sum::<f64>()
        };
        // Quantiles are found to a relative 1e-10; a tail changes by less than ten times as much.
        assert!((at_most(misses, upper) / TAIL - 1.0).abs() < 1e-9);
        assert!(((1.0 - at_most(misses - 1, lower)) / TAIL - 1.0).abs() < 1e-9);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(judge("share", 0, 0, 0.1).is_err());
        assert!(judge("share", 3, 2, 0.1).is_err());
        assert!(trials_for(f64::NAN).is_err());
    }
}
