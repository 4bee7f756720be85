//! Many pairs of streams judged as one claim, from counts and sums that need no memory of the numbers.

use super::{Correlation, POWER, Table, resolution};
use crate::claim::{Evidence, Picture, REJECTION_LEVEL, Resolution};
use crate::error::InputError;
use crate::tails::positive;

/// Columns and rows of a tally's table.
const GRID: usize = 8;

/// What is kept of the pairs of two streams that have been seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    name: String,
    counts: [u32; GRID * GRID],
    n: u64,
    sums: [f64; 5],
    outside: u64,
}

impl Tally {
    /// Nothing seen yet.
    ///
    /// * `name`: of the two streams, for reports.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), counts: [0; GRID * GRID], n: 0, sums: [0.0; 5], outside: 0 }
    }

    /// Adds one pair; pairs of one tally must be independent of one another.
    #[inline]
    pub fn push(&mut self, [x, y]: [f64; 2]) {
        #[expect(clippy::cast_possible_truncation, reason = "the cell is wanted; saturates, and is checked")]
        let cell = |u: f64| (u * GRID as f64) as usize;
        let inside = |u: f64| (0.0..1.0).contains(&u);
        if !(inside(x) && inside(y)) {
            self.outside += 1;
            return;
        }
        self.counts[cell(y) * GRID + cell(x)] += 1;
        self.n += 1;
        let (x, y) = (x - 0.5, y - 0.5);
        let new = [x, y, x * x, y * y, x * y];
        self.sums.iter_mut().zip(new).for_each(|(sum, term)| *sum += term);
    }

    /// Number of pairs seen.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        self.n
    }

    fn correlation(&self) -> f64 {
        let n = self.n as f64;
        let [x, y, xx, yy, xy] = self.sums;
        let [xx, yy, xy] = [xx - x * x / n, yy - y * y / n, xy - x * y / n];
        if xx > 0.0 && yy > 0.0 { (xy / (xx * yy).sqrt()).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// Judges the independence of several pairs of streams as one claim.
///
/// Each of the m pairs is tested as by [`IndependenceClaim`](super::IndependenceClaim). Correlations and tables of different pairs do not
/// depend on one another even where the pairs share a stream, so p = 1 − (1 − min p)²ᵐ (Šidák). The defect is the largest |r|, with limits
/// at 1 − 1e-3/m for each; the resolution is the |ρ| that is found with power 0.9 in the pair of which the fewest were seen.
/// Margins need not be uniform.
///
/// # Errors
/// [`InputError`] for no tally, fewer than five pairs a cell in one, a number outside [0, 1), or a bound that is not above 0.
///
/// # Source
/// As [`IndependenceClaim::evidence`](super::IndependenceClaim::evidence).
pub fn judge_tallies(tallies: &[Tally], bound: f64) -> Result<Evidence, InputError> {
    positive("bound", bound)?;
    let needed = 5 * (GRID * GRID) as u64;
    let fewest = tallies.iter().map(Tally::pairs).min().unwrap_or(0);
    if fewest < needed {
        return Err(InputError::TooFew { what: "pairs of numbers", given: fewest, needed });
    }
    if let Some(tally) = tallies.iter().find(|tally| tally.outside > 0) {
        let outside = tally.outside as f64;
        return Err(InputError::Parameter {
            name: "number of pairs outside the unit square",
            value: outside,
            accepted: "0",
        });
    }
    let streams = tallies.len() as f64;
    let found: Vec<Finding> = tallies.iter().map(|tally| Finding::of(tally, streams)).collect();
    let largest = |of: fn(&Finding) -> f64| found.iter().map(of).fold(0.0, f64::max);
    let (place, worst) = found
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.p_value.total_cmp(&b.1.p_value))
        .ok_or(InputError::TooFew { what: "pairs of streams", given: 0, needed: 1 })?;
    let table = Table::of_counts(tallies[place].counts.map(f64::from).to_vec(), GRID);
    Ok(Evidence {
        method: format!(
            "independence of {} pairs of streams by tables and correlations; least likely: {}",
            tallies.len(),
            tallies[place].name
        ),
        n: fewest,
        statistic: table.statistic,
        dof: Some(table.dof),
        p_value: worst.p_value,
        estimate: largest(|f| f.correlation),
        interval: [largest(|f| f.interval[0]), largest(|f| f.interval[1])],
        bound,
        resolution: Resolution { quantity: "correlation", value: resolution(streams, fewest), power: POWER },
        doubts: Vec::new(),
        pictures: vec![Picture::Cells {
            shape: [GRID, GRID],
            axes: ["first number", "second number"],
            observed: table.observed,
            expected: table.expected,
        }],
    })
}

/// What one pair shows.
struct Finding {
    p_value: f64,
    correlation: f64,
    interval: [f64; 2],
}

impl Finding {
    /// * `streams`: number of pairs that share the level; the p-value is corrected for them.
    fn of(tally: &Tally, streams: f64) -> Self {
        let table = Table::of_counts(tally.counts.map(f64::from).to_vec(), GRID);
        let correlation = Correlation::of(tally.correlation(), tally.n);
        let interval = correlation.interval(0.5 * REJECTION_LEVEL / streams);
        let p_value = correlation.joined_with(&table, streams);
        Self { p_value, correlation: correlation.r.abs(), interval }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::{derive, uniform};

    const BOUND: f64 = 0.1;

    /// `streams` pairs of independent streams, but for the first, which has the correlation `rho`: its density is
    /// 1 + 3ρ(2x − 1)(2y − 1) (Farlie, Gumbel, Morgenstern), y being with probability |3ρ(2x − 1)| the larger or the smaller of two.
    fn tallies(seed: u64, streams: u64, rho: f64) -> Vec<Tally> {
        let tally = |k: u64| {
            let mut tally = Tally::new(format!("pair {k}"));
            for i in 0..4000 {
                let u = |which: u64| uniform(derive(seed, k, which), i);
                let slope = if k == 0 { 3.0 * rho * (2.0 * u(0) - 1.0) } else { 0.0 };
                let other = if slope > 0.0 { u(1).max(u(3)) } else { u(1).min(u(3)) };
                tally.push([u(0), if u(2) < slope.abs() { other } else { u(1) }]);
            }
            tally
        };
        (0..streams).map(tally).collect()
    }

    #[test]
    fn independent_streams_are_kept_and_twice_the_resolution_is_seen() {
        let right = judge_tallies(&tallies(0, 50, 0.0), 0.2).unwrap();
        assert!(right.p_value > 1e-6 && right.interval[1] < 0.2, "{right:?}");
        let wrong = judge_tallies(&tallies(1, 50, 2.2 * right.resolution.value), BOUND).unwrap();
        assert!(wrong.p_value < 1e-3 && wrong.method.ends_with("pair 0"));
        assert!(wrong.interval[0] <= wrong.estimate && wrong.estimate <= wrong.interval[1]);
    }

    #[test]
    fn the_level_is_kept_and_a_defect_of_the_resolution_is_found() {
        let runs = 600;
        let p = |seed: u64, reused: f64| judge_tallies(&tallies(seed, 3, reused), BOUND).unwrap();
        let below = (0..runs).filter(|&i| p(i, 0.0).p_value < 0.1).count();
        assert!((15..=110).contains(&below), "{below}"); // 60 expected of six tests; a tenth of it and 6 standard deviations of 7.3
        let resolution = p(0, 0.0).resolution.value;
        let found = (0..runs).filter(|&i| p(runs + i, resolution).p_value < 1e-3).count();
        // 0.9 ± 5 standard deviations of a share of 600, 0.012.
        assert!((504..=576).contains(&found), "{found}");
    }

    #[test]
    fn numbers_of_one_corner_are_as_independent_as_those_of_the_square() {
        let mut tally = Tally::new("a corner");
        (0..20_000).for_each(|i| tally.push([0.25 * uniform(0, i), 0.25 * uniform(1, i)]));
        // Six standard errors 1/√n of an r; of means that were not taken off, 3/8 away from ½, it would be 27/28.
        assert!(tally.correlation().abs() < 6.0 / 20_000.0_f64.sqrt(), "{}", tally.correlation());
    }

    #[test]
    fn repeated_numbers_and_their_opposites_are_rejected() {
        let mut same = Tally::new("same");
        let mut opposite = Tally::new("opposite");
        for i in 0..1000 {
            let u = uniform(3, i);
            same.push([u, u]);
            opposite.push([u, 1.0 - u - 1e-12]);
        }
        for tally in [same, opposite] {
            let found = judge_tallies(&[tally], BOUND).unwrap();
            assert!(found.p_value < 1e-9 && found.interval == [1.0; 2]);
        }
    }

    #[test]
    fn what_cannot_be_judged_is_refused() {
        assert!(judge_tallies(&[], BOUND).is_err());
        let mut few = Tally::new("few");
        (0..319).for_each(|i| few.push([uniform(0, i), uniform(1, i)]));
        assert!(judge_tallies(std::slice::from_ref(&few), BOUND).is_err());
        let mut outside = tallies(0, 1, 0.0);
        assert!(judge_tallies(&outside, 0.0).is_err());
        outside[0].push([1.0, 0.5]);
        assert!(judge_tallies(&outside, BOUND).is_err());
    }
}
