//! How many points each cell should get: the density's integral over every cell, with its error.

use std::cell::Cell;

use super::smooth::Smooth;
use crate::domain::Domain;
use crate::error::InputError;
use crate::histogram::coarsen;
use crate::quadrature::{Tolerance, integrate_2d};

/// Error accepted in a cell of the fine grid. Relative: λ = N Σ p δ² of N points is N·10⁻¹², which no sample
/// count notices. Absolute: over 20,000 cells, 2·10⁻⁸ of the whole. Pieces: a jump through a cell is found to
/// 1/250 of its length, at 25,000 evaluations.
const TOLERANCE: Tolerance = Tolerance { relative: 1e-6, absolute: 1e-12, pieces: 500 };

/// Error of the whole integral above which there is nothing to compare counts with.
const LARGEST_MASS_ERROR: f64 = 0.01;

/// Relative rounding of densities computed in single precision: 16 units in the last place, 16·2⁻²⁴.
const DENSITY_ROUNDING: f64 = 1e-6;

/// The density that points should have, per unit of the domain's measure.
pub(super) enum Density<P> {
    /// The same everywhere, with integral 1.
    Uniform,
    /// Any function.
    Function(Box<dyn Fn(P) -> f64 + Send + Sync>),
    /// Constant on the cells of a regular grid over the domain's coordinates.
    Cells { shape: [usize; 2], values: Vec<f64> },
}

/// Probabilities of the cells of one grid.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    pub(super) shape: [usize; 2],
    pub(super) probabilities: Vec<f64>,
    /// Estimated absolute errors of the probabilities.
    pub(super) errors: Vec<f64>,
}

impl Grid {
    /// The non-centrality that the quadrature's errors alone can give a chi-square statistic of n points: n Σ
    /// δ²/p.
    pub(super) fn quadrature_lambda(&self, n: f64) -> f64 {
        let cells = self.probabilities.iter().zip(&self.errors);
        cells.filter(|(p, _)| **p > 0.0).map(|(p, error)| n * error * error / p).sum()
    }

    /// Observed and expected counts of n points.
    pub(super) fn cells(&self, counts: &[u64], n: f64) -> Vec<(f64, f64)> {
        counts.iter().zip(&self.probabilities).map(|(count, p)| (*count as f64, n * p)).collect()
    }

    /// Number of cells that points can be in.
    pub(super) fn possible_cells(&self) -> usize {
        self.probabilities.iter().filter(|p| **p > 0.0).count()
    }
}

/// Probabilities of the cells of both grids, and of being discarded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Expected {
    pub(super) coarse: Grid,
    pub(super) fine: Grid,
    /// ∫ pdf over the domain.
    pub(super) mass: f64,
    /// By how much the mass may be off: quadrature, and rounding of the density.
    pub(super) mass_error: f64,
    /// Probabilities of the atoms.
    pub(super) atoms: Vec<f64>,
}

impl Expected {
    /// Integrates a density over the cells of a domain.
    ///
    /// # Errors
    /// `Density` where it is negative or not finite, `Quadrature` if its integral is not known to 1 %,
    /// `TooFew` if fewer than two cells are possible, `Parameter` for an atom's probability that is none.
    pub(super) fn of<D: Domain>(
        domain: &D,
        density: &Density<D::Point>,
        atoms: &[f64],
    ) -> Result<Self, InputError> {
        if let Some(&value) = atoms.iter().find(|p| !(0.0..=1.0).contains(*p)) {
            return Err(InputError::Parameter { name: "probability of an atom", value, accepted: "0 to 1" });
        }
        let (coarse_shape, factor) = (domain.coarse_grid(), domain.refinement());
        let shape = [coarse_shape[0] * factor[0], coarse_shape[1] * factor[1]];
        let fine = match density {
            Density::Uniform => uniform(shape, atoms),
            Density::Function(density) => integrated(domain, density, shape)?,
            Density::Cells { shape: given, values } => tabulated(domain, *given, values, shape)?,
        };
        let coarse = Grid {
            shape: coarse_shape,
            probabilities: coarsen(&fine.probabilities, coarse_shape, factor),
            errors: coarsen(&fine.errors, coarse_shape, factor),
        };
        let mass: f64 = coarse.probabilities.iter().sum();
        let quadrature_error: f64 = coarse.errors.iter().sum();
        if quadrature_error > LARGEST_MASS_ERROR * mass {
            let place = format!("the whole {}", domain.name());
            return Err(InputError::Quadrature {
                reached: quadrature_error / mass,
                wanted: LARGEST_MASS_ERROR,
                place,
            });
        }
        let given = coarse.possible_cells() as u64;
        if given < 2 {
            return Err(InputError::TooFew { what: "cells of positive probability", given, needed: 2 });
        }
        let mass_error = quadrature_error + DENSITY_ROUNDING;
        Ok(Self { coarse, fine, mass, mass_error, atoms: atoms.to_vec() })
    }

    /// Columns and rows of fine cells in a coarse one.
    pub(super) fn refinement(&self) -> [usize; 2] {
        [self.fine.shape[0] / self.coarse.shape[0], self.fine.shape[1] / self.coarse.shape[1]]
    }

    /// What density and atoms leave of 1; below 0 where they exceed it.
    pub(super) fn missing(&self) -> f64 {
        1.0 - self.mass - self.atoms.iter().sum::<f64>()
    }

    /// Probability of being discarded; 0 where density and atoms don't differ from 1 by more than the
    /// density's error.
    pub(super) fn discarded(&self) -> f64 {
        let missing = self.missing();
        if missing > self.mass_error { missing } else { 0.0 }
    }

    /// Whether density and atoms make more than 1, beyond the quadrature's error.
    pub(super) fn exceeds_one(&self) -> bool {
        -self.missing() > self.mass_error
    }
}

/// What the atoms leave, the same for every cell.
fn uniform(shape: [usize; 2], atoms: &[f64]) -> Grid {
    let cells = shape[0] * shape[1];
    let share = (1.0 - atoms.iter().sum::<f64>()).max(0.0) / cells as f64;
    Grid { shape, probabilities: vec![share; cells], errors: vec![0.0; cells] }
}

/// Integrals of a function over the cells.
fn integrated<D: Domain>(
    domain: &D,
    density: &dyn Fn(D::Point) -> f64,
    shape: [usize; 2],
) -> Result<Grid, InputError> {
    let measure = domain.measure();
    let bad = Cell::new(None);
    let f = |square: [f64; 2]| {
        let value = density(domain.point(square));
        if value >= 0.0 && value.is_finite() {
            return measure * value;
        }
        bad.set(Some((value, square)));
        0.0
    };
    let edges = |i: usize, count: usize| [i, i + 1].map(|i| i as f64 / count as f64);
    let rectangle = |[x, y]: [usize; 2], [columns, rows]: [usize; 2]| [edges(x, columns), edges(y, rows)];
    let ([columns, rows], factor) = (domain.coarse_grid(), domain.refinement());
    let smooth = Smooth::on(factor);
    let (mut probabilities, mut errors) = (vec![0.0; shape[0] * shape[1]], vec![0.0; shape[0] * shape[1]]);
    for block in 0..columns * rows {
        let corner = [block % columns, block / columns];
        let cells = smooth.integrals(&f, rectangle(corner, [columns, rows]), TOLERANCE.relative);
        for part in 0..factor[0] * factor[1] {
            let place = [corner[0] * factor[0] + part % factor[0], corner[1] * factor[1] + part / factor[0]];
            let integral = match &cells {
                Some(cells) => cells[part],
                None => integrate_2d(&f, rectangle(place, shape), TOLERANCE),
            };
            let cell = place[1] * shape[0] + place[0];
            (probabilities[cell], errors[cell]) = (integral.value, integral.error);
        }
    }
    match bad.get() {
        Some((value, [x, y])) => {
            let [x_axis, y_axis] = domain.axes();
            let place = format!("{x_axis} = {x}, {y_axis} = {y} of the {}", domain.name());
            Err(InputError::Density { value, place })
        }
        None => Ok(Grid { shape, probabilities, errors }),
    }
}

/// Integrals of a density that is constant on the cells of another grid: sums over what the cells share.
fn tabulated<D: Domain>(
    domain: &D,
    given: [usize; 2],
    values: &[f64],
    shape: [usize; 2],
) -> Result<Grid, InputError> {
    let needed = (given[0] * given[1]).max(1) as u64;
    if values.len() as u64 != needed {
        let what = "densities of cells";
        return Err(InputError::TooFew { what, given: values.len() as u64, needed });
    }
    if let Some(i) = values.iter().position(|value| !(*value >= 0.0 && value.is_finite())) {
        let place = format!("column {}, row {} of the cells", i % given[0], i / given[0]);
        return Err(InputError::Density { value: values[i], place });
    }
    let [columns, rows] = [0, 1].map(|axis| overlaps(given[axis], shape[axis]));
    let mut probabilities = Vec::with_capacity(shape[0] * shape[1]);
    for row in &rows {
        for column in &columns {
            let part = |&(j, height): &(usize, f64)| {
                let line = |&(i, width): &(usize, f64)| width * values[j * given[0] + i];
                height * column.iter().map(line).sum::<f64>()
            };
            probabilities.push(domain.measure() * row.iter().map(part).sum::<f64>());
        }
    }
    let errors = vec![0.0; probabilities.len()];
    Ok(Grid { shape, probabilities, errors })
}

/// For each of `to` equal parts of [0, 1], which of `from` equal parts it meets and the lengths that they share.
///
/// In units of 1/(from·to) all ends are whole numbers, so nothing is lost to rounding at the borders.
fn overlaps(from: usize, to: usize) -> Vec<Vec<(usize, f64)>> {
    let unit = 1.0 / (from * to) as f64;
    let part = |k: usize| {
        let (low, high) = (k * from, (k + 1) * from);
        let shared = |i: usize| high.min((i + 1) * to) - low.max(i * to);
        (low / to..high.div_ceil(to)).map(|i| (i, shared(i) as f64 * unit)).collect()
    };
    (0..to).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Directions, Disk};

    #[test]
    fn cells_of_a_cosine_lobe_are_exact() {
        let cosine = Density::Function(Box::new(|[_, _, z]: [f64; 3]| z / std::f64::consts::PI));
        let expected = Expected::of(&Directions::hemisphere(), &cosine, &[]).expect("a density");
        // Between 1 − z = a and b: ∫ 2z dz = (1 − a)² − (1 − b)², over 20 angles.
        for (cell, p) in expected.coarse.probabilities.iter().enumerate() {
            let (a, b) = ((cell % 10) as f64 / 10.0, (cell % 10 + 1) as f64 / 10.0);
            let exact = ((1.0 - a).powi(2) - (1.0 - b).powi(2)) / 20.0;
            assert!((p - exact).abs() < 1e-15 * 100.0, "{p} is not {exact}"); // rounding of 100 cells of one block
        }
        assert!(
            (expected.mass - 1.0).abs() < 1e-12 && expected.discarded() == 0.0 && !expected.exceeds_one()
        );
        assert!(expected.fine.quadrature_lambda(1e9) < 1e-6); // smooth: far below 0.1·√(2·20000) = 20
    }

    #[test]
    fn mass_below_and_above_one_is_seen() {
        let with_mass = |mass: f64| {
            let density = Density::Function(Box::new(move |_| mass / std::f64::consts::PI));
            Expected::of(&Disk::unit(), &density, &[]).expect("a density")
        };
        assert!((with_mass(0.9).discarded() - 0.1).abs() < 1e-12);
        assert!(with_mass(1.00001).exceeds_one());
        assert!(!with_mass(1.000_000_1).exceeds_one()); // one unit in the last place of single precision
    }

    #[test]
    fn what_is_no_density_is_refused() {
        let of = |density: fn([f64; 2]) -> f64| {
            Expected::of(&Disk::unit(), &Density::Function(Box::new(density)), &[]).err()
        };
        assert!(matches!(of(|[x, _]| x), Some(InputError::Density { .. })));
        assert!(matches!(of(|_| f64::NAN), Some(InputError::Density { .. })));
        assert!(matches!(of(|_| 0.0), Some(InputError::TooFew { .. })));
    }

    #[test]
    fn tables_of_another_shape_are_shared_out_exactly() {
        assert_eq!(
            overlaps(3, 2),
            [vec![(0, 1.0 / 3.0), (1, 1.0 / 6.0)], vec![(1, 1.0 / 6.0), (2, 1.0 / 3.0)]]
        );
        let of = |shape, values| Expected::of(&Disk::of_radius(2.0), &Density::Cells { shape, values }, &[]);
        let linear: Vec<f64> =
            (0..3).map(|i| f64::from(i + 1) / (2.0 * 4.0 * std::f64::consts::PI)).collect();
        let expected = of([3, 1], linear).expect("a density");
        assert!((expected.mass - 1.0).abs() < 1e-12); // rounding of 20,000 cells
        // The first of ten columns has a tenth of the first third, (1/6)/(1/3)/10; 20 rows share it.
        assert!((expected.coarse.probabilities[0] - 0.05 / 20.0).abs() < 1e-15);
        assert!(matches!(of([2, 1], vec![0.1]), Err(InputError::TooFew { .. })));
        assert!(matches!(of([2, 1], vec![0.1, f64::NAN]), Err(InputError::Density { .. })));
    }

    #[test]
    fn atoms_take_their_share() {
        let disk = Disk::unit();
        let expected = Expected::of(&disk, &Density::Uniform, &[0.25, 0.5]).expect("a density");
        assert!((expected.mass - 0.25).abs() < 1e-12 && expected.discarded() == 0.0); // rounding of 20,000 cells
        let thin = Density::Function(Box::new(|_: [f64; 2]| 0.1 / std::f64::consts::PI));
        let expected = Expected::of(&disk, &thin, &[0.5]).expect("a density");
        assert!((expected.discarded() - 0.4).abs() < 1e-12); // the same
        assert!(Expected::of(&disk, &thin, &[1.0]).expect("a density").exceeds_one());
        assert!(Expected::of(&disk, &thin, &[-0.1]).is_err());
    }
}
