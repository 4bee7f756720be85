//! Integrals of a smooth function over all fine cells of a coarse one, from few values.
//!
//! Where a polynomial through 8 × 8 values agrees with the function at the middle of every fine cell, its integrals are taken: 164
//! values instead of the 4,900 that a rule for each of 100 cells takes.

use crate::quadrature::Integral;

/// Nodes along an axis; the polynomial's degree is one less.
const NODES: usize = 8;

/// Positive abscissae and weights of the Gauss rule of 8 points on [−1, 1].
///
/// # Source
/// Abramowitz and Stegun 1964, table 25.4.
const ABSCISSAE: [f64; 4] =
    [0.183_434_642_495_649_8, 0.525_532_409_916_329, 0.796_666_477_413_626_7, 0.960_289_856_497_536_3];
const WEIGHTS: [f64; 4] =
    [0.362_683_783_378_362, 0.313_706_645_877_887_3, 0.222_381_034_453_374_48, 0.101_228_536_290_376_26];

type Row = [f64; NODES];

/// Tables for a division of coarse cells into fine ones.
pub(super) struct Smooth {
    nodes: Row,
    /// At each node, weight · Pₖ · (2k + 1)/2 for each degree k: sums with them give Legendre's coefficients.
    analysis: [Row; NODES],
    /// For each fine column and row, Pₖ at its middle.
    middles: [Vec<Row>; 2],
    /// For each fine column and row, ∫ Pₖ over it, as a share of the coarse cell's length.
    integrals: [Vec<Row>; 2],
}

impl Smooth {
    /// * `factor`: columns and rows of fine cells in a coarse one.
    pub(super) fn on(factor: [usize; 2]) -> Self {
        let node = |i: usize| if i < 4 { -ABSCISSAE[3 - i] } else { ABSCISSAE[i - 4] };
        let weight = |i: usize| if i < 4 { WEIGHTS[3 - i] } else { WEIGHTS[i - 4] };
        let nodes = std::array::from_fn(node);
        let analysis = std::array::from_fn(|i| {
            let values = legendre(node(i));
            std::array::from_fn(|k| weight(i) * values[k] * (k as f64 + 0.5))
        });
        let edge = |i: usize, count: usize| 2.0 * i as f64 / count as f64 - 1.0;
        let middle = |i, count| {
            let values = legendre(0.5 * (edge(i, count) + edge(i + 1, count)));
            std::array::from_fn(|k| values[k])
        };
        // ∫ P_k = (P_{k+1} − P_{k−1})/(2k + 1), and x for k = 0; half of it is the share of a length of 2.
        let primitive = |x: f64| -> Row {
            let p = legendre(x);
            std::array::from_fn(|k| {
                if k == 0 { 0.5 * x } else { 0.5 * (p[k + 1] - p[k - 1]) / (2.0 * k as f64 + 1.0) }
            })
        };
        let integral = |i, count| {
            let [low, high] = [primitive(edge(i, count)), primitive(edge(i + 1, count))];
            std::array::from_fn(|k| high[k] - low[k])
        };
        Self {
            nodes,
            analysis,
            middles: factor.map(|count| (0..count).map(|i| middle(i, count)).collect()),
            integrals: factor.map(|count| (0..count).map(|i| integral(i, count)).collect()),
        }
    }

    /// Integrals over the fine cells of a rectangle, row by row; `None` where the polynomial misses a value by more than `relative`.
    ///
    /// The error of each is the largest miss in the rectangle, times the cell's area.
    pub(super) fn integrals(
        &self,
        f: &impl Fn([f64; 2]) -> f64,
        rectangle: [[f64; 2]; 2],
        relative: f64,
    ) -> Option<Vec<Integral>> {
        let [width, height] = rectangle.map(|[low, high]| high - low);
        let at = |axis: usize, x: f64| {
            rectangle[axis][0] + 0.5 * (x + 1.0) * (rectangle[axis][1] - rectangle[axis][0])
        };
        let coefficients = self.coefficients(|[x, y]| f([at(0, x), at(1, y)]));
        let [columns, rows] = [self.middles[0].len(), self.middles[1].len()];
        let middle = |i: usize, count: usize| 2.0 * (i as f64 + 0.5) / count as f64 - 1.0;
        let (values, mut largest) = (tensor(&coefficients, &self.middles), 0.0f64);
        for (cell, value) in values.into_iter().enumerate() {
            let exact = f([at(0, middle(cell % columns, columns)), at(1, middle(cell / columns, rows))]);
            let miss = (value - exact).abs();
            let agrees = miss <= relative * exact;
            if !agrees {
                return None;
            }
            largest = largest.max(miss);
        }
        let area = width * height;
        let error = largest * area / (columns * rows) as f64;
        let integral = |share: f64| Integral { value: area * share.max(0.0), error };
        Some(tensor(&coefficients, &self.integrals).into_iter().map(integral).collect())
    }

    /// Legendre's coefficients of the polynomial through a function's values at the nodes: a row a degree in y.
    fn coefficients(&self, f: impl Fn([f64; 2]) -> f64) -> [Row; NODES] {
        let mut coefficients = [[0.0; NODES]; NODES];
        for (&y, by_y) in self.nodes.iter().zip(&self.analysis) {
            let mut line = [0.0; NODES];
            for (&x, by_x) in self.nodes.iter().zip(&self.analysis) {
                let value = f([x, y]);
                line.iter_mut().zip(by_x).for_each(|(sum, factor)| *sum += factor * value);
            }
            for (row, factor) in coefficients.iter_mut().zip(by_y) {
                row.iter_mut().zip(line).for_each(|(sum, value)| *sum += factor * value);
            }
        }
        coefficients
    }
}

/// Σ c·a(x)·b(y) for every column x and row y, row by row.
fn tensor(coefficients: &[Row; NODES], [columns, rows]: &[Vec<Row>; 2]) -> Vec<f64> {
    let dot = |a: &Row, b: &Row| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut values = Vec::with_capacity(columns.len() * rows.len());
    for row in rows {
        let line: Row = std::array::from_fn(|j| (0..NODES).map(|k| coefficients[k][j] * row[k]).sum());
        values.extend(columns.iter().map(|column| dot(&line, column)));
    }
    values
}

/// Legendre polynomials of degree 0 to 8.
fn legendre(x: f64) -> [f64; NODES + 1] {
    let mut p = [1.0; NODES + 1];
    p[1] = x;
    for k in 2..=NODES {
        let n = k as f64;
        p[k] = ((2.0 * n - 1.0) * x * p[k - 1] - (n - 1.0) * p[k - 2]) / n;
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::{Tolerance, integrate_2d};

    const RECTANGLE: [[f64; 2]; 2] = [[0.2, 0.3], [0.5, 0.6]];

    #[test]
    fn smooth_functions_have_their_integrals() {
        let f = |[x, y]: [f64; 2]| (3.0 * x).exp() * (1.0 + (2.0 * y).sin());
        let cells = Smooth::on([10, 5]).integrals(&f, RECTANGLE, 1e-6).expect("smooth");
        let tolerance = Tolerance { relative: 1e-13, absolute: 0.0, pieces: 100 };
        for (cell, integral) in cells.iter().enumerate() {
            let (column, row) = ((cell % 10) as f64, (cell / 10) as f64);
            let [x, y] = [0.2 + 0.01 * column, 0.5 + 0.02 * row];
            let exact = integrate_2d(&f, [[x, x + 0.01], [y, y + 0.02]], tolerance).value;
            // Degree 7 on a tenth of the scale: (0.3/2)^8/(2^7·8!) = 5e-14, and rounding.
            assert!((integral.value / exact - 1.0).abs() < 1e-12, "{cell}: {integral:?}");
        }
    }

    #[test]
    fn jumps_and_narrow_peaks_are_left_to_others() {
        let smooth = Smooth::on([10, 10]);
        let jump = |[x, _]: [f64; 2]| if x < 0.25 { 1.0 } else { 2.0 };
        assert!(smooth.integrals(&jump, RECTANGLE, 1e-6).is_none());
        // As wide as a fine cell, between the nodes.
        let peak =
            |[x, y]: [f64; 2]| 1.0 + (-((x - 0.225) / 0.005).powi(2) - ((y - 0.545) / 0.005).powi(2)).exp();
        assert!(smooth.integrals(&peak, RECTANGLE, 1e-6).is_none());
        let nothing = smooth.integrals(&|_| 0.0, RECTANGLE, 1e-6).expect("zero everywhere");
        assert!(nothing.iter().all(|integral| integral.value == 0.0 && integral.error == 0.0));
    }

    #[test]
    fn the_rule_is_exact_for_degree_15() {
        let sum =
            |power: i32| -> f64 { ABSCISSAE.iter().zip(WEIGHTS).map(|(x, w)| 2.0 * w * x.powi(power)).sum() };
        for power in (0..16).step_by(2) {
            assert!((sum(power) - 2.0 / f64::from(power + 1)).abs() < 1e-15, "{power}"); // rounding of weights below 1
        }
    }
}
