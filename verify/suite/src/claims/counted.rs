//! How many rays a render follows.

use std::sync::atomic::{AtomicU64, Ordering};

use renderer::integrator::{Batch, Integrator, PathTracer, stages};
use renderer::render::{RenderSettings, render_with};
use renderer::sampling::{DecisionSet, Sampler, SamplerKind, Sobol};
use renderer::scene::{IntegratorSettings, Scene};

/// The path tracer's stages without its lights, which counts the rays that it follows.
struct Counter {
    settings: IntegratorSettings,
    rays: AtomicU64,
}

impl Integrator for Counter {
    fn decisions(&self, scene: &Scene) -> [DecisionSet; 2] {
        PathTracer { settings: self.settings }.decisions(scene)
    }

    fn trace<S: Sampler>(&self, scene: &Scene, sampler: &S, batch: &mut Batch) {
        stages::camera(scene, sampler, batch);
        for depth in 1..=self.settings.max_depth.unwrap_or(u32::MAX) {
            if batch.paths.is_empty() {
                break;
            }
            self.rays.fetch_add(batch.paths.len() as u64, Ordering::Relaxed);
            if self.settings.max_depth == Some(depth) {
                break;
            }
            stages::closest_hits(scene, batch);
            stages::surfaces(scene, batch);
            stages::scatter(scene, sampler, self.settings.branch, batch);
            if depth >= self.settings.rr_depth {
                stages::roulette(sampler, batch);
            }
        }
    }
}

/// The rays that a render of `samples` a pixel follows, a sample: shadow rays not counted.
pub(super) fn edges(scene: &Scene, samples: u32, seed: u64) -> f64 {
    let counter = Counter { settings: scene.integrator, rays: AtomicU64::new(0) };
    let settings = RenderSettings { sampler: SamplerKind::Sobol, samples, replicates: 1, seed, threads: 0 };
    let [planned, _] = counter.decisions(scene);
    render_with(scene, &counter, &Sobol::new(seed, planned), &settings, &|_| ())
        .expect("one replicate, at least one sample, and the threads at hand");
    let count = f64::from(scene.film.width) * f64::from(scene.film.height) * f64::from(samples);
    counter.rays.into_inner() as f64 / count
}
