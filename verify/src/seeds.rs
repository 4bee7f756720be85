//! Seeds that derive from a run's seed: far apart for neighbouring indices, the same on every machine.

/// Derives the seed of item `index` of stream `stream` from `seed`.
///
/// Three rounds of a bijective 64-bit mixer, so that for a fixed seed and stream no two indices share a seed.
///
/// # Source
/// The finaliser is Stafford's variant 13, as in Steele, Lea, Flood 2014, 10.1145/2660193.2660195.
#[must_use]
pub fn derive(seed: u64, stream: u64, index: u64) -> u64 {
    let golden = 0x9e37_79b9_7f4a_7c15_u64;
    let first = mix(seed.wrapping_add(golden));
    let second = mix((first ^ stream).wrapping_add(golden));
    mix((second ^ index).wrapping_add(golden))
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
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
