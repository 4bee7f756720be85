//! Jittered points: one in each stratum, the strata of different decisions in independent orders.

use super::hash::{Key, halves};
use super::permutation::permuted;
use super::{Decision, SampleId, Sampler, Vertex};
use crate::math::float::unit_f32;

/// Stratified numbers for a given number of samples.
///
/// A decision of one dimension has n strata for n samples. One of two dimensions has a grid of a = ⌊√n⌋ columns and
/// b = ⌊n/a⌋ rows; the n − ab < a samples left over go to different cells of it, by a second permutation, and which
/// samples those are is random too. So each sample alone is uniform whatever n, and a square n gives the n-by-n
/// grid of the textbook. Samples beyond n start a fresh set.
///
/// # Precision, limits
/// Indices below 2³¹; 24 binary digits.
///
/// # Source
/// Cook 1986, "Stochastic sampling in computer graphics", doi 10.1145/7529.8927; pairing strata of several
/// decisions at random: Cook, Porter and Carpenter 1984, doi 10.1145/800031.808590.
///
/// # Verified by
/// `sampling::stratified::tests`; claims `sampler/stratified/*`
#[derive(Debug, Clone, Copy)]
pub struct Stratified {
    key: Key,
    samples: u32,
    columns: u32,
    rows: u32,
}

impl Stratified {
    /// The sampler of `seed` for `samples` per pixel and replicate; 0 counts as 1.
    pub const fn new(seed: u64, samples: u32) -> Self {
        let samples = if samples == 0 { 1 } else { samples };
        let columns = samples.isqrt();
        Self { key: Key::of_seed(seed, 2), samples, columns, rows: samples / columns }
    }

    /// The grid of a decision of two dimensions: columns and rows.
    pub const fn grid(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }
}

/// The permutations of a set, up to four: counters of its key from the upper end, where no sample's index is.
pub(super) const fn permutation(key: Key, set: u32, which: u32) -> u64 {
    key.bits(u32::MAX - set.wrapping_mul(4) - which)
}

/// The number in [0, 1) at `jitter` of 2³² in the cell `cell` of `cells` equal ones; never 1.
#[inline]
pub(super) fn in_cell(cell: u32, cells: u32, jitter: u32) -> f32 {
    let fixed = ((cell as u64) << 32 | jitter as u64) / cells as u64;
    unit_f32(halves(fixed)[0])
}

impl Sampler for Stratified {
    #[inline]
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        let key = self.key.sample_set(sample).decision(vertex, decision);
        let (set, index) = (sample.index / self.samples, sample.index % self.samples);
        let stratum = permuted(index, self.samples, permutation(key, set, 0));
        in_cell(stratum, self.samples, halves(key.bits(sample.index))[1])
    }

    #[inline]
    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        let key = self.key.sample_set(sample).decision(vertex, decision);
        let (set, index) = (sample.index / self.samples, sample.index % self.samples);
        let cells = self.columns * self.rows;
        let place = permuted(index, self.samples, permutation(key, set, 0));
        let cell =
            if place < cells { place } else { permuted(place - cells, cells, permutation(key, set, 1)) };
        let [jitter_x, jitter_y] = halves(key.bits(sample.index));
        let (column, row) = (cell % self.columns, cell / self.columns);
        [in_cell(column, self.columns, jitter_x), in_cell(row, self.rows, jitter_y)]
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "cells of a grid")]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON;

    fn sample(index: u32) -> SampleId {
        SampleId { pixel: [1, 2], replicate: 0, index }
    }

    #[test]
    fn the_grid_rule() {
        let grids = [1, 2, 3, 4, 5, 8, 16, 17, 64, 100].map(|n| Stratified::new(0, n).grid());
        assert_eq!(grids, [[1, 1], [1, 2], [1, 3], [2, 2], [2, 2], [2, 4], [4, 4], [4, 4], [8, 8], [10, 10]]);
        assert_eq!(Stratified::new(0, 0).grid(), [1, 1]);
    }

    #[test]
    fn each_cell_has_a_point_and_those_left_over_have_different_cells() {
        for n in [1, 2, 3, 5, 7, 16, 17, 23, 64] {
            let sampler = Stratified::new(4, n);
            let [columns, rows] = sampler.grid();
            let mut counts = vec![0; (columns * rows) as usize];
            for index in 0..n {
                let [x, y] = sampler.draw_2d(sample(index), Vertex::default(), Decision::Lens);
                let (column, row) = ((x * columns as f32) as u32, (y * rows as f32) as u32);
                counts[(row * columns + column) as usize] += 1;
            }
            let more = counts.iter().filter(|&&c| c == 2).count();
            assert!(counts.iter().all(|&c| c == 1 || c == 2), "{n}: {counts:?}");
            assert_eq!(more, (n - columns * rows) as usize, "{n}");
        }
    }

    #[test]
    fn one_dimension_has_as_many_strata_as_samples_in_every_set() {
        let sampler = Stratified::new(0, 37);
        for set in 0..3_u32 {
            let number = |i: u32| sampler.draw_1d(sample(37 * set + i), Vertex::default(), Decision::Time);
            let mut strata: Vec<u32> = (0..37).map(|i| (number(i) * 37.0) as u32).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..37));
        }
    }

    #[test]
    fn the_ends_of_the_interval() {
        assert_eq!(in_cell(0, 3, 0), 0.0);
        for cells in [1, 3, 1_000, u32::MAX] {
            assert_eq!(in_cell(cells - 1, cells, u32::MAX), ONE_MINUS_EPSILON, "{cells}");
        }
    }

    #[test]
    fn decisions_have_their_own_orders() {
        let sampler = Stratified::new(0, 64);
        let order = |decision, vertex| -> Vec<u32> {
            (0..64).map(|i| (sampler.draw_1d(sample(i), vertex, decision) * 64.0) as u32).collect()
        };
        let later = Vertex { bounce: 1, ..Vertex::default() };
        assert_ne!(order(Decision::Time, Vertex::default()), order(Decision::Lobe, Vertex::default()));
        assert_ne!(order(Decision::Time, Vertex::default()), order(Decision::Time, later));
    }
}
