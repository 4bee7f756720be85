//! One boundary of glass between two radiances: η², the variance of picking a branch, and how many rays each way takes.

use glam::{DAffine3, DVec3};
use renderer::film::FilmSettings;
use renderer::math::Rgb;
use renderer::sampling::SamplerKind;
use renderer::scene::{Branch, IntegratorSettings, LightSettings, Scene, SceneDescription};
use renderer::shapes::ShapeSettings;
use std::sync::{Arc, LazyLock};
use verify::claim::{Claim, Level, claim};
use verify::fresnel::reflectance;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::counted::edges;
use crate::bounds;
use crate::setup::{built, glass, image, lamp, radiance, rectangle_at, remembering, spot, thing};

pub(super) fn claims() -> Vec<Claim> {
    vec![squared_index(), variance(), cost()]
}

const ETA: f64 = 1.5;

/// Radiance above the boundary; below it is 1.
const SKY: f32 = 0.3;

/// The glass fills z < 0; a lamp in it fills the view below, and above there is a sky. The eye sees the origin at the cosine `z`,
/// below 0 from inside the glass.
fn boundary(z: f64, branch: Branch, pixels: u32) -> SceneDescription {
    let sheet = DAffine3::from_scale(DVec3::new(1e3, 1e3, 1.0));
    let deep = rectangle_at(-50.0 * DVec3::Z, 1e4 * DVec3::X, 1e4 * DVec3::Y);
    let objects =
        vec![thing(ShapeSettings::Rectangle, sheet, glass(1.5)), lamp(ShapeSettings::Rectangle, deep)];
    let integrator = IntegratorSettings { branch, ..IntegratorSettings::DIRECT };
    let eye = DVec3::new((1.0 - z * z).sqrt(), 0.0, z);
    let mut description = spot(eye, DVec3::ZERO, objects, integrator);
    description.film = FilmSettings { width: pixels, height: pixels, ..description.film };
    description.lights = vec![LightSettings::Constant { radiance: Rgb::splat(SKY) }];
    description
}

/// What is reflected and what is refracted towards the eye, and the share of the former.
fn parts(z: f64) -> [f64; 3] {
    // Light that enters a medium of index n gets n² times as much radiance, and loses it when it leaves.
    let (above, below) = (f64::from(SKY), 1.0);
    let eta = if z > 0.0 { ETA } else { 1.0 / ETA };
    let share = reflectance(z.abs(), eta);
    let [near, far] = if z > 0.0 { [above, below] } else { [below, above] };
    [near, far / (eta * eta), share]
}

/// Cosines from outside and from inside, one beyond the critical angle.
const COSINES: [f64; 5] = [0.9, 0.3, -0.95, -0.8, -0.5];

fn squared_index() -> Claim {
    let claims = |power: i32| {
        let of = move |z: f64| {
            let [near, far, share] = parts(z);
            let eta: f64 = if z > 0.0 { ETA } else { 1.0 / ETA };
            let exact = share * near + (1.0 - share) * far * eta.powi(power);
            // Ten roundings of 2⁻²⁴ in f32 factors up to n².
            MeanClaim { rounding: 2e-6, ..MeanClaim::relative(exact, bounds::FRESNEL) }
        };
        COSINES.map(of)
    };
    let subject = || {
        let scenes = LazyLock::new(|| COSINES.map(|z| built(&boundary(z, Branch::Fresnel, 1))));
        remembering(move |i, seed| radiance(&scenes[i], 1024, seed))
    };
    let right = Arc::new(subject());
    let (control, without, once) = (right.clone(), right.clone(), right.clone());
    claim(
        "fresnel/radiance/squared-index",
        "radiance is multiplied by η² as it enters glass, and divided as it leaves",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&claims(0), run, |i, s| control(i, s)))
    .rejects("radiance kept", move |run| joint_evidence(&claims(2), run, |i, s| without(i, s)))
    .rejects("η in the place of η²", move |run| joint_evidence(&claims(1), run, |i, s| once(i, s)))
    .by(move |run| joint_evidence(&claims(0), run, |i, s| right(i, s)))
    .from_level(Level::Standard)
}

/// Side of the film all of whose pixels see the same: one sample each.
const SIDE: u32 = 32;

/// The unbiased variance over the film's pixels.
fn spread(scene: &Scene, seed: u64) -> f64 {
    let rendering = image(scene, SamplerKind::Independent, 1, seed);
    let values = || rendering.pixels.iter().map(|p| p.mean[0]);
    let count = rendering.pixels.len() as f64;
    let mean = values().sum::<f64>() / count;
    values().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0)
}

/// Ways to follow branches, with the variance of one sample: of two halves ± half the difference of the doubled parts, by
/// shares that of a coin between the radiances, and none for both.
fn variance() -> Claim {
    const COSINE: f64 = 0.25;
    let ways = [Branch::Half, Branch::Fresnel, Branch::Both];
    let exact = |branch: Branch| {
        let [near, far, share] = parts(COSINE);
        match branch {
            Branch::Half => (share * near - (1.0 - share) * far).powi(2),
            Branch::Fresnel => share * (1.0 - share) * (near - far).powi(2),
            Branch::Both => 0.0,
        }
    };
    let claims = move |swapped: bool| {
        let unit = exact(Branch::Half);
        let of = |branch: Branch| {
            let branch = match branch {
                Branch::Half if swapped => Branch::Fresnel,
                Branch::Fresnel if swapped => Branch::Half,
                other => other,
            };
            MeanClaim {
                rounding: 1e-6,
                ..MeanClaim::in_units_of(unit, exact(branch), bounds::BRANCH_VARIANCE)
            }
        };
        ways.map(of)
    };
    let scenes = LazyLock::new(move || ways.map(|branch| built(&boundary(COSINE, branch, SIDE))));
    let right = Arc::new(remembering(move |i, seed| spread(&scenes[i], seed)));
    let (control, swapped) = (right.clone(), right.clone());
    claim(
        "fresnel/branch/variance",
        "picking one branch has the variance of its coin: by halves (Ra − (1 − R)b)², by shares R(1 − R)(a − b)², following both none",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&claims(false), run, |i, s| control(i, s)))
    .rejects("halves and shares exchanged", move |run| joint_evidence(&claims(true), run, |i, s| swapped(i, s)))
    .by(move |run| joint_evidence(&claims(false), run, |i, s| right(i, s)))
    .from_level(Level::Standard)
}

fn cost() -> Claim {
    let ways = [Branch::Both, Branch::Half, Branch::Fresnel];
    let claims = |exact: [f64; 3]| exact.map(|rays| MeanClaim::relative(rays, bounds::FRESNEL));
    let scenes = LazyLock::new(move || ways.map(|branch| built(&boundary(0.25, branch, 8))));
    let right = Arc::new(remembering(move |i, seed| edges(&scenes[i], 4, seed)));
    let (control, alike) = (right.clone(), right.clone());
    claim(
        "fresnel/branch/cost",
        "at one boundary following both branches takes three rays a sample, and picking one takes two",
    )
    .rejects("2.2 × resolution", move |run| {
        joint_control(&claims([3.0, 2.0, 2.0]), run, |i, s| control(i, s))
    })
    .rejects("as many rays for both", move |run| joint_evidence(&claims([2.0; 3]), run, |i, s| alike(i, s)))
    .by(move |run| joint_evidence(&claims([3.0, 2.0, 2.0]), run, |i, s| right(i, s)))
}
