//! Both branches, one of two halves, or one by its share of the power: three ways to the same image.

use glam::{DAffine3, DVec3};
use renderer::math::Rgb;
use renderer::scene::{Branch, IntegratorSettings, LightSettings, ObjectSettings, Scene};
use renderer::shapes::ShapeSettings;
use std::sync::{Arc, LazyLock};
use verify::claim::{Claim, Level, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use crate::bounds;
use crate::setup::{blurred_glass, built, glass, lamp, radiance, rectangle_at, remembering, spot, thing};

pub(super) fn claims() -> Vec<Claim> {
    vec![
        same_mean(("fresnel/branch/same-mean-quick", "a glass sphere"), sphere, bounds::BRANCH_QUICK, 1),
        same_mean(("fresnel/branch/same-mean", "a glass sphere"), sphere, bounds::BRANCH, 16)
            .from_level(Level::Standard),
        same_mean(("fresnel/branch/same-mean-blurred", "blurred glass"), boundary, bounds::BRANCH, 1),
    ]
}

/// Index of the sphere: at 5 four ninths of the light are reflected, so that both branches matter, and one of two
/// halves, of weights 0.9 and 1.1, is little noise.
const ETA: f32 = 5.0;

/// Samples a replicate, of paths that follow both branches and of those that follow one: the former cost ten times as
/// much and are less noisy by more.
const SAMPLES: [u32; 3] = [128, 512, 512];

/// A glass sphere that is lit unevenly, seen at 42°, by a way of following its branches; no path ends by chance.
fn sphere(branch: Branch) -> Scene {
    let shape = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
    let target = DVec3::new(0.6, 0.3, -(1.0 - 0.36 - 0.09_f64).sqrt());
    lit(thing(shape, DAffine3::IDENTITY, glass(ETA)), [DVec3::new(0.6, 0.3, -5.0), target], branch)
}

/// A boundary of blurred glass, seen at a grazing angle from which two fifths are reflected, with one side brighter than
/// the other. One boundary, since in a body total reflection doubles the weights of one of two halves without end.
fn boundary(branch: Branch) -> Scene {
    let sheet = DAffine3::from_scale(DVec3::new(10.0, 10.0, 1.0));
    let sheet = DAffine3::from_rotation_y(std::f64::consts::PI) * sheet; // faces −z, away from the wall
    lit(
        thing(ShapeSettings::Rectangle, sheet, blurred_glass(0.2, 1.5)),
        [DVec3::new(0.6, 0.8, -0.25), DVec3::ZERO],
        branch,
    )
}

/// An object before a bright wall, in an environment that is less bright. Where light goes round in the sphere a reflection
/// leaves four ninths of it, so a hundred edges leave out 1e-34; numbers that never say "refract" still come to an end.
fn lit(object: ObjectSettings, [eye, target]: [DVec3; 2], branch: Branch) -> Scene {
    let integrator =
        IntegratorSettings { max_depth: Some(100), rr_depth: 100, branch, ..IntegratorSettings::PATH };
    let wall = rectangle_at(DVec3::new(0.0, 0.0, 4.0), 20.0 * DVec3::X, -20.0 * DVec3::Y);
    let mut description = spot(eye, target, vec![object, lamp(ShapeSettings::Rectangle, wall)], integrator);
    description.lights.push(LightSettings::Constant { radiance: Rgb::splat(0.8) });
    built(&description)
}

/// Makes a scene for a way to follow branches.
type Build = fn(Branch) -> Scene;

/// The claim that the differences between pairs of ways average to 0, relative to radiances near 1, in so many times the samples.
fn same_mean((id, what): (&str, &str), scene: Build, bound: f64, times: u32) -> Claim {
    let says = format!(
        "{what} is as bright when both branches are followed, one of two halves, or one by its share"
    );
    let claims = [MeanClaim { rounding: 1e-6, ..MeanClaim::in_units_of(1.0, 0.0, bound) }; 2];
    let scenes = LazyLock::new(move || [Branch::Both, Branch::Half, Branch::Fresnel].map(scene));
    let shown = Arc::new(remembering(move |way, seed| radiance(&scenes[way], times * SAMPLES[way], seed)));
    let difference = move |i: usize, seed: u64, factor: f64| shown(0, seed) - factor * shown(i + 1, !seed);
    let (control, half) = (difference.clone(), difference.clone());
    claim(id, says)
        .rejects("one of two halves without its factor 2", move |run| {
            joint_evidence(&claims, run, |i, seed| half(i, seed, 0.5))
        })
        .rejects("2.2 × resolution", move |run| joint_control(&claims, run, |i, seed| control(i, seed, 1.0)))
        .by(move |run| joint_evidence(&claims, run, |i, seed| difference(i, seed, 1.0)))
}
