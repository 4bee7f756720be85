//! Images of two rooms, each without and with what should change no mean, compared by their rows and columns.

use std::sync::{Arc, LazyLock};

use renderer::sampling::SamplerKind;
use renderer::scene::Scene;
use verify::claim::{Claim, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use crate::setup::{difference_of_images, image, mean, remembering};

/// Samples a pixel and replicate.
const SAMPLES: u32 = 512;

/// Pixels in a row, and rows.
pub(super) const SIDE: u32 = 4;

/// A line of an image: which room it is of, the room whose image's mean is its unit, and the line's row, or after the rows its column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) room: usize,
    pub(super) unit: usize,
    pub(super) line: usize,
}

/// What a wrong version makes of the pixels without and with.
type Wrong = fn(&[f64], &[f64]) -> Vec<f64>;

/// The claim that `lines` differ by at most `bound`.
///
/// * `rooms`: makes the scenes, for each room that without and that with.
pub(super) fn same_lines(
    [id, says]: [&'static str; 2],
    bound: f64,
    lines: Vec<Line>,
    rooms: fn() -> [[Scene; 2]; 2],
    (name, wrong): (&'static str, Wrong),
) -> Claim {
    let rooms = Arc::new(LazyLock::new(rooms));
    let known = rooms.clone();
    let value = Arc::new(remembering(move |way, seed| pixels(&rooms[way / 2][way % 2], seed)));
    let lines: Arc<[Line]> = lines.into();
    let units = lines.clone();
    let differences = Arc::new(LazyLock::new(move || -> Vec<MeanClaim> {
        let unit = remembering(|room, seed| mean(&image(&known[room][0], SamplerKind::Sobol, SAMPLES, seed)));
        units.iter().map(|line| difference_of_images(unit(line.unit, 0), bound)).collect()
    }));
    // What an image with has more of in a line than one without.
    let more = move |value: &dyn Fn(usize, u64) -> Arc<[f64]>, i: usize, seed: u64, wrong: Option<Wrong>| {
        let Line { room, line, .. } = lines[i];
        let [without, with] = [0, 1].map(|way| value(2 * room + way, seed));
        let more = |with: &[f64]| line_mean(line, with) - line_mean(line, &without);
        wrong.map_or_else(|| more(&with), |wrong| more(&wrong(&without, &with)))
    };
    let (differences_2, differences_3) = (differences.clone(), differences.clone());
    let (control, spoilt) = (value.clone(), value.clone());
    let (more_2, more_3) = (more.clone(), more.clone());
    claim(id, says)
        .bound(bound)
        .rejects("2.2 × resolution", move |run| {
            joint_control(&differences_2, run, |i, seed| more_2(&*control, i, seed, None))
        })
        .rejects(name, move |run| {
            joint_evidence(&differences_3, run, |i, seed| more_3(&*spoilt, i, seed, Some(wrong)))
        })
        .by(move |run| joint_evidence(&differences, run, |i, seed| more(&*value, i, seed, None)))
}

/// The means of an image's pixels over channels, row by row.
fn pixels(scene: &Scene, seed: u64) -> Arc<[f64]> {
    let image = image(scene, SamplerKind::Sobol, SAMPLES, seed);
    image.pixels.iter().map(|pixel| pixel.mean.iter().sum::<f64>() / 3.0).collect()
}

/// The mean of a row, or after the rows of a column.
fn line_mean(line: usize, pixels: &[f64]) -> f64 {
    let side = SIDE as usize;
    let place = |k: usize| if line < side { line * side + k } else { k * side + line - side };
    (0..side).map(|k| pixels[place(k)]).sum::<f64>() / f64::from(SIDE)
}
