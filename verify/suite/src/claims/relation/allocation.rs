//! More samples where the image is uncertain give the same image.

use std::sync::{Arc, LazyLock};

use renderer::film::{Allocation, Part, Reconstruction};
use renderer::integrator::PathTracer;
use renderer::render::{RenderSettings, Rendering, go_on, pilot};
use renderer::sampling::SamplerKind;
use renderer::scene::Scene;
use verify::claim::{Claim, claim};
use verify::mean::{joint_control, joint_evidence};

use super::room;
use crate::bounds;
use crate::setup::{built, difference_of_images, image, mean, remembering};

/// Samples a pixel, and how many of them the pilot takes.
const SAMPLES: u32 = 32;
const FIRST: u32 = 8;

/// The ways to give pixels their samples.
#[derive(Clone, Copy)]
enum Way {
    Even,
    ByError,
    /// A pixel gets no more where its own first samples are brighter than others were.
    UntilBright,
}

pub(super) fn claims() -> Vec<Claim> {
    let scene = Arc::new(LazyLock::new(|| built(&room())));
    let known = scene.clone();
    let ways = [Way::Even, Way::ByError, Way::UntilBright];
    let value = Arc::new(remembering(move |way, seed| allocated(&scene, ways[way], seed)));
    let difference = move |value: &dyn Fn(usize, u64) -> f64, way: Way, seed: u64| {
        value(way as usize, seed) - value(Way::Even as usize, seed)
    };
    let differences = Arc::new(LazyLock::new(move || {
        [difference_of_images(allocated(&known, Way::Even, 0), bounds::RELATION)]
    }));
    let (differences_2, differences_3) = (differences.clone(), differences.clone());
    let (control, bright) = (value.clone(), value.clone());
    let same = claim(
        "relation/allocation/same-mean",
        "samples given to pixels by their neighbours' error keep the mean",
    )
    .bound(bounds::RELATION)
    .rejects("2.2 × resolution", move |run| {
        joint_control(differences_2.as_slice(), run, |_, seed| difference(&*control, Way::ByError, seed))
    })
    .rejects("pixels stop whose first samples are bright", move |run| {
        joint_evidence(differences_3.as_slice(), run, |_, seed| difference(&*bright, Way::UntilBright, seed))
    })
    .by(move |run| {
        joint_evidence(differences.as_slice(), run, |_, seed| difference(&*value, Way::ByError, seed))
    });
    vec![same]
}

/// The mean of an image of `scene` with its samples given in one way.
fn allocated(scene: &Scene, way: Way, seed: u64) -> f64 {
    let settings =
        RenderSettings { sampler: SamplerKind::Sobol, samples: SAMPLES, replicates: 1, seed, threads: 0 };
    let integrator = PathTracer { settings: scene.integrator };
    let finished = |part: Part| {
        let part = go_on(scene, &integrator, &settings, part, &|_| ()).expect("the part is of this film");
        Rendering::of(&part, Reconstruction::Importance)
    };
    let part = match way {
        Way::Even => settings.whole(scene),
        Way::ByError => {
            pilot::allocated(scene, &integrator, &settings, &|_| ()).expect("a Sobol sampler serves")
        }
        Way::UntilBright => {
            let film = [scene.film.width, scene.film.height];
            let first = finished(Part::new(film, 1, [0, FIRST]));
            let others = image(scene, SamplerKind::Sobol, SAMPLES, !seed);
            let sum = |mean: [f64; 3]| mean.iter().sum::<f64>();
            let pairs = first.pixels.iter().zip(&others.pixels);
            let counts =
                pairs.map(|(a, b)| if sum(a.mean) > sum(b.mean) { FIRST } else { SAMPLES }).collect();
            Part::allocated(film, 1, SAMPLES, Allocation { counts, pilot: None })
                .expect("a count for each pixel")
        }
    };
    mean(&finished(part))
}
