//! Observed, expected and residual counts of a chi-square test as three small maps.

use std::io::Cursor;

use base64::{Engine as _, engine::general_purpose::STANDARD};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use maud::{Markup, html};

use super::colour::{self, Colour, DIVERGING, SEQUENTIAL};
use super::curve;
use crate::figures::three;

/// Residuals of this many standard deviations and more have the scale's last colour.
const SATURATION: f32 = 4.0;

/// Counts on a grid.
pub(super) struct Cells<'a> {
    pub(super) shape: [usize; 2],
    pub(super) axes: [&'a str; 2],
    pub(super) observed: &'a [f32],
    pub(super) expected: &'a [f32],
}

/// The three maps with their scales; a grid of one row is drawn as a curve, and one that does not fit its shape not at all.
pub(super) fn draw(cells: &Cells<'_>) -> Markup {
    let [columns, rows] = cells.shape;
    let count = columns.checked_mul(rows);
    if count != Some(cells.observed.len()) || count != Some(cells.expected.len()) || count == Some(0) {
        return html! { p.note { "The picture's data does not fit its shape of " (columns) " × " (rows) " cells." } };
    }
    if rows == 1 {
        return as_curve(cells);
    }
    let top = cells.observed.iter().chain(cells.expected).fold(0.0f32, |a, &b| a.max(b));
    let counts = |values: &[f32]| -> Vec<Colour> {
        values.iter().map(|v| colour::at(SEQUENTIAL, v / top.max(f32::MIN_POSITIVE))).collect()
    };
    let residuals: Vec<f32> =
        cells.observed.iter().zip(cells.expected).map(|(&o, &e)| residual(o, e)).collect();
    let largest = residuals.iter().fold(0.0f32, |a, b| a.max(b.abs()));
    let place = |r: &f32| colour::at(DIVERGING, 0.5 + 0.5 * r / SATURATION);
    let residual_colours: Vec<Colour> = residuals.iter().map(place).collect();
    html! {
        div.maps {
            (map(cells, "observed", &counts(cells.observed)))
            (map(cells, "expected", &counts(cells.expected)))
            (map(cells, "residual", &residual_colours))
        }
        div.scales {
            (scale(SEQUENTIAL, "0", &format!("{} a cell", three(Some(f64::from(top))))))
            (scale(DIVERGING, &format!("−{SATURATION} σ"), &format!("+{SATURATION} σ")))
        }
        p.note { (columns) " × " (rows) " cells; largest residual " (three(Some(f64::from(largest)))) " σ. Across: " (cells.axes[0])
            "; upwards: " (cells.axes[1]) "." }
    }
}

/// A distribution over one coordinate: counts as points on the expected curve.
fn as_curve(cells: &Cells<'_>) -> Markup {
    #[expect(clippy::cast_precision_loss, reason = "a drawing has fewer than 2^24 cells")]
    let middle = |i: usize| (i as f32 + 0.5) / cells.shape[0] as f32;
    let exact: Vec<[f32; 2]> = cells.expected.iter().enumerate().map(|(i, &e)| [middle(i), e]).collect();
    let measured: Vec<[f32; 3]> = cells
        .observed
        .iter()
        .zip(cells.expected)
        .enumerate()
        .map(|(i, (&o, &e))| [middle(i), o, e.sqrt()])
        .collect();
    curve::draw(&[cells.axes[0], "counts a cell"], &exact, &measured)
}

/// Standardised residual; infinite where something is observed that cannot be.
fn residual(observed: f32, expected: f32) -> f32 {
    if observed == expected { 0.0 } else { (observed - expected) / expected.sqrt() }
}

fn map(cells: &Cells<'_>, name: &str, colours: &[Colour]) -> Markup {
    let columns = cells.shape[0];
    let upwards: Vec<Colour> = colours.chunks(columns).rev().flatten().copied().collect();
    html! {
        figure {
            img.map src=(data_uri(&png(columns, &upwards))) alt=(format!("{name} counts over {} and {}", cells.axes[0], cells.axes[1]));
            figcaption { (name) }
        }
    }
}

fn scale(colours: &[Colour], from: &str, to: &str) -> Markup {
    html! { div.scale { span { (from) } span.bar style=(colour::css_gradient(colours)) {} span { (to) } } }
}

/// The bytes of a PNG file.
///
/// * `colours`: rows of `columns` pixels, from the top.
///
/// # Panics
/// If the last row is not full.
pub(crate) fn png(columns: usize, colours: &[Colour]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let [width, height] =
        [columns, colours.len() / columns.max(1)].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::NoFilter)
        .write_image(colours.as_flattened(), width, height, ExtendedColorType::Rgb8)
        .expect("whole rows, written to memory");
    file.into_inner()
}

/// The bytes of a PNG file as an address that needs no network.
pub(super) fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_is_at_the_bottom() {
        let cells = Cells { shape: [1, 2], axes: ["x", "y"], observed: &[1.0; 2], expected: &[1.0; 2] };
        let markup = map(&cells, "observed", &[[1, 2, 3], [4, 5, 6]]).into_string();
        let text =
            markup.split_once("base64,").and_then(|(_, rest)| rest.split_once('"')).expect("a picture").0;
        let image =
            image::load_from_memory(&STANDARD.decode(text).expect("base64")).expect("a PNG file").to_rgb8();
        assert_eq!([image.get_pixel(0, 0).0, image.get_pixel(0, 1).0], [[4, 5, 6], [1, 2, 3]]);
    }

    #[test]
    fn data_that_does_not_fit_is_said_and_not_drawn() {
        let cells = Cells { shape: [2, 2], axes: ["x", "y"], observed: &[1.0], expected: &[1.0] };
        assert!(draw(&cells).into_string().contains("does not fit"));
    }

    #[test]
    fn an_impossible_count_has_an_infinite_residual() {
        assert_eq!(residual(0.0, 0.0), 0.0);
        assert_eq!(residual(1.0, 0.0), f32::INFINITY);
        assert_eq!(residual(110.0, 100.0), 1.0);
    }
}
