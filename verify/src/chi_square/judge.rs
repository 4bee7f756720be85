//! From counts and expectations to evidence: how many samples, which p, which limits, what could have been
//! seen.

use super::expected::Expected;
use super::pearson::{Pearson, count_p_value, pearson, pearson_within};
use crate::claim::{Evidence, Picture, REJECTION_LEVEL, Resolution};
use crate::error::InputError;
use crate::histogram::{Histogram, coarsen};
use crate::power::{chi_square_critical, lambda_lower, lambda_upper, noncentral_cdf};

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

/// The RMS relative error that n samples show with power 0.9 on the coarse grid.
pub(super) fn resolution(expected: &Expected, n: u64) -> f64 {
    let n = n as f64;
    let counts = expected.coarse.probabilities.iter().map(|p| (0.0, n * p));
    let dof = pearson(counts.chain([(0.0, n * expected.discarded())])).dof.max(1.0);
    let share = if expected.discarded() > 0.0 { 0.5 } else { 1.0 }; // the other half is for the number of discarded samples
    let level = 1.0 - (1.0 - share * REJECTION_LEVEL).sqrt(); // the inverse of `either`
    (lambda_lower(chi_square_critical(level, dof), dof, POWER) / n).sqrt()
}

/// The probability that the smaller of two independent p-values is as small (Šidák).
fn either(p: f64, q: f64) -> f64 {
    let smaller = p.min(q);
    smaller * (2.0 - smaller)
}

fn degrees_of_freedom(expected: &Expected) -> f64 {
    expected.coarse.possible_cells() as f64 - 1.0 + f64::from(u8::from(expected.discarded() > 0.0))
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
    let observed = coarse_counts(expected, histogram);
    let cells = expected.coarse.cells(&observed, n);
    let coarse =
        pearson(cells.iter().copied().chain([(histogram.discarded() as f64, n * expected.discarded())]));
    let within = pearson_within(blocks(expected, histogram, n));
    let discarded_p = discarded_p_value(expected, histogram);
    let stray = stray_points(expected, histogram);
    let stray_p = count_p_value(stray, total, 0.0, expected.mass_error);
    let counts_matter = expected.discarded() > 0.0 || histogram.discarded() > 0 || stray > 0;
    let p_value = match either(coarse.p_value, within.p_value) {
        _ if histogram.outside() > 0 || expected.exceeds_one() => 0.0,
        p if counts_matter => (2.0 * p).min(4.0 * discarded_p).min(4.0 * stray_p).min(1.0),
        p => p,
    };
    let [low, high] = [lambda_lower, lambda_upper]
        .map(|limit| (limit(coarse.statistic, coarse.dof, REJECTION_LEVEL) / n).sqrt());
    let (observed, expectations) = cells.into_iter().unzip();
    let shape = expected.coarse.shape;
    Ok(Evidence {
        method: method(
            domain,
            [coarse, within],
            histogram,
            [(histogram.discarded(), discarded_p), (stray, stray_p)],
        ),
        n: total,
        statistic: coarse.statistic,
        dof: Some(coarse.dof),
        p_value,
        estimate: ((coarse.statistic - coarse.dof).max(0.0) / n).sqrt(),
        interval: [low, high],
        bound,
        resolution: Resolution {
            quantity: "RMS relative error over cells",
            value: resolution(expected, total),
            power: POWER,
        },
        doubts: doubts(expected, [coarse, within], histogram),
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

/// Probability of a number of discarded samples as far from what the density leaves for them.
fn discarded_p_value(expected: &Expected, histogram: &Histogram) -> f64 {
    let missing = 1.0 - expected.mass;
    let [low, high] =
        [missing - expected.mass_error, missing + expected.mass_error].map(|p| p.clamp(0.0, 1.0));
    count_p_value(histogram.discarded(), histogram.total(), low, high)
}

/// Points in cells where the density is 0, as far as the quadrature sees.
fn stray_points(expected: &Expected, histogram: &Histogram) -> u64 {
    let cells = histogram.counts().iter().zip(&expected.fine.probabilities);
    cells.filter(|(_, p)| **p == 0.0).map(|(count, _)| count).sum()
}

fn method(
    domain: &str,
    [coarse, within]: [Pearson; 2],
    histogram: &Histogram,
    counts: [(u64, f64); 2],
) -> String {
    let (cells, p) = (coarse.dof + 1.0, coarse.p_value);
    let mut text = format!(
        "chi-square on the {domain}: {cells} cells, p {p:.2e}; inside them, {} more, p {:.2e}",
        within.dof, within.p_value
    );
    for ((count, p), what) in counts.into_iter().zip(["discarded", "where the density is 0"]) {
        if count > 0 || p < 1.0 {
            text += &format!("; {count} {what}, p {p:.2e}");
        }
    }
    if histogram.outside() > 0 {
        text += &format!("; {} outside", histogram.outside());
    }
    text
}

fn doubts(expected: &Expected, tests: [Pearson; 2], histogram: &Histogram) -> Vec<String> {
    let (mut doubts, n) = (Vec::new(), histogram.total() as f64);
    if histogram.outside() > 0 {
        doubts.push(format!("{} points are outside the domain", histogram.outside()));
    }
    if expected.exceeds_one() {
        doubts.push(format!("the density integrates to {}, more than 1", expected.mass));
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
