//! Numbers in [0, 1) from random bits, and differences that keep their digits.

/// The largest f32 below one, 1 − 2⁻²⁴.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// 2⁻²⁴, the distance between the values of [`unit_f32`].
const ULP_BELOW_ONE: f32 = 1.0 / (1_u32 << 24) as f32;

/// 2⁻⁵³, the distance between the values of [`unit_f64`].
const ULP_BELOW_ONE_F64: f64 = 1.0 / (1_u64 << 53) as f64;

/// Makes a number in [0, 1) of 32 random bits: their upper 24, as a multiple of 2⁻²⁴.
///
/// Returns: 0 to [`ONE_MINUS_EPSILON`]. Every value is exact, so 1 never comes out
/// (`bits as f32 / 2³²` is 1 for the 128 largest `bits`).
///
/// # Precision, limits
/// 2²⁴ values of equal probability; below 2⁻²⁴ there is only zero.
///
/// # Verified by
/// `math::float::tests::one_never_comes_out`
#[inline]
pub const fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * ULP_BELOW_ONE
}

/// Makes a number in [0, 1) of 64 random bits: their upper 53, as a multiple of 2⁻⁵³.
#[inline]
pub const fn unit_f64(bits: u64) -> f64 {
    (bits >> 11) as f64 * ULP_BELOW_ONE_F64
}

/// Rounds to the nearest f32.
#[inline]
pub const fn round_f32(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "to round to f32 is the purpose")]
    let rounded = x as f32;
    rounded
}

/// Computes a·b − c·d to within 1.5 units in the last place, however much of it cancels.
///
/// # Precision, limits
/// No overflow or underflow of a·b and c·d is assumed.
///
/// # Source
/// Kahan's algorithm; its error bound is by Jeannerod, Louvet and Muller 2013, "Further analysis of Kahan's
/// algorithm for the accurate computation of 2×2 determinants", doi 10.1090/S0025-5718-2013-02679-8.
///
/// # Verified by
/// `math::float::tests::a_cancelling_difference_keeps_its_digits`
#[inline]
pub fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let cd = c * d;
    let difference = a.mul_add(b, -cd);
    let error = (-c).mul_add(d, cd);
    difference + error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_never_comes_out() {
        assert_eq!(unit_f32(u32::MAX), ONE_MINUS_EPSILON);
        assert_eq!(unit_f64(u64::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!((u32::MAX as f32) / 4_294_967_296.0, 1.0, "the naive division does reach one");
        let top = u32::MAX - 1_000..=u32::MAX;
        let stride = (0..=u32::MAX).step_by(65_521);
        for bits in top.chain(stride) {
            let x = unit_f32(bits);
            let exact = f64::from(bits) / 4_294_967_296.0;
            assert!((0.0..1.0).contains(&x), "{bits}: {x}");
            assert!(f64::from(x) <= exact && exact - f64::from(x) < f64::from(ULP_BELOW_ONE), "{bits}: {x}");
        }
    }

    #[test]
    fn zero_and_a_half_are_exact() {
        assert_eq!((unit_f32(0), unit_f32(1 << 31)), (0.0, 0.5));
        assert_eq!((unit_f64(0), unit_f64(1 << 63)), (0.0, 0.5));
    }

    #[test]
    fn a_cancelling_difference_keeps_its_digits() {
        // a² − (a − δ)(a + δ) = δ², here 2⁻²⁶, where the products are near 1 and round to multiples of 2⁻²³.
        let delta = 2.0_f32.powi(-13);
        let exact = f64::from(delta * delta);
        let mut naive_error = 0.0_f64;
        for k in 1..2_000_u16 {
            let a = 1.0 + f32::from(k) * 2.0_f32.powi(-20);
            let relative = |x: f32| ((f64::from(x) - exact) / exact).abs();
            // 1.5 units in the last place, of at most 2⁻²³ relative each: the bound of the source.
            let accurate = difference_of_products(a, a, a - delta, a + delta);
            assert!(relative(accurate) <= 1.5 * f64::from(f32::EPSILON), "{k}: {accurate}");
            naive_error = naive_error.max(relative(a * a - (a - delta) * (a + delta)));
        }
        assert!(naive_error >= 1.0, "the naive form loses every digit: {naive_error}");
    }
}
