//! Counts of points on a grid over the unit square, with cells for atoms, for what was discarded and for what fell outside.

/// Counts of points by cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    shape: [usize; 2],
    counts: Vec<u64>,
    discarded: u64,
    atoms: Vec<u64>,
    outside: u64,
}

impl Histogram {
    /// An empty histogram of that many columns and rows.
    pub fn new(shape: [usize; 2]) -> Self {
        Self::with_atoms(shape, 0)
    }

    /// An empty histogram, with counts of that many atoms beside the cells.
    pub fn with_atoms(shape: [usize; 2], atoms: usize) -> Self {
        Self { shape, counts: vec![0; shape[0] * shape[1]], discarded: 0, atoms: vec![0; atoms], outside: 0 }
    }

    /// Counts a point by its coordinates on the unit square, as
    /// [`Domain::to_square`](crate::domain::Domain::to_square) gives them; `None`, or coordinates out of [0,
    /// 1), are outside.
    #[inline]
    pub fn add(&mut self, square: Option<[f64; 2]>) {
        let [columns, rows] = self.shape;
        match square {
            Some([x, y]) if (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) => {
                self.counts[cell(y, rows) * columns + cell(x, columns)] += 1;
            }
            _ => self.outside += 1,
        }
    }

    /// Counts a sample that the subject discarded on purpose.
    #[inline]
    pub fn add_discarded(&mut self) {
        self.discarded += 1;
    }

    /// Counts a sample at an atom; one at an atom that the histogram does not have is outside.
    #[inline]
    pub fn add_atom(&mut self, atom: usize) {
        *self.atoms.get_mut(atom).unwrap_or(&mut self.outside) += 1;
    }

    /// Columns and rows.
    pub fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// Counts of the cells, row by row.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// Number of samples that the subject discarded.
    pub fn discarded(&self) -> u64 {
        self.discarded
    }

    /// Numbers of samples at the atoms.
    pub fn atoms(&self) -> &[u64] {
        &self.atoms
    }

    /// Number of points outside the domain.
    pub fn outside(&self) -> u64 {
        self.outside
    }

    /// Number of all samples, those at atoms, discarded and outside ones included.
    pub fn total(&self) -> u64 {
        self.counts.iter().chain(&self.atoms).sum::<u64>() + self.discarded + self.outside
    }
}

/// Sums blocks of cells, row by row, into the cells of a grid that is coarser by whole factors.
///
/// * `fine`: values of a grid of `shape` times `factor`.
pub(crate) fn coarsen<T: Copy + Default + std::ops::AddAssign>(
    fine: &[T],
    shape: [usize; 2],
    factor: [usize; 2],
) -> Vec<T> {
    let mut coarse = vec![T::default(); shape[0] * shape[1]];
    let columns = shape[0] * factor[0];
    for (index, &value) in fine.iter().enumerate() {
        let (column, row) = (index % columns, index / columns);
        coarse[row / factor[1] * shape[0] + column / factor[0]] += value;
    }
    coarse
}

/// Which of `count` equal parts of [0, 1) a coordinate of [0, 1) is in.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "x is in [0, 1), so the product is in [0, count]"
)]
fn cell(x: f64, count: usize) -> usize {
    ((x * count as f64) as usize).min(count - 1) // the product rounds up to `count` for the last x below 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_counted_once() {
        let mut histogram = Histogram::new([2, 3]);
        let below_one = 1.0 - f64::EPSILON / 2.0;
        for square in [
            Some([0.0, 0.0]),
            Some([0.5, 0.0]),
            Some([below_one, below_one]),
            None,
            Some([1.0, 0.5]),
            Some([f64::NAN, 0.5]),
        ] {
            histogram.add(square);
        }
        histogram.add_discarded();
        assert_eq!(histogram.counts(), [1, 1, 0, 0, 0, 1]);
        assert_eq!((histogram.outside(), histogram.discarded(), histogram.total()), (3, 1, 7));
        let mut atoms = Histogram::with_atoms([1, 1], 2);
        [0, 1, 1, 2].into_iter().for_each(|atom| atoms.add_atom(atom));
        assert_eq!((atoms.atoms(), atoms.outside(), atoms.total()), (&[1, 2][..], 1, 4));
    }

    #[test]
    fn coarse_cells_are_sums_of_blocks() {
        let fine: Vec<u64> = (0..24).collect(); // 6 columns, 4 rows
        assert_eq!(coarsen(&fine, [3, 2], [2, 2]), [14, 22, 30, 62, 70, 78]);
        assert_eq!(coarsen(&fine, [6, 1], [1, 4]), [36, 40, 44, 48, 52, 56]);
    }
}
