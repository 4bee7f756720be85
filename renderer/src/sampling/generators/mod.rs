//! Rank 1: generators with a state, one number after the other, for programs that need a stream of them.
//!
//! The renderer itself draws from a [`Sampler`](super::Sampler), which has none. The generators are here to be
//! compared: by what statistics see, and by what they cost.

mod lcg;

pub use lcg::Lcg;

use crate::math::float::{unit_f32, unit_f64};
use rand_mt::Mt;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A stream of random bits.
#[derive(Debug, Clone)]
pub enum Generator {
    /// A linear congruential generator modulo 2³²: small, quick, and weak (see [`Lcg`]).
    Lcg(Lcg),
    /// The Mersenne Twister MT19937: period 2¹⁹⁹³⁷ − 1, 2.5 kB of state, each bit a linear recurrence.
    ///
    /// Source: Matsumoto and Nishimura 1998, doi 10.1145/272991.272995 (crate `rand_mt`).
    MersenneTwister(Box<Mt>),
    /// PCG XSH RR 64/32: period 2⁶⁴, 16 bytes.
    ///
    /// Source: O'Neill 2014, "PCG: a family of simple fast space-efficient statistically good algorithms for
    /// random number generation", HMC-CS-2014-0905 (crate `rand_pcg`).
    Pcg(Pcg32),
    /// xoshiro256++: period 2²⁵⁶ − 1, 32 bytes.
    ///
    /// Source: Blackman and Vigna 2021, "Scrambled linear pseudorandom number generators", doi 10.1145/3460772
    /// (crate `rand_xoshiro`).
    Xoshiro(Xoshiro256PlusPlus),
}

impl Generator {
    /// The linear congruential generator whose first output follows `seed`.
    pub const fn lcg(seed: u32) -> Self {
        Self::Lcg(Lcg::new(seed))
    }

    /// The Mersenne Twister initialised by the authors' `init_genrand(seed)`.
    pub fn mersenne_twister(seed: u32) -> Self {
        Self::MersenneTwister(Box::new(Mt::new(seed)))
    }

    /// PCG seeded by its own stretching of 64 bits.
    pub fn pcg(seed: u64) -> Self {
        Self::Pcg(Pcg32::seed_from_u64(seed))
    }

    /// xoshiro seeded by `SplitMix64`, as its authors advise.
    pub fn xoshiro(seed: u64) -> Self {
        Self::Xoshiro(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// The next 32 bits; of a 64-bit output, the upper ones.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        match self {
            Self::Lcg(g) => g.next_u32(),
            Self::MersenneTwister(g) => g.next_u32(),
            Self::Pcg(g) => g.next_u32(),
            Self::Xoshiro(g) => g.next_u32(),
        }
    }

    /// The next 64 bits; of 32-bit outputs, two, the first one lowest.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        match self {
            Self::Xoshiro(g) => g.next_u64(),
            Self::Lcg(_) | Self::MersenneTwister(_) | Self::Pcg(_) => {
                let low = u64::from(self.next_u32());
                low | u64::from(self.next_u32()) << 32
            }
        }
    }

    /// The next number in [0, 1), of the upper 24 of 32 bits; never 1.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_f32(self.next_u32())
    }

    /// The next number in [0, 1), of the upper 53 of 64 bits; never 1.
    #[inline]
    pub fn next_f64(&mut self) -> f64 {
        unit_f64(self.next_u64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first<const N: usize>(mut generator: Generator) -> [u32; N] {
        std::array::from_fn(|_| generator.next_u32())
    }

    #[test]
    fn mersenne_twister_gives_the_published_numbers() {
        // mt19937ar with its default seed 5489; the 10,000th number is the one the C++ standard requires.
        let published = [3_499_211_612, 581_869_302, 3_890_346_734, 3_586_334_585, 545_404_204];
        assert_eq!(first(Generator::mersenne_twister(5489)), published);
        let mut generator = Generator::mersenne_twister(5489);
        let last = (0..10_000).map(|_| generator.next_u32()).last();
        assert_eq!(last, Some(4_123_659_995));
    }

    #[test]
    fn pcg_gives_the_published_numbers() {
        // The demonstration of the reference implementation: state 42, stream 54.
        let published = [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330, 0x83d2_f293, 0xbfa4_784b, 0xcbed_606e];
        assert_eq!(first(Generator::Pcg(Pcg32::new(42, 54))), published);
    }

    #[test]
    fn xoshiro_gives_the_published_numbers() {
        // The reference implementation with state 1, 2, 3, 4.
        let mut state = [0; 32];
        for k in 0..4_u8 {
            state[usize::from(8 * k)] = k + 1;
        }
        let mut generator = Generator::Xoshiro(Xoshiro256PlusPlus::from_seed(state));
        let published = [41_943_041, 58_720_359, 3_588_806_011_781_223, 3_591_011_842_654_386];
        assert_eq!([0; 4].map(|_: u64| generator.next_u64()), published);
    }

    #[test]
    fn two_outputs_make_64_bits() {
        let [low, high] = first(Generator::mersenne_twister(1));
        let both = Generator::mersenne_twister(1).next_u64();
        assert_eq!(both, u64::from(high) << 32 | u64::from(low));
        let mut generator = Generator::mersenne_twister(1);
        assert_eq!(generator.next_f32(), unit_f32(low));
        assert_eq!(Generator::pcg(1).next_f64(), unit_f64(Generator::pcg(1).next_u64()));
    }
}
