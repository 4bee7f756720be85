//! Densities that are constant on the cells of a regular grid: images of lights, tabulated filters.

use super::discrete::Discrete;
use crate::ParamError;
use crate::math::float::{ONE_MINUS_EPSILON, round_f32};

/// A density on [0, 1), constant on n equal cells.
///
/// # Source
/// Inversion: the cell by its share of the mass, then evenly within the cell.
///
/// # Verified by
/// `sampling::piecewise::tests`
#[derive(Debug, Clone, PartialEq)]
pub struct Piecewise1d {
    cells: Discrete,
}

impl Piecewise1d {
    /// The density proportional to `values`, one for each cell from 0 on.
    ///
    /// # Errors
    /// As [`Discrete::new`].
    pub fn new(values: &[f64]) -> Result<Self, ParamError> {
        Ok(Self { cells: Discrete::new(values)? })
    }

    /// Maps `u` in [0, 1) to a position in [0, 1) of this density.
    ///
    /// Returns: the position and its density.
    ///
    /// # Measure
    /// Per unit of the interval.
    pub fn sample(&self, u: f32) -> (f32, f32) {
        let chosen = self.cells.sample(u);
        (position(chosen.index, chosen.u, self.cells.len()), self.density(chosen.index))
    }

    /// The density at `x`; 0 outside [0, 1).
    ///
    /// # Measure
    /// Per unit of the interval.
    pub fn pdf(&self, x: f32) -> f32 {
        cell(x, self.cells.len()).map_or(0.0, |index| self.density(index))
    }

    fn density(&self, index: usize) -> f32 {
        self.cells.pmf(index) * self.cells.len() as f32
    }
}

/// A density on [0, 1)², constant on the cells of a grid.
///
/// # Source
/// The row by its share of the mass, then the column by its share of the row's: the marginal and the conditional
/// distribution, each by inversion, so that a well spread set of `u` stays well spread.
///
/// # Verified by
/// `sampling::piecewise::tests`
#[derive(Debug, Clone, PartialEq)]
pub struct Piecewise2d {
    marginal: Discrete,
    /// `None` for a row without mass.
    rows: Vec<Option<Piecewise1d>>,
}

impl Piecewise2d {
    /// The density proportional to `values`: rows of `columns` cells, the row at y = 0 first.
    ///
    /// # Errors
    /// As [`Discrete::new`]; `OutOfRange` if `columns` doesn't divide the number of values.
    pub fn new(values: &[f64], columns: usize) -> Result<Self, ParamError> {
        if columns == 0 || !values.len().is_multiple_of(columns) {
            let (name, accepted) = ("columns", "a divisor of the number of values");
            return Err(ParamError::OutOfRange { name, value: columns as f64, accepted });
        }
        let mut masses = Vec::with_capacity(values.len() / columns);
        let mut rows = Vec::with_capacity(values.len() / columns);
        for row in values.chunks_exact(columns) {
            if row.iter().all(|&v| v == 0.0) {
                masses.push(0.0);
                rows.push(None);
            } else {
                let row = Piecewise1d::new(row)?;
                masses.push(row.cells.sum());
                rows.push(Some(row));
            }
        }
        Ok(Self { marginal: Discrete::new(&masses)?, rows })
    }

    /// Maps `u` in [0, 1)² to a point in [0, 1)² of this density: the row by `u[1]`, the column by `u[0]`.
    ///
    /// Returns: the point and its density.
    ///
    /// # Measure
    /// Per unit of the square's area.
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let chosen = self.marginal.sample(u[1]);
        let row = self.rows[chosen.index].as_ref().expect("a row of probability above 0 has mass");
        let (x, pdf_x) = row.sample(u[0]);
        let y = position(chosen.index, chosen.u, self.rows.len());
        ([x, y], pdf_x * self.row_density(chosen.index))
    }

    /// The density at `point`; 0 outside [0, 1)².
    ///
    /// # Measure
    /// Per unit of the square's area.
    pub fn pdf(&self, point: [f32; 2]) -> f32 {
        let Some(index) = cell(point[1], self.rows.len()) else { return 0.0 };
        self.rows[index].as_ref().map_or(0.0, |row| row.pdf(point[0]) * self.row_density(index))
    }

    fn row_density(&self, index: usize) -> f32 {
        self.marginal.pmf(index) * self.rows.len() as f32
    }
}

/// The position at `u` of [0, 1) in cell `index` of `count`, below the cell's upper end after rounding.
fn position(index: usize, u: f32, count: usize) -> f32 {
    let exact = (index as f64 + f64::from(u)) / count as f64;
    let end = round_f32((index + 1) as f64 / count as f64).next_down();
    round_f32(exact).min(end).min(ONE_MINUS_EPSILON)
}

/// The cell of `count` that holds `x`.
fn cell(x: f32, count: usize) -> Option<usize> {
    if !(0.0..1.0).contains(&x) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "below count, because x is below 1")]
    let index = (f64::from(x) * count as f64) as usize;
    Some(index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_dimension() {
        let density = Piecewise1d::new(&[1.0, 0.0, 3.0, 0.0]).unwrap();
        assert_eq!(density.sample(0.0), (0.0, 1.0));
        assert_eq!(density.sample(0.125), (0.125, 1.0));
        assert_eq!(density.sample(0.25), (0.5, 3.0));
        assert_eq!([0.1, 0.3, 0.6, 0.9, 1.0, -0.1].map(|x| density.pdf(x)), [1.0, 0.0, 3.0, 0.0, 0.0, 0.0]);
        let (last, pdf) = density.sample(ONE_MINUS_EPSILON);
        assert!(last < 0.75 && pdf == 3.0, "{last}");
    }

    #[test]
    fn two_dimensions() {
        let density = Piecewise2d::new(&[1.0, 3.0, 0.0, 0.0, 2.0, 2.0], 2).unwrap();
        assert_eq!(density.sample([0.125, 0.25]), ([0.25, 1.0 / 6.0], 0.75));
        assert_eq!(density.pdf([0.75, 0.1]), 2.25);
        assert_eq!(density.pdf([0.75, 0.5]), 0.0);
        assert_eq!(density.pdf([1.0, 0.5]), 0.0);
    }

    #[test]
    fn the_sampled_density_is_the_density_and_integrates_to_one() {
        let values: Vec<f64> = (0..7 * 5_u8).map(|k| f64::from(k % 4)).collect();
        let density = Piecewise2d::new(&values, 7).unwrap();
        let mut integral = 0.0;
        for k in 0..35 * 4_usize {
            let point = [(k % 14) as f32 / 14.0 + 1.0 / 28.0, (k / 14) as f32 / 10.0 + 0.05];
            integral += f64::from(density.pdf(point)) / 140.0;
            let (point, pdf) = density.sample(point);
            assert_eq!(density.pdf(point), pdf, "{point:?}");
        }
        // Each density is two products of two rounded shares: four roundings of 2⁻²⁴.
        assert!((integral - 1.0).abs() < 2.0_f64.powi(-22), "{integral}");
    }

    #[test]
    fn bad_values_are_refused() {
        assert!(matches!(Piecewise2d::new(&[1.0; 5], 2), Err(ParamError::OutOfRange { .. })));
        assert!(matches!(Piecewise2d::new(&[1.0; 4], 0), Err(ParamError::OutOfRange { .. })));
        assert!(matches!(Piecewise2d::new(&[0.0; 4], 2), Err(ParamError::Empty { .. })));
        assert!(matches!(Piecewise1d::new(&[f64::INFINITY]), Err(ParamError::NotFinite { .. })));
    }
}
