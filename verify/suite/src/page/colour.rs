//! Two colour scales that people with any colour vision can read, in light and in dark surroundings.

/// Red, green and blue, 0 to 255.
pub(crate) type Colour = [u8; 3];

/// Dark blue over green to yellow: evenly spaced in lightness. For counts.
pub(super) const SEQUENTIAL: &[Colour] =
    &[[38, 24, 74], [49, 74, 128], [36, 122, 134], [52, 168, 112], [150, 206, 70], [250, 230, 60]];

/// Blue over light grey to red: for residuals, zero in the middle.
pub(crate) const DIVERGING: &[Colour] = &[
    [20, 70, 150],
    [86, 148, 204],
    [184, 212, 232],
    [240, 240, 238],
    [244, 200, 176],
    [218, 112, 84],
    [150, 24, 36],
];

/// Steps of a scale in a picture: more would not be seen, and cost space.
const STEPS: f32 = 63.0;

/// The colour at a place of the scale.
///
/// * `at`: 0 to 1; what lies outside takes the colour of the nearer end.
pub(crate) fn at(scale: &[Colour], at: f32) -> Colour {
    let place = (at.clamp(0.0, 1.0) * STEPS).round() / STEPS;
    #[expect(clippy::cast_precision_loss, reason = "a scale has fewer than ten colours")]
    let along = place * (scale.len() - 1) as f32;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to the scale's length")]
    let lower = (along.floor() as usize).min(scale.len() - 2);
    #[expect(clippy::cast_precision_loss, reason = "a scale has fewer than ten colours")]
    let t = along - lower as f32;
    let [a, b] = [scale[lower], scale[lower + 1]];
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two bytes")]
    std::array::from_fn(|i| (f32::from(a[i]) * (1.0 - t) + f32::from(b[i]) * t).round() as u8)
}

/// The scale as a background in a style sheet, from left to right.
pub(super) fn css_gradient(scale: &[Colour]) -> String {
    let stops: Vec<String> = scale.iter().map(|[r, g, b]| format!("rgb({r} {g} {b})")).collect();
    format!("background:linear-gradient(to right,{})", stops.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_of_the_scales() {
        assert_eq!(at(SEQUENTIAL, -1.0), SEQUENTIAL[0]);
        assert_eq!(at(SEQUENTIAL, 1.0), SEQUENTIAL[5]);
        assert_eq!(at(DIVERGING, 2.0), DIVERGING[6]);
        // An odd number of steps has no colour at exactly one half; the two nearest are within two of it.
        let middle = at(DIVERGING, 0.5);
        assert!(middle.iter().zip(DIVERGING[3]).all(|(a, b)| a.abs_diff(b) <= 4), "{middle:?}");
    }
}
