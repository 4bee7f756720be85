//! Linear complexity over GF(2): the length of the shortest shift register that gives a bit sequence.
//!
//! It separates families of generators without chance: bit j of a linear congruential generator modulo 2^k has at most 2^j + 1, the
//! Mersenne Twister exactly its state's 19,937, and a truly random sequence of n bits about n/2.

/// Linear complexity of a bit sequence, by Berlekamp and Massey's algorithm on words of 64 bits.
///
/// O(n²/64) steps: 40,000 bits take about a tenth of a second.
///
/// # Source
/// Massey 1969, 10.1109/TIT.1969.1054260.
#[must_use]
pub fn linear_complexity(bits: &[bool]) -> usize {
    let words = bits.len() / 64 + 2;
    let (mut current, mut previous) = (vec![0_u64; words], vec![0_u64; words]);
    (current[0], previous[0]) = (1, 1);
    // The bits seen, newest first, so that the discrepancy is the parity of `current & window`.
    let mut window = vec![0_u64; words];
    let (mut length, mut since) = (0, 1);
    for (n, &bit) in bits.iter().enumerate() {
        push_front(&mut window, bit, n / 64 + 1);
        let used = length / 64 + 1;
        let parity =
            current[..used].iter().zip(&window).fold(0, |sum, (c, w)| sum ^ (c & w)).count_ones() & 1;
        if parity == 0 {
            since += 1;
            continue;
        }
        if 2 * length <= n {
            let before = current.clone();
            add_shifted(&mut current, &previous, since);
            previous = before;
            length = n + 1 - length;
            since = 1;
        } else {
            add_shifted(&mut current, &previous, since);
            since += 1;
        }
    }
    length
}

/// Shifts the first `used` words by one bit and puts `bit` at the front.
fn push_front(window: &mut [u64], bit: bool, used: usize) {
    let mut carry = u64::from(bit);
    for word in &mut window[..used] {
        let out = *word >> 63;
        *word = *word << 1 | carry;
        carry = out;
    }
}

/// `sum` += `term`·x^`shift` over GF(2).
fn add_shifted(sum: &mut [u64], term: &[u64], shift: usize) {
    let (words, bits) = (shift / 64, shift % 64);
    for i in words..sum.len() {
        sum[i] ^= term[i - words] << bits;
        if bits > 0 && i > words {
            sum[i] ^= term[i - words - 1] >> (64 - bits);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::mix;

    #[test]
    fn known_registers_have_their_lengths() {
        assert_eq!(linear_complexity(&[]), 0);
        assert_eq!(linear_complexity(&[false; 100]), 0);
        assert_eq!(linear_complexity(&[true; 100]), 1);
        let mut last = [false; 100];
        last[99] = true;
        assert_eq!(linear_complexity(&last), 100);
        // x^7 + x + 1 is primitive: any sequence of its register has complexity 7.
        let mut bits = vec![true, false, false, true, false, false, false];
        (7..300).for_each(|i| bits.push(bits[i - 7] ^ bits[i - 6]));
        assert_eq!(linear_complexity(&bits), 7);
    }

    #[test]
    fn bits_of_a_congruential_generator_have_two_to_the_j_plus_one() {
        for j in [0_u32, 4, 8, 12] {
            let mut state = 12345_u32;
            let next = |_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                state >> j & 1 == 1
            };
            let bits: Vec<bool> = (0..20_000).map(next).collect();
            assert_eq!(linear_complexity(&bits), (1 << j) + 1);
        }
    }

    #[test]
    fn a_random_sequence_has_half_its_length() {
        let bits: Vec<bool> = (0..10_000).map(|i| mix(i) & 1 == 1).collect();
        // The deviation from n/2 has P(|d| > k) below 2^(1 − 2k): 20 gives 2e-12.
        assert!(linear_complexity(&bits).abs_diff(5000) <= 20);
    }

    /// The Mersenne Twister's low bit, from its recurrence written here: complexity 19,937, its number of state bits.
    #[test]
    fn the_mersenne_twister_shows_its_state() {
        let mut state: Vec<u32> = vec![5489];
        for i in 1..624_u32 {
            let last = state[state.len() - 1];
            state.push(1_812_433_253_u32.wrapping_mul(last ^ (last >> 30)).wrapping_add(i));
        }
        for i in 624..624 + 40_200 {
            let joined = (state[i - 624] & 0x8000_0000) | (state[i - 623] & 0x7fff_ffff);
            let twist = if joined & 1 == 1 { 0x9908_b0df } else { 0 };
            state.push(state[i - 227] ^ (joined >> 1) ^ twist);
        }
        let bits: Vec<bool> = state[624..].iter().map(|word| word & 1 == 1).collect();
        assert_eq!(linear_complexity(&bits), 19_937);
    }
}
