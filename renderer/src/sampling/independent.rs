//! Independent uniform numbers: the sampler of the textbook's variance σ²/n.

use super::hash::{Key, halves};
use super::{Decision, SampleId, Sampler, Vertex};
use crate::math::float::unit_f32;

/// Numbers that share nothing between any two samples, vertices or decisions.
///
/// # Source
/// A counter-based generator (Salmon, Moraes, Dror and Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3",
/// doi 10.1145/2063384.2063405) on the mixing function of `SplitMix64`.
#[derive(Debug, Clone, Copy)]
pub struct Independent {
    key: Key,
}

impl Independent {
    /// The sampler of `seed`.
    pub const fn new(seed: u64) -> Self {
        Self { key: Key::of_seed(seed, 1) }
    }

    #[inline]
    fn bits(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [u32; 2] {
        halves(self.key.sample_set(sample).decision(vertex, decision).bits(sample.index))
    }
}

impl Sampler for Independent {
    #[inline]
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        unit_f32(self.bits(sample, vertex, decision)[1])
    }

    #[inline]
    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        self.bits(sample, vertex, decision).map(unit_f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asking_again_gives_the_same_number() {
        let sample = SampleId { pixel: [3, 4], replicate: 5, index: 6 };
        let ask = |seed| Independent::new(seed).draw_2d(sample, Vertex::default(), Decision::Lens);
        assert_eq!(ask(7), ask(7));
        assert_ne!(ask(7), ask(8));
    }
}
