//! Correlated multi-jittered points: one in each cell of a grid, each in a row and a column of its own.

use super::hash::{Key, halves};
use super::permutation::permuted;
use super::stratified::{in_cell, permutation};
use super::{Decision, SampleId, Sampler, Vertex};

/// Multi-jittered numbers for a given number of samples.
///
/// A decision of two dimensions has a grid of a = ⌊√n⌋ columns and b = ⌈n/a⌉ rows, cut into ab fine columns and rows.
/// Each of n samples goes to a cell of its own, chosen by a permutation of all ab, so that each alone is uniform. In its
/// coarse column it takes the fine one that a permutation gives its row, and in its row the fine one that another gives
/// its column: the same permutation for all columns, which keeps neighbours apart. A decision of one dimension has n
/// strata for n samples. Samples beyond n start a fresh set.
///
/// # Precision, limits
/// Indices below 2³⁰; 24 binary digits. Where n is not ab, ab − n < a cells, fine rows and fine columns stay empty.
///
/// # Source
/// Kensler 2013, "Correlated multi-jittered sampling", Pixar TM 13-01, which fills the first n cells in their order
/// instead, so that its samples are not uniform one by one where n is not ab.
///
/// # Verified by
/// `sampling::multijitter::tests`; claims `sampler/multijitter/*`
#[derive(Debug, Clone, Copy)]
pub struct MultiJitter {
    key: Key,
    samples: u32,
    columns: u32,
    rows: u32,
}

impl MultiJitter {
    /// The sampler of `seed` for `samples` per pixel and replicate; 0 counts as 1.
    pub const fn new(seed: u64, samples: u32) -> Self {
        let samples = if samples == 0 { 1 } else { samples };
        let columns = samples.isqrt();
        Self { key: Key::of_seed(seed, 4), samples, columns, rows: samples.div_ceil(columns) }
    }

    /// The coarse grid of a decision of two dimensions: columns and rows.
    pub const fn grid(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }
}

impl Sampler for MultiJitter {
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
        let (columns, rows) = (self.columns, self.rows);
        let cells = columns * rows;
        let cell = permuted(index, cells, permutation(key, set, 0));
        let (column, row) = (cell % columns, cell / columns);
        let fine_x = column * rows + permuted(row, rows, permutation(key, set, 1));
        let fine_y = row * columns + permuted(column, columns, permutation(key, set, 2));
        let [jitter_x, jitter_y] = halves(key.bits(sample.index));
        [in_cell(fine_x, cells, jitter_x), in_cell(fine_y, cells, jitter_y)]
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "cells of a grid")]
mod tests {
    use super::*;

    fn points(n: u32, set: u32) -> Vec<[f32; 2]> {
        let sampler = MultiJitter::new(7, n);
        let sample = |index| SampleId { pixel: [1, 2], replicate: 0, index };
        let draw = |i| sampler.draw_2d(sample(set * n + i), Vertex::default(), Decision::Lens);
        (0..n).map(draw).collect()
    }

    /// How often each of `cells` is hit.
    fn counts(cells: u32, hits: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut counts = vec![0; cells as usize];
        hits.for_each(|hit| counts[hit as usize] += 1);
        counts
    }

    #[test]
    fn each_cell_fine_row_and_fine_column_has_at_most_one_point() {
        for (n, set) in [1, 2, 3, 5, 7, 12, 16, 17, 23, 64, 100].into_iter().flat_map(|n| [(n, 0), (n, 3)]) {
            let [columns, rows] = MultiJitter::new(7, n).grid();
            let cells = columns * rows;
            assert!(cells >= n && cells < n + columns, "{n}");
            let points = points(n, set);
            let at = |u: f32, parts: u32| (f64::from(u) * f64::from(parts)) as u32;
            let grid = points.iter().map(|&[x, y]| at(y, rows) * columns + at(x, columns));
            let fine = |axis: usize| points.iter().map(move |p| at(p[axis], cells));
            for counts in [counts(cells, grid), counts(cells, fine(0)), counts(cells, fine(1))] {
                assert!(counts.iter().all(|&c| c <= 1) && counts.iter().sum::<u32>() == n, "{n}: {counts:?}");
            }
        }
    }

    #[test]
    fn sets_differ() {
        assert_ne!(points(16, 0), points(16, 1));
    }
}
