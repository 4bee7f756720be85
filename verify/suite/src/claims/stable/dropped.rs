//! Samples that overflow are left out, and each is counted: none is clamped, and none spoils its pixel.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use renderer::integrator::PathTracer;
use renderer::materials::Material;
use renderer::math::Rgb;
use renderer::render::{RenderSettings, Rendering, render};
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, LightSettings, ObjectSettings, SceneDescription};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, Evidence, Run, claim};
use verify::error::InputError;

use super::hard::wide;
use super::routine::worst_case;
use crate::setup::{built, diffuse, lamp, receiver, rectangle_at, spot, subject, thing};

pub(super) fn claims() -> Vec<Claim> {
    vec![all(), some(), sums()]
}

/// One replicate of a scene, whose pixels have `samples` samples.
fn rendered(description: &SceneDescription, samples: u32, seed: u64) -> Result<Rendering, InputError> {
    let scene = built(description);
    let settings =
        RenderSettings { sampler: SamplerKind::Independent, samples, replicates: 1, seed, threads: 0 };
    render(&scene, &PathTracer { settings: scene.integrator }, &settings, &|_| ()).map_err(subject)
}

/// How many of a rendering's samples are neither in its pixels nor counted as dropped, or both.
fn uncounted(image: &Rendering, lost: u64) -> Evidence {
    let n = image.pixels.iter().map(|p| p.samples).sum();
    let finite = image.pixels.iter().all(|p| p.mean.iter().all(|m| m.is_finite()));
    let error = if finite { lost.abs_diff(image.dropped) as f64 } else { f64::INFINITY };
    worst_case("samples dropped and not counted", error, n, 0.5, None)
}

/// A plate lit by a point light that hangs over it.
fn below_a_point(height: f64, intensity: f32) -> SceneDescription {
    let mut description = receiver(Vec::new());
    let position = DVec3::new(0.0, 0.0, height);
    description.lights.push(LightSettings::Point { position, intensity: Rgb::splat(intensity) });
    description
}

/// A point light whose irradiance overflows everywhere.
fn all() -> Claim {
    let trial = |run: &Run, intensity: f32| {
        let image = rendered(&below_a_point(1e-6, intensity), 1024, run.seed)?;
        let black = image.pixels.iter().all(|p| p.mean == [0.0; 3]);
        let n = image.pixels.iter().map(|p| p.samples).sum();
        Ok(uncounted(&image, if black { n } else { 0 }))
    };
    claim("stable/scene/dropped", "samples that are not finite are left out, and each is counted")
        .rejects("a count that is one short", move |run| {
            let image = rendered(&below_a_point(1e-6, 3e38), 1024, run.seed)?;
            Ok(uncounted(&image, image.dropped + 1))
        })
        .by(move |run| trial(run, 3e38))
}

/// A point light whose irradiance overflows near its foot only: with one sample a pixel the pixels that are black there are
/// those whose sample was dropped, as no sample is under a dim light.
fn some() -> Claim {
    let scene = |intensity: f32| {
        let plate = thing(ShapeSettings::Rectangle, DAffine3::IDENTITY, diffuse(1.0));
        let eye = DVec3::new(0.3, -2.0, 2.0);
        let mut description = spot(eye, DVec3::ZERO, vec![plate], IntegratorSettings::DIRECT);
        let position = DVec3::new(0.0, 0.0, 0.1);
        description.lights.push(LightSettings::Point { position, intensity: Rgb::splat(intensity) });
        wide(description, 64, 64)
    };
    let trial = move |run: &Run, counted: i64| -> Result<Evidence, InputError> {
        let [dim, bright] = [1e30, 1.5e38].map(|intensity| rendered(&scene(intensity), 1, run.seed));
        let (dim, mut bright) = (dim?, bright?);
        let lit = |image: &Rendering| image.pixels.iter().map(|p| p.mean != [0.0; 3]).collect::<Vec<_>>();
        let lost =
            lit(&dim).into_iter().zip(lit(&bright)).filter(|(dim, bright)| *dim && !bright).count() as u64;
        let visible = lit(&dim).into_iter().filter(|lit| *lit).count() as u64;
        bright.dropped = bright.dropped.saturating_add_signed(counted);
        let evidence = uncounted(&bright, lost);
        // Some and not all: else this would say nothing.
        let doubt = format!("{lost} of {visible} samples overflow; a tenth to nine tenths are accepted");
        let doubts = if 10 * lost < visible || 10 * lost > 9 * visible { vec![doubt] } else { Vec::new() };
        Ok(Evidence { doubts, ..evidence })
    };
    claim(
        "stable/scene/dropped-some",
        "where some samples of an image overflow, those and no others are left out and counted",
    )
    .rejects("one is not counted", move |run| trial(run, -1))
    .rejects("one is counted twice", move |run| trial(run, 1))
    .by(move |run| trial(run, 0))
}

/// Two contributions of 3e38 to one sample, of which each is finite: one is left out.
fn sums() -> Claim {
    let scene = |second: f32| {
        let side = |x: f64| rectangle_at(DVec3::new(x, 0.0, 1.0), DVec3::Y, DVec3::Z);
        let mirror = Material::new_mirror(Rgb::WHITE.into()).expect("a reflectance of 1");
        let near = thing(ShapeSettings::Rectangle, side(0.0), Arc::new(mirror));
        let far = lamp(ShapeSettings::Rectangle, side(4.0));
        let objects = vec![
            ObjectSettings { radiance: Rgb::splat(3e38).into(), ..near },
            ObjectSettings { radiance: Rgb::splat(second).into(), flip_normals: true, ..far },
        ];
        let integrator = IntegratorSettings { max_depth: Some(3), ..IntegratorSettings::PATH };
        spot(DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 1.0), objects, integrator)
    };
    let trial = move |run: &Run, second: f32| {
        let image = rendered(&scene(second), 256, run.seed)?;
        // What came first stays: 3e38, which is rounded by 2⁻²⁵ of it.
        let stays = image.pixels.iter().flat_map(|p| p.mean).all(|m| (m / 3e38 - 1.0).abs() < 1e-7);
        let n = image.pixels.iter().map(|p| p.samples).sum();
        Ok(uncounted(&image, if stays { n } else { 0 }))
    };
    claim("stable/scene/dropped-sums", "a contribution that makes a sample overflow is left out and counted")
        .rejects("a second one of 1e30, which fits", move |run| trial(run, 1e30))
        .by(move |run| trial(run, 3e38))
}
