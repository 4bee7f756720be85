//! Paths that neighbours share give each pixel what its own would.

use std::sync::{Arc, LazyLock};

use renderer::integrator::reuse::group;
use renderer::sampling::SamplerKind;
use renderer::scene::Scene;
use verify::claim::{Claim, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::room;
use crate::bounds;
use crate::setup::{built, image, mean, remembering};

/// Samples a pixel and replicate.
const SAMPLES: u32 = 64;

/// Pixels in a row, and rows: those of two groups.
const SIDE: usize = 4;

/// The rows of an image, and the columns of one by roulette from the first surface on.
const LINES: usize = 2 * SIDE;

pub(super) fn claims() -> Vec<Claim> {
    let rooms =
        Arc::new(LazyLock::new(|| [false, true].map(|reuse| [u32::MAX, 1].map(|rr| shared(rr, reuse)))));
    let known = rooms.clone();
    let value = move |way: usize, seed: u64| pixels(&rooms[way % 2][way / 2], seed);
    let value = Arc::new(remembering(value));
    let differences = Arc::new(LazyLock::new(move || {
        let unit = mean(&image(&known[0][0], SamplerKind::Sobol, SAMPLES, 0));
        // sums of f32 products along paths of a few vertices
        let rounding = 16.0 * f64::from(f32::EPSILON);
        let one = MeanClaim { rounding, ..MeanClaim::in_units_of(unit, 0.0, bounds::RELATION_QUICK) };
        [one; LINES]
    }));
    let (differences_2, differences_3) = (differences.clone(), differences.clone());
    let (control, even) = (value.clone(), value.clone());
    let same = claim(
        "relation/reuse/same-lines",
        "paths that neighbours share leave the means of an image's rows and columns as they are",
    )
    .bound(bounds::RELATION_QUICK)
    .rejects("2.2 × resolution", move |run| {
        joint_control(differences_2.as_slice(), run, |i, seed| {
            line(i, &control(2 * (i / SIDE) + 1, seed)) - line(i, &control(2 * (i / SIDE), seed))
        })
    })
    .rejects("pixels that share get the same", move |run| {
        joint_evidence(differences_3.as_slice(), run, |i, seed| {
            let own = even(2 * (i / SIDE), seed);
            line(i, &evened(&own)) - line(i, &own)
        })
    })
    .by(move |run| {
        joint_evidence(differences.as_slice(), run, |i, seed| {
            line(i, &value(2 * (i / SIDE) + 1, seed)) - line(i, &value(2 * (i / SIDE), seed))
        })
    });
    vec![same]
}

/// The room, with paths that neighbours share or not, and with roulette from an edge on.
fn shared(rr_depth: u32, reuse: bool) -> Scene {
    let mut description = room();
    (description.film.width, description.film.height) = (SIDE as u32, SIDE as u32);
    (description.integrator.rr_depth, description.integrator.reuse) = (rr_depth, reuse);
    built(&description)
}

/// The means of an image's pixels over channels, row by row.
fn pixels(scene: &Scene, seed: u64) -> Arc<[f64]> {
    let image = image(scene, SamplerKind::Sobol, SAMPLES, seed);
    image.pixels.iter().map(|pixel| pixel.mean.iter().sum::<f64>() / 3.0).collect()
}

/// The mean of a row, or after the rows of a column.
fn line(i: usize, pixels: &[f64]) -> f64 {
    let inside = |place: usize| if i < SIDE { i == place / SIDE } else { i - SIDE == place % SIDE };
    (0..pixels.len()).filter(|&place| inside(place)).map(|place| pixels[place]).sum::<f64>() / SIDE as f64
}

/// Each pixel as the mean of those that share with it.
fn evened(pixels: &[f64]) -> Vec<f64> {
    let group = |place: usize| group([place % SIDE, place / SIDE].map(|i| i as u32));
    let mean = |place: usize| {
        let mates: Vec<f64> =
            (0..pixels.len()).filter(|&i| group(i) == group(place)).map(|i| pixels[i]).collect();
        mates.iter().sum::<f64>() / mates.len() as f64
    };
    (0..pixels.len()).map(mean).collect()
}
