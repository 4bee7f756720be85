//! Effects at their null value are absent: the same bits as a scene that never mentions them.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use renderer::camera::{FovAxis, Projection, Shutter};
use renderer::film::{FilmSettings, Filter};
use renderer::materials::Material;
use renderer::math::{Rgb, transform::Motion};
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, ObjectSettings, SceneDescription};
use renderer::shapes::ShapeSettings;
use renderer::texture::Texture;
use verify::claim::{Claim, Run, claim};
use verify::share;

use crate::bounds;
use crate::setup::{built, diffuse, image, lamp, rectangle_at, spot, thing};

mod variance;

/// Side of the images: three channels of its square are enough numbers to settle the bound on misses.
const SIDE: u32 = 160;

/// Samples a pixel.
const SAMPLES: u32 = 2;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    vec![
        null("lens", "a lens of radius 0 is a pinhole", with_lens(0.0, 3.0), scene(), with_lens(1e-3, 3.0)),
        null(
            "shutter",
            "a shutter that opens for no time sees a scene at rest",
            moving(0.0),
            scene(),
            moving(0.01),
        ),
        null("motion", "equal keys do not move", equal_keys(0.0), scene(), equal_keys(1e-3)),
        null("area-light", "a light of radiance 0 is a black shape", dark(0.0), without_light(), dark(1e-3)),
        null("dielectric", "a surface of eta 1 is not there", glass(1.0), scene(), glass(1.001)),
        null("filter", "a box of radius ½ is the plain average", with_box(0.5), scene(), with_box(0.501)),
        null("rough", "a blur of 0 is a mirror", blurred(0.0), mirror(), blurred(1e-3)),
        variance::total_effect(),
        null("inter-reflection", "paths of two edges are direct light", depth(2), direct(), depth(3)),
    ]
}

/// The claim that `absent`, an effect at its null value, has the bits of `never`; `present` is barely there.
fn null(
    effect: &'static str,
    says: &'static str,
    absent: SceneDescription,
    never: SceneDescription,
    present: SceneDescription,
) -> Claim {
    let [absent, never, present] = [absent, never, present].map(|d| Arc::new(built(&d)));
    let against = never.clone();
    let differ = |a: &renderer::scene::Scene, b: &renderer::scene::Scene, run: &Run| {
        let samples = SAMPLES * u32::try_from(run.effort).unwrap_or(u32::MAX);
        let [a, b] = [a, b].map(|scene| image(scene, SamplerKind::Sobol, samples, run.seed));
        let numbers =
            |r: &renderer::render::Rendering| r.pixels.iter().flat_map(|p| p.mean).collect::<Vec<f64>>();
        let (a, b) = (numbers(&a), numbers(&b));
        let misses = a.iter().zip(&b).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        share::judge("share of numbers with other bits", misses as u64, a.len() as u64, bounds::MISSES)
    };
    claim(format!("effect/{effect}/null"), format!("{says}: the same bits"))
        .rejects("barely there", move |run| differ(&present, &against, run))
        .by(move |run| differ(&absent, &never, run))
}

/// A ball between a floor and a square light.
fn scene() -> SceneDescription {
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.0, 0.5, 0.0), radius: 0.5 };
    let objects = vec![
        thing(ball, DAffine3::IDENTITY, diffuse(0.7)),
        thing(
            ShapeSettings::Rectangle,
            rectangle_at(DVec3::ZERO, 3.0 * DVec3::Z, 3.0 * DVec3::X),
            diffuse(0.5),
        ),
        lamp(
            ShapeSettings::Rectangle,
            rectangle_at(DVec3::new(0.0, 2.5, 0.5), 0.8 * DVec3::X, 0.8 * DVec3::Z),
        ),
    ];
    let integrator = IntegratorSettings { max_depth: Some(3), ..IntegratorSettings::PATH };
    let mut description = spot(DVec3::new(0.3, 1.5, 4.0), DVec3::new(0.0, 0.6, 0.0), objects, integrator);
    description.film = FilmSettings { width: SIDE, height: SIDE, ..description.film };
    description.camera.projection = projection(0.0, 1.0);
    description
}

fn projection(lens_radius: f64, focus_distance: f64) -> Projection {
    Projection::Perspective { fov: 40.0, axis: FovAxis::X, lens_radius, focus_distance }
}

fn with_lens(radius: f64, focus: f64) -> SceneDescription {
    let mut description = scene();
    description.camera.projection = projection(radius, focus);
    description
}

/// The ball slides from its place while the shutter is open for `length`.
fn moving(length: f64) -> SceneDescription {
    let mut description = scene();
    description.objects[0].to_world = slide(0.5);
    description.camera.shutter = Shutter::new(0.0, length).expect("lengths of claims are at least 0");
    description
}

/// The shutter is open, and the ball's keys are `distance` apart.
fn equal_keys(distance: f64) -> SceneDescription {
    let mut description = scene();
    description.objects[0].to_world = slide(distance);
    description.camera.shutter = Shutter::new(0.0, 1.0).expect("0 is before 1");
    description
}

fn slide(distance: f64) -> Motion {
    let to = DAffine3::from_translation(DVec3::new(distance, 0.0, 0.0));
    Motion::keyed(vec![(0.0, DAffine3::IDENTITY), (1.0, to)]).expect("two finite, invertible keys in order")
}

/// A black ball in the corner, alone or as a light.
fn black_ball(radiance: f32) -> ObjectSettings {
    let ball = ShapeSettings::Sphere { center: DVec3::new(1.0, 0.3, 0.5), radius: 0.3 };
    ObjectSettings { radiance: Rgb::splat(radiance).into(), ..thing(ball, DAffine3::IDENTITY, diffuse(0.0)) }
}

fn dark(radiance: f32) -> SceneDescription {
    let mut description = scene();
    description.objects.push(black_ball(radiance));
    description
}

fn without_light() -> SceneDescription {
    let mut description = scene();
    description.objects.push(black_ball(0.0));
    description
}

/// A ball of glass before the other one.
fn glass(eta: f32) -> SceneDescription {
    let white = || Texture::Constant(Rgb::WHITE);
    with_ball(Material::new_dielectric(eta, white(), white()).expect("etas of claims are above 0"))
}

/// A mirror before the ball, blurred or not.
fn blurred(blur: f32) -> SceneDescription {
    let white = || Texture::Constant(Rgb::WHITE);
    let material = Material::new_blur_disk(blur, None, white(), white());
    with_ball(material.expect("blurs of claims are 0 or at least 1e-4"))
}

fn mirror() -> SceneDescription {
    with_ball(Material::new_mirror(Texture::Constant(Rgb::WHITE)).expect("a reflectance of 1"))
}

fn with_ball(material: Material) -> SceneDescription {
    let mut description = scene();
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.2, 0.7, 1.5), radius: 0.4 };
    description.objects.insert(0, thing(ball, DAffine3::IDENTITY, Arc::new(material)));
    description
}

fn with_box(radius: f64) -> SceneDescription {
    let mut description = scene();
    description.film.filter = Filter::Box { radius };
    description
}

fn depth(max_depth: u32) -> SceneDescription {
    let mut description = scene();
    description.integrator.max_depth = Some(max_depth);
    description
}

fn direct() -> SceneDescription {
    let mut description = scene();
    description.integrator = IntegratorSettings::DIRECT;
    description
}
