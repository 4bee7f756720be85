//! Constant light through each filter: signed weights average to 1, with the variance that negative lobes predict.

use renderer::film::Filter;
use renderer::sampling::SamplerKind;
use renderer::scene::Scene;
use std::sync::{Arc, LazyLock};
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::kernel;
use crate::bounds;
use crate::setup::{built, flat, half_plane, image};

/// Side of the images: one sample a pixel makes as many weights.
const SIDE: u32 = 80;

/// An image of light 1 everywhere.
fn bright(filter: Filter) -> Scene {
    let mut description = flat([SIDE, SIDE], vec![half_plane(60.0, 0.0)]);
    description.film.filter = filter;
    built(&description)
}

/// The mean of w and of (w − 1)², over an image of one sample a pixel.
fn moments(scene: &Scene, seed: u64) -> [f64; 2] {
    let rendering = image(scene, SamplerKind::Independent, 1, seed);
    let count = rendering.pixels.len() as f64;
    let mean = |of: fn(f64) -> f64| rendering.pixels.iter().map(|p| of(p.mean[0])).sum::<f64>() / count;
    [mean(|w| w), mean(|w| (w - 1.0).powi(2))]
}

/// Samples drawn from |f| have weights ±m, m = (∫|f|/∫f)²: mean 1 and variance m² − 1.
pub(super) fn mean_and_variance(name: &'static str, filter: Filter) -> Claim {
    let mass = kernel(filter).absolute_mass();
    let variance = mass.powi(4) - 1.0;
    // Tables leave weights of positive filters off by up to 1e-3; the variance of that is 1e-6 of what is tolerated.
    let unit = variance.max(1.0);
    let claims = [
        MeanClaim { rounding: 1e-6, ..MeanClaim::relative(1.0, bounds::WEIGHT_VARIANCE) },
        MeanClaim {
            rounding: 1e-2 * variance / unit + 1e-6,
            ..MeanClaim::in_units_of(unit, variance, bounds::WEIGHT_VARIANCE)
        },
    ];
    let scene = Arc::new(LazyLock::new(move || bright(filter)));
    let (control, dark) = (scene.clone(), scene.clone());
    let evidence = move |run: &Run, factor: f64, scene: &Scene| -> Result<Evidence, InputError> {
        joint_evidence(&claims, run, |i, seed| factor * moments(scene, seed)[i])
    };
    claim(
        format!("filter/{name}/constant"),
        format!("constant light through the {name} filter has mean 1 and variance (∫|f|/∫f)⁴ − 1"),
    )
    .rejects("2.2 × resolution", move |run| {
        joint_control(&claims, run, |i, seed| moments(&control, seed)[i])
    })
    .rejects("weights divided by ∫|f|", move |run| evidence(run, 0.9, &dark))
    .by(move |run| evidence(run, 1.0, &scene))
    .from_level(Level::Standard)
}
