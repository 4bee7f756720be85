//! No number serves two decisions of one sample.

use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};

use glam::{DAffine3, DVec3};
use renderer::integrator::PathTracer;
use renderer::math::Rgb;
use renderer::render::{RenderSettings, render_with};
use renderer::sampling::{Decision, Independent, SampleId, Sampler, SamplerKind, Vertex};
use renderer::scene::{Branch, IntegratorSettings, LightSettings, Scene};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, Evidence, Run, claim};
use verify::error::InputError;
use verify::share;

use crate::bounds;
use crate::setup::{blurred_glass, built, diffuse, lamp, rectangle_at, spot, subject, thing};

/// Samples at effort 1: each asks for dozens of numbers.
const SAMPLES: u32 = 5000;

pub(super) fn claims() -> Vec<Claim> {
    let says = "a sample whose path forks at blurred glass, over a diffuse floor and under two lights, asks for no number twice";
    vec![
        claim("sampler/names/once", says)
            .rejects("both branches of a fork under one name", |run| evidence(run, 1))
            .rejects("the same in one sample of 256", |run| evidence(run, 256))
            .by(|run| evidence(run, u32::MAX)),
    ]
}

/// A sampler that notes which numbers it is asked for.
struct Register {
    inner: Independent,
    /// Of the last of each so many samples it takes both branches of a fork for one.
    forgetful: u32,
    asked: Mutex<Asked>,
}

#[derive(Default)]
struct Asked {
    names: HashSet<(SampleId, Vertex, Decision)>,
    again: u64,
    count: u64,
}

impl Register {
    fn note(&self, sample: SampleId, vertex: Vertex, decision: Decision) {
        let forgets = sample.index % self.forgetful == self.forgetful - 1;
        let vertex = if forgets { Vertex { branch: 0, ..vertex } } else { vertex };
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        asked.count += 1;
        if !asked.names.insert((sample, vertex, decision)) {
            asked.again += 1;
        }
    }
}

impl Sampler for Register {
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        self.note(sample, vertex, decision);
        self.inner.draw_1d(sample, vertex, decision)
    }

    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        self.note(sample, vertex, decision);
        self.inner.draw_2d(sample, vertex, decision)
    }
}

fn evidence(run: &Run, forgetful: u32) -> Result<Evidence, InputError> {
    let scene = forking();
    let samples = u32::try_from(u64::from(SAMPLES) * run.effort).map_err(subject)?;
    let settings = RenderSettings {
        sampler: SamplerKind::Independent,
        samples,
        replicates: 1,
        seed: run.seed,
        threads: 1,
    };
    let register =
        Register { inner: Independent::new(run.seed), forgetful, asked: Mutex::new(Asked::default()) };
    let integrator = PathTracer { settings: scene.integrator };
    render_with(&scene, &integrator, &register, &settings, &|_| ()).map_err(subject)?;
    let asked = register.asked.into_inner().unwrap_or_else(PoisonError::into_inner);
    share::judge("share of numbers asked for twice", asked.again, asked.count, bounds::MISSES)
}

/// A ball of blurred glass over a floor, under a lamp and a sky; every path follows both branches.
fn forking() -> Scene {
    let ball = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
    let floor = rectangle_at(DVec3::new(0.0, -1.5, 0.0), 5.0 * DVec3::X, -5.0 * DVec3::Z);
    let above = rectangle_at(DVec3::new(0.0, 3.0, 0.0), DVec3::X, DVec3::Z);
    let objects = vec![
        thing(ball, DAffine3::IDENTITY, blurred_glass(0.2, 1.5)),
        thing(ShapeSettings::Rectangle, floor, diffuse(0.5)),
        lamp(ShapeSettings::Rectangle, above),
    ];
    let integrator = IntegratorSettings {
        branch: Branch::Both,
        max_depth: Some(8),
        rr_depth: 3,
        ..IntegratorSettings::PATH
    };
    let mut description = spot(DVec3::new(0.3, 0.6, -4.0), DVec3::new(0.1, -0.2, 0.0), objects, integrator);
    description.lights.push(LightSettings::Constant { radiance: Rgb::splat(0.3) });
    built(&description)
}
