//! Positions with a tent's density on an interval about 0.

/// Maps [0, 1) onto (−r, r) with the density of a tent.
///
/// Below ½ x = r(√(2u) − 1), else x = r(1 − √(2(1 − u))).
///
/// * `radius`: r > 0.
///
/// # Measure
/// Per unit length, [`tent_pdf`].
///
/// # Source
/// The inverse of the distribution function, which is a parabola on each side.
///
/// # Verified by
/// `tests/properties.rs::tent_and_back`; claims `warp/tent/*`
#[inline]
pub fn unit_to_tent(u: f32, radius: f32) -> f32 {
    if u < 0.5 { radius * ((2.0 * u).sqrt() - 1.0) } else { radius * (1.0 - (2.0 * (1.0 - u)).sqrt()) }
}

/// The inverse of [`unit_to_tent`].
pub fn tent_to_unit(x: f32, radius: f32) -> f32 {
    let rest = 1.0 - x.abs() / radius;
    let tail = 0.5 * rest * rest;
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// The density of [`unit_to_tent`]: (1 − |x|/r)/r within the radius, 0 outside.
///
/// # Measure
/// Per unit length.
///
/// # Source
/// A triangle of base 2r and height 1/r has area 1.
#[inline]
pub fn tent_pdf(x: f32, radius: f32) -> f32 {
    (1.0 - x.abs() / radius).max(0.0) / radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::float::ONE_MINUS_EPSILON as LAST;

    #[test]
    fn ends_and_middle() {
        assert_eq!([0.0, 0.125, 0.5, 0.875].map(|u| unit_to_tent(u, 2.0)), [-2.0, -1.0, 0.0, 1.0]);
        assert!(unit_to_tent(LAST, 2.0) < 2.0);
        assert_eq!([-3.0, -1.0, 0.0, 2.0].map(|x| tent_pdf(x, 2.0)), [0.0, 0.25, 0.5, 0.0]);
    }
}
