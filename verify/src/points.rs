//! Independent uniform numbers, addressed by seed and index: the input of every sampler under test.

/// Increment of the counter: 2⁶⁴ divided by the golden ratio, odd.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Fills one point with independent numbers, uniform on [0, 1).
///
/// A number is a pure function of seed, index, and its place in the point: `SplitMix64` at counter index ·
/// dimensions + place. So points can be made again, skipped, or made in any order.
///
/// * `seed`: of the run.
/// * `index`: of the point.
/// * `point`: receives multiples of 2⁻⁵³ in [0, 1); 1 never comes out.
///
/// # Precision, limits
/// Index · dimensions must stay below 2⁶⁴. Two seeds read the same sequence from places that are unrelated:
/// for 10⁹ numbers each, they overlap with probability 10⁻¹⁰.
///
/// # Source
/// Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators", OOPSLA, doi
/// 10.1145/2660193.2660195; the finaliser is Stafford's variant 13.
#[inline]
pub fn fill(seed: u64, index: u64, point: &mut [f64]) {
    let first = index.wrapping_mul(point.len() as u64);
    for (place, x) in (0u64..).zip(point) {
        let word = mix(seed.wrapping_add(first.wrapping_add(place).wrapping_mul(GAMMA)));
        *x = (word >> 11) as f64 * f64::EPSILON / 2.0;
    }
}

/// One step and the finaliser of `SplitMix64`: a bijection of 64-bit words.
#[inline]
pub(crate) fn mix(word: u64) -> u64 {
    let word = word.wrapping_add(GAMMA);
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mix_is_splitmix64() {
        // The first outputs from state 1234567, as published with the reference implementation.
        let state = |step: u64| 1_234_567u64.wrapping_add(step.wrapping_mul(GAMMA));
        assert_eq!(mix(state(0)), 6_457_827_717_110_365_317);
        assert_eq!(mix(state(1)), 3_203_168_211_198_807_973);
    }

    #[test]
    fn points_are_the_sequence_cut_into_pieces() {
        let mut long = [0.0; 6];
        fill(5, 0, &mut long);
        let mut short = [0.0; 2];
        fill(5, 2, &mut short);
        assert_eq!(short, long[4..]);
        assert_eq!(long[0], (mix(5) >> 11) as f64 / 2f64.powi(53));
    }

    #[test]
    fn one_never_comes_out() {
        assert!((u64::MAX >> 11) as f64 * f64::EPSILON / 2.0 < 1.0);
    }
}
