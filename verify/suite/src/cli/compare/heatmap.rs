//! The picture of a comparison: where two images differ.

use verify::image::TILE;

use crate::page::colour::{self, Colour, DIVERGING};
use crate::page::heat;
use crate::side::Side;

/// Differences of this share of the mean and more have the scale's last colour.
const SHARE: f64 = 0.2;

/// So have tiles whose difference is this many standard errors.
const SCORE: f64 = 4.0;

/// Columns between the two halves.
const GAP: usize = 4;

/// The bytes of a PNG file: left (A − B)/mean B of the pixels, right the scores of the tiles.
pub(super) fn png(a: &Side, b: &Side, scores: &[f64]) -> Vec<u8> {
    #[expect(clippy::cast_precision_loss, reason = "a file has fewer than 2^53 pixels")]
    let mean = b.grey.iter().sum::<f64>() / b.grey.len() as f64;
    let width = a.width;
    let tiles = width.div_ceil(TILE);
    let mut colours = Vec::new();
    for y in 0..a.grey.len() / width {
        let pixel = |x: usize| shade((a.grey[y * width + x] - b.grey[y * width + x]) / mean / SHARE);
        let tile = |x: usize| shade(scores.get(y / TILE * tiles + x / TILE).copied().unwrap_or(0.0) / SCORE);
        colours.extend((0..width).map(pixel));
        colours.extend([[255; 3]; GAP]);
        colours.extend((0..width).map(tile));
    }
    heat::png(2 * width + GAP, &colours)
}

/// The colour of a difference between −1 and 1; what is not a number has the middle's.
fn shade(difference: f64) -> Colour {
    #[expect(clippy::cast_possible_truncation, reason = "a colour needs few digits")]
    let place = 0.5 + 0.5 * difference as f32;
    colour::at(DIVERGING, if place.is_nan() { 0.5 } else { place })
}
