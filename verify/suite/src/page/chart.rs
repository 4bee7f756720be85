//! What charts share: size, colours, fonts, and the way from plotters to the page.

use maud::{Markup, PreEscaped, html};
use plotters::prelude::*;
use plotters::style::TextStyle;

/// Width of a chart; it shrinks with the page.
pub(super) const WIDTH: u32 = 600;

/// Colours of lines, distinct for any colour vision and legible on white and on black (after Okabe and Ito 2008).
pub(super) const LINES: [RGBColor; 7] = [
    RGBColor(0, 130, 200),
    RGBColor(222, 110, 20),
    RGBColor(0, 158, 115),
    RGBColor(204, 100, 160),
    RGBColor(190, 150, 0),
    RGBColor(100, 110, 220),
    RGBColor(150, 110, 80),
];

/// The colour that the page's style sheet replaces by that of its text.
pub(super) const INK: RGBColor = RGBColor(0, 0, 0);

/// The colour of grid lines, which the style sheet replaces by a faint one.
pub(super) const GRID: RGBColor = RGBColor(221, 221, 221);

/// Text of axes.
pub(super) fn text() -> TextStyle<'static> {
    ("sans-serif", 15).into_font().color(&INK)
}

/// A plotters error; drawing into a string has no other source than an empty range.
pub(super) type DrawingError = Box<dyn std::error::Error>;

/// Draws into an SVG element; a chart that cannot be drawn says so in its place.
pub(super) fn svg(
    height: u32,
    name: &str,
    draw: impl FnOnce(&DrawingArea<SVGBackend<'_>, plotters::coord::Shift>) -> Result<(), DrawingError>,
) -> Markup {
    let mut text = String::new();
    let result = {
        let area = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw(&area).and_then(|()| Ok(area.present()?))
    };
    match result {
        Ok(()) => html! { div.chart role="img" aria-label=(name) { (PreEscaped(text)) } },
        Err(error) => html! { p.note { "The chart could not be drawn: " (error) } },
    }
}

/// The least and the greatest value, apart from each other.
pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    Some(if low < high { [low, high] } else { [low - 0.5, high + 0.5] })
}

/// A power of ten as people write it, `10³`; other values in digits.
pub(super) fn power_of_ten(value: f64) -> String {
    let exponent = value.log10().round();
    if (value.log10() - exponent).abs() > 1e-9 {
        return crate::figures::three(Some(value));
    }
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    format!("10{}", format!("{exponent:.0}").chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_raised() {
        assert_eq!(power_of_ten(1e-3), "10⁻³");
        assert_eq!(power_of_ten(1e12), "10¹²");
        assert_eq!(power_of_ten(200.0), "200");
    }

    #[test]
    fn an_empty_range_is_none_and_a_single_value_has_width() {
        assert_eq!(range([].into_iter()), None);
        assert_eq!(range([2.0].into_iter()), Some([1.5, 2.5]));
    }
}
