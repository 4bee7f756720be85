//! Pearson's statistic with pooling of rare cells, and the exact test of a count.

use statrs::function::gamma::ln_gamma;

use crate::power::chi_square_sf;

/// Expected count below which cells are pooled: the usual limit for the chi-square approximation.
const POOLED_BELOW: f64 = 5.0;

/// The test of the counts of one grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pearson {
    pub(super) statistic: f64,
    pub(super) dof: f64,
    pub(super) p_value: f64,
}

impl Pearson {
    pub(super) fn of(statistic: f64, dof: f64) -> Self {
        let p_value = if dof > 0.0 { chi_square_sf(statistic, dof) } else { 1.0 };
        Self { statistic, dof, p_value }
    }
}

/// A cell or several pooled ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell<const K: usize> {
    pub(super) observed: f64,
    pub(super) expected: f64,
    /// The contrasts' values times the expectation, so that pooling adds them.
    pub(super) contrasts: [f64; K],
}

impl<const K: usize> Cell<K> {
    /// * `contrasts`: values at the cell.
    pub(super) fn new(observed: f64, expected: f64, contrasts: [f64; K]) -> Self {
        Self { observed, expected, contrasts: contrasts.map(|value| value * expected) }
    }

    fn join(&mut self, other: &Self) {
        self.observed += other.observed;
        self.expected += other.expected;
        self.contrasts.iter_mut().zip(other.contrasts).for_each(|(sum, value)| *sum += value);
    }
}

/// Pearson's statistic: Σ (o − e)²/e.
pub(super) fn pearson<const K: usize>(cells: &[Cell<K>]) -> f64 {
    cells.iter().map(|c| (c.observed - c.expected) * (c.observed - c.expected) / c.expected).sum()
}

/// Compares counts inside blocks of cells with what the block's own count and the expectations' ratios make
/// of it.
///
/// Given the blocks' counts, this statistic does not depend on how the points are spread over blocks; so its
/// p-value and that of the blocks are independent when the expectations are right.
///
/// * `blocks`: observed and expected counts of the cells of each block; cells of expectation 0 take no part.
pub(super) fn pearson_within(blocks: impl Iterator<Item = Vec<(f64, f64)>>) -> Pearson {
    let (mut statistic, mut dof) = (0.0, 0.0);
    for block in blocks {
        let possible = || block.iter().filter(|(_, e)| *e > 0.0);
        let (o, e) = possible().fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
        if o > 0.0 {
            let cells = pool(possible().map(|cell| Cell::new(cell.0, cell.1 * o / e, [])));
            statistic += pearson(&cells);
            dof += cells.len() as f64 - 1.0;
        }
    }
    Pearson::of(statistic, dof)
}

/// Joins cells of expectation below 5, the rarest first, until each has at least 5; what remains joins the
/// smallest other cell. Cells of expectation 0 take no part.
pub(super) fn pool<const K: usize>(cells: impl Iterator<Item = Cell<K>>) -> Vec<Cell<K>> {
    let (mut large, mut rare): (Vec<_>, Vec<_>) =
        cells.filter(|c| c.expected > 0.0).partition(|c| c.expected >= POOLED_BELOW);
    rare.sort_by(|a, b| a.expected.total_cmp(&b.expected));
    let empty = Cell::new(0.0, 0.0, [0.0; K]);
    let mut pool = empty;
    for cell in &rare {
        pool.join(cell);
        if pool.expected >= POOLED_BELOW {
            large.push(pool);
            pool = empty;
        }
    }
    if pool.expected > 0.0 {
        match large.iter_mut().min_by(|a, b| a.expected.total_cmp(&b.expected)) {
            Some(smallest) => smallest.join(&pool),
            None => large.push(pool),
        }
    }
    large
}

/// Two-sided probability of a count as far from its expectation, when its probability is only known to be
/// between two values.
///
/// * `count`: of `n`, at most `n`; `low`, `high`: limits of its probability; the tail above is taken at
///   `high`, the one below at `low`.
pub(super) fn count_p_value(count: u64, n: u64, low: f64, high: f64) -> f64 {
    let at_most = binomial_at_least(n - count, n, 1.0 - low); // the others, of the complementary probability
    (2.0 * binomial_at_least(count, n, high).min(at_most)).min(1.0)
}

/// Probability that a binomial count is at least `count`, by summing its terms from there away from the mean.
fn binomial_at_least(count: u64, n: u64, p: f64) -> f64 {
    if count == 0 {
        return 1.0;
    }
    if p <= 0.0 || count > n {
        return 0.0;
    }
    if p >= 1.0 {
        return 1.0;
    }
    let (n, odds, from) = (n as f64, p / (1.0 - p), count as f64);
    let ln_choose = |k: f64| ln_gamma(n + 1.0) - ln_gamma(k + 1.0) - ln_gamma(n - k + 1.0);
    let term = |k: f64| (ln_choose(k) + k * p.ln() + (n - k) * (-p).ln_1p()).exp();
    if from > n * p {
        sum_terms(term(from), from, |k| (n - k) / (k + 1.0) * odds, 1.0)
    } else {
        1.0 - sum_terms(term(from - 1.0), from - 1.0, |k| k / ((n - k + 1.0) * odds), -1.0)
    }
}

/// Sums terms that fall away from the first by given ratios, until they no longer count.
fn sum_terms(first: f64, mut k: f64, ratio: impl Fn(f64) -> f64, step: f64) -> f64 {
    let (mut term, mut sum) = (first, first);
    while term > f64::EPSILON * sum {
        term *= ratio(k);
        sum += term;
        k += step;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell((observed, expected): (f64, f64)) -> Cell<0> {
        Cell::new(observed, expected, [])
    }

    #[test]
    fn the_p_value_of_a_small_statistic() {
        let test = Pearson::of(0.8, 2.0);
        assert!((test.p_value - (-0.4f64).exp()).abs() < 1e-14); // two degrees of freedom: exp(−x/2)
        assert_eq!(Pearson::of(0.0, 0.0).p_value, 1.0);
    }

    #[test]
    fn blocks_are_compared_with_their_own_counts() {
        // Twice and three times as many points as expected, spread as expected: nothing to see inside the blocks.
        let even = vec![(20.0, 10.0), (40.0, 20.0), (0.0, 0.0)];
        let test = pearson_within([even, vec![(30.0, 10.0), (30.0, 10.0)], vec![(0.0, 10.0)]].into_iter());
        assert_eq!((test.statistic, test.dof), (0.0, 2.0));
        let uneven = pearson_within([vec![(15.0, 100.0), (5.0, 100.0)]].into_iter());
        assert_eq!((uneven.statistic, uneven.dof), (5.0, 1.0)); // 2·5²/10
    }

    #[test]
    fn rare_cells_are_pooled_and_impossible_ones_left_out() {
        let cells = [(9.0, 10.0), (1.0, 2.0), (4.0, 4.0), (0.0, 0.0), (2.0, 1.0), (3.0, 4.5), (1.0, 0.5)];
        let pooled = pool(cells.map(cell).into_iter());
        assert_eq!(pooled, [(9.0, 10.0), (8.0 + 3.0, 7.5 + 4.5)].map(cell)); // 0.5 + 1 + 2 + 4, then 4.5 remains
        assert_eq!(pool([(1.0, 2.0), (2.0, 1.0)].map(cell).into_iter()), [(3.0, 3.0)].map(cell));
        let mut joined = Cell::new(1.0, 2.0, [3.0]);
        joined.join(&Cell::new(1.0, 1.0, [6.0]));
        assert_eq!(joined.contrasts, [12.0]); // 2·3 + 1·6
    }

    #[test]
    fn binomial_tails_are_exact() {
        assert!((binomial_at_least(7, 10, 0.5) - 176.0 / 1024.0).abs() < 1e-12); // 120 + 45 + 10 + 1 of 1024; ln Γ keeps 1e-14
        assert!((binomial_at_least(3, 10, 0.5) - 968.0 / 1024.0).abs() < 1e-12); // less 1 + 10 + 45; the same
        assert_eq!(binomial_at_least(0, 10, 0.0), 1.0);
        assert_eq!(binomial_at_least(1, 10, 0.0), 0.0);
        // 2·10⁹ draws, 3.16 deviations up: sf of scipy 1.17.1 `binom`; ln Γ(2·10⁹) = 4·10¹⁰ keeps 4·10¹⁰·ε = 1e-5.
        assert!(
            (binomial_at_least(200_042_427, 2_000_000_000, 0.1) / 0.000_782_922_903_566_4 - 1.0).abs() < 1e-4
        );
    }

    #[test]
    fn a_count_is_tested_on_both_sides_and_against_the_nearer_limit() {
        assert!(count_p_value(150, 1000, 0.1, 0.1) < 1e-5 && count_p_value(60, 1000, 0.1, 0.1) < 1e-5);
        assert!(count_p_value(100, 1000, 0.1, 0.1) > 0.9);
        assert!(count_p_value(120, 1000, 0.1, 0.12) > 0.4);
        assert_eq!(count_p_value(0, 1000, 0.0, 1e-6), 1.0);
    }
}
