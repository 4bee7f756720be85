//! Smooth errors: low-order contrasts of the counts, apart from what is left of Pearson's statistic.
//!
//! A statistic of 200 cells has 199 directions to look in; a smooth error lies in a few of them and is lost among the others.
//! So the statistic is split: the part along the contrasts of total degree 1 to 4 in the domain's coordinates (means, variances,
//! correlation, skewness …), and the rest. For a right sampler the two are independent chi-square variables.

use super::pearson::{Cell, Pearson, pool};

/// Largest total degree of a contrast.
const DEGREE: usize = 4;

/// Number of contrasts: products of Legendre polynomials of total degree 1 to 4.
pub(super) const CONTRASTS: usize = (DEGREE + 1) * (DEGREE + 2) / 2 - 1;

/// Share of its length that a contrast must keep across the ones before it; below, it is one of them (or constant) but for rounding.
const NEW_DIRECTION: f64 = 1e-6;

/// Values of the contrasts at a point of the unit square.
pub(super) fn at(square: [f64; 2]) -> [f64; CONTRASTS] {
    let [xs, ys] = square.map(legendre);
    let degrees = (1..=DEGREE).flat_map(|total| (0..=total).map(move |j| [total - j, j]));
    let mut values = [0.0; CONTRASTS];
    values.iter_mut().zip(degrees).for_each(|(value, [i, j])| *value = xs[i] * ys[j]);
    values
}

/// Legendre polynomials of degree 0 to 4 on [0, 1].
fn legendre(u: f64) -> [f64; DEGREE + 1] {
    let x = 2.0 * u - 1.0;
    let mut p = [1.0; DEGREE + 1];
    p[1] = x;
    for k in 2..=DEGREE {
        let n = k as f64;
        p[k] = ((2.0 * n - 1.0) * x * p[k - 1] - (n - 1.0) * p[k - 2]) / n;
    }
    p
}

/// Pearson's statistic of all cells, rare ones pooled, and its two parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Split {
    pub(super) whole: Pearson,
    pub(super) contrasts: Pearson,
    pub(super) rest: Pearson,
}

/// Splits the statistic of a grid's counts.
///
/// With z = (o − e)/√e the statistic is |z|², and z is across √e. The contrasts times √e, made orthonormal across √e and one
/// another, give the part Σ (q·z)²; what is left has the other degrees of freedom.
///
/// # Source
/// Neyman 1937, "Smooth test for goodness of fit", 10.1080/03461238.1937.10404821; its form for counts: Rayner and Best 1989,
/// "Smooth tests of goodness of fit", chapter 5.
pub(super) fn split(cells: Vec<Cell<CONTRASTS>>) -> Split {
    let cells = pool(cells.into_iter());
    let residuals: Vec<f64> = cells.iter().map(|c| (c.observed - c.expected) / c.expected.sqrt()).collect();
    let whole = dot(&residuals, &residuals);
    let dof = cells.len() as f64 - 1.0;
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(CONTRASTS + 1);
    let constant = cells.iter().map(|c| c.expected.sqrt()).collect();
    let contrast = |k: usize| cells.iter().map(|c| c.contrasts[k] / c.expected.sqrt()).collect();
    for vector in std::iter::once(constant).chain((0..CONTRASTS).map(contrast)) {
        basis.extend(across(vector, &basis));
    }
    let directions = basis.len().saturating_sub(1);
    let along: f64 = basis.iter().skip(1).map(|q| dot(q, &residuals).powi(2)).sum();
    Split {
        whole: Pearson::of(whole, dof),
        contrasts: Pearson::of(along, directions as f64),
        rest: Pearson::of((whole - along).max(0.0), dof - directions as f64),
    }
}

/// The part of a vector across an orthonormal basis, of length 1; `None` if nothing but rounding is left.
fn across(mut vector: Vec<f64>, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
    let before = dot(&vector, &vector).sqrt();
    for q in basis.iter().chain(basis) {
        // Twice, since the first pass leaves rounding of the parts that it takes away.
        let part = dot(q, &vector);
        vector.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
    }
    let length = dot(&vector, &vector).sqrt();
    (length > NEW_DIRECTION * before).then(|| vector.into_iter().map(|v| v / length).collect())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid with 10 points expected a cell, whose counts follow a factor.
    fn grid(columns: usize, rows: usize, factor: impl Fn([f64; 2]) -> f64) -> Vec<Cell<CONTRASTS>> {
        let middle = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
        let cell = |i: usize| {
            let place = [middle(i % columns, columns), middle(i / columns, rows)];
            Cell::new(10.0 * factor(place), 10.0, at(place))
        };
        (0..columns * rows).map(cell).collect()
    }

    #[test]
    fn a_smooth_error_is_all_in_the_contrasts_and_a_checker_all_in_the_rest() {
        let smooth = split(grid(14, 14, |[x, y]| 1.0 + 0.3 * (x - 0.5) * (y - 0.5)));
        assert_eq!((smooth.contrasts.dof, smooth.rest.dof, smooth.whole.dof), (14.0, 181.0, 195.0));
        assert!(smooth.rest.statistic < 1e-9 && smooth.contrasts.statistic > 0.1); // rounding of 196 terms
        let sign = |x: f64| if (7.0 * x).fract() < 0.5 { 1.0 } else { -1.0 };
        let checker = split(grid(14, 14, |[x, y]| 1.0 + 0.1 * sign(x) * sign(y)));
        // The signs of 14 columns have the share (2k + 1)/14² along the polynomial of odd degree k: (3² + 2·3·7)/14⁴ = 1.3e-3 in all.
        assert!(checker.contrasts.statistic < 2e-3 * checker.rest.statistic);
    }

    #[test]
    fn a_smooth_error_of_uneven_cells_is_in_the_contrasts() {
        let cell = |i: usize| {
            let place = [i % 14, i / 14].map(|k| (k as f64 + 0.5) / 14.0);
            let expected = 5.0 + 100.0 * place[0];
            Cell::new(expected * (0.9 + 0.2 * place[1]), expected, at(place))
        };
        let split = split((0..196).map(cell).collect());
        assert!(split.rest.statistic < 1e-9 && split.contrasts.statistic > 1.0); // rounding of 196 terms
    }

    #[test]
    fn one_row_and_few_cells_have_fewer_contrasts() {
        let row = split(grid(200, 1, |_| 1.0));
        assert_eq!((row.contrasts.dof, row.rest.dof), (4.0, 195.0));
        let two = split(grid(2, 1, |[x, _]| 0.5 + x));
        assert_eq!((two.contrasts.dof, two.rest.dof, two.rest.p_value), (1.0, 0.0, 1.0));
        assert!((two.contrasts.statistic - two.whole.statistic).abs() < 1e-12); // one direction: all of it
    }

    #[test]
    fn polynomials_are_legendres() {
        assert_eq!(legendre(1.0), [1.0; 5]);
        assert_eq!(legendre(0.5), [1.0, 0.0, -0.5, 0.0, 0.375]);
    }
}
