//! What a render does not depend on, or only through its noise: a mirror, a shutter before a scene at rest, the sample count.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DVec3};
use renderer::camera::{Projection, Shutter};
use renderer::sampling::SamplerKind;
use renderer::scene::{Scene, SceneDescription};
use verify::claim::{Claim, Level, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::seeds::derive;

use super::{Version, by_points, moved, room, same, transformed};
use crate::bounds;
use crate::setup::{built, image, remembering};

pub(super) fn claims() -> Vec<Claim> {
    vec![
        same(
            bounds::RELATION_QUICK,
            "relation/camera/mirrored-quick",
            "a scene and its camera in a mirror give the same mean",
            || MIRRORS.map(|outer| Version::of(moved(DAffine3::from_scale(outer)))).into(),
        )
        .from_level(Level::Standard),
        same(
            bounds::INVARIANCE,
            "relation/camera/mirrored",
            "a scene and its camera in a mirror give the same mean of light from the same points",
            || MIRRORS.map(|outer| Version::of(transformed(by_points(), DAffine3::from_scale(outer)))).into(),
        )
        .from_level(Level::Standard),
        same(
            bounds::INVARIANCE,
            "relation/shutter/at-rest",
            "a scene at rest is the same for any shutter",
            || [(0.0, 0.0), (0.0, 0.5), (-3.0, 40.0)].map(|times| Version::of(exposed(times))).into(),
        )
        .from_level(Level::Standard),
        same(
            bounds::RELATION_QUICK,
            "relation/lens/pinhole-quick",
            "a lens of radius 1e-4 shows what a pinhole shows",
            || [(0.0, 1.0), (1e-4, 3.7)].map(|lens| Version::of(through(lens))).into(),
        )
        .from_level(Level::Standard),
        same(
            bounds::INVARIANCE,
            "relation/lens/pinhole",
            "a lens of radius 0 shows what a pinhole shows, wherever it is in focus",
            || [(0.0, 1.0), (0.0, 3.7), (0.0, 1e3)].map(|lens| Version::of(through(lens))).into(),
        )
        .from_level(Level::Standard),
        halved(),
    ]
}

/// None, left for right, and upside down.
const MIRRORS: [DVec3; 3] = [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0)];

/// The room through a lens of a radius, in focus at a distance.
fn through((radius, distance): (f64, f64)) -> SceneDescription {
    let mut description = room();
    if let Projection::Perspective { lens_radius, focus_distance, .. } = &mut description.camera.projection {
        (*lens_radius, *focus_distance) = (radius, distance);
    }
    description
}

/// The room with the shutter open from one time to another.
fn exposed((open, close): (f64, f64)) -> SceneDescription {
    let mut description = room();
    description.camera.shutter = Shutter::new(open, close).expect("the times of claims are in order");
    description
}

/// Sample counts whose variances are halved in turn.
const COUNTS: [u32; 3] = [4, 8, 16];

/// Pairs of images behind one value.
const PAIRS: u64 = 5;

/// The variance of an image of `samples` independent samples a pixel, summed over pixels: half the squared difference of two.
fn variance(scene: &Scene, samples: u32, seed: u64) -> f64 {
    let pair = |i: u64| {
        let [a, b] =
            [0, 1].map(|side| image(scene, SamplerKind::Independent, samples, derive(seed, side, i)));
        a.pixels.iter().zip(&b.pixels).map(|(a, b)| 0.5 * (a.mean[0] - b.mean[0]).powi(2)).sum::<f64>()
    };
    (0..PAIRS).map(pair).sum::<f64>() / PAIRS as f64
}

fn halved() -> Claim {
    let scene = Arc::new(LazyLock::new(|| {
        let mut description = room();
        description.integrator.max_depth = Some(2); // the variance of longer paths has heavier tails
        built(&description)
    }));
    let known = scene.clone();
    let spread = Arc::new(remembering(move |i, seed| variance(&scene, COUNTS[i], seed)));
    // Two counts from different seeds; the unit is a rough value of the larger variance.
    let difference = move |spread: &dyn Fn(usize, u64) -> f64, i: usize, seed: u64, factor: f64| {
        spread(i, seed) - factor * spread(i + 1, !seed)
    };
    let claims = LazyLock::new(move || {
        [0, 1].map(|i| {
            let unit =
                (0..16).map(|seed| variance(&known, COUNTS[i], derive(0, 7, seed))).sum::<f64>() / 16.0;
            MeanClaim { replicates: 96, ..MeanClaim::in_units_of(unit, 0.0, bounds::HALVED) }
        })
    });
    let claims = Arc::new(claims);
    let (claims_2, claims_3) = (claims.clone(), claims.clone());
    let (control, fast) = (spread.clone(), spread.clone());
    claim("relation/samples/halved", "twice as many independent samples halve the variance of each image")
        .rejects("2.2 × resolution", move |run| {
            joint_control(claims_2.as_slice(), run, |i, seed| difference(&*control, i, seed, 2.0))
        })
        .rejects("the variance falls by the root of two", move |run| {
            joint_evidence(claims_3.as_slice(), run, |i, seed| {
                difference(&*fast, i, seed, std::f64::consts::SQRT_2)
            })
        })
        .by(move |run| joint_evidence(claims.as_slice(), run, |i, seed| difference(&*spread, i, seed, 2.0)))
        .from_level(Level::Standard)
}
