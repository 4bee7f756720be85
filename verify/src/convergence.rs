//! The rate of convergence: the slope of ln RMSE against ln N, with its interval, against theory.

use crate::claim::{Evidence, Line, Picture, REJECTION_LEVEL, Resolution, Run};
use crate::error::InputError;
use crate::seeds::derive;
use crate::tails::{normal_quantile, normal_tail, positive};
use statrs::function::gamma::digamma;

/// Power for which the resolution is stated.
const POWER: f64 = 0.9;
/// Fewest replicates at each sample count: below, ln of a chi-square is too skewed for normal limits.
pub const FEWEST_REPLICATES: u64 = 100;

/// The claim that an estimator's error falls with a known power of the sample count.
///
/// At each N the RMSE comes from R replicates' errors against the exact value; the slope is a weighted least-squares fit.
#[derive(Debug, Clone, PartialEq)]
pub struct SlopeClaim {
    /// Name of the line in the picture.
    pub name: String,
    /// Exact value of what is estimated.
    pub exact: f64,
    /// Sample counts, such as powers of four; at least three.
    pub counts: Vec<u64>,
    /// Replicates at each sample count at effort 1, at least 100.
    pub replicates: u64,
    /// Slope that theory predicts, such as −½.
    pub theory: f64,
    /// Bound on |slope − theory|.
    pub bound: f64,
}

/// A root mean square error at one sample count.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rmse {
    count: f64,
    value: f64,
    /// Expected bias and standard error of ln of `value`.
    log_bias: f64,
    log_error: f64,
}

impl SlopeClaim {
    /// Runs the claim on a subject that gives an estimate from a sample count and a replicate's seed.
    ///
    /// # Errors
    /// [`InputError`] for fewer than three sample counts or 100 replicates, a bound that is not above 0, an estimate that is not
    /// finite, and for errors that are all zero, which have no logarithm.
    pub fn evidence(&self, run: &Run, subject: impl Fn(u64, u64) -> f64) -> Result<Evidence, InputError> {
        positive("bound", self.bound)?;
        too_few("sample counts", self.counts.len() as u64, 3)?;
        too_few("replicates", self.replicates, FEWEST_REPLICATES)?;
        let replicates = self.replicates * run.effort;
        let error = |n: u64, i: u64| subject(n, derive(run.seed, n, i)) - self.exact;
        let all = |&n: &u64| Rmse::of(n, &(0..replicates).map(|i| error(n, i)).collect::<Vec<_>>());
        self.judge(&self.counts.iter().map(all).collect::<Result<Vec<_>, _>>()?, replicates)
    }

    /// Runs the claim against a theory that is wrong by 2.2 resolutions of this run: evidence that must reject.
    ///
    /// # Errors
    /// As [`Self::evidence`].
    pub fn control(&self, run: &Run, subject: impl Fn(u64, u64) -> f64) -> Result<Evidence, InputError> {
        let values: Vec<Vec<f64>> = {
            let value = |n: u64, i: u64| subject(n, derive(run.seed, n, i));
            self.counts
                .iter()
                .map(|&n| (0..self.replicates * run.effort).map(|i| value(n, i)).collect())
                .collect()
        };
        let replay = |theory: f64| {
            let one = |(&n, values): (&u64, &Vec<f64>)| {
                Rmse::of(n, &values.iter().map(|value| value - self.exact).collect::<Vec<_>>())
            };
            let points = self.counts.iter().zip(&values).map(one).collect::<Result<Vec<_>, _>>()?;
            Self { theory, ..self.clone() }.judge(&points, self.replicates * run.effort)
        };
        let resolution = replay(self.theory)?.resolution.value;
        replay(self.theory + 2.2 * resolution)
    }

    fn judge(&self, points: &[Rmse], replicates: u64) -> Result<Evidence, InputError> {
        let [slope, error] = weighted_slope(points);
        if !slope.is_finite() {
            return Err(InputError::Parameter {
                name: "slope",
                value: slope,
                accepted: "different sample counts",
            });
        }
        let z = (slope - self.theory) / error;
        let half = normal_quantile(0.5 * REJECTION_LEVEL) * error;
        let defect = (slope - self.theory).abs();
        let shift = normal_quantile(0.5 * REJECTION_LEVEL) + normal_quantile(1.0 - POWER);
        let line = Line {
            name: self.name.clone(),
            points: points.iter().map(|p| [p.count, p.value, p.log_error]).collect(),
            slope: [slope, slope - half, slope + half],
            theory: self.theory,
        };
        Ok(Evidence {
            method: format!("slope of ln RMSE over {} sample counts, {replicates} replicates", points.len()),
            n: replicates * points.len() as u64,
            statistic: z,
            dof: None,
            p_value: 2.0 * normal_tail(z.abs()),
            estimate: defect,
            interval: [(defect - half).max(0.0), defect + half],
            bound: self.bound,
            resolution: Resolution { quantity: "error of the slope", value: shift * error, power: POWER },
            doubts: Vec::new(),
            pictures: vec![Picture::Convergence { lines: vec![line] }],
        })
    }
}

fn too_few(what: &'static str, given: u64, needed: u64) -> Result<(), InputError> {
    if given < needed { Err(InputError::TooFew { what, given, needed }) } else { Ok(()) }
}

impl Rmse {
    /// ln RMSE = ½ ln mean(e²), whose error follows from the spread of the e² themselves.
    ///
    /// Var ln x̄ ≈ v = s²/(R x̄²) for any distribution of the errors; for normal ones v = 2/R, and ln RMSE has the error 1/√(2R). As
    /// a chi-square of 2/v degrees of freedom the logarithm has the bias ψ(1/v) + ln v, which is taken off.
    ///
    /// # Source
    /// Delta method; the moments of ln χ² are Bartlett and Kendall 1946, 10.2307/2983618.
    fn of(count: u64, errors: &[f64]) -> Result<Self, InputError> {
        let moments: crate::estimate::Moments = errors.iter().map(|e| e * e).collect();
        if !(moments.mean() > 0.0 && moments.mean().is_finite()) {
            let (mean, n) = (moments.mean(), count);
            return Err(InputError::Subject(format!("the mean square error at {n} samples is {mean}")));
        }
        let relative = moments.variance() / (errors.len() as f64 * moments.mean().powi(2));
        // Two-point errors ±e have no spread in e²; one part in R is what R replicates can say.
        let relative = relative.max((errors.len() as f64).powi(-2));
        Ok(Self {
            count: count as f64,
            value: moments.mean().sqrt(),
            log_bias: 0.5 * (digamma(1.0 / relative) + relative.ln()),
            log_error: 0.5 * relative.sqrt(),
        })
    }
}

/// Slope and its standard error, from points whose logarithms have known errors.
fn weighted_slope(points: &[Rmse]) -> [f64; 2] {
    let weight = |p: &Rmse| p.log_error.powi(-2);
    let total: f64 = points.iter().map(weight).sum();
    let centre = points.iter().map(|p| weight(p) * p.count.ln()).sum::<f64>() / total;
    let spread: f64 = points.iter().map(|p| weight(p) * (p.count.ln() - centre).powi(2)).sum();
    let log = |p: &Rmse| p.value.ln() - p.log_bias;
    let slope = points.iter().map(|p| weight(p) * (p.count.ln() - centre) * log(p)).sum::<f64>() / spread;
    [slope, spread.recip().sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrands::Integrand;
    use crate::seeds::uniform;

    fn claim(exact: f64, theory: f64) -> SlopeClaim {
        let name = String::from("test");
        SlopeClaim { name, exact, counts: vec![16, 64, 256, 1024], replicates: 200, theory, bound: 0.08 }
    }

    fn random(n: u64, seed: u64) -> f64 {
        let disk = Integrand::named("quarterdisk").unwrap();
        (0..n).map(|i| disk.eval([uniform(seed, 2 * i), uniform(seed, 2 * i + 1)])).sum::<f64>() / n as f64
    }

    #[test]
    fn random_points_converge_with_slope_one_half_and_no_other() {
        let run = Run { seed: 0, effort: 4 };
        let evidence = claim(0.5, -0.5).evidence(&run, random).unwrap();
        assert!(evidence.p_value > 1e-6 && evidence.interval[1] < 0.08, "{evidence:?}");
        // SE(slope) = .32/√(2R) for four N spaced by 4, R = 800.
        let expected = (normal_quantile(5e-4) + normal_quantile(0.1)) * 0.32 / 1600.0_f64.sqrt();
        assert!((evidence.resolution.value / expected - 1.0).abs() < 0.15); // the spread of 800 e², twice: 2·√(2/800)
        assert!(claim(0.5, -0.5).control(&run, random).unwrap().p_value < 1e-3);
        assert!(claim(0.5, -0.75).evidence(&run, random).unwrap().p_value < 1e-3);
    }

    #[test]
    fn an_exact_power_law_is_recovered() {
        let law =
            |n: u64, seed: u64| (n as f64).powf(-1.25) * if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
        let evidence = claim(0.0, -1.25).evidence(&Run { seed: 3, effort: 1 }, law).unwrap();
        assert!(evidence.estimate < 1e-12); // rounding of logarithms of size 10
    }

    #[test]
    fn what_has_no_slope_is_refused() {
        let run = Run { seed: 0, effort: 1 };
        assert!(claim(0.5, -0.5).evidence(&run, |_, _| 0.5).is_err());
        assert!(claim(0.5, -0.5).evidence(&run, |_, _| f64::NAN).is_err());
        let few = SlopeClaim { counts: vec![16, 64], ..claim(0.5, -0.5) };
        assert!(few.evidence(&run, random).is_err());
    }
}
