use std::sync::OnceLock;

use super::tail::{kolmogorov_tail, shifted_tail};
use super::{Fit, anderson_darling, kolmogorov_smirnov};
use crate::claim::{Evidence, REJECTION_LEVEL, Resolution, Run};
use crate::error::InputError;
use crate::independence::Source;
use crate::power::bisect;
use crate::tails::{normal_quantile, positive};

/// Power for which the resolution is stated.
const POWER: f64 = 0.9;

/// Which statistic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// Greatest distance of the distribution functions; sees shifts of the middle.
    KolmogorovSmirnov,
    /// Weighted square distance; sees smooth errors and the tails.
    AndersonDarling,
}

/// Which fits are wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Bad ones.
    Upper,
    /// Bad ones and such as are too good to be independent, as of stratified numbers.
    Both,
}

/// The claim that independent numbers are uniform on [0, 1); others come here through their distribution function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marginal {
    /// The statistic.
    pub statistic: Statistic,
    /// Which fits are wrong.
    pub sides: Sides,
    /// Number of values at effort 1, at least 32.
    pub values: u64,
    /// Bound on the defect.
    pub bound: f64,
    /// What the source declares.
    pub source: Source,
}

impl Marginal {
    /// Runs the claim on a subject that gives the value of a seed and an index.
    ///
    /// The defect of Kolmogorov's statistic is the greatest distance of the distribution functions; its resolution is that of a distance
    /// at the median, where the sample spreads most. The defect of Anderson and Darling's is the density's tilt θ in 1 + θ√3(2u − 1),
    /// the RMS relative error of a density that rises evenly.
    ///
    /// # Errors
    /// [`InputError::NotIndependent`] for a source that declares itself low-discrepancy; [`InputError`] for fewer than 32 values, one
    /// outside [0, 1], or a bound that is not above 0.
    pub fn evidence(&self, run: &Run, subject: impl Fn(u64, u64) -> f64) -> Result<Evidence, InputError> {
        self.source.independent("goodness of fit")?;
        self.judge(&(0..self.values * run.effort).map(|i| subject(run.seed, i)).collect::<Vec<_>>())
    }

    /// Judges values that were drawn already.
    ///
    /// # Errors
    /// As [`Self::evidence`].
    pub fn judge(&self, values: &[f64]) -> Result<Evidence, InputError> {
        const FEWEST: u64 = 32;
        positive("bound", self.bound)?;
        let given = values.len() as u64;
        if given < FEWEST {
            return Err(InputError::TooFew { what: "values", given, needed: FEWEST });
        }
        let (name, fit) = match self.statistic {
            Statistic::KolmogorovSmirnov => ("Kolmogorov–Smirnov", kolmogorov_smirnov(values)?),
            Statistic::AndersonDarling => ("Anderson–Darling", anderson_darling(values)?),
        };
        let [estimate, low, high] = self.defect(values, fit);
        let (quantity, value) = self.resolution(given);
        let sides = match self.sides {
            Sides::Upper => "",
            Sides::Both => ", two-sided",
        };
        Ok(Evidence {
            method: format!("{name}{sides}"),
            n: given,
            statistic: fit.statistic,
            dof: None,
            p_value: match self.sides {
                Sides::Upper => fit.p_value,
                Sides::Both => 2.0 * fit.p_value.min(1.0 - fit.p_value),
            },
            estimate,
            interval: [low.max(0.0), high],
            bound: self.bound,
            resolution: Resolution { quantity, value, power: POWER },
            doubts: Vec::new(),
            pictures: Vec::new(),
        })
    }

    /// The defect and its limits.
    fn defect(&self, values: &[f64], fit: Fit) -> [f64; 3] {
        let n = values.len() as f64;
        match self.statistic {
            Statistic::KolmogorovSmirnov => {
                // |D − sup|F − F₀|| is at most the sample's own distance from F.
                let half = kolmogorov_critical(REJECTION_LEVEL) / finite(n);
                [fit.statistic, fit.statistic - half, fit.statistic + half]
            }
            Statistic::AndersonDarling => {
                let tilt = 3.0_f64.sqrt() * values.iter().map(|u| 2.0 * u - 1.0).sum::<f64>() / n;
                let half = normal_quantile(0.5 * REJECTION_LEVEL) / n.sqrt();
                [tilt.abs(), tilt.abs() - half, tilt.abs() + half]
            }
        }
    }

    /// What is resolved, and how much of it by `n` values.
    fn resolution(&self, n: u64) -> (&'static str, f64) {
        let n = n as f64;
        let level = match self.sides {
            Sides::Upper => REJECTION_LEVEL,
            Sides::Both => 0.5 * REJECTION_LEVEL,
        };
        match self.statistic {
            Statistic::KolmogorovSmirnov => {
                // At the median √n(Fₙ − F) has the standard deviation ½.
                let beyond = 0.5 * normal_quantile(1.0 - POWER) / n.sqrt();
                ("distance of the distribution functions", kolmogorov_critical(level) / finite(n) + beyond)
            }
            Statistic::AndersonDarling => {
                ("tilt of the density", anderson_darling_shift(self.sides) / n.sqrt())
            }
        }
    }
}

/// Stephens' factor of D for n values.
fn finite(n: f64) -> f64 {
    n.sqrt() + 0.12 + 0.11 / n.sqrt()
}

/// The λ that D·√n exceeds with a small probability.
fn kolmogorov_critical(level: f64) -> f64 {
    bisect([0.5, 5.0], |lambda| kolmogorov_tail(lambda) > level)
}

/// The mean of the first component of A² at which it is found with power 0.9.
fn anderson_darling_shift(sides: Sides) -> f64 {
    static SHIFTS: [OnceLock<f64>; 2] = [OnceLock::new(), OnceLock::new()];
    let (place, level) = match sides {
        Sides::Upper => (0, REJECTION_LEVEL),
        Sides::Both => (1, 0.5 * REJECTION_LEVEL),
    };
    *SHIFTS[place].get_or_init(|| {
        let critical = bisect([1.0, 8.0], |z| shifted_tail(z, 0.0) > level);
        bisect([0.0, 6.0], |shift| shifted_tail(critical, shift) < POWER)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::uniform;

    const RUN: Run = Run { seed: 4, effort: 1 };

    fn claim(statistic: Statistic, sides: Sides) -> Marginal {
        Marginal { statistic, sides, values: 2000, bound: 0.15, source: Source::Independent }
    }

    #[test]
    fn the_critical_distance_of_ten_values_is_the_exact_one() {
        // Exact, from Birnbaum's table (1952): P(D₁₀ > 0.48893) = 0.01. Stephens' factor is good to a per cent.
        let critical = kolmogorov_critical(0.01) / finite(10.0);
        assert!((critical / 0.48893 - 1.0).abs() < 0.01, "{critical}");
    }

    #[test]
    fn uniform_numbers_are_kept_and_twice_the_resolution_is_seen() {
        for statistic in [Statistic::KolmogorovSmirnov, Statistic::AndersonDarling] {
            for sides in [Sides::Upper, Sides::Both] {
                let claim = claim(statistic, sides);
                let right = claim.evidence(&RUN, uniform).unwrap();
                assert!(right.p_value > 1e-6 && right.is_within_bound(), "{right:?}");
                let tilt = 2.2
                    * claim.resolution(2000).1
                    * if statistic == Statistic::AndersonDarling { 1.0 } else { 4.0 / 3f64.sqrt() };
                // F = u + θ√3(u² − u), solved for u; its distance from u is θ√3/4.
                let bent = |seed, i| {
                    let (a, v): (f64, f64) = (tilt * 3.0_f64.sqrt(), uniform(seed, i));
                    (((1.0 - a).powi(2) + 4.0 * a * v).sqrt() - (1.0 - a)) / (2.0 * a)
                };
                assert!(claim.evidence(&RUN, bent).unwrap().p_value < 1e-3);
            }
        }
    }

    #[test]
    fn a_fit_that_is_too_good_is_wrong_on_both_sides_only() {
        let even = |_: u64, i: u64| (i as f64 + 0.5) / 2000.0;
        for statistic in [Statistic::KolmogorovSmirnov, Statistic::AndersonDarling] {
            assert!(claim(statistic, Sides::Upper).evidence(&RUN, even).unwrap().p_value > 0.99);
            assert!(claim(statistic, Sides::Both).evidence(&RUN, even).unwrap().p_value < 1e-6);
        }
    }

    #[test]
    fn what_cannot_be_judged_is_refused() {
        let claim = claim(Statistic::KolmogorovSmirnov, Sides::Upper);
        let declared = Marginal { source: Source::LowDiscrepancy, ..claim };
        assert!(matches!(declared.evidence(&RUN, uniform), Err(InputError::NotIndependent { .. })));
        assert!(Marginal { values: 31, ..claim }.evidence(&RUN, uniform).is_err());
        assert!(claim.evidence(&RUN, |_, _| 1.5).is_err());
    }
}
