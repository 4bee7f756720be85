//! The weighted average Σf·L/Σf: exact on constant light, and biased by O(1/N) on an edge.

use std::sync::{Arc, LazyLock};

use renderer::film::{Filter, Reconstruction};
use renderer::sampling::SamplerKind;
use renderer::scene::Scene;
use verify::claim::{Claim, Evidence, Level, Picture, Run, claim};
use verify::filter::edge_ratio_moments;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::share;

use super::kernel;
use crate::bounds;
use crate::setup::{built, flat, half_plane, image, mean, remembering};

/// Side of the constant image: enough pixels to settle the bound on misses with three filters.
const SIDE: u32 = 160;

pub(super) fn claims() -> Vec<Claim> {
    vec![constant(), bias()]
}

/// An image of the weighted average, bright to the left of `edge`.
fn weighted(size: [u32; 2], filter: Filter, edge: f64, reconstruction: Reconstruction) -> Scene {
    let mut description = flat(size, vec![half_plane(edge, 0.0)]);
    description.film.filter = filter;
    description.film.reconstruction = reconstruction;
    built(&description)
}

fn constant() -> Claim {
    let misses = |run: &Run, reconstruction| {
        let samples = 3 * u32::try_from(run.effort).unwrap_or(u32::MAX);
        let mut measured = Vec::new();
        let mut missed = |filter| {
            let scene = weighted([SIDE, SIDE], filter, 99.0, reconstruction);
            let rendering = image(&scene, SamplerKind::Independent, samples, run.seed);
            let row = rendering.pixels.iter().take(SIDE as usize);
            let first = measured.len();
            measured
                .extend(row.enumerate().map(|(i, p)| [(first + i) as f64, p.mean[0], f64::EPSILON / 3.0]));
            // Sums of equal products: each quotient is within one rounding of f64 of 1.
            let off = |p: &&renderer::film::PixelEstimate| (p.mean[0] - 1.0).abs() > f64::EPSILON;
            rendering.pixels.iter().filter(off).count() as u64
        };
        let filters =
            [GAUSSIAN, Filter::Tent { radius: 1.0 }, Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }];
        let all = filters.len() as u64 * u64::from(SIDE * SIDE);
        let misses = filters.map(&mut missed).iter().sum();
        let evidence = share::judge("share of pixels that are not 1", misses, all, bounds::MISSES)?;
        let exact = measured.iter().map(|p: &[f64; 3]| [p[0], 1.0]).collect();
        let axes = ["pixel of three filters' first rows", "radiance"];
        Ok(Evidence { pictures: vec![Picture::Curve { axes, exact, measured }], ..evidence })
    };
    claim("filter/weighted/constant", "the weighted average of constant light is that light in every pixel")
        .rejects("samples drawn from |f| and not divided", move |run| misses(run, Reconstruction::Importance))
        .by(move |run| misses(run, Reconstruction::Weighted))
}

/// Samples a pixel at which the bias is measured.
const COUNTS: [u32; 2] = [10, 16];

/// Where the edge is, in pixels from the middle.
const EDGE: f64 = 0.6;

/// Pixels along the edge, which all see the same.
const PIXELS: u32 = 1000;

/// Of the filters without negative lobes (with them Σf near 0 leaves no moments) the one whose bias is the largest.
const GAUSSIAN: Filter = Filter::Gaussian { stddev: 0.5 };

/// Mean over the pixels along an edge.
struct Rows {
    claims: Vec<MeanClaim>,
    mean: Box<dyn Fn(usize, u64) -> f64 + Send + Sync>,
}

impl Rows {
    fn new(reconstruction: Reconstruction) -> Self {
        let (mut scenes, mut claims) = (Vec::new(), Vec::new());
        for count in COUNTS {
            let moments = edge_ratio_moments(&kernel(GAUSSIAN), EDGE);
            let bias = moments.bias(f64::from(count));
            // Of the series' terms, each is this share of the one before.
            let ratio = moments.bias(f64::from(4 * count)) * 4.0 / bias - 1.0;
            claims.push(MeanClaim {
                rounding: ratio * ratio,
                replicates: 96,
                ..MeanClaim::in_units_of(bias.abs(), moments.limit + bias, bounds::RATIO_BIAS)
            });
            scenes.push((weighted([1, PIXELS], GAUSSIAN, EDGE, reconstruction), count));
        }
        let mean = remembering(move |i, seed| {
            let (scene, count) = &scenes[i];
            mean(&image(scene, SamplerKind::Independent, *count, seed))
        });
        Self { claims, mean: Box::new(mean) }
    }
}

fn bias() -> Claim {
    let rows = Arc::new(LazyLock::new(|| Rows::new(Reconstruction::Weighted)));
    let unbiased = LazyLock::new(|| Rows::new(Reconstruction::Importance));
    let (control, right) = (rows.clone(), rows.clone());
    claim(
        "filter/weighted/bias",
        "on an edge the weighted average of 10 and of 16 samples has the bias −C/(NB²) + O(N⁻²) of a ratio of means",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&control.claims, run, &control.mean))
    .rejects("no bias", move |run| joint_evidence(&right.claims, run, &unbiased.mean))
    .by(move |run| joint_evidence(&rows.claims, run, &rows.mean))
    .from_level(Level::Standard)
}
