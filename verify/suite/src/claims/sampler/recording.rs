//! The numbers that renders of a scene ask for, written down as they are given.

use std::sync::{Arc, Mutex};

use glam::{DAffine3, DVec3};
use renderer::camera::{FovAxis, Projection, Shutter};
use renderer::film::FilmSettings;
use renderer::integrator::{Integrator, PathTracer};
use renderer::materials::Material;
use renderer::math::Rgb;
use renderer::math::transform::Motion;
use renderer::render::{RenderSettings, render_with};
use renderer::sampling::{Decision, SampleId, Sampler, SamplerKind, Vertex};
use renderer::scene::{IntegratorSettings, ObjectSettings, Scene, SceneDescription};
use renderer::shapes::ShapeSettings;
use renderer::texture::Texture;
use verify::error::InputError;
use verify::points;

use crate::setup::{lamp, sampler, spot, subject, thing};
use crate::wrong::samplers::{Confused, Question};

/// Columns and rows of the image, even.
const SIDE: usize = 48;
/// Replicates of a render, even.
const REPLICATES: usize = 2;
/// Samples of a pixel and replicate.
pub(super) const SAMPLES: usize = 2;
/// Bounces whose numbers are kept: 0 to 3.
const BOUNCES: usize = 4;
/// Numbers of a sample before the first hit: pixel, lens, time.
const CAMERA: usize = 5;
/// Numbers of a bounce: light choice, light point, lobe, direction, roulette.
const BOUNCE: usize = 7;
/// Numbers of a sample.
const NUMBERS: usize = CAMERA + BOUNCES * BOUNCE;

/// Which of a sample's numbers.
pub(super) enum Place {}

impl Place {
    /// The lens's first number.
    pub(super) const LENS: usize = 2;
    /// The shutter's number.
    pub(super) const TIME: usize = 4;

    /// The first place of a decision, in the order in which decisions are made; `None` beyond the last bounce.
    fn of(vertex: Vertex, decision: Decision) -> Option<usize> {
        let bounce = usize::from(vertex.bounce);
        let within = match decision {
            Decision::Pixel => return Some(0),
            Decision::Lens => return Some(Self::LENS),
            Decision::Time => return Some(Self::TIME),
            Decision::LightChoice => 0,
            Decision::LightPoint => 1,
            Decision::Lobe => 3,
            Decision::Direction => 4,
            Decision::Roulette => 6,
        };
        (bounce < BOUNCES).then_some(CAMERA + bounce * BOUNCE + within)
    }

    /// The names of all places.
    pub(super) fn names() -> Vec<String> {
        let axis = |decision: Decision, k: usize| match (decision.dimensions(), k) {
            (1, _) => "",
            (_, 0) => " x",
            _ => " y",
        };
        let mut names = vec![String::new(); NUMBERS];
        for bounce in (0..).take(BOUNCES) {
            for decision in Decision::ALL {
                let vertex = Vertex { bounce, ..Vertex::default() };
                for k in 0..decision.dimensions() {
                    if let Some(place) =
                        Self::of(vertex, decision).filter(|_| bounce == 0 || is_at_bounces(decision))
                    {
                        names[place + k] = format!("{decision:?}{} at bounce {bounce}", axis(decision, k));
                    }
                }
            }
        }
        names
    }
}

fn is_at_bounces(decision: Decision) -> bool {
    !matches!(decision, Decision::Pixel | Decision::Lens | Decision::Time)
}

/// A share of sets in which one number is put in the place of another.
#[derive(Clone, Copy)]
pub(super) struct Reuse {
    /// The share, at most 1.
    pub(super) share: f64,
    /// Which sets they are.
    pub(super) seed: u64,
}

/// The numbers of one render, by set (replicate and pixel) and sample; NaN where none was asked for.
pub(super) struct Recording(Vec<[[f32; NUMBERS]; SAMPLES]>);

impl Recording {
    /// Sets of a render: pixels and replicates.
    pub(super) const SETS: usize = REPLICATES * SIDE * SIDE;

    /// Renders the scene with the sampler of `kind` and `seed`, which may take one question for another.
    pub(super) fn of(
        kind: SamplerKind,
        seed: u64,
        question: Option<fn(Question) -> Question>,
    ) -> Result<Self, InputError> {
        let scene = Scene::new(&description()?).map_err(subject)?;
        let integrator = PathTracer { settings: scene.integrator };
        let [first, _] = integrator.decisions(&scene);
        let count = |n: usize| u32::try_from(n).map_err(subject);
        let right = sampler(kind, seed, first, count(SAMPLES)?);
        let inner: Box<dyn Sampler> = match question {
            Some(question) => Box::new(Confused { inner: right, question }),
            None => right,
        };
        let empty = vec![[[f32::NAN; NUMBERS]; SAMPLES]; Self::SETS];
        let recorder = Recorder { inner, recording: Mutex::new(Self(empty)) };
        let settings = RenderSettings {
            sampler: kind,
            samples: count(SAMPLES)?,
            replicates: count(REPLICATES)?,
            seed,
            threads: 1,
        };
        render_with(&scene, &integrator, &recorder, &settings, &|_| ()).map_err(subject)?;
        recorder.recording.into_inner().map_err(subject)
    }

    /// The numbers of one sample of a set.
    pub(super) fn numbers(&self, set: usize, index: usize) -> &[f32; NUMBERS] {
        &self.0[set][index]
    }

    /// The sample of a set that stands for it: the first and the second on a checkerboard.
    pub(super) fn chosen(set: usize) -> usize {
        (set % SIDE + set / SIDE) % SAMPLES
    }

    /// The set to the right of one in an even column; so no set is in two pairs.
    pub(super) fn right_of(set: usize) -> Option<usize> {
        set.is_multiple_of(2).then_some(set + 1)
    }

    /// The set below one in an even row.
    pub(super) fn below(set: usize) -> Option<usize> {
        (set / SIDE).is_multiple_of(2).then_some(set + SIDE)
    }

    /// The same pixel's second set.
    pub(super) fn next_replicate(set: usize) -> Option<usize> {
        (set < SIDE * SIDE).then_some(set + SIDE * SIDE)
    }

    /// Puts the number of one place in another's, in a share of the sets.
    pub(super) fn reuse(&mut self, from: usize, to: usize, reuse: Reuse) {
        for (set, samples) in (0..).zip(&mut self.0) {
            let mut u = [0.0];
            points::fill(reuse.seed, set, &mut u);
            if u[0] < reuse.share {
                samples.iter_mut().for_each(|numbers| numbers[to] = numbers[from]);
            }
        }
    }

    fn put(&mut self, sample: SampleId, place: usize, value: f32) {
        let [x, y, replicate, index] =
            [sample.pixel[0], sample.pixel[1], sample.replicate, sample.index].map(|n| n as usize);
        self.0[(replicate * SIDE + y) * SIDE + x][index][place] = value;
    }
}

/// A sampler that writes down what it is asked for and what it answers.
struct Recorder {
    inner: Box<dyn Sampler>,
    recording: Mutex<Recording>,
}

impl Recorder {
    fn write(&self, sample: SampleId, vertex: Vertex, decision: Decision, values: &[f32]) {
        if let Some(place) = Place::of(vertex, decision) {
            let mut recording = self.recording.lock().expect("no thread panics while it writes");
            for (k, &value) in values.iter().enumerate() {
                recording.put(sample, place + k, value);
            }
        }
    }
}

impl Sampler for Recorder {
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        let value = self.inner.draw_1d(sample, vertex, decision);
        self.write(sample, vertex, decision, &[value]);
        value
    }

    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        let values = self.inner.draw_2d(sample, vertex, decision);
        self.write(sample, vertex, decision, &values);
        values
    }
}

/// A closed glossy room with two spherical lamps and a ball that moves, through a lens: each decision is made, and most paths go on
/// beyond the third bounce.
fn description() -> Result<SceneDescription, InputError> {
    let grey = |value| Texture::Constant(Rgb::splat(value));
    let glossy = Arc::new(Material::new_phong(grey(0.5), grey(0.45), 20.0).map_err(subject)?);
    let ball = |center, radius| ShapeSettings::Sphere { center, radius };
    let room = ObjectSettings {
        flip_normals: true,
        ..thing(ball(DVec3::ZERO, 2.0), DAffine3::IDENTITY, glossy.clone())
    };
    let start = DAffine3::from_translation(DVec3::new(0.5, -0.3, 0.8));
    let end = DAffine3::from_translation(DVec3::new(-0.5, -0.3, 0.8));
    let moving = ObjectSettings {
        to_world: Motion::keyed(vec![(0.0, start), (1.0, end)]).map_err(subject)?,
        ..thing(ball(DVec3::ZERO, 0.2), DAffine3::IDENTITY, glossy)
    };
    let lamps = [DVec3::new(0.8, 1.2, 0.3), DVec3::new(-0.9, 1.0, -0.6)]
        .map(|center| lamp(ball(center, 0.15), DAffine3::IDENTITY));
    let objects = [room, moving].into_iter().chain(lamps).collect();
    let integrator = IntegratorSettings { max_depth: Some(5), rr_depth: 1, ..IntegratorSettings::PATH };
    let mut description = spot(DVec3::new(0.0, 0.0, -1.5), DVec3::ZERO, objects, integrator);
    description.camera.projection =
        Projection::Perspective { fov: 60.0, axis: FovAxis::X, lens_radius: 0.02, focus_distance: 2.0 };
    description.camera.shutter = Shutter::new(0.0, 1.0).map_err(subject)?;
    let side = u32::try_from(SIDE).map_err(subject)?;
    description.film = FilmSettings { width: side, height: side, ..description.film };
    Ok(description)
}
