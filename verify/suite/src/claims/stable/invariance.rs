//! A scene far away, small, large or mirrored looks the same.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DVec3};
use renderer::render::Rendering;
use renderer::sampling::SamplerKind;
use renderer::scene::{Scene, SceneDescription};
use verify::claim::{Claim, Level, Run, claim};
use verify::mean::{CONTROL_FACTOR, MeanClaim, joint_control, joint_evidence};

use super::super::relation::{by_points, room, transformed};
use super::routine::worst_case;
use crate::bounds;
use crate::setup::{built, difference_of_images, fixed, image, mean, remembering};

/// Samples a pixel and replicate.
const SAMPLES: u32 = 16;

pub(super) fn claims() -> Vec<Claim> {
    // Not a whole number of anything in single precision.
    let shift =
        |d: f64| DAffine3::from_translation(d * DVec3::new(1.0, -0.7, 0.3) + DVec3::new(0.37, 0.61, -0.43));
    let scale = |s: f64| DAffine3::from_scale(DVec3::splat(s));
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let moved = [
        ("translated-1e5", "1e5 away from the origin", shift(1e5)),
        ("translated-1e7", "1e7 away from the origin", shift(1e7)),
        ("scaled-1e-6", "a millionth as large", scale(1e-6)),
        ("scaled-1e6", "a million times as large", scale(1e6)),
    ];
    let means = moved.into_iter().chain([("mirrored", "mirrored", mirror)]);
    let means = means.map(|(id, how, outer)| same(id, how, outer).from_level(Level::Standard));
    let pixels = moved.map(|(id, how, outer)| alike((id, how), outer, lit));
    means.chain(pixels).chain([alike(("mirrored", "mirrored"), mirror, by_points)]).collect()
}

/// The mean absolute difference of two images' pixels, over the mean of the first.
fn apart(a: &Rendering, b: &Rendering) -> f64 {
    let values = |image: &Rendering| image.pixels.iter().flat_map(|p| p.mean).collect::<Vec<f64>>();
    let (a, b) = (values(a), values(b));
    let apart: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum();
    apart / a.iter().sum::<f64>()
}

/// Makes the scene that is moved.
type Make = fn() -> SceneDescription;

/// The image of the same seed, pixel by pixel.
fn alike((id, how): (&'static str, &'static str), outer: DAffine3, make: Make) -> Claim {
    let trial = move |run: &Run, brighter: f64, moved: fn(Make, DAffine3) -> SceneDescription| {
        let [there, mut here] = [make(), moved(make, outer)]
            .map(|description| image(&built(&description), SamplerKind::Sobol, SAMPLES, run.seed));
        here.pixels.iter_mut().for_each(|p| p.mean = p.mean.map(|m| brighter * m));
        let n = here.pixels.iter().map(|p| p.samples).sum();
        Ok(worst_case("mean difference of pixels", apart(&there, &here), n, bounds::INVARIANCE, None))
    };
    let says = format!("pixels of a scene {how} are the same within 0.2 % in the mean");
    let exact: fn(Make, DAffine3) -> SceneDescription = |make, outer| transformed(make(), outer);
    let claim = claim(format!("stable/invariance/{id}-pixels"), says)
        .rejects("2.2 × bound", move |run| trial(run, 1.0 + CONTROL_FACTOR * bounds::INVARIANCE, exact));
    let claim = if id == "translated-1e7" {
        claim.rejects("translations in single precision", move |run| trial(run, 1.0, in_single))
    } else if id == "mirrored" {
        // What faces away from its mirror image is lit from the other side.
        claim.rejects("the light turned over", move |run| trial(run, 1.0, turned_over))
    } else {
        claim
    };
    claim.by(move |run| trial(run, 1.0, exact))
}

/// The room without inter-reflection, which would only add noise.
fn lit() -> SceneDescription {
    let mut description = room();
    description.integrator.max_depth = Some(2);
    description
}

/// The scene under `outer` with its normals left as they were: those of a mirror's image point to the other side.
fn turned_over(make: Make, outer: DAffine3) -> SceneDescription {
    let mut description = transformed(make(), outer);
    description.objects.iter_mut().for_each(|object| object.flip_normals = !object.flip_normals);
    description
}

/// The room and the same under `outer`: their means from the same seed.
struct Pair {
    mean: Box<dyn Fn(usize, u64) -> f64 + Send + Sync>,
    difference: MeanClaim,
}

impl Pair {
    fn new(outer: DAffine3) -> Self {
        let scenes = [built(&lit()), built(&transformed(lit(), outer)), built(&in_single(lit, outer))];
        let of = |scene: &Scene, seed| mean(&image(scene, SamplerKind::Sobol, SAMPLES, seed));
        // A mirrored surface's frame is another, and so are the directions drawn in it: only there the noise is not shared.
        let replicates = if outer.matrix3.determinant() < 0.0 { 800 } else { 32 };
        let difference =
            MeanClaim { replicates, ..difference_of_images(of(&scenes[0], 0), bounds::INVARIANCE) };
        Self { mean: Box::new(remembering(move |version, seed| of(&scenes[version], seed))), difference }
    }

    fn off(&self, version: usize, seed: u64) -> f64 {
        (self.mean)(version, seed) - (self.mean)(0, seed)
    }
}

/// The room under `outer` as a renderer has it that keeps transforms in single precision, in the world's own frame.
fn in_single(make: Make, outer: DAffine3) -> SceneDescription {
    let mut description = transformed(make(), outer);
    for object in &mut description.objects {
        let m = object.to_world.at(0.0);
        object.to_world = fixed(DAffine3 { translation: m.translation.as_vec3().as_dvec3(), ..m });
    }
    let m = description.camera.to_world.at(0.0);
    description.camera.to_world = fixed(DAffine3 { translation: m.translation.as_vec3().as_dvec3(), ..m });
    description
}

fn same(id: &'static str, how: &'static str, outer: DAffine3) -> Claim {
    let pair = Arc::new(LazyLock::new(move || Pair::new(outer)));
    let (control, naive, brighter) = (pair.clone(), pair.clone(), pair.clone());
    let claim =
        claim(format!("stable/invariance/{id}"), format!("a scene {how} has the same mean within 0.2 %"))
            .bound(bounds::INVARIANCE)
            .rejects("2.2 × resolution", move |run| {
                joint_control(&[control.difference], run, |_, seed| control.off(1, seed))
            })
            .rejects("1 % brighter", move |run| {
                joint_evidence(&[brighter.difference], run, |_, seed| {
                    brighter.off(1, seed) + 0.01 * (brighter.mean)(1, seed)
                })
            });
    // Steps of 1 at 1e7 show; those of 1/128 at 1e5 are too small to.
    let far = id == "translated-1e7";
    let claim = if far {
        claim.rejects("translations in single precision", move |run| {
            joint_evidence(&[naive.difference], run, |_, seed| naive.off(2, seed))
        })
    } else {
        claim
    };
    claim.by(move |run| joint_evidence(&[pair.difference], run, |_, seed| pair.off(1, seed)))
}
