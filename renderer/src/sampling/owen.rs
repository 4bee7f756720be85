//! Owen's nested uniform scrambling, by a hash instead of a tree of random bits.

use super::hash::halves;

/// Scrambles the digits of a number in [0, 1) given by its 32 binary digits in reverse (the first digit lowest).
///
/// Each digit is flipped by a hash of the digits before it, so that elementary intervals go to elementary
/// intervals: a digital net stays one. In reversed order that is every function whose output bit k depends on the
/// input bits 0 to k: sums, and products with constants, of which this is a short chain.
///
/// * `seed`: well mixed bits; another seed is another scrambling.
///
/// # Precision, limits
/// Each two flips are independent, as in Owen's scrambling, and so are the variances of averages. More than two are
/// not: the seven flips of the first three digits take 32 of their 128 patterns, so that the distribution of an
/// average's error is not exactly Owen's.
///
/// # Source
/// Laine and Karras 2011, "Stratified sampling for stochastic transparency", doi 10.1111/j.1467-8659.2011.02000.x;
/// Burley 2020, "Practical hash-based Owen scrambling", JCGT 9(4); constants by Vegdahl 2021, "Building a better LK
/// hash" (psychopath.io, final hash). There factor and summand come from the same 32 bits of seed; here from two
/// halves of 64.
///
/// # Verified by
/// `sampling::owen::tests`
#[inline]
pub(super) fn scramble_reversed(mut digits: u32, seed: u64) -> u32 {
    let [summand, factor] = halves(seed);
    digits ^= digits.wrapping_mul(0x3d20_adea);
    digits = digits.wrapping_add(summand);
    digits = digits.wrapping_mul(factor | 1);
    digits ^= digits.wrapping_mul(0x0552_6c56);
    digits ^ digits.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::mixed;

    #[test]
    fn equal_halves_give_the_published_hash() {
        for n in 0..1_000 {
            let [digits, seed] = halves(mixed(n));
            let published = sobol_burley::parts::owen_scramble_rev(digits, seed);
            assert_eq!(scramble_reversed(digits, u64::from(seed >> 16) << 32 | u64::from(seed)), published);
        }
    }

    #[test]
    fn a_digit_depends_on_itself_and_those_before_only() {
        for n in 0..1_000 {
            let [digits, _] = halves(mixed(n));
            for k in 0..32 {
                let difference =
                    scramble_reversed(digits, mixed(!n)) ^ scramble_reversed(digits ^ 1 << k, mixed(!n));
                assert_eq!(difference.trailing_zeros(), k, "digit {k} of {digits:#x}");
            }
        }
    }

    /// The flips are one for each node of a binary tree. Owen's scrambling has them fair and independent; means
    /// and variances of averages over points depend on each two of them only, which are tested here: the digits
    /// from `first` on, below one prefix.
    fn worst_pair(first: u32) -> f64 {
        const SEEDS: u64 = 1 << 16;
        let nodes: Vec<(u32, u32)> =
            (0..4).flat_map(|level| (0..1 << level).map(move |n| (n, level))).collect();
        let mut sums = vec![vec![0_i32; nodes.len()]; nodes.len()];
        for n in 0..SEEDS {
            let flip = |&(node, level): &(u32, u32)| {
                let digits = node << first;
                (scramble_reversed(digits, mixed(n)) ^ digits) >> (first + level) & 1
            };
            let flips: Vec<u32> = nodes.iter().map(flip).collect();
            for (a, sums) in sums.iter_mut().enumerate() {
                for (b, sum) in sums.iter_mut().enumerate() {
                    // The diagonal holds the flip itself, the rest whether two of them are equal.
                    let bit = if a == b { flips[a] } else { flips[a] ^ flips[b] };
                    *sum += if bit == 0 { 1 } else { -1 };
                }
            }
        }
        let worst = sums.into_iter().flatten().map(i32::abs).max().unwrap_or(0);
        f64::from(worst) / (SEEDS as f64).sqrt()
    }

    #[test]
    fn each_two_flips_are_independent() {
        for first in [0, 1, 5, 12, 20, 28] {
            // 120 sums of fair ±1, in standard deviations; one passes 6 with probability 2e-7, the seeds being fixed.
            let worst = worst_pair(first);
            assert!(worst < 6.0, "from digit {first}: {worst}");
        }
    }
}
