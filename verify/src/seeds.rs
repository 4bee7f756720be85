//! Seeds that derive from a run's seed: far apart for neighbouring indices, the same on every machine.

use crate::points::mix;

/// Derives the seed of item `index` of stream `stream` from `seed`.
///
/// Three rounds of a bijective 64-bit mixer, so that for a fixed seed and stream no two indices share a seed.
///
/// # Source
/// The finaliser of `SplitMix64`: Steele, Lea, Flood 2014, 10.1145/2660193.2660195.
#[must_use]
pub fn derive(seed: u64, stream: u64, index: u64) -> u64 {
    mix(mix(mix(seed) ^ stream) ^ index)
}

/// Independent numbers for tests of tests: the counter `index` of `seed`, hashed to [0, 1).
#[cfg(test)]
pub(crate) fn uniform(seed: u64, index: u64) -> f64 {
    (derive(seed, 0x7e57, index) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn neighbouring_seeds_streams_and_indices_share_nothing() {
        let all: HashSet<u64> =
            (0..16).flat_map(|s| (0..16).flat_map(move |t| (0..64).map(move |i| derive(s, t, i)))).collect();
        assert_eq!(all.len(), 16 * 16 * 64); // a collision of random 64-bit words: 16384²/2^65 = 7e-12
    }
}
