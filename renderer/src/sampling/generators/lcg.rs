//! The linear congruential generator of the textbooks.

/// xₖ₊₁ = 1664525·xₖ + 1013904223 modulo 2³².
///
/// # Precision, limits
/// What the statistics of this project must see: bit k has period 2^(k + 1), so that the lowest bit alternates;
/// d-dimensional points of successive outputs lie on few planes; streams of nearby seeds stay related; its period
/// of 2³² is used up in seconds. It serves as the weak one among the generators and is not used to render.
///
/// # Source
/// Press, Teukolsky, Vetterling and Flannery, "Numerical Recipes", 2nd edition, section 7.1, "An even quicker
/// generator"; factor by Knuth and Lewis.
///
/// # Verified by
/// `sampling::generators::lcg::tests`
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lcg {
    state: u32,
}

impl Lcg {
    /// The generator whose first output is 1664525·`seed` + 1013904223.
    pub const fn new(seed: u32) -> Self {
        Self { state: seed }
    }

    /// The next state, which is the output.
    #[inline]
    pub const fn next_u32(&mut self) -> u32 {
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_numbers() {
        // Numerical Recipes, section 7.1: the outputs from seed 0, for checking an implementation.
        let published = [
            0x3c6e_f35f,
            0x4750_2932,
            0xd1cc_f6e9,
            0xaaf9_5334,
            0x6252_e503,
            0x9f2e_c686,
            0x57fe_6c2d,
            0xa3d9_5fa8,
        ];
        let mut generator = Lcg::new(0);
        assert_eq!([0; 8].map(|_: u32| generator.next_u32()), published);
    }

    #[test]
    fn the_lowest_bits_have_short_periods() {
        let mut generator = Lcg::new(12_345);
        let low: Vec<u32> = (0..64).map(|_| generator.next_u32() & 7).collect();
        assert!(low.windows(9).all(|w| w[0] == w[8]), "three bits repeat after 8");
        assert!(low.windows(2).all(|w| w[0] & 1 != w[1] & 1), "one bit alternates");
    }
}
