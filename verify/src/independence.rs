//! Independence of two streams of numbers: a contingency table and two correlations.

use crate::claim::{Evidence, Picture, REJECTION_LEVEL, Resolution, Run};
use crate::error::InputError;
use crate::power::chi_square_sf;
use crate::tails::{normal_quantile, normal_tail, positive};

mod joint;

pub use joint::{Tally, judge_tallies};

/// Whether a source's draws are independent of one another, as it declares itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Each pair is drawn independently of the others, such as one from each scrambling.
    Independent,
    /// The pairs of one run together form a low-discrepancy set.
    LowDiscrepancy,
}

/// The claim that two numbers in [0, 1), drawn together many times, are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndependenceClaim {
    /// Number of pairs at effort 1; at least five for each cell of the table.
    pub pairs: u64,
    /// Columns and rows of the contingency table, at least 2.
    pub grid: usize,
    /// Bound on the correlation's size.
    pub bound: f64,
    /// What the source declares.
    pub source: Source,
}

/// Number of tests that share the level: table, linear correlation, rank correlation.
const TESTS: f64 = 3.0;
/// Power for which the resolution is stated.
const POWER: f64 = 0.9;

impl IndependenceClaim {
    /// Runs the claim on a subject that gives the pair of an index from a run's seed.
    ///
    /// Three tests share the level, p = min(1, 3·min p): chi-square of a k×k table with (k − 1)² degrees of freedom, its margins taken
    /// from the data; Fisher's z = atanh(r)·√(n − 3) of the linear and of the rank correlation. The defect is the larger |r|, with
    /// Fisher's limits; the resolution is the |ρ| of a monotone dependence that is found with power 0.9.
    ///
    /// # Errors
    /// [`InputError::NotIndependent`] for a source that declares itself low-discrepancy, whose tables are too even to be tested so;
    /// [`InputError`] for too few pairs or cells, or for numbers outside [0, 1).
    ///
    /// # Source
    /// Pearson 1900; Fisher 1921 (z); Fieller, Hartley, Pearson 1957, 10.1093/biomet/44.3-4.470 (variance 1.06/(n − 3) for ranks).
    pub fn evidence(
        &self,
        run: &Run,
        subject: impl Fn(u64, u64) -> [f64; 2],
    ) -> Result<Evidence, InputError> {
        if self.source == Source::LowDiscrepancy {
            return Err(InputError::NotIndependent { test: "independence of two streams" });
        }
        positive("bound", self.bound)?;
        let pairs: Vec<[f64; 2]> = (0..self.pairs * run.effort).map(|i| subject(run.seed, i)).collect();
        self.judge(&pairs)
    }

    /// Judges pairs that were drawn already.
    ///
    /// # Errors
    /// As [`Self::evidence`].
    pub fn judge(&self, pairs: &[[f64; 2]]) -> Result<Evidence, InputError> {
        let given = pairs.len() as u64;
        if self.grid < 2 {
            return Err(InputError::TooFew {
                what: "columns of the table",
                given: self.grid as u64,
                needed: 2,
            });
        }
        let needed = 5 * (self.grid * self.grid) as u64;
        if given < needed {
            return Err(InputError::TooFew { what: "pairs", given, needed });
        }
        if let Some(&value) = pairs.iter().flatten().find(|x| !(0.0..1.0).contains(*x)) {
            return Err(InputError::Parameter { name: "number of a pair", value, accepted: "[0, 1)" });
        }
        let table = Table::of(pairs, self.grid);
        let linear = correlation(pairs.iter().copied());
        let ranks = [ranks(pairs, 0), ranks(pairs, 1)];
        let rank = correlation(ranks[0].iter().zip(&ranks[1]).map(|(&x, &y)| [x, y]));
        let root = (given as f64 - 3.0).sqrt();
        let z = [linear.atanh() * root, rank.atanh() * root / 1.06_f64.sqrt()];
        let z_p = z.map(|z| 2.0 * normal_tail(z.abs()));
        let p_value = (TESTS * table.p_value.min(z_p[0]).min(z_p[1])).min(1.0);
        // Each of the two correlations has half of the level, so that the interval's upper end is above both.
        let half = normal_quantile(0.25 * REJECTION_LEVEL) * 1.06_f64.sqrt() / root;
        let larger = linear.abs().max(rank.abs());
        let limit = |shift: f64| (larger.atanh() + shift).max(0.0).tanh();
        let shift = normal_quantile(0.5 * REJECTION_LEVEL / TESTS) + normal_quantile(1.0 - POWER);
        Ok(Evidence {
            method: format!("independence: {0}×{0} table, linear and rank correlation", self.grid),
            n: given,
            statistic: table.statistic,
            dof: Some(table.dof),
            p_value,
            estimate: larger,
            interval: [limit(-half), limit(half)],
            bound: self.bound,
            resolution: Resolution { quantity: "correlation", value: (shift / root).tanh(), power: POWER },
            doubts: Vec::new(),
            pictures: vec![Picture::Cells {
                shape: [self.grid, self.grid],
                axes: ["first number", "second number"],
                observed: table.observed,
                expected: table.expected,
            }],
        })
    }
}

struct Table {
    observed: Vec<f64>,
    expected: Vec<f64>,
    statistic: f64,
    dof: f64,
    p_value: f64,
}

impl Table {
    fn of(pairs: &[[f64; 2]], k: usize) -> Self {
        let mut observed = vec![0.0; k * k];
        let cell = |x: f64| (0..k).rev().find(|&i| x * k as f64 >= i as f64).unwrap_or(0);
        for [x, y] in pairs {
            observed[cell(*y) * k + cell(*x)] += 1.0;
        }
        Self::of_counts(observed, k)
    }

    fn of_counts(observed: Vec<f64>, k: usize) -> Self {
        let row = |j: usize| observed[j * k..(j + 1) * k].iter().sum::<f64>();
        let column = |i: usize| observed.iter().skip(i).step_by(k).sum::<f64>();
        let [rows, columns] = [(0..k).map(row).collect::<Vec<_>>(), (0..k).map(column).collect::<Vec<_>>()];
        let n: f64 = observed.iter().sum();
        let expected: Vec<f64> = (0..k * k).map(|c| rows[c / k] * columns[c % k] / n).collect();
        // A row or column without any pair says nothing and counts for no degree of freedom.
        let used = |margin: &[f64]| margin.iter().filter(|&&count| count > 0.0).count() as f64 - 1.0;
        let dof = used(&rows) * used(&columns);
        let term = |(o, e): (&f64, &f64)| if *e > 0.0 { (o - e) * (o - e) / e } else { 0.0 };
        let statistic = observed.iter().zip(&expected).map(term).sum();
        let p_value = if dof > 0.0 { chi_square_sf(statistic, dof) } else { 1.0 };
        Self { observed, expected, statistic, dof, p_value }
    }
}

/// Pearson's correlation; 0 where a margin is constant.
fn correlation(pairs: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let n = pairs.clone().count() as f64;
    let sums = pairs.clone().fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    let [mx, my] = sums.map(|sum| sum / n);
    let [xx, yy, xy] = pairs.fold([0.0; 3], |[xx, yy, xy], [x, y]| {
        let (dx, dy) = (x - mx, y - my);
        [xx + dx * dx, yy + dy * dy, xy + dx * dy]
    });
    if xx > 0.0 && yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}

/// Ranks of one coordinate, equal values sharing the middle of theirs.
fn ranks(pairs: &[[f64; 2]], axis: usize) -> Vec<f64> {
    let mut order: Vec<usize> = (0..pairs.len()).collect();
    order.sort_by(|&a, &b| pairs[a][axis].total_cmp(&pairs[b][axis]));
    let mut ranks = vec![0.0; pairs.len()];
    let mut start = 0;
    while start < order.len() {
        let value = pairs[order[start]][axis];
        let ties = order[start..].iter().take_while(|&&i| pairs[i][axis] == value).count();
        order[start..start + ties].iter().for_each(|&i| ranks[i] = start as f64 + 0.5 * (ties - 1) as f64);
        start += ties;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::uniform;

    const RUN: Run = Run { seed: 0, effort: 1 };
    const CLAIM: IndependenceClaim =
        IndependenceClaim { pairs: 20_000, grid: 8, bound: 0.05, source: Source::Independent };

    fn apart(seed: u64, i: u64) -> [f64; 2] {
        [uniform(seed, 2 * i), uniform(seed, 2 * i + 1)]
    }

    #[test]
    fn independent_streams_are_kept() {
        let evidence = CLAIM.evidence(&RUN, apart).unwrap();
        assert!(evidence.p_value > 1e-6 && evidence.interval[1] < 0.05, "{evidence:?}");
        assert_eq!(evidence.dof, Some(49.0));
    }

    #[test]
    fn reused_mirrored_and_merely_dependent_numbers_are_rejected() {
        let wrong: [fn(u64, u64) -> [f64; 2]; 3] = [
            |seed, i| [uniform(seed, i), uniform(seed, i)],
            |seed, i| [uniform(seed, i), 1.0 - uniform(seed, i) * (1.0 - 1e-12)],
            // Uncorrelated, yet the first decides the second up to sign.
            |seed, i| [uniform(seed, i), (2.0 * uniform(seed, i) - 1.0).abs()],
        ];
        for subject in wrong {
            assert!(CLAIM.evidence(&RUN, subject).unwrap().p_value < 1e-9);
        }
    }

    #[test]
    fn a_correlation_of_the_resolution_times_two_is_seen() {
        let rho = 2.2 * CLAIM.evidence(&RUN, apart).unwrap().resolution.value;
        // With probability ρ the second repeats the first: correlation ρ exactly.
        let mixed = |seed: u64, i: u64| {
            let [x, y] = apart(seed, i);
            if uniform(seed ^ 1, i) < rho { [x, x] } else { [x, y] }
        };
        assert!(CLAIM.evidence(&RUN, mixed).unwrap().p_value < 1e-3);
    }

    #[test]
    fn a_low_discrepancy_source_and_too_few_pairs_are_refused() {
        let declared = IndependenceClaim { source: Source::LowDiscrepancy, ..CLAIM };
        let refused = declared.evidence(&RUN, apart);
        assert_eq!(refused, Err(InputError::NotIndependent { test: "independence of two streams" }));
        assert!(IndependenceClaim { pairs: 319, ..CLAIM }.evidence(&RUN, apart).is_err());
        assert!(CLAIM.evidence(&RUN, |_, _| [1.0, 0.0]).is_err());
    }

    #[test]
    fn ties_share_their_ranks() {
        assert_eq!(ranks(&[[0.5, 0.0], [0.1, 0.0], [0.5, 0.0]], 0), [1.5, 0.0, 1.5]);
    }
}
