//! Keys: from what a number is for to 64 random bits, without state.

use super::{Decision, SampleId, Vertex};

/// 2⁶⁴ divided by the golden ratio, made odd: multiples of it spread over the 64-bit integers.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Another odd constant of balanced bits, for a second coordinate.
const SILVER: u64 = 0xd1b5_4a32_d192_ed03;

/// Permutes the 64-bit integers so that each input bit flips each output bit with probability close to ½.
///
/// # Source
/// Stafford 2011, "Better bit mixing", variant 13; the finaliser of Steele, Lea and Flood 2014, "Fast splittable
/// pseudorandom number generators", doi 10.1145/2660193.2660195.
#[inline]
const fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// 64 random bits that name one stream of numbers. Streams of different keys are independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Key(u64);

impl Key {
    /// The key of a sampler's seed: equal seeds of two samplers share nothing.
    pub(super) const fn of_seed(seed: u64, sampler: u64) -> Self {
        Self(mix(mix(seed.wrapping_add(GOLDEN)) ^ sampler.wrapping_mul(SILVER)))
    }

    /// The key of a pixel's replicate.
    ///
    /// Pixels fill the 64 bits without a collision; the replicate shifts them by multiples of [`GOLDEN`], which
    /// no two pixels of an image of up to 2¹⁶ × 2¹⁶ and no two of 2³¹ replicates undo.
    #[inline]
    pub(super) const fn sample_set(self, sample: SampleId) -> Self {
        let [x, y] = sample.pixel;
        let pixel = (y as u64) << 32 | x as u64;
        let replicate = (sample.replicate as u64).wrapping_mul(GOLDEN);
        Self(mix(self.0.wrapping_add(pixel).wrapping_add(replicate)))
    }

    /// The key of a decision at a vertex.
    #[inline]
    pub(super) const fn decision(self, vertex: Vertex, decision: Decision) -> Self {
        let place = (vertex.branch as u64) << 32 | (vertex.split as u64) << 16 | vertex.bounce as u64;
        let decision = (decision as u64 + 1).wrapping_mul(GOLDEN);
        Self(mix(self.0.wrapping_add(place).wrapping_add(decision)))
    }

    /// The key of branch `n` of a tree.
    #[inline]
    pub(super) const fn child(self, n: u32) -> Self {
        Self(self.bits(n))
    }

    /// The bits of the stream at `counter`.
    #[inline]
    pub(super) const fn bits(self, counter: u32) -> u64 {
        mix(self.0.wrapping_add((counter as u64 + 1).wrapping_mul(GOLDEN)))
    }
}

/// The lower and the upper half of 64 bits.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the halves are wanted")]
pub(super) const fn halves(bits: u64) -> [u32; 2] {
    [bits as u32, (bits >> 32) as u32]
}

/// 64 well mixed bits for trial `n` of a test.
#[cfg(test)]
pub(super) const fn mixed(n: u64) -> u64 {
    Key::of_seed(n, 0).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Flipping one of `bits` input bits of `hash` must flip each output bit in half of the cases.
    fn worst_avalanche(inputs: u32, hash: impl Fn(u64) -> u64) -> f64 {
        const TRIALS: u32 = 4_096;
        let mut worst = 0.0_f64;
        for input in 0..inputs {
            let mut flips = [0_u32; 64];
            for trial in 0..u64::from(TRIALS) {
                let difference = hash(trial) ^ hash(trial ^ 1 << input);
                for (bit, count) in flips.iter_mut().enumerate() {
                    *count += u32::from(difference >> bit & 1 == 1);
                }
            }
            for count in flips {
                worst = worst.max((f64::from(count) / f64::from(TRIALS) - 0.5).abs());
            }
        }
        worst
    }

    #[test]
    fn each_bit_of_what_a_number_is_for_flips_each_bit_of_it() {
        let seed = Key::of_seed(0, 1);
        let sample = |low: u64| {
            let [x, y] = halves(low);
            SampleId { pixel: [x, y], replicate: 0, index: 0 }
        };
        let vertex = Vertex::default();
        let by_pixel = |n| seed.sample_set(sample(n)).decision(vertex, Decision::Lens).bits(0);
        let by_seed = |n| Key::of_seed(n, 1).sample_set(sample(0)).decision(vertex, Decision::Lens).bits(0);
        let by_index = |n| seed.sample_set(sample(0)).decision(vertex, Decision::Lens).bits(halves(n)[0]);
        // The standard deviation of a share of 4,096 is 1/128; 64·64 of them pass 6 of it once in 1e5 times.
        let limit = 6.0 / 128.0;
        for worst in
            [worst_avalanche(64, by_pixel), worst_avalanche(64, by_seed), worst_avalanche(32, by_index)]
        {
            assert!(worst < limit, "{worst}");
        }
    }

    #[test]
    fn nearby_streams_differ() {
        let mut seen = HashSet::new();
        let mut count = 0;
        for n in 0..4_u32.pow(6) {
            let digit = |k: u32| n >> (2 * k) & 3;
            let bounce = u16::try_from(digit(0)).expect("a digit is below 4");
            let vertex = Vertex { bounce, split: 0, branch: digit(1) };
            let sample = SampleId { pixel: [digit(2), digit(3)], replicate: digit(4), index: 0 };
            let set = Key::of_seed(u64::from(digit(5)), 1).sample_set(sample);
            for decision in Decision::ALL {
                seen.insert(set.decision(vertex, decision).bits(0));
                count += 1;
            }
        }
        assert_eq!(seen.len(), count);
    }
}
