//! Claims about what the camera's stages decide, recorded from samples of a real render.

use std::sync::{Arc, Mutex};

use renderer::integrator::batch::{Path, Sample};
use renderer::integrator::{Batch, Integrator, PathTracer, stages};
use renderer::render::{RenderSettings, render_with};
use renderer::sampling::{Decision, DecisionSet, Independent, SampleId, Sampler, SamplerKind, Vertex};
use renderer::scene::Scene;
use verify::chi_square::Target;
use verify::claim::{Claim, ClaimBuilder, Evidence, Run};
use verify::domain::Domain;
use verify::error::InputError;
use verify::histogram::Histogram;

use crate::setup::subject;

/// Size of the automatic control's defect, in resolutions.
const CONTROL_RESOLUTIONS: f64 = 2.2;

/// What is read off a sample and its camera ray.
pub(super) type Read<P> = fn(&Scene, &Sample, &Path) -> Option<P>;

/// A quantity of camera samples that should follow a density.
pub(super) struct Recorded<D: Domain> {
    /// The domain and the density.
    pub target: Target<D>,
    /// The decision behind the quantity.
    pub decision: Decision,
    /// The scene that is rendered.
    pub scene: Scene,
    /// The quantity.
    pub read: Read<D::Point>,
    /// RMS relative error over cells.
    pub bound: f64,
}

/// A control: the same with another scene, or with something else read.
pub(super) struct Wrong<P> {
    /// The mistake.
    pub name: &'static str,
    /// The scene, where the mistake is in it.
    pub scene: Option<Scene>,
    /// What is read.
    pub read: Read<P>,
}

impl<D: Domain> Recorded<D>
where
    D::Point: 'static,
{
    /// Completes a claim, with the gross mistake and a distortion u^(1+δ) of the decision's first number as controls.
    pub(super) fn claim(self, builder: ClaimBuilder, wrong: Wrong<D::Point>) -> Claim {
        let this = Arc::new(self);
        let (control, gross) = (this.clone(), this.clone());
        builder
            .bound(this.bound)
            .rejects(wrong.name, move |run| {
                gross.evidence(run, wrong.scene.as_ref().unwrap_or(&gross.scene), wrong.read, 1.0)
            })
            .rejects("u0^(1+δ), 2.2 × resolution", move |run| {
                let resolution = control.evidence(run, &control.scene, control.read, 1.0)?.resolution.value;
                // the density of u^(1+δ) is off by δ·(−1 − ln u) to first order, RMS δ
                let exponent = 1.0 + CONTROL_RESOLUTIONS * resolution;
                control.evidence(run, &control.scene, control.read, exponent)
            })
            .by(move |run| this.evidence(run, &this.scene, this.read, 1.0))
    }

    fn evidence(
        &self,
        run: &Run,
        scene: &Scene,
        read: Read<D::Point>,
        exponent: f64,
    ) -> Result<Evidence, InputError> {
        let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
        let needed = self.target.sample_count(self.bound)? * run.effort;
        let samples = u32::try_from(needed.div_ceil(pixels)).map_err(subject)?;
        let recorder =
            Recorder { target: &self.target, read, histogram: Mutex::new(self.target.histogram()) };
        #[expect(clippy::cast_possible_truncation, reason = "numbers are f32")]
        let sampler = Distorted {
            inner: Independent::new(run.seed),
            decision: self.decision,
            exponent: exponent as f32,
        };
        let settings = RenderSettings {
            sampler: SamplerKind::Independent,
            samples,
            replicates: 1,
            seed: run.seed,
            threads: 0,
        };
        render_with(scene, &recorder, &sampler, &settings, &|_| ()).map_err(subject)?;
        let histogram = recorder.histogram.into_inner().map_err(subject)?;
        self.target.judge(&histogram, self.bound)
    }
}

/// Runs the stages up to the camera's rays, and counts what it reads off them.
struct Recorder<'a, D: Domain> {
    target: &'a Target<D>,
    read: Read<D::Point>,
    histogram: Mutex<Histogram>,
}

impl<D: Domain> Integrator for Recorder<'_, D> {
    fn decisions(&self, scene: &Scene) -> [DecisionSet; 2] {
        PathTracer { settings: scene.integrator }.decisions(scene)
    }

    fn trace<S: Sampler>(&self, scene: &Scene, sampler: &S, batch: &mut Batch) {
        stages::camera(scene, sampler, batch);
        let mut histogram = self.histogram.lock().expect("no thread panics while it counts");
        for path in &batch.paths {
            match (self.read)(scene, &batch.samples[path.sample as usize], path) {
                Some(point) => self.target.add(&mut histogram, point),
                None => histogram.add_discarded(),
            }
        }
    }
}

/// A sampler with one decision's first number u replaced by a power of u.
struct Distorted {
    inner: Independent,
    decision: Decision,
    exponent: f32,
}

impl Distorted {
    fn distort(&self, u: f32, decision: Decision) -> f32 {
        if decision == self.decision && self.exponent != 1.0 { u.powf(self.exponent) } else { u }
    }
}

impl Sampler for Distorted {
    fn draw_1d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> f32 {
        self.distort(self.inner.draw_1d(sample, vertex, decision), decision)
    }

    fn draw_2d(&self, sample: SampleId, vertex: Vertex, decision: Decision) -> [f32; 2] {
        let [u, v] = self.inner.draw_2d(sample, vertex, decision);
        [self.distort(u, decision), v]
    }
}
