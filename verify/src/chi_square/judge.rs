//! From counts and expectations to evidence: how many samples, which p, which limits, what could have been
//! seen.

use super::contrasts::{self, CONTRASTS, Split, split};
use super::expected::Expected;
use super::pearson::{Cell, Pearson, count_p_value, pearson, pearson_within, pool};
use crate::claim::{Evidence, Picture, REJECTION_LEVEL, Resolution};
use crate::error::InputError;
use crate::goodness::Fit;
use crate::histogram::{Histogram, coarsen};
use crate::power::{chi_square_critical, lambda_lower, lambda_upper, noncentral_cdf};
use crate::tails::{any, shared_level};

/// Probability that a right sampler stays undecided.
const UNDECIDED: f64 = 1e-6;

/// Power at which the resolution is stated.
const POWER: f64 = 0.9;

/// Samples below which there is nothing to pool into two cells.
const FEWEST_SAMPLES: u64 = 10;

/// Share of the statistic's own spread, √(2k), that the quadrature's errors may add.
const QUADRATURE_SHARE: f64 = 0.1;

/// The number of samples with which a right sampler's upper limit is below the bound but once in 10⁶.
///
/// λ* is the non-centrality that leaves a statistic of at most the central 1e-6 point with probability 1e-3;
/// n = λ*/bound².
pub(super) fn sample_count(expected: &Expected, bound: f64) -> Result<u64, InputError> {
    if !(bound > 0.0 && bound < 1.0) {
        return Err(InputError::Parameter {
            name: "bound on the RMS relative error",
            value: bound,
            accepted: "0 to 1, exclusive",
        });
    }
    let dof = degrees_of_freedom(expected);
    let lambda = lambda_upper(chi_square_critical(UNDECIDED, dof), dof, REJECTION_LEVEL);
    let n = (lambda / (bound * bound)).ceil();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive; `as` saturates for bounds below 1e-8"
    )]
    let n = n as u64;
    Ok(n)
}

/// The three independent tests of a sampler's counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Low-order contrasts of the coarse grid's counts: smooth errors.
    pub contrasts: Fit,
    /// What is left of the coarse grid's statistic.
    pub rest: Fit,
    /// Counts of the fine grid inside each coarse cell: narrow errors.
    pub within: Fit,
}

/// Number of tests of a sampler's cells; each discarded or atomic count is one more.
const CELL_TESTS: usize = 3;

/// The RMS relative error that n samples show with power 0.9 on the coarse grid, if no contrast has a part of it.
pub(super) fn resolution(expected: &Expected, n: u64) -> f64 {
    let Split { rest, contrasts, .. } = split(coarse_cells(expected, None, n as f64));
    least_seen(expected, if rest.dof > 0.0 { rest } else { contrasts }, n)
}

/// The same if all of it lies in the low-order contrasts.
pub(super) fn smooth_resolution(expected: &Expected, n: u64) -> f64 {
    least_seen(expected, split(coarse_cells(expected, None, n as f64)).contrasts, n)
}

/// The RMS relative error that one of the tests shows with power 0.9 at its share of the level.
fn least_seen(expected: &Expected, test: Pearson, n: u64) -> f64 {
    let tests = CELL_TESTS + special(expected, None).len();
    let level = shared_level(tests as f64, REJECTION_LEVEL);
    let dof = test.dof.max(1.0);
    (lambda_lower(chi_square_critical(level, dof), dof, POWER) / n as f64).sqrt()
}

fn degrees_of_freedom(expected: &Expected) -> f64 {
    (expected.coarse.possible_cells() + special(expected, None).len()) as f64 - 1.0
}

/// The cells of the coarse grid, with expectations that sum to `n`; without a histogram as if nothing had been observed.
fn coarse_cells(expected: &Expected, histogram: Option<&Histogram>, n: f64) -> Vec<Cell<CONTRASTS>> {
    let [columns, rows] = expected.coarse.shape;
    let counts = histogram.map(|histogram| coarse_counts(expected, histogram));
    let observed = |i: usize| counts.as_ref().map_or(0.0, |counts| counts[i] as f64);
    let middle = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
    let cell = |(i, p): (usize, &f64)| {
        let place = [middle(i % columns, columns), middle(i / columns, rows)];
        Cell::new(observed(i), n * p / expected.mass, contrasts::at(place))
    };
    expected.coarse.probabilities.iter().enumerate().map(cell).collect()
}

/// Pearson's statistic of the coarse grid, the discarded samples and the atoms together: what the limits rest on.
fn whole(expected: &Expected, histogram: &Histogram) -> Pearson {
    let n = histogram.total() as f64;
    let beside = special(expected, Some(histogram)).into_iter();
    let beside =
        beside.map(|special| Cell::new(special.count as f64, n * special.probability, [0.0; CONTRASTS]));
    let cells = pool(coarse_cells(expected, Some(histogram), n * expected.mass).into_iter().chain(beside));
    Pearson::of(pearson(&cells), cells.len() as f64 - 1.0)
}

/// Samples in no cell that are held against a probability of their own.
struct Special {
    what: String,
    count: u64,
    probability: f64,
    /// By how much the probability may be off.
    error: f64,
}

/// The discarded samples, where there should be or are any, and the atoms.
fn special(expected: &Expected, histogram: Option<&Histogram>) -> Vec<Special> {
    let discarded = histogram.map_or(0, Histogram::discarded);
    let counts = histogram.map_or(&[][..], Histogram::atoms);
    let atom = |(k, p): (usize, &f64)| Special {
        what: format!("at atom {k}"),
        count: counts.get(k).copied().unwrap_or(0),
        probability: *p,
        error: 0.0,
    };
    let none = discarded == 0 && expected.discarded() == 0.0;
    let first = Special {
        what: String::from("discarded"),
        count: discarded,
        probability: expected.discarded(),
        error: expected.mass_error,
    };
    (!none).then_some(first).into_iter().chain(expected.atoms.iter().enumerate().map(atom)).collect()
}

impl Special {
    fn p_value(&self, n: u64) -> f64 {
        let [low, high] =
            [self.probability - self.error, self.probability + self.error].map(|p| p.clamp(0.0, 1.0));
        count_p_value(self.count, n, low, high)
    }
}

/// The cells of the coarse grid, given the number of points in them, and those of the fine grid, given the coarse cells' counts.
fn cell_tests(expected: &Expected, histogram: &Histogram) -> (Split, Pearson) {
    let n = histogram.counts().iter().sum::<u64>() as f64;
    (split(coarse_cells(expected, Some(histogram), n)), pearson_within(blocks(expected, histogram, n)))
}

/// The three tests of a histogram.
pub(super) fn parts(expected: &Expected, histogram: &Histogram) -> Parts {
    let (coarse, within) = cell_tests(expected, histogram);
    let fit = |test: Pearson| Fit { statistic: test.statistic, p_value: test.p_value };
    Parts { contrasts: fit(coarse.contrasts), rest: fit(coarse.rest), within: fit(within) }
}

/// Tests counts against expectations.
///
/// Points outside the domain and a density that integrates to more than 1 are wrong whatever the statistics
/// say: p = 0. Points in cells of probability 0 must be as few as rounding and the quadrature's error allow.
pub(super) fn judge(
    expected: &Expected,
    histogram: &Histogram,
    bound: f64,
    domain: &str,
    axes: [&'static str; 2],
) -> Result<Evidence, InputError> {
    let total = histogram.total();
    if total < FEWEST_SAMPLES {
        return Err(InputError::TooFew { what: "samples", given: total, needed: FEWEST_SAMPLES });
    }
    let n = total as f64;
    let whole = whole(expected, histogram);
    let (coarse, within) = cell_tests(expected, histogram);
    let special: Vec<(Special, f64)> = special(expected, Some(histogram))
        .into_iter()
        .map(|special| {
            let p_value = special.p_value(total);
            (special, p_value)
        })
        .collect();
    let mut p_values = vec![coarse.contrasts.p_value, coarse.rest.p_value, within.p_value];
    p_values.extend(special.iter().map(|(_, p)| *p));
    let stray = stray_points(expected, histogram);
    let p_value = match any(&p_values) {
        _ if histogram.outside() > 0 || expected.exceeds_one() => 0.0,
        // Half of the level each, where rounding brought points into cells of density 0.
        p if stray > 0 => 1f64.min(2.0 * p.min(count_p_value(stray, total, 0.0, expected.mass_error))),
        p => p,
    };
    let limit = |lambda: f64| (lambda / n).sqrt();
    let observed = coarse_counts(expected, histogram);
    let (observed, expectations) = expected.coarse.cells(&observed, n).into_iter().unzip();
    let shape = expected.coarse.shape;
    Ok(Evidence {
        method: method(domain, &coarse, within, &special) + &strays(histogram, stray),
        n: total,
        statistic: whole.statistic,
        dof: Some(whole.dof),
        p_value,
        estimate: limit((whole.statistic - whole.dof).max(0.0)),
        interval: [lambda_lower, lambda_upper]
            .map(|lambda| limit(lambda(whole.statistic, whole.dof, REJECTION_LEVEL))),
        bound,
        resolution: Resolution {
            quantity: "RMS relative error over cells",
            value: resolution(expected, total),
            power: POWER,
        },
        doubts: doubts(expected, [whole, within], histogram),
        pictures: vec![Picture::Cells { shape, axes, observed, expected: expectations }],
    })
}

fn coarse_counts(expected: &Expected, histogram: &Histogram) -> Vec<u64> {
    coarsen(histogram.counts(), expected.coarse.shape, expected.refinement())
}

/// Observed and expected counts of the fine cells, coarse cell by coarse cell.
fn blocks(expected: &Expected, histogram: &Histogram, n: f64) -> impl Iterator<Item = Vec<(f64, f64)>> {
    let ([columns, rows], [width, height]) = (expected.coarse.shape, expected.refinement());
    let cells = expected.fine.cells(histogram.counts(), n);
    (0..columns * rows).map(move |block| {
        let (column, row) = (block % columns * width, block / columns * height);
        let line = |y: usize| (row + y) * columns * width + column;
        (0..height).flat_map(|y| cells[line(y)..line(y) + width].iter().copied()).collect()
    })
}

/// Points in cells where the density is 0, as far as the quadrature sees.
fn stray_points(expected: &Expected, histogram: &Histogram) -> u64 {
    let cells = histogram.counts().iter().zip(&expected.fine.probabilities);
    cells.filter(|(_, p)| **p == 0.0).map(|(count, _)| count).sum()
}

fn method(domain: &str, coarse: &Split, within: Pearson, special: &[(Special, f64)]) -> String {
    let Split { whole, contrasts, rest } = coarse;
    let mut text = format!(
        "chi-square on the {domain}: {} cells, of which {} low-order contrasts have p {:.2e} and the rest p {:.2e}; inside them, {} more, p {:.2e}",
        whole.dof + 1.0,
        contrasts.dof,
        contrasts.p_value,
        rest.p_value,
        within.dof,
        within.p_value
    );
    for (Special { what, count, .. }, p_value) in special {
        text += &format!("; {count} {what}, p {p_value:.2e}");
    }
    text
}

/// Points that no probability allows, in words.
fn strays(histogram: &Histogram, stray: u64) -> String {
    let outside = histogram.outside();
    let mut text = String::new();
    for (count, what) in [(stray, "where the density is 0"), (outside, "outside")] {
        if count > 0 {
            text += &format!("; {count} {what}");
        }
    }
    text
}

fn doubts(expected: &Expected, tests: [Pearson; 2], histogram: &Histogram) -> Vec<String> {
    let (mut doubts, n) = (Vec::new(), histogram.total() as f64);
    if histogram.outside() > 0 {
        doubts.push(format!("{} points are outside the domain", histogram.outside()));
    }
    if expected.exceeds_one() {
        let total = 1.0 - expected.missing();
        doubts.push(format!("density and atoms make {total} together, more than 1"));
    }
    for (grid, test) in [&expected.coarse, &expected.fine].into_iter().zip(tests) {
        let (lambda, spread) = (grid.quadrature_lambda(n), (2.0 * test.dof).sqrt());
        if lambda >= QUADRATURE_SHARE * spread {
            let [columns, rows] = grid.shape;
            doubts.push(format!(
                "quadrature errors on {columns} × {rows} cells may add {lambda:.2} to a statistic that spreads by {spread:.2}"
            ));
        }
        if test.dof > 0.0 && noncentral_cdf(test.statistic, test.dof, 0.0) < UNDECIDED {
            let (statistic, dof) = (test.statistic, test.dof);
            doubts.push(format!(
                "a statistic of {statistic:.1} with {dof} degrees of freedom is smaller than independent samples give it"
            ));
        }
    }
    doubts
}
