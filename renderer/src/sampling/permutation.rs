//! A random permutation of 0 to n − 1, element by element.

use super::hash::halves;

/// Irreducible polynomials over the field of two elements, of degrees 1 to 12: bit k is the coefficient of xᵏ.
const IRREDUCIBLE: [u32; 12] = [0x3, 0x7, 0xb, 0x13, 0x25, 0x43, 0x83, 0x11b, 0x211, 0x409, 0x805, 0x1053];

/// Sends `index` to its place in the permutation of 0 to `n` − 1 that `key` names.
///
/// For powers of two up to 2¹²: two rounds of a keyed chain of bijections, then x ↦ ax + b in the field of `n` elements
/// with random a ≠ 0 and b. For other n: ten rounds of the chain on the next power of two; what falls outside 0 to
/// n − 1 goes through it again.
///
/// * `index`: below `n`.
/// * `key`: well mixed bits; another key is another permutation.
///
/// # Precision, limits
/// Each two elements go to each two places equally often, in the field exactly so, since (a, b) ↦ (ai + b, aj + b) is
/// one-to-one. By ten rounds of the chain the places of two of twelve elements deviate by less than 1 % (RMS over pairs
/// of places); each two more divide that by four. For n up to 4 every permutation occurs equally often.
///
/// # Source
/// Cycle walking: Black and Rogaway 2002, "Ciphers with arbitrary finite domains", doi 10.1007/3-540-45760-7_9;
/// its use for strata: Kensler 2013, "Correlated multi-jittered sampling", Pixar TM 13-01. Our chain has a fresh
/// factor and summand in each of its rounds; the field is ours.
///
/// # Verified by
/// `sampling::permutation::tests`
#[inline]
pub(super) fn permuted(index: u32, n: u32, key: u64) -> u32 {
    debug_assert!(index < n, "{index} of {n}");
    let mask = n.next_power_of_two() - 1;
    if mask == 0 {
        return 0;
    }
    let degree = mask.count_ones();
    match IRREDUCIBLE.get(degree as usize - 1) {
        Some(&polynomial) if n == mask + 1 => {
            let (place, bits) = chain::<2>(index, mask, key);
            let [factor, summand] = halves(bits);
            let factor = 1 + below(factor, mask);
            product(place, factor, polynomial, degree) ^ summand & mask
        }
        _ => {
            let mut place = index;
            loop {
                (place, _) = chain::<10>(place, mask, key);
                if place < n {
                    return place;
                }
            }
        }
    }
}

/// Rounds of multiplication, addition and shift, each with its own bits; and the bits of the round after them.
#[inline]
fn chain<const ROUNDS: usize>(mut place: u32, mask: u32, key: u64) -> (u32, u64) {
    let half = mask.count_ones().div_ceil(2).max(1);
    let mut bits = key;
    for _ in 0..ROUNDS {
        let [summand, factor] = halves(bits);
        place = place.wrapping_mul(factor | 1).wrapping_add(summand) & mask;
        place ^= place >> half;
        bits = (bits ^ bits >> 29).wrapping_mul(0xd1b5_4a32_d192_ed03);
        bits ^= bits >> 32;
    }
    (place, bits)
}

/// A number below `n` from 32 random bits, each with the same probability to within n/2³².
#[inline]
pub(super) fn below(bits: u32, n: u32) -> u32 {
    halves(u64::from(bits) * u64::from(n))[1]
}

/// The product in the field of 2^`degree` elements of `polynomial`.
#[inline]
fn product(a: u32, mut b: u32, polynomial: u32, degree: u32) -> u32 {
    let mut sum = 0;
    for bit in 0..degree {
        sum ^= b & 0_u32.wrapping_sub(a >> bit & 1);
        b <<= 1;
        b ^= polynomial & 0_u32.wrapping_sub(b >> degree);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::mixed;
    use std::collections::BTreeMap;

    /// Chi-square of the counts of `outcomes` equally probable values of `of` over many keys, and its excess over
    /// the degrees of freedom in standard deviations √(2·dof).
    fn excess(outcomes: u32, of: impl Fn(u64) -> Vec<u32>) -> f64 {
        let draws = 1_000 * u64::from(outcomes);
        let mut counts = BTreeMap::<Vec<u32>, u32>::new();
        for n in 0..draws {
            *counts.entry(of(mixed(n))).or_default() += 1;
        }
        let dof = f64::from(outcomes - 1);
        let missing = f64::from(outcomes) - counts.len() as f64;
        let seen: f64 = counts.values().map(|&c| (f64::from(c) - 1_000.0).powi(2) / 1_000.0).sum();
        (seen + missing * 1_000.0 - dof) / (2.0 * dof).sqrt()
    }

    #[test]
    fn every_element_has_one_place() {
        for n in [1, 2, 3, 4, 7, 8, 16, 32, 64, 100, 128, 256, 257, 512, 1024, 2048, 4096, 8192] {
            let mut places: Vec<u32> = (0..n).map(|i| permuted(i, n, mixed(u64::from(n)))).collect();
            places.sort_unstable();
            assert!(places.into_iter().eq(0..n), "{n}");
        }
    }

    #[test]
    fn small_permutations_are_equally_frequent() {
        for (n, factorial) in [(2, 2), (3, 6), (4, 24)] {
            let excess = excess(factorial, |key| (0..n).map(|i| permuted(i, n, key)).collect());
            // Chi-square's tail at 8 standard deviations: below 3e-5 for 1 degree of freedom, less for more.
            assert!(excess < 8.0, "{n}: {excess}");
        }
    }

    #[test]
    fn fields_have_inverses() {
        for (degree, polynomial) in (1..=12).zip(IRREDUCIBLE) {
            // Without divisors of zero every factor permutes the field: a reducible polynomial has some.
            let n = 1 << degree;
            for factor in (1..n).step_by(if degree > 8 { 37 } else { 1 }) {
                let zeros = (0..n).filter(|&x| product(x, factor, polynomial, degree) == 0).count();
                assert_eq!(zeros, 1, "{factor} in the field of {n}");
            }
        }
    }

    #[test]
    fn two_elements_go_anywhere() {
        for n in [8, 12, 16] {
            for (i, j) in [(0, 1), (0, n / 2), (n - 2, n - 1)] {
                let excess = excess(n * (n - 1), |key| vec![permuted(i, n, key), permuted(j, n, key)]);
                assert!(excess < 8.0, "{n}: {i}, {j}: {excess}"); // As above.
            }
        }
    }
}
