//! The stages of a batch, each a loop over slices.

use super::batch::{Batch, Path, Surface};
use crate::lights::Light;
use crate::materials::{Branch as MaterialBranch, Bsdf, BsdfSample, Lobe};
use crate::math::Rgb;
use crate::ray::Ray;
use crate::sampling::mis::power_heuristic;
use crate::sampling::{Decision, SampleId, Sampler, Vertex, warp};
use crate::scene::{Branch, Effect, Scene, Strategy};

/// Weight below which a path no longer forks.
const FORK_MIN: f32 = 1.0 / 64.0;

/// The stages from the film to the camera's rays, as far as the scene calls for them.
pub fn camera<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    film_points(scene, sampler, batch);
    if scene.effects.contains(Effect::Shutter) {
        shutter_times(scene, sampler, batch);
    }
    if scene.effects.contains(Effect::Lens) {
        lens_points(sampler, batch);
    }
    camera_rays(scene, batch);
}

/// Where on the film each sample lies, and its filter weight.
pub fn film_points<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    for sample in &mut batch.samples {
        let u = sampler.draw_2d(sample.id, Vertex::default(), Decision::Pixel);
        (sample.position, sample.weight) = scene.film.place(sample.id.pixel, u);
    }
}

/// When each sample sees the scene.
pub fn shutter_times<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    for sample in &mut batch.samples {
        sample.time = scene.shutter.time(sampler.draw_1d(sample.id, Vertex::default(), Decision::Time));
    }
}

/// Where on the lens each sample's ray starts.
pub fn lens_points<S: Sampler>(sampler: &S, batch: &mut Batch) {
    for sample in &mut batch.samples {
        let u = sampler.draw_2d(sample.id, Vertex::default(), Decision::Lens);
        sample.lens = warp::square_to_disk(u).to_array();
    }
}

/// The camera's ray of each sample.
pub fn camera_rays(scene: &Scene, batch: &mut Batch) {
    let has_lens = scene.camera.has_lens();
    for (index, sample) in (0..).zip(&batch.samples) {
        let p = scene.film.to_image(sample.position);
        let ray = if has_lens {
            scene.camera.lens_ray(p, sample.lens, sample.time)
        } else {
            scene.camera.ray(p, sample.time)
        };
        batch.paths.push(Path {
            sample: index,
            vertex: Vertex::default(),
            ray,
            throughput: Rgb::WHITE,
            eta_scale: 1.0,
            pdf: None,
        });
    }
}

/// What each path's ray meets first.
pub fn closest_hits(scene: &Scene, batch: &mut Batch) {
    batch.rays.clear();
    batch.rays.extend(batch.paths.iter().map(|p| p.ray));
    scene.accel.closest(&batch.rays, &mut batch.hits);
}

/// The surfaces that were hit.
pub fn surfaces(scene: &Scene, batch: &mut Batch) {
    batch.surfaces.clear();
    for (index, (path, hit)) in (0..).zip(batch.paths.iter().zip(&batch.hits)) {
        if let Some(hit) = hit {
            let interaction = scene.accel.interaction(&path.ray, hit);
            let frame = if scene.anisotropic {
                scene.frame_along(&path.ray, hit, &interaction)
            } else {
                interaction.frame()
            };
            batch.surfaces.push(Surface { path: index, hit: *hit, interaction, frame });
        }
    }
}

/// Light that each path's ray has run into, weighed against the chance of having connected to it.
pub fn emission(scene: &Scene, strategy: Strategy, batch: &mut Batch) {
    for index in 0..batch.surfaces.len() {
        let Surface { path, hit, interaction, .. } = batch.surfaces[index];
        let path = batch.paths[path as usize];
        let ng = interaction.surface.ng;
        if let Some((index, light)) = scene.light_of(interaction.object)
            && ng.dot(interaction.wo) > 0.0
        {
            let pmf = scene.lights.pmf(index, path.ray.origin);
            let pdf = pmf * light.pdf(&scene.accel, &path.ray, &hit, ng);
            batch
                .add(path.sample, path.throughput * light.radiance() * found_weight(strategy, path.pdf, pdf));
        }
    }
    let Some(light) = scene.lights.background() else { return };
    for index in 0..batch.paths.len() {
        if batch.hits[index].is_none() {
            let path = batch.paths[index];
            let direction = path.ray.direction;
            let pdf = scene.lights.pmf_far() * light.pdf_escaped(direction);
            let weight = found_weight(strategy, path.pdf, pdf);
            batch.add(path.sample, path.throughput * light.radiance_escaped(direction) * weight);
        }
    }
}

/// The weight of light found by a direction of density `pdf` (`None`: no other way could have found it), where a
/// connection to it has density `pdf_light`.
fn found_weight(strategy: Strategy, pdf: Option<f32>, pdf_light: f32) -> f32 {
    match (pdf, strategy) {
        (None, _) | (_, Strategy::Material) => 1.0,
        (Some(_), Strategy::Light) => 0.0,
        (Some(pdf), Strategy::Both) => power_heuristic(pdf, pdf_light),
    }
}

/// A point on a light for each surface that light can be connected to.
pub fn light_points<S: Sampler>(scene: &Scene, sampler: &S, strategy: Strategy, batch: &mut Batch) {
    let choose = scene.lights.needs_choice();
    for index in 0..batch.surfaces.len() {
        let Surface { path, interaction, frame, .. } = batch.surfaces[index];
        let path = batch.paths[path as usize];
        let material = scene.material(interaction.object);
        if material.calls_for().delta_only {
            continue;
        }
        let id = batch.samples[path.sample as usize].id;
        let u_light = if choose { sampler.draw_1d(id, path.vertex, Decision::LightChoice) } else { 0.0 };
        let (light, pmf) = scene.lights.choose(u_light, interaction.surface.point);
        let u = match light {
            Light::Point { .. } | Light::Spot(_) | Light::Directional { .. } => [0.0; 2],
            Light::Area(_) | Light::Constant { .. } | Light::Environment(_) => {
                sampler.draw_2d(id, path.vertex, Decision::LightPoint)
            }
        };
        let Some(light) = light.sample(&scene.accel, &interaction, u) else { continue };
        let bsdf = material.bsdf(interaction.surface.uv);
        let (wo, wi) = (frame.to_local(interaction.wo), frame.to_local(light.wi));
        let f_cos = bsdf.eval_cos(wo, wi);
        if f_cos.is_black() {
            continue;
        }
        let pdf = pmf * light.pdf;
        let weight = if light.delta || strategy == Strategy::Light {
            1.0
        } else {
            power_heuristic(pdf, bsdf.pdf(wo, wi))
        };
        let contribution = path.throughput * f_cos * light.radiance * (weight / pdf);
        batch.connect(path.sample, light.shadow_ray, contribution);
    }
}

/// Adds the light points that nothing hides.
pub fn occlusion(scene: &Scene, batch: &mut Batch) {
    scene.accel.occluded(&batch.shadow_rays, &mut batch.blocked);
    for index in 0..batch.connections.len() {
        if !batch.blocked[index] {
            let connection = batch.connections[index];
            batch.add(connection.sample, connection.contribution);
        }
    }
    batch.connections.clear();
    batch.shadow_rays.clear();
}

/// One further ray for each surface, or two where both branches of a dielectric are followed.
pub fn scatter<S: Sampler>(scene: &Scene, sampler: &S, branch: Branch, batch: &mut Batch) {
    let Batch { surfaces, paths, samples, .. } = batch;
    let mut next = Vec::with_capacity(surfaces.len());
    for surface in surfaces.iter() {
        let path = &paths[surface.path as usize];
        let bounce = Bounce { scene, sampler, surface, path, id: samples[path.sample as usize].id };
        bounce.follow(branch, &mut next);
    }
    *paths = next;
}

/// A path at a surface.
struct Bounce<'a, S> {
    scene: &'a Scene,
    sampler: &'a S,
    surface: &'a Surface,
    path: &'a Path,
    id: SampleId,
}

impl<S: Sampler> Bounce<'_, S> {
    fn follow(&self, branch: Branch, next: &mut Vec<Path>) {
        let interaction = &self.surface.interaction;
        let material = self.scene.material(interaction.object);
        let calls = material.calls_for();
        let bsdf = material.bsdf(interaction.surface.uv);
        let wo = self.surface.frame.to_local(interaction.wo);
        let vertex = self.path.vertex;
        // branches of one path share nothing: each draws at its own vertex
        let direction = |branch: u32| {
            let vertex = Vertex { branch, ..vertex };
            if calls.direction {
                self.sampler.draw_2d(self.id, vertex, Decision::Direction)
            } else {
                [0.0; 2]
            }
        };
        let lobe = || if calls.lobe { self.sampler.draw_1d(self.id, vertex, Decision::Lobe) } else { 0.0 };
        if !bsdf.forks() || branch == Branch::Fresnel {
            next.extend(
                bsdf.sample(wo, lobe(), direction(vertex.branch))
                    .and_then(|s| self.path_along(&s, vertex.branch, 1.0)),
            );
            return;
        }
        let reflected = bsdf.branch_probability_fresnel(wo);
        let can_fork = self.path.throughput.max_component() * reflected.min(1.0 - reflected) >= FORK_MIN;
        match branch {
            Branch::Both if can_fork => {
                for (child, which) in [(1, MaterialBranch::Reflect), (2, MaterialBranch::Refract)] {
                    let branch = vertex.branch.wrapping_mul(2).wrapping_add(child);
                    next.extend(self.branch(&bsdf, which, direction(branch), branch, 1.0));
                }
            }
            Branch::Half => {
                let which = if lobe() < 0.5 { MaterialBranch::Reflect } else { MaterialBranch::Refract };
                next.extend(self.branch(&bsdf, which, direction(vertex.branch), vertex.branch, 2.0));
            }
            Branch::Both | Branch::Fresnel => {
                let (which, share) = if lobe() < reflected {
                    (MaterialBranch::Reflect, reflected)
                } else {
                    (MaterialBranch::Refract, 1.0 - reflected)
                };
                next.extend(self.branch(&bsdf, which, direction(vertex.branch), vertex.branch, 1.0 / share));
            }
        }
    }

    /// The path along one branch of a dielectric, its throughput times `factor`.
    fn branch(
        &self,
        bsdf: &Bsdf,
        which: MaterialBranch,
        u: [f32; 2],
        branch: u32,
        factor: f32,
    ) -> Option<Path> {
        let wo = self.surface.frame.to_local(self.surface.interaction.wo);
        let sample = bsdf.sample_branch(wo, which, u)?;
        // the weights of light and material samples add up to 1 for any density that both agree on
        let pdf = bsdf.pdf(wo, sample.wi);
        self.path_along(&BsdfSample { pdf, ..sample }, branch, factor)
    }

    fn path_along(&self, sample: &BsdfSample, branch: u32, factor: f32) -> Option<Path> {
        let throughput = self.path.throughput * sample.weight * factor;
        if throughput.is_black() {
            return None;
        }
        let interaction = &self.surface.interaction;
        let ray: Ray = interaction.spawn(self.surface.frame.to_world(sample.wi));
        let eta = if sample.transmitted { sample.eta_rel * sample.eta_rel } else { 1.0 };
        let vertex = Vertex { bounce: self.path.vertex.bounce.saturating_add(1), branch, split: 0 };
        Some(Path {
            sample: self.path.sample,
            vertex,
            ray,
            throughput,
            eta_scale: self.path.eta_scale * eta,
            pdf: (sample.lobe == Lobe::Spread).then_some(sample.pdf),
        })
    }
}

/// Ends paths by chance: one goes on with probability q = min(0.95, throughput without the squeezing of solid
/// angles), and then counts 1/q times.
pub fn roulette<S: Sampler>(sampler: &S, batch: &mut Batch) {
    let Batch { paths, samples, .. } = batch;
    paths.retain_mut(|path| {
        let q = (path.throughput.max_component() * path.eta_scale).min(0.95);
        // the path's vertex is that of its next hit; the decision belongs to the one it leaves
        let vertex = Vertex { bounce: path.vertex.bounce - 1, ..path.vertex };
        let u = sampler.draw_1d(samples[path.sample as usize].id, vertex, Decision::Roulette);
        path.throughput = path.throughput / q;
        u < q
    });
}
