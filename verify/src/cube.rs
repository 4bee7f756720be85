//! Points of a d-dimensional cube through their projections on each axis and each pair of axes.
//!
//! Counts of uniform points on a 16 × 16 grid split into three parts that say nothing of one another: the columns, the rows, and the
//! interaction that is left. So the axes and the pairs of axes are tested once each, d + d(d − 1)/2 tests in all, and their p-values
//! are joined exactly (Šidák). An error of three axes together that no pair shows is not seen.

use crate::claim::{Evidence, Picture, REJECTION_LEVEL, Resolution, Run};
use crate::error::InputError;
use crate::independence::Source;
use crate::power::{chi_square_critical, chi_square_sf, lambda_lower, lambda_upper};
use crate::tails::{any_of, shared_level};

/// Columns and rows of a projection.
const GRID: usize = 16;
/// Cells of a projection.
const CELLS: usize = GRID * GRID;
/// Power at which the resolution is stated.
const POWER: f64 = 0.9;
/// Probability that right points stay undecided.
const UNDECIDED: f64 = 1e-6;
/// Expected count of a cell, below which the chi-square approximation is not trusted.
const FEWEST_IN_CELL: usize = 5;
/// Largest number of dimensions: 2,016 pairs.
pub const MOST_DIMENSIONS: usize = 64;

/// Counts of points of the cube [0, 1)ᵈ on every pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    dimensions: usize,
    /// One table a pair (i, j), i < j: the column is the place on axis i, the row that on axis j.
    tables: Vec<[u64; CELLS]>,
    n: u64,
    outside: u64,
}

/// One projection's statistics.
struct Finding {
    axes: [usize; 2],
    /// Smallest p of its parts.
    p_value: f64,
    /// Statistic of all its cells.
    statistic: f64,
}

impl Cube {
    /// Nothing counted yet.
    ///
    /// # Errors
    /// `Parameter` for fewer than 2 or more than 64 dimensions.
    pub fn new(dimensions: usize) -> Result<Self, InputError> {
        if !(2..=MOST_DIMENSIONS).contains(&dimensions) {
            let value = dimensions as f64;
            return Err(InputError::Parameter { name: "dimensions of a cube", value, accepted: "2 to 64" });
        }
        let pairs = dimensions * (dimensions - 1) / 2;
        Ok(Self { dimensions, tables: vec![[0; CELLS]; pairs], n: 0, outside: 0 })
    }

    /// Counts a point; one with a coordinate outside [0, 1) is counted as outside.
    ///
    /// * `point`: one coordinate a dimension.
    ///
    /// # Panics
    /// In debug builds, for a point of other dimensions.
    pub fn add(&mut self, point: &[f64]) {
        debug_assert_eq!(point.len(), self.dimensions, "a point has one coordinate a dimension");
        self.n += 1;
        if !point.iter().all(|x| (0.0..1.0).contains(x)) {
            self.outside += 1;
            return;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a power of two times a number in [0, 1) is below it"
        )]
        let cell = |x: f64| (x * GRID as f64) as usize;
        let mut tables = self.tables.iter_mut();
        for (i, &x) in point.iter().enumerate() {
            let column = cell(x);
            for (table, &y) in tables.by_ref().take(point.len() - 1 - i).zip(&point[i + 1..]) {
                table[cell(y) * GRID + column] += 1;
            }
        }
    }

    /// Number of tests: one an axis and one a pair of axes.
    fn tests(&self) -> f64 {
        (self.dimensions + self.tables.len()) as f64
    }

    /// The level of one test, so that all together have `level` (Šidák).
    fn share(&self, level: f64) -> f64 {
        shared_level(self.tests(), level)
    }

    /// How many points a bound takes: so many that right ones are undecided with probability 1e-6.
    ///
    /// * `bound`: RMS relative error over the 256 cells of a projection, in (0, 1).
    ///
    /// # Errors
    /// `Parameter` for another bound.
    pub fn sample_count(&self, bound: f64) -> Result<u64, InputError> {
        if !(bound > 0.0 && bound < 1.0) {
            let (name, accepted) = ("bound on the RMS relative error", "0 to 1, exclusive");
            return Err(InputError::Parameter { name, value: bound, accepted });
        }
        let dof = CELLS as f64 - 1.0;
        let worst = chi_square_critical(UNDECIDED / self.tables.len() as f64, dof);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive; saturates for bounds below 1e-8"
        )]
        let n = (lambda_upper(worst, dof, REJECTION_LEVEL) / (bound * bound)).ceil() as u64;
        Ok(n.max((FEWEST_IN_CELL * CELLS) as u64))
    }

    /// Draws points and tests them.
    ///
    /// * `source`: what the sampler declares; `sampler`: fills the point of a seed and an index.
    ///
    /// # Errors
    /// `NotIndependent` for a source that declares itself low-discrepancy; else as [`judge`](Self::judge).
    pub fn evidence(
        dimensions: usize,
        bound: f64,
        source: Source,
        run: &Run,
        sampler: impl Fn(u64, u64, &mut [f64]),
    ) -> Result<Evidence, InputError> {
        source.independent("uniformity of a cube's projections")?;
        let mut cube = Self::new(dimensions)?;
        let mut point = vec![0.0; dimensions];
        for index in 0..cube.sample_count(bound)? * run.effort {
            sampler(run.seed, index, &mut point);
            cube.add(&point);
        }
        cube.judge(bound)
    }

    /// Tests the counts of independent points.
    ///
    /// The defect is the RMS relative error over the cells of the worst projection; the resolution is that of an interaction, which
    /// spreads over the most degrees of freedom and is the hardest to see.
    ///
    /// # Errors
    /// `TooFew` below five points a cell.
    pub fn judge(&self, bound: f64) -> Result<Evidence, InputError> {
        let needed = (FEWEST_IN_CELL * CELLS) as u64;
        if self.n < needed {
            return Err(InputError::TooFew { what: "points", given: self.n, needed });
        }
        let (n, dof) = (self.n as f64, CELLS as f64 - 1.0);
        let findings = self.findings();
        let least = |a: &&Finding, b: &&Finding| a.p_value.total_cmp(&b.p_value);
        let worst = findings.iter().min_by(least).expect("a cube has at least one pair of axes");
        let largest = findings.iter().map(|f| f.statistic).fold(0.0, f64::max);
        let joint = any_of(self.tests(), worst.p_value);
        let limit = |lambda: f64| (lambda / n).sqrt();
        let low = lambda_lower(largest, dof, REJECTION_LEVEL / self.tables.len() as f64);
        let table = &self.tables[self.table_of(worst.axes)];
        let [x, y] = worst.axes;
        let outside = (self.outside > 0).then(|| format!("{} points are outside the cube", self.outside));
        Ok(Evidence {
            method: format!(
                "uniformity of {} axes and {} pairs of axes; least likely: axes {x} and {y}, p {:.2e}",
                self.dimensions,
                self.tables.len(),
                worst.p_value
            ),
            n: self.n,
            statistic: worst.statistic,
            dof: Some(dof),
            p_value: if self.outside > 0 { 0.0 } else { joint },
            estimate: limit((largest - dof).max(0.0)),
            interval: [limit(low), limit(lambda_upper(largest, dof, REJECTION_LEVEL))],
            bound,
            resolution: Resolution {
                quantity: "RMS relative error over the cells of a projection",
                value: self.resolution(self.n),
                power: POWER,
            },
            doubts: outside.into_iter().collect(),
            pictures: vec![Picture::Cells {
                shape: [GRID, GRID],
                axes: ["first axis", "second axis"],
                observed: table.iter().map(|&count| count as f64).collect(),
                expected: vec![n / CELLS as f64; CELLS],
            }],
        })
    }

    /// The smallest RMS relative error of an interaction that counts of `n` points show with power 0.9.
    pub fn resolution(&self, n: u64) -> f64 {
        let dof = ((GRID - 1) * (GRID - 1)) as f64;
        let critical = chi_square_critical(self.share(REJECTION_LEVEL), dof);
        (lambda_lower(critical, dof, POWER) / n as f64).sqrt()
    }

    fn table_of(&self, [i, j]: [usize; 2]) -> usize {
        i * self.dimensions - i * (i + 1) / 2 + j - i - 1
    }

    fn findings(&self) -> Vec<Finding> {
        self.pairs().zip(&self.tables).map(|(axes, table)| Finding::of(axes, table)).collect()
    }

    /// Pairs of axes in the order of the tables.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let dimensions = self.dimensions;
        (0..dimensions).flat_map(move |i| (i + 1..dimensions).map(move |j| [i, j]))
    }
}

impl Finding {
    fn of(axes: [usize; 2], table: &[u64; CELLS]) -> Self {
        let n = table.iter().sum::<u64>() as f64;
        let statistic = pearson(table.iter().map(|&o| o as f64), n / CELLS as f64);
        let column = |x: usize| table.iter().skip(x).step_by(GRID).sum::<u64>() as f64;
        let row = |y: usize| table[y * GRID..(y + 1) * GRID].iter().sum::<u64>() as f64;
        let margin = n / GRID as f64;
        let margins = [pearson((0..GRID).map(column), margin), pearson((0..GRID).map(row), margin)];
        let side = GRID as f64 - 1.0;
        let interaction = (statistic - margins[0] - margins[1]).max(0.0);
        let p_value = margins.map(|margin| chi_square_sf(margin, side)).into_iter().fold(1.0, f64::min);
        Self { axes, p_value: p_value.min(chi_square_sf(interaction, side * side)), statistic }
    }
}

/// Σ (o − e)²/e for equal expectations.
fn pearson(observed: impl Iterator<Item = f64>, expected: f64) -> f64 {
    observed.map(|o| (o - expected) * (o - expected) / expected).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::fill;

    const RUN: Run = Run { seed: 3, effort: 1 };

    fn evidence(dimensions: usize, sampler: impl Fn(u64, u64, &mut [f64])) -> Evidence {
        Cube::evidence(dimensions, 0.1, Source::Independent, &RUN, sampler).expect("runs")
    }

    #[test]
    fn uniform_points_are_kept_in_any_dimension() {
        for dimensions in [2, 3, 7] {
            let found = evidence(dimensions, fill);
            assert!(found.p_value > 1e-6 && found.is_within_bound(), "{found:?}");
        }
    }

    #[test]
    fn a_reused_axis_a_bent_axis_and_an_interaction_are_rejected_and_named() {
        let reused = evidence(5, |seed, i, p| {
            fill(seed, i, p);
            p[4] = p[1];
        });
        assert!(reused.p_value < 1e-9 && reused.method.contains("axes 1 and 4"), "{}", reused.method);
        let bent = evidence(5, |seed, i, p| {
            fill(seed, i, p);
            p[3] = p[3].powf(1.1);
        });
        assert!(bent.p_value < 1e-9 && bent.method.contains('3'));
        // Both margins uniform: a half turn of the second axis for one half of the first.
        let interaction = evidence(3, |seed, i, p| {
            fill(seed, i, p);
            p[2] = 0.5 * p[2] + if p[0] < 0.5 { 0.0 } else { 0.5 };
        });
        assert!(interaction.p_value < 1e-9 && interaction.method.contains("axes 0 and 2"));
    }

    #[test]
    fn points_outside_too_few_and_low_discrepancy_are_answered() {
        let out = evidence(2, |seed, i, p| {
            fill(seed, i, p);
            if i == 7 {
                p[0] = 1.0;
            }
        });
        assert!(out.p_value == 0.0 && out.doubts[0].contains("1 points"));
        assert!(Cube::new(1).is_err() && Cube::new(65).is_err());
        let mut few = Cube::new(2).expect("two dimensions");
        (0..1279).for_each(|_| few.add(&[0.5, 0.5]));
        assert!(matches!(few.judge(0.1), Err(InputError::TooFew { given: 1279, needed: 1280, .. })));
        let refused = Cube::evidence(2, 0.1, Source::LowDiscrepancy, &RUN, fill);
        assert!(matches!(refused, Err(InputError::NotIndependent { .. })));
    }

    #[test]
    fn tables_are_found_by_their_axes() {
        let cube = Cube::new(5).expect("five dimensions");
        let places: Vec<usize> = cube.pairs().map(|axes| cube.table_of(axes)).collect();
        assert_eq!(places, (0..10).collect::<Vec<_>>());
    }
}
