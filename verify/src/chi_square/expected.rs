//! How many points each cell should get: the density's integral over every cell, with its error.

use std::cell::Cell;

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
}

impl Expected {
    /// Integrates a density over the cells of a domain.
    ///
    /// # Errors
    /// `Density` where it is negative or not finite, `Quadrature` if its integral is not known to 1 %,
    /// `TooFew` if fewer than two cells are possible.
    pub(super) fn of<D: Domain>(domain: &D, density: &dyn Fn(D::Point) -> f64) -> Result<Self, InputError> {
        let (coarse_shape, factor) = (domain.coarse_grid(), domain.refinement());
        let shape = [coarse_shape[0] * factor[0], coarse_shape[1] * factor[1]];
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
        let (mut probabilities, mut errors) = (Vec::with_capacity(shape[0] * shape[1]), Vec::new());
        for index in 0..shape[0] * shape[1] {
            let edges = |i: usize, count: usize| [i, i + 1].map(|i| i as f64 / count as f64);
            let rectangle = [edges(index % shape[0], shape[0]), edges(index / shape[0], shape[1])];
            let integral = integrate_2d(&f, rectangle, TOLERANCE);
            probabilities.push(integral.value);
            errors.push(integral.error);
        }
        if let Some((value, [x, y])) = bad.get() {
            let [x_axis, y_axis] = domain.axes();
            return Err(InputError::Density {
                value,
                place: format!("{x_axis} = {x}, {y_axis} = {y} of the {}", domain.name()),
            });
        }
        let coarse = Grid {
            shape: coarse_shape,
            probabilities: coarsen(&probabilities, coarse_shape, factor),
            errors: coarsen(&errors, coarse_shape, factor),
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
        Ok(Self { coarse, fine: Grid { shape, probabilities, errors }, mass, mass_error })
    }

    /// Columns and rows of fine cells in a coarse one.
    pub(super) fn refinement(&self) -> [usize; 2] {
        [self.fine.shape[0] / self.coarse.shape[0], self.fine.shape[1] / self.coarse.shape[1]]
    }

    /// Probability of being discarded; 0 where the density's integral doesn't differ from 1 by more than its
    /// error.
    pub(super) fn discarded(&self) -> f64 {
        let missing = 1.0 - self.mass;
        if missing > self.mass_error { missing } else { 0.0 }
    }

    /// Whether the density integrates to more than 1, beyond the quadrature's error.
    pub(super) fn exceeds_one(&self) -> bool {
        self.mass - 1.0 > self.mass_error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{Directions, Disk};

    #[test]
    fn cells_of_a_cosine_lobe_are_exact() {
        let expected = Expected::of(&Directions::hemisphere(), &|[_, _, z]| z / std::f64::consts::PI)
            .expect("a density");
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
            Expected::of(&Disk::unit(), &move |_| mass / std::f64::consts::PI).expect("a density")
        };
        assert!((with_mass(0.9).discarded() - 0.1).abs() < 1e-12);
        assert!(with_mass(1.00001).exceeds_one());
        assert!(!with_mass(1.000_000_1).exceeds_one()); // one unit in the last place of single precision
    }

    #[test]
    fn what_is_no_density_is_refused() {
        let of = |density: fn([f64; 2]) -> f64| Expected::of(&Disk::unit(), &density).err();
        assert!(matches!(of(|[x, _]| x), Some(InputError::Density { .. })));
        assert!(matches!(of(|_| f64::NAN), Some(InputError::Density { .. })));
        assert!(matches!(of(|_| 0.0), Some(InputError::TooFew { .. })));
    }
}
