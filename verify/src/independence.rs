//! Independence of two streams of numbers: their correlation, and what else a contingency table shows.

use crate::claim::{Evidence, Picture, REJECTION_LEVEL, Resolution, Run};
use crate::error::InputError;
use crate::power::chi_square_sf;
use crate::tails::{any_of, normal_quantile, normal_tail, positive, shared_level};

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

impl Source {
    /// Lets independent draws through.
    ///
    /// * `test`: name of the test that assumes them.
    ///
    /// # Errors
    /// [`InputError::NotIndependent`] for a low-discrepancy source.
    pub fn independent(self, test: &'static str) -> Result<(), InputError> {
        match self {
            Self::Independent => Ok(()),
            Self::LowDiscrepancy => Err(InputError::NotIndependent { test }),
        }
    }
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

/// Number of tests that share the level: the correlation, and the rest of the table.
const TESTS: f64 = 2.0;
/// Power for which the resolution is stated.
const POWER: f64 = 0.9;

impl IndependenceClaim {
    /// Runs the claim on a subject that gives the pair of an index from a run's seed.
    ///
    /// Two tests share the level: Fisher's z = atanh(r)·√(n − 3) of the correlation r; and a k×k table, its margins taken from the
    /// data, without the part of its statistic that a correlation of columns and rows makes, with (k − 1)² − 1 degrees of freedom. The
    /// two are independent for independent streams, so p = 1 − (1 − min p)² (Šidák). The defect is |r|, with Fisher's limits; the
    /// resolution is the |ρ| that is found with power 0.9.
    ///
    /// # Errors
    /// [`InputError::NotIndependent`] for a source that declares itself low-discrepancy, whose tables are too even to be tested so;
    /// [`InputError`] for too few pairs or cells, or for numbers outside [0, 1).
    ///
    /// # Source
    /// Pearson 1900; Fisher 1921 (z); the parts of a table's statistic: Mantel 1963, 10.1080/01621459.1963.10500879.
    pub fn evidence(
        &self,
        run: &Run,
        subject: impl Fn(u64, u64) -> [f64; 2],
    ) -> Result<Evidence, InputError> {
        self.source.independent("independence of two streams")?;
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
        let correlation = Correlation::of(correlation(pairs.iter().copied()), given);
        let p_value = correlation.joined_with(&table, 1.0);
        Ok(Evidence {
            method: format!("independence: correlation, and the rest of a {0}×{0} table", self.grid),
            n: given,
            statistic: table.statistic,
            dof: Some(table.dof),
            p_value,
            estimate: correlation.r.abs(),
            interval: correlation.interval(0.5 * REJECTION_LEVEL),
            bound: self.bound,
            resolution: Resolution { quantity: "correlation", value: resolution(1.0, given), power: POWER },
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

/// The |ρ| that the correlation of `n` pairs shows with power 0.9, in one of `streams` pairs of streams.
fn resolution(streams: f64, n: u64) -> f64 {
    let level = shared_level(TESTS * streams, REJECTION_LEVEL);
    let shift = normal_quantile(0.5 * level) + normal_quantile(1.0 - POWER);
    (shift / (n as f64 - 3.0).sqrt()).tanh()
}

/// A correlation with Fisher's error.
#[derive(Clone, Copy)]
struct Correlation {
    r: f64,
    root: f64,
}

impl Correlation {
    fn of(r: f64, n: u64) -> Self {
        Self { r, root: (n as f64 - 3.0).sqrt() }
    }

    fn p_value(self) -> f64 {
        2.0 * normal_tail((self.r.atanh() * self.root).abs())
    }

    /// The p-value of this and the rest of the table, in one of `streams` pairs of streams (Šidák).
    fn joined_with(self, table: &Table, streams: f64) -> f64 {
        any_of(TESTS * streams, self.p_value().min(table.p_value))
    }

    /// Limits of |ρ|, each missed with probability `tail`.
    fn interval(self, tail: f64) -> [f64; 2] {
        let half = normal_quantile(tail) / self.root;
        [-half, half].map(|shift| (self.r.abs().atanh() + shift).max(0.0).tanh())
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
        let dof = used(&rows) * used(&columns) - 1.0;
        let term = |(o, e): (&f64, &f64)| if *e > 0.0 { (o - e) * (o - e) / e } else { 0.0 };
        let whole: f64 = observed.iter().zip(&expected).map(term).sum();
        let statistic = (whole - linear_part(&observed, &rows, &columns)).max(0.0);
        let p_value = if dof > 0.0 { chi_square_sf(statistic, dof) } else { 1.0 };
        Self { observed, expected, statistic, dof, p_value }
    }
}

/// The part of a table's statistic that the correlation r of its columns' and rows' numbers makes: n·r².
fn linear_part(observed: &[f64], rows: &[f64], columns: &[f64]) -> f64 {
    let n: f64 = rows.iter().sum();
    let moments = |margin: &[f64]| {
        let mean = margin.iter().enumerate().map(|(i, count)| i as f64 * count).sum::<f64>() / n;
        let square = |(i, count): (usize, &f64)| (i as f64 - mean).powi(2) * count;
        (mean, margin.iter().enumerate().map(square).sum::<f64>())
    };
    let ((x, xx), (y, yy)) = (moments(columns), moments(rows));
    let k = columns.len();
    let product = |(c, count): (usize, &f64)| ((c % k) as f64 - x) * ((c / k) as f64 - y) * count;
    let xy: f64 = observed.iter().enumerate().map(product).sum();
    if xx > 0.0 && yy > 0.0 { n * xy * xy / (xx * yy) } else { 0.0 }
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
        assert_eq!(evidence.dof, Some(48.0));
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
    fn the_rest_of_a_table_has_no_part_of_the_correlation() {
        // Points on the diagonal of 3×3: X² = 2n, of which n is the correlation's.
        let diagonal = Table::of_counts(vec![10.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 10.0], 3);
        assert!((diagonal.statistic - 30.0).abs() < 1e-12 && diagonal.dof == 3.0); // sums of whole numbers, and a quotient
        let saddle = Table::of_counts(vec![15.0, 10.0, 10.0, 15.0], 2);
        assert!(saddle.statistic < 1e-12); // 2×2 has nothing but its correlation
    }
}
