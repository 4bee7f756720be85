//! Owen-scrambled Halton points: one joint set before the first bounce, padded pairs after it.

use super::hash::{Key, halves};
use super::owen::scramble_reversed;
use super::permutation::below;
use super::stratified::in_cell;
use super::{Decision, DecisionSet, SampleId, Sampler, Vertex};
use crate::math::float::unit_f32;

/// The bases of the joint set's dimensions: all twelve numbers of a camera ray.
const BASES: [u32; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// The order of a padded set: a counter of its key; its dimensions' scramblings are branches 0 and 1.
const SHUFFLE: u32 = 2;

/// Numbers whose every run of 2ᵃ·3ᵇ samples fills the cells of a grid of 2ᵃ by 3ᵇ, and so on in further bases.
///
/// The planned decisions at [`Vertex::default`] are the dimensions of one Halton sequence, in the order of
/// [`Decision::ALL`] and the bases 2, 3, 5, 7 and on, with the ranks closed over those that are not planned. Every other
/// decision or vertex has the bases 2 and 3 in an order of its own. The digits of each dimension of each pixel,
/// replicate, vertex and decision are permuted at random, each by a permutation that depends on the digits before it.
///
/// # Precision, limits
/// 24 binary digits. Digits are followed as far as tells apart the number of samples that the sampler is made for;
/// below them numbers are random. Samples beyond that number remain uniform, and even to those digits.
///
/// # Source
/// Halton 1960, doi 10.1007/BF01386213; nested scrambling: Owen 1995, doi 10.1007/978-1-4612-2552-2_19. A digit d goes
/// to (a·d + b) mod p with random a ≠ 0 and b: each two digits go to each two equally often, on which alone means and
/// variances depend. Shuffled padded pairs: as in `Sobol`.
///
/// # Verified by
/// `sampling::halton::tests`; claims `sampler/halton/*`
#[derive(Debug, Clone, Copy)]
pub struct Halton {
    key: Key,
    /// The first dimension of each decision in the joint set.
    ranks: [Option<u8>; Decision::ALL.len()],
    /// Digits of each base.
    digits: [u8; BASES.len()],
    /// Binary digits of an index in a padded set.
    bits: u32,
}

impl Halton {
    /// The sampler of `seed` for `samples` per pixel and replicate, with the joint set for the decisions `planned`
    /// before the first bounce.
    pub fn new(seed: u64, planned: DecisionSet, samples: u32) -> Self {
        let mut ranks = [None; Decision::ALL.len()];
        let mut dimensions = 0_u8;
        for decision in planned.iter() {
            ranks[decision as usize] = Some(dimensions);
            dimensions += if decision.dimensions() == 2 { 2 } else { 1 };
        }
        let bits = samples.max(2).saturating_sub(1).ilog2() + 1;
        // Twice the samples: the order of a padded set takes indices up to the next power of two.
        let enough = |base: u32| (1..).find(|&k| reaches(base, k, 1 << bits.min(31))).unwrap_or(1);
        Self { key: Key::of_seed(seed, 5), ranks, digits: BASES.map(enough), bits }
    }

    /// The base's place in [`BASES`] of the decision's first dimension in the joint set; `None` for a padded one.
    #[inline]
    fn joint_rank(&self, vertex: Vertex, decision: Decision) -> Option<usize> {
        if vertex == Vertex::default() { self.ranks[decision as usize].map(usize::from) } else { None }
    }

    /// The place of a padded set's sample in the sequence: aligned runs of 2ᵐ samples are runs of the sequence.
    #[inline]
    fn shuffled(&self, index: u32, key: Key) -> u32 {
        let unused = 32 - self.bits;
        let (block, within) = (index >> (self.bits - 1) >> 1, index << unused);
        let place = scramble_reversed(within.reverse_bits(), key.child(block).bits(SHUFFLE)).reverse_bits();
        // Samples beyond the number planned for repeat the places with other digits.
        place >> unused
    }

    /// The number of a dimension of the `rank`-th base.
    #[inline]
    fn number(&self, index: u32, rank: usize, key: Key) -> f32 {
        match rank {
            0 => unit_f32(scramble_reversed(index, key.bits(0)).reverse_bits()),
            _ => radical_inverse(index, BASES[rank], self.digits[rank], key),
        }
    }
}

/// Whether `digits` digits of `base` tell `count` numbers apart, or one more would not fit into 32 bits.
fn reaches(base: u32, digits: u8, count: u32) -> bool {
    let cells = u64::from(base).pow(u32::from(digits));
    cells >= u64::from(count) || cells * u64::from(base) > u64::from(u32::MAX)
}

/// The mirrored digits of `index`, each permuted by what the digits before it name, and a random rest.
#[inline]
fn radical_inverse(mut index: u32, base: u32, digits: u8, key: Key) -> f32 {
    let (mut mirrored, mut cells, mut node) = (0, 1, key);
    for _ in 0..digits {
        let digit = index % base;
        index /= base;
        let [a, b] = halves(node.bits(base));
        let (a, b) = (1 + below(a, base - 1), below(b, base));
        mirrored = mirrored * base + (a * digit + b) % base;
        cells *= base;
        node = node.child(digit);
    }
    in_cell(mirrored, cells, halves(node.bits(index))[1])
}

impl Sampler for Halton {
    #[inline]
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        let key = self.key.sample_set(sample).decision(vertex, decision);
        match self.joint_rank(vertex, decision) {
            Some(rank) => self.number(sample.index, rank, key),
            None => self.number(
                self.shuffled(sample.index, key),
                0,
                key.child(sample.index >> (self.bits - 1) >> 1),
            ),
        }
    }

    #[inline]
    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        let key = self.key.sample_set(sample).decision(vertex, decision);
        let (index, rank, key) = match self.joint_rank(vertex, decision) {
            Some(rank) => (sample.index, rank, key),
            None => (self.shuffled(sample.index, key), 0, key.child(sample.index >> (self.bits - 1) >> 1)),
        };
        [(0, 0), (1, 1)].map(|(k, child)| self.number(index, rank + k, key.child(child)))
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "cells of a grid")]
mod tests {
    use super::*;

    fn cell(u: f32, cells: u32) -> u32 {
        // A cell's lower edge is cut down to 24 digits, by which it may fall into the cell below.
        ((f64::from(u) + 2.0_f64.powi(-25)) * f64::from(cells)) as u32
    }

    /// Whether each cell of a grid in two dimensions has one of the points.
    fn fills(points: &[[f32; 2]], columns: u32, rows: u32) -> bool {
        let mut counts = vec![0; (columns * rows) as usize];
        for &[x, y] in points {
            counts[(cell(y, rows) * columns + cell(x, columns)) as usize] += 1;
        }
        counts.iter().all(|&c| c == 1)
    }

    fn draw(sampler: &Halton, index: u32, vertex: Vertex, decision: Decision) -> [f32; 2] {
        let sample = SampleId { pixel: [3, 8], replicate: 1, index };
        match decision.dimensions() {
            1 => [sampler.draw_1d(sample, vertex, decision), 0.0],
            _ => sampler.draw_2d(sample, vertex, decision),
        }
    }

    #[test]
    fn every_run_fills_its_grid() {
        let sampler = Halton::new(2, DecisionSet::FULL, 1024);
        let vertex = Vertex::default();
        for (columns, rows) in [(2, 3), (4, 9), (8, 3), (1, 27), (16, 9), (8, 81)] {
            for block in 0..1024 / (columns * rows) {
                let run = block * columns * rows..(block + 1) * columns * rows;
                let pixel: Vec<_> = run.map(|i| draw(&sampler, i, vertex, Decision::Pixel)).collect();
                assert!(fills(&pixel, columns, rows), "{columns} × {rows}, block {block}");
            }
        }
        let lens: Vec<_> = (0..35).map(|i| draw(&sampler, i, vertex, Decision::Lens)).collect();
        assert!(fills(&lens, 5, 7), "the lens has the bases 5 and 7");
    }

    #[test]
    fn padded_pairs_are_runs_of_the_sequence() {
        let sampler = Halton::new(5, DecisionSet::EMPTY, 64);
        let later = Vertex { bounce: 2, ..Vertex::default() };
        let points: Vec<_> = (0..64).map(|i| draw(&sampler, i, later, Decision::Direction)).collect();
        assert!(fills(&points, 64, 1), "64 intervals of the first number");
        let single: Vec<_> = (0..64).map(|i| draw(&sampler, i, later, Decision::Lobe)).collect();
        assert!(fills(&single, 64, 1), "64 intervals of a single number");
        // 64 of 81 cells of the second number, each at most once.
        let mut cells: Vec<u32> = points.iter().map(|p| cell(p[1], 81)).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 64);
    }

    #[test]
    fn samples_beyond_those_planned_for_are_other_points() {
        let sampler = Halton::new(0, DecisionSet::EMPTY, 16);
        let at = |i| draw(&sampler, i, Vertex::default(), Decision::Lens);
        assert!((0..16).all(|i| at(i) != at(i + 16)));
    }
}
