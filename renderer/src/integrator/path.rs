//! Light paths from the camera, from surface to surface.

use super::{Batch, Integrator, reuse, stages};
use crate::sampling::{Decision, DecisionSet, Sampler};
use crate::scene::{Effect, IntegratorSettings, Scene, Strategy};

/// Follows paths from the camera.
///
/// The radiance leaving a surface is what it emits and what it reflects: L = Le + ∫ f·L·|cos θ| dω. The integral's
/// direct part is estimated by points on lights, its indirect part by one further ray, and so on until the longest
/// path, black, or Russian roulette ends it. The last ray of the longest path can only find lights; where points on them do
/// that well by themselves, it is left out.
///
/// # Source
/// Kajiya 1986, "The rendering equation" (doi:10.1145/15886.15902); Veach 1997, "Robust Monte Carlo methods for
/// light transport simulation", section 9.2 for the weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathTracer {
    /// Which paths, and how.
    pub settings: IntegratorSettings,
}

impl Integrator for PathTracer {
    fn decisions(&self, scene: &Scene) -> [DecisionSet; 2] {
        let mut later = DecisionSet::EMPTY;
        let settings = &self.settings;
        let follows = |depth: u32| settings.max_depth.is_none_or(|max| depth <= max);
        if follows(2) {
            if settings.strategy != Strategy::Material && !scene.lights.is_empty() {
                later = later.with(Decision::LightPoint);
                if scene.lights.needs_choice() {
                    later = later.with(Decision::LightChoice);
                }
            }
            let calls: Vec<_> = scene.materials().map(|m| m.calls_for()).collect();
            if calls.iter().any(|c| c.lobe) {
                later = later.with(Decision::Lobe);
            }
            if calls.iter().any(|c| c.direction) {
                later = later.with(Decision::Direction);
            }
        }
        let mut first = later.with(Decision::Pixel);
        if let Some(emission) = &scene.emission {
            // Where paths from lights begin.
            first = first.with(Decision::LightPoint).with(Decision::Direction);
            if emission.needs_choice() {
                first = first.with(Decision::LightChoice);
            }
        }
        if scene.effects.contains(Effect::Lens) {
            first = first.with(Decision::Lens);
        }
        if scene.effects.contains(Effect::Shutter) {
            first = first.with(Decision::Time);
        }
        if follows(settings.rr_depth.saturating_add(1)) {
            later = later.with(Decision::Roulette);
            if settings.rr_depth <= 1 {
                first = first.with(Decision::Roulette);
            }
        }
        [first, later]
    }

    fn reuses(&self, scene: &Scene) -> bool {
        self.settings.reuse && !scene.effects.contains(Effect::Shutter)
    }

    fn trace<S: Sampler>(&self, scene: &Scene, sampler: &S, batch: &mut Batch) {
        let settings = &self.settings;
        let lights = settings.strategy != Strategy::Material && !scene.lights.is_empty();

        let reuses = self.reuses(scene);

        stages::camera(scene, sampler, batch);
        for depth in 1..=settings.max_depth.unwrap_or(u32::MAX) {
            if batch.paths.is_empty() {
                break;
            }
            stages::closest_hits(scene, batch);
            if depth == 1 && settings.hide_emitters {
                stages::pass_emitters(scene, batch);
            }
            stages::surfaces(scene, batch);
            if depth > 1 || !settings.hide_emitters {
                stages::emission(scene, settings.strategy, batch);
            }
            if settings.max_depth == Some(depth) {
                break;
            }
            if reuses && depth == 2 {
                reuse::reach_second(scene, batch);
            }
            let last = settings.max_depth.is_some_and(|max| max - depth == 1);
            if lights {
                stages::light_points(scene, sampler, settings.strategy, last, batch);
                stages::occlusion(scene, batch);
            }
            if last {
                stages::leave_connected(scene, settings.strategy, batch);
            }
            if reuses && depth == 1 {
                reuse::leave_first(scene, settings.rr_depth <= 1, batch);
            }
            stages::scatter(scene, sampler, settings.branch, batch);
            if depth >= settings.rr_depth {
                stages::roulette(sampler, batch);
            }
        }
        if reuses {
            reuse::share(scene, batch);
        }
    }
}
