//! Owen-scrambled Sobol points: one joint set up to the second hit, padded sets after it.

use super::hash::Key;
use super::owen::scramble_reversed;
use super::sobol_matrix::{DIMENSIONS, Dimension, second_dimension_reversed};
use super::{Decision, DecisionSet, Place, SampleId, Sampler, Vertex};
use crate::math::float::unit_f32;

/// What the two numbers and the order of a set are scrambled by: counters of its key.
const SCRAMBLE: [u32; 2] = [0, 1];
const SHUFFLE: u32 = 2;

/// Numbers whose first 2ᵐ samples fill every decision's interval or square evenly.
///
/// The planned decisions at [`Vertex::default`], and after them those at the second hit as far as there are dimensions, are the
/// dimensions of one Sobol sequence, in the order of [`Decision::ALL`] with the ranks closed over those that are not
/// planned. Every other decision or vertex has a set of its own, the first one or two dimensions in an order of its own. Each dimension of each pixel, replicate,
/// vertex and decision is scrambled independently, so that every number is uniform over scramblings and the error
/// can be taken from replicates.
///
/// # Precision, limits
/// Indices below 2³²; 24 digits. The first two dimensions of the joint set and every padded pair are
/// (0, m, 2)-nets for each m; of the other pairs, that of worst balance at 256 points has t = 4, and with the second hit's t = 5.
///
/// # Source
/// Sobol' 1967, doi 10.1016/0041-5553(67)90144-9; Owen 1995, "Randomly permuted (t,m,s)-nets and (t,s)-sequences",
/// doi 10.1007/978-1-4612-2552-2_19; padding and shuffling: Burley 2020, "Practical hash-based Owen scrambling",
/// JCGT 9(4), section 4. One set for all decisions of a camera ray instead of padded pairs is our divergence.
///
/// # Verified by
/// `sampling::sobol::tests`; claims `sampler/sobol/*`
#[derive(Debug, Clone)]
pub struct Sobol {
    key: Key,
    joint: Vec<Dimension>,
    /// The first dimension in the joint set of each decision before the first bounce and at the second hit.
    ranks: [[Option<u8>; Decision::ALL.len()]; 2],
}

impl Sobol {
    /// The sampler of `seed` with the joint set for the decisions `planned` before the first bounce.
    pub fn new(seed: u64, planned: DecisionSet) -> Self {
        let ranks = [[None; Decision::ALL.len()]; 2];
        Self { key: Key::of_seed(seed, 3), joint: Vec::new(), ranks }.joined_by(0, planned)
    }

    /// The sampler whose joint set has the decisions `planned` at the second hit, too, as far as there are dimensions.
    #[must_use]
    pub fn with_second_hit(self, planned: DecisionSet) -> Self {
        self.joined_by(1, planned)
    }

    fn joined_by(mut self, bounce: usize, planned: DecisionSet) -> Self {
        for decision in planned.iter() {
            let first = self.joint.len();
            let end = first + decision.dimensions();
            if end <= DIMENSIONS {
                self.ranks[bounce][decision as usize] = u8::try_from(first).ok();
                self.joint.extend((self.joint.len()..end).map(Dimension::new));
            }
        }
        self
    }

    /// The set of a pixel's replicate that a decision takes its numbers from.
    #[inline]
    fn set(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> Set<'_> {
        let key = self.key.sample_set(sample).decision(vertex, decision);
        let ranks = self.ranks.get(usize::from(vertex.bounce));
        let is_plain = vertex == Vertex { bounce: vertex.bounce, ..Vertex::default() };
        let rank = ranks.filter(|_| is_plain).and_then(|ranks| ranks[decision as usize]);
        let joint = rank.map(|rank| &self.joint[usize::from(rank)..]);
        Set { joint, shuffle: key.bits(SHUFFLE), scrambles: [key.bits(SCRAMBLE[0]), key.bits(SCRAMBLE[1])] }
    }
}

/// One or two dimensions with their scrambling.
#[derive(Debug, Clone, Copy)]
struct Set<'a> {
    /// The dimensions of the joint set from the decision's first on; `None` for a padded set.
    joint: Option<&'a [Dimension]>,
    /// Of a padded set's order, and of the numbers.
    shuffle: u64,
    scrambles: [u64; 2],
}

impl Set<'_> {
    /// The first dimension's digits of the point `index`, in reverse.
    #[inline]
    fn first_digits(&self, index: u32) -> u32 {
        match self.joint {
            Some(joint) => joint[0].digits_reversed(index),
            None => shuffled(index, self.shuffle),
        }
    }

    /// Both dimensions' digits of the point `index`, in reverse.
    #[inline]
    fn digits(&self, index: u32) -> [u32; 2] {
        match self.joint {
            Some(joint) => [joint[0].digits_reversed(index), joint[1].digits_reversed(index)],
            None => {
                let index = shuffled(index, self.shuffle);
                [index, second_dimension_reversed(index)]
            }
        }
    }
}

/// The place of a padded set's sample in the sequence.
///
/// The order is a nested scrambling of the index, so that 2ᵐ aligned samples remain 2ᵐ aligned points.
#[inline]
fn shuffled(index: u32, seed: u64) -> u32 {
    scramble_reversed(index.reverse_bits(), seed).reverse_bits()
}

/// The number in [0, 1) of scrambled digits.
#[inline]
fn finished(digits_reversed: u32, seed: u64) -> f32 {
    unit_f32(scramble_reversed(digits_reversed, seed).reverse_bits())
}

/// Points of one set that are made together: a loop over so many becomes one of vectors.
const TOGETHER: usize = 16;

/// The numbers of the first `count` digits, and of a few more, so that whole vectors are made.
#[inline]
fn finished_each(digits: &[u32; TOGETHER], count: usize, seed: u64) -> [f32; TOGETHER] {
    let mut numbers = [0.0; TOGETHER];
    let end = count.next_multiple_of(8);
    for (number, digits) in numbers[..end].iter_mut().zip(&digits[..end]) {
        *number = finished(*digits, seed);
    }
    numbers
}

impl Sampler for Sobol {
    #[inline]
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        debug_assert_eq!(decision.dimensions(), 1, "{decision:?}");
        let set = self.set(sample, vertex, decision);
        finished(set.first_digits(sample.index), set.scrambles[0])
    }

    #[inline]
    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        debug_assert_eq!(decision.dimensions(), 2, "{decision:?}");
        let set = self.set(sample, vertex, decision);
        let [x, y] = set.digits(sample.index);
        [finished(x, set.scrambles[0]), finished(y, set.scrambles[1])]
    }

    fn draw_1d_each(&self, places: &[Place], decision: Decision, out: &mut Vec<f32>) {
        debug_assert_eq!(decision.dimensions(), 1, "{decision:?}");
        out.clear();
        for run in places.chunk_by(Place::shares_set) {
            let set = self.set(run[0].sample, run[0].vertex, decision);
            for part in run.chunks(TOGETHER) {
                let mut digits = [0; TOGETHER];
                for (digits, place) in digits.iter_mut().zip(part) {
                    *digits = set.first_digits(place.sample.index);
                }
                out.extend(&finished_each(&digits, part.len(), set.scrambles[0])[..part.len()]);
            }
        }
    }

    fn draw_2d_each(&self, places: &[Place], decision: Decision, out: &mut Vec<[f32; 2]>) {
        debug_assert_eq!(decision.dimensions(), 2, "{decision:?}");
        out.clear();
        for run in places.chunk_by(Place::shares_set) {
            let set = self.set(run[0].sample, run[0].vertex, decision);
            for part in run.chunks(TOGETHER) {
                let mut digits = [[0; TOGETHER]; 2];
                for (k, place) in part.iter().enumerate() {
                    [digits[0][k], digits[1][k]] = set.digits(place.sample.index);
                }
                let [x, y] = [0, 1].map(|axis| finished_each(&digits[axis], part.len(), set.scrambles[axis]));
                out.extend((0..part.len()).map(|k| [x[k], y[k]]));
            }
        }
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "cells of a grid and small counts")]
mod tests {
    use super::*;

    /// The least t for which the 2ᵐ points are a (t, m, 2)-net: boxes of area 2^(t − m) hold 2ᵗ points each.
    fn balance(points: &[[f32; 2]]) -> u32 {
        let m = points.len().ilog2();
        let is_net = |t: u32| (0..=m - t).all(|across| boxes_hold(points, across, m - t - across, 1 << t));
        (0..=m).find(|&t| is_net(t)).expect("one box holds all points")
    }

    fn boxes_hold(points: &[[f32; 2]], across: u32, up: u32, count: u32) -> bool {
        let mut counts = vec![0; 1 << (across + up)];
        for [x, y] in points {
            let column = (x * (1 << across) as f32) as usize;
            let row = (y * (1 << up) as f32) as usize;
            counts[row << across | column] += 1;
        }
        counts.iter().all(|&c| c == count)
    }

    fn sample(index: u32) -> SampleId {
        SampleId { pixel: [11, 5], replicate: 2, index }
    }

    /// All numbers of one sample up to the second hit, in the order of their dimensions.
    fn joint_numbers(sampler: &Sobol, index: u32, planned: [DecisionSet; 2]) -> Vec<f32> {
        let numbers = |vertex: Vertex, d: Decision| match d.dimensions() {
            1 => vec![sampler.draw_1d(sample(index), vertex, d)],
            _ => sampler.draw_2d(sample(index), vertex, d).to_vec(),
        };
        let second = Vertex { bounce: 1, ..Vertex::default() };
        let [first, later] = planned.map(DecisionSet::iter);
        let first = first.flat_map(|d| numbers(Vertex::default(), d));
        first.chain(later.flat_map(|d| numbers(second, d))).collect()
    }

    #[test]
    fn scrambling_keeps_the_balance_of_every_pair_of_the_joint_set() {
        const POINTS: u32 = 256;
        let later = DecisionSet::EMPTY.with(Decision::LightPoint).with(Decision::Direction);
        let sampler = Sobol::new(3, DecisionSet::FULL).with_second_hit(later);
        let ours: Vec<_> =
            (0..POINTS).map(|i| joint_numbers(&sampler, i, [DecisionSet::FULL, later])).collect();
        assert_eq!(ours[0].len(), DIMENSIONS);
        let plain = |i: u32, d: usize| {
            unit_f32(sobol_burley::parts::sobol_rev(i.reverse_bits(), d as u32).reverse_bits())
        };
        let mut worst = [0; 2];
        for (a, b) in (0..DIMENSIONS).flat_map(|a| (0..a).map(move |b| (a, b))) {
            let scrambled: Vec<_> = ours.iter().map(|p| [p[a], p[b]]).collect();
            let unscrambled: Vec<_> = (0..POINTS).map(|i| [plain(i, a), plain(i, b)]).collect();
            assert_eq!(balance(&scrambled), balance(&unscrambled), "dimensions {a} and {b}");
            let worst = &mut worst[usize::from(a >= 12)];
            *worst = balance(&scrambled).max(*worst);
        }
        assert_eq!(worst, [4, 5], "the worst pair's t before the first bounce, and with the second hit's");
    }

    #[test]
    fn first_pair_and_padded_pairs_are_perfect_nets() {
        let sampler = Sobol::new(0, DecisionSet::FULL);
        let split = Vertex { split: 1, ..Vertex::default() };
        let later = Vertex { bounce: 2, ..Vertex::default() };
        for (vertex, decision) in [
            (Vertex::default(), Decision::Pixel),
            (split, Decision::LightPoint),
            (later, Decision::Direction),
        ] {
            let points: Vec<_> = (0..1024).map(|i| sampler.draw_2d(sample(i), vertex, decision)).collect();
            for m in 0..=10 {
                assert_eq!(balance(&points[..1 << m]), 0, "{vertex:?}, {decision:?}, 2^{m} points");
            }
        }
    }

    #[test]
    fn ranks_close_over_what_is_not_planned() {
        let planned = DecisionSet::EMPTY.with(Decision::LightPoint).with(Decision::Time);
        let sampler = Sobol::new(0, planned);
        assert_eq!(sampler.ranks[0][Decision::Time as usize], Some(0));
        assert_eq!(sampler.ranks[0][Decision::LightPoint as usize], Some(1));
        assert_eq!((sampler.joint.len(), sampler.ranks[0][Decision::Lens as usize]), (3, None));
        // Not planned, and yet a perfect net: it has a set of its own.
        let lens: Vec<_> =
            (0..64).map(|i| sampler.draw_2d(sample(i), Vertex::default(), Decision::Lens)).collect();
        assert_eq!(balance(&lens), 0);
    }

    #[test]
    fn the_second_hit_has_the_dimensions_that_are_left() {
        let sampler = Sobol::new(0, DecisionSet::FULL).with_second_hit(DecisionSet::FULL);
        let second = |decision: Decision| sampler.ranks[1][decision as usize];
        // Twelve are taken, and what comes next in the order of decisions takes the other four.
        assert_eq!([Decision::Pixel, Decision::Lens].map(second), [Some(12), Some(14)]);
        assert_eq!((second(Decision::Direction), sampler.joint.len()), (None, DIMENSIONS));
        assert_eq!(sampler.ranks[0], Sobol::new(0, DecisionSet::FULL).ranks[0]);
    }

    #[test]
    fn numbers_drawn_together_are_those_drawn_one_by_one() {
        let planned = DecisionSet::EMPTY.with(Decision::Pixel).with(Decision::Lobe);
        let sampler = Sobol::new(3, planned).with_second_hit(planned);
        let vertex = |n: u32| Vertex { bounce: (n / 100 % 2) as u16, ..Vertex::default() };
        // Runs of several lengths, the last of them beyond 2¹⁶.
        let index = |n: u32| if n > 250 { n << 12 } else { 3 * n };
        let places: Vec<Place> =
            (0..300).map(|n| Place { sample: sample(index(n)), vertex: vertex(n) }).collect();
        for decision in [Decision::Pixel, Decision::LightPoint] {
            let mut points = vec![[2.0; 2]];
            sampler.draw_2d_each(&places, decision, &mut points);
            let single = places.iter().map(|p| sampler.draw_2d(p.sample, p.vertex, decision));
            assert!(points.into_iter().eq(single), "{decision:?}");
        }
        for decision in [Decision::Lobe, Decision::Time] {
            let mut numbers = vec![2.0];
            sampler.draw_1d_each(&places, decision, &mut numbers);
            let single = places.iter().map(|p| sampler.draw_1d(p.sample, p.vertex, decision));
            assert!(numbers.into_iter().eq(single), "{decision:?}");
        }
    }

    #[test]
    fn single_numbers_are_stratified() {
        let sampler = Sobol::new(9, DecisionSet::FULL);
        let later = Vertex { bounce: 1, ..Vertex::default() };
        for (vertex, decision) in [(Vertex::default(), Decision::Roulette), (later, Decision::Lobe)] {
            let mut cells: Vec<_> =
                (0..512).map(|i| (sampler.draw_1d(sample(i), vertex, decision) * 512.0) as u32).collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..512), "{decision:?}");
        }
    }

    #[test]
    fn pixels_replicates_decisions_and_vertices_have_their_own_order() {
        let sampler = Sobol::new(0, DecisionSet::EMPTY);
        let order = |sample: SampleId, vertex, decision| -> Vec<u32> {
            (0..64)
                .map(|index| (sampler.draw_1d(SampleId { index, ..sample }, vertex, decision) * 64.0) as u32)
                .collect()
        };
        let base = order(sample(0), Vertex::default(), Decision::Time);
        let pixel = SampleId { pixel: [12, 5], ..sample(0) };
        let replicate = SampleId { replicate: 3, ..sample(0) };
        let branch = Vertex { branch: 1, ..Vertex::default() };
        for other in [
            order(pixel, Vertex::default(), Decision::Time),
            order(replicate, Vertex::default(), Decision::Time),
            order(sample(0), branch, Decision::Time),
            order(sample(0), Vertex::default(), Decision::Lobe),
        ] {
            assert_ne!(base, other);
        }
    }
}
