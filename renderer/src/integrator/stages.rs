//! The stages of a batch, each a loop over slices.

use glam::Vec3;

use super::batch::{Batch, Connection, Draws, Path, Surface};
use crate::interaction::Interaction;
use crate::lights::{Light, LightSample};
use crate::materials::{Branch as MaterialBranch, Bsdf, BsdfSample, Lobe};
use crate::math::{Frame, Rgb};
use crate::ray::Ray;
use crate::sampling::mis::power_heuristic;
use crate::sampling::{Decision, SampleId, Sampler, Vertex, warp};
use crate::scene::{Branch, Effect, Meter, Scene, Strategy};

/// Share of its sample's light below which a path no longer forks. Forks divide it, and refraction doesn't squeeze it, so that
/// they make at most 64 paths of one that begins with all of the light.
const FORK_MIN: f32 = 1.0 / 64.0;

/// The stages from the film to the camera's rays, as far as the scene calls for them.
pub fn camera<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    film_points(scene, sampler, batch);
    if scene.effects.contains(Effect::Shutter) {
        shutter_times(scene, sampler, batch);
    }
    if scene.effects.contains(Effect::Lens) {
        lens_points(scene, sampler, batch);
    }
    camera_rays(scene, batch);
}

/// Where on the film each sample lies, and its filter weight.
pub fn film_points<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    let Batch { samples, draws, .. } = batch;
    draws.at_camera(samples);
    sampler.draw_2d_each(&draws.places, Decision::Pixel, &mut draws.points);
    for (sample, &u) in samples.iter_mut().zip(&draws.points) {
        (sample.position, sample.weight) = scene.film.place(sample.id.pixel, u);
    }
}

/// When each sample sees the scene.
pub fn shutter_times<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    for sample in &mut batch.samples {
        sample.time = scene.shutter.time(sampler.draw_1d(sample.id, Vertex::default(), Decision::Time));
    }
}

/// Where on the lens each sample's ray starts; of a meter the numbers of its direction.
pub fn lens_points<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    let Batch { samples, draws, .. } = batch;
    draws.at_camera(samples);
    sampler.draw_2d_each(&draws.places, Decision::Lens, &mut draws.points);
    for (sample, &u) in samples.iter_mut().zip(&draws.points) {
        sample.lens = if scene.meter.is_some() { u } else { warp::square_to_disk(u).to_array() };
    }
}

/// The camera's ray of each sample.
pub fn camera_rays(scene: &Scene, batch: &mut Batch) {
    let (has_lens, meter) = (scene.camera.has_lens(), scene.meter);
    let throughput = if meter.is_some() { Rgb::splat(Meter::WEIGHT) } else { Rgb::WHITE };
    for (index, sample) in (0..).zip(&batch.samples) {
        let p = scene.film.to_image(sample.position);
        let ray = if let Some(meter) = meter {
            meter.ray(scene, p, sample.lens, sample.time)
        } else if has_lens {
            scene.camera.lens_ray(p, sample.lens, sample.time)
        } else {
            scene.camera.ray(p, sample.time)
        };
        batch.paths.push(Path {
            sample: index,
            vertex: Vertex::default(),
            ray,
            throughput,
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
            batch.surfaces.push(Surface { path: index, hit: *hit, interaction });
        }
    }
}

/// The frame in which the material of a surface sees directions.
fn frame(scene: &Scene, path: &Path, surface: &Surface) -> Frame {
    if scene.anisotropic {
        scene.frame_along(&path.ray, &surface.hit, &surface.interaction)
    } else {
        surface.interaction.frame()
    }
}

/// Light that each path's ray has run into, weighed against the chance of having connected to it.
pub fn emission(scene: &Scene, strategy: Strategy, batch: &mut Batch) {
    for index in 0..batch.surfaces.len() {
        let Surface { path, hit, interaction } = &batch.surfaces[index];
        let ng = interaction.surface.ng;
        if let Some((index, light)) = scene.light_of(interaction.object)
            && ng.dot(interaction.wo) > 0.0
        {
            let path = batch.paths[*path as usize];
            let pmf = scene.lights.pmf(index, path.ray.origin);
            let pdf = pmf * light.pdf(&scene.accel, &path.ray, hit, ng);
            let weight = found_weight(strategy, path.pdf, pdf);
            batch.add(path.sample, path.throughput * light.radiance_at(interaction.surface.uv) * weight);
        }
    }
    let Some(light) = scene.lights.background() else { return };
    let pmf = scene.lights.pmf_background();
    for index in 0..batch.paths.len() {
        if batch.hits[index].is_none() {
            let path = batch.paths[index];
            let direction = path.ray.direction;
            let pdf = pmf * light.pdf_escaped(direction);
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
///
/// * `last`: whether the edge that follows would be the last of the longest path.
pub fn light_points<S: Sampler>(
    scene: &Scene,
    sampler: &S,
    strategy: Strategy,
    last: bool,
    batch: &mut Batch,
) {
    let Batch { surfaces, paths, samples, draws, connections, shadow_rays, .. } = batch;
    let is_lit = |surface: &&Surface| !scene.calls_for(surface.interaction.object).delta_only;
    let lit: Vec<&Surface> = surfaces.iter().filter(is_lit).collect();
    draws.at_surfaces(lit.iter().copied(), paths, samples);
    if scene.lights.needs_choice() {
        sampler.draw_1d_each(&draws.places, Decision::LightChoice, &mut draws.choices);
    } else {
        draws.no_choices();
    }
    if scene.lights.have_extent() {
        sampler.draw_2d_each(&draws.places, Decision::LightPoint, &mut draws.points);
    } else {
        draws.no_points();
    }
    let (pmfs, found) = points_on_lights(scene, &lit, draws);
    for (surface, (pmf, light)) in lit.iter().zip(pmfs.iter().zip(found)) {
        let Some(light) = light else { continue };
        let interaction = &surface.interaction;
        let path = &paths[surface.path as usize];
        let alone = last && is_connected(scene, strategy, interaction.object);
        let weighed = !(light.delta || alone || strategy == Strategy::Light);
        let (f_cos, pdf_bsdf) = towards(scene, path, surface, light.wi, weighed);
        if f_cos.is_black() {
            continue;
        }
        let pdf = pmf * light.pdf;
        let weight = if weighed { power_heuristic(pdf, pdf_bsdf) } else { 1.0 };
        let contribution = path.throughput * f_cos * light.radiance * (weight / pdf);
        connections.push(Connection { sample: path.sample, contribution });
        shadow_rays.push(light.shadow_ray);
    }
}

/// What the material of a surface makes of light from the direction `wi`: f |cos θᵢ|, and the density of that direction
/// where it is asked for.
#[inline]
fn towards(scene: &Scene, path: &Path, surface: &Surface, wi: Vec3, with_pdf: bool) -> (Rgb, f32) {
    let Interaction { surface: point, wo, object, .. } = &surface.interaction;
    if let Some(matte) = scene.material(*object).matte(point.uv) {
        return matte.eval_cos(wo.dot(point.n), wi.dot(point.n));
    }
    let frame = frame(scene, path, surface);
    let bsdf = scene.material(*object).bsdf(point.uv);
    let (wo, wi) = (frame.to_local(*wo), frame.to_local(wi));
    let f_cos = bsdf.eval_cos(wo, wi);
    let pdf = if with_pdf && !f_cos.is_black() { bsdf.pdf(wo, wi) } else { 0.0 };
    (f_cos, pdf)
}

/// For each of `lit` the probability of the light chosen and a point on it.
fn points_on_lights(scene: &Scene, lit: &[&Surface], draws: &Draws) -> (Vec<f32>, Vec<Option<LightSample>>) {
    let mut found = Vec::with_capacity(lit.len());
    if let Some(only) = scene.lights.only() {
        let from: Vec<&Interaction> = lit.iter().map(|surface| &surface.interaction).collect();
        only.sample_each(&scene.accel, &from, &draws.points, &mut found);
        return (vec![1.0; lit.len()], found);
    }
    let choose = |(&u, surface): (&f32, &&Surface)| scene.lights.choose(u, surface.interaction.surface.point);
    let (lights, pmfs): (Vec<&Light>, Vec<f32>) = draws.choices.iter().zip(lit).map(choose).unzip();
    // Light by light, since a light finds many points faster than as many times one.
    let mut order: Vec<usize> = (0..lit.len()).collect();
    order.sort_unstable_by_key(|&k| std::ptr::from_ref(lights[k]));
    let from: Vec<&Interaction> = order.iter().map(|&k| &lit[k].interaction).collect();
    let points: Vec<[f32; 2]> = order.iter().map(|&k| draws.points[k]).collect();
    let mut start = 0;
    for run in order.chunk_by(|&a, &b| std::ptr::eq(lights[a], lights[b])) {
        let range = start..start + run.len();
        lights[run[0]].sample_each(&scene.accel, &from[range.clone()], &points[range], &mut found);
        start += run.len();
    }
    let mut in_place = vec![None; lit.len()];
    order.iter().zip(found).for_each(|(&k, sample)| in_place[k] = sample);
    (pmfs, in_place)
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

/// Whether points on lights are all that is needed for the last edge from the object of that index.
fn is_connected(scene: &Scene, strategy: Strategy, object: u32) -> bool {
    strategy == Strategy::Both && scene.lights.are_even() && scene.is_matte(object)
}

/// Leaves out the surfaces from which no last ray is needed.
pub fn leave_connected(scene: &Scene, strategy: Strategy, batch: &mut Batch) {
    batch.surfaces.retain(|surface| !is_connected(scene, strategy, surface.interaction.object));
}

/// One further ray for each surface, or two where both branches of a dielectric are followed.
pub fn scatter<S: Sampler>(scene: &Scene, sampler: &S, branch: Branch, batch: &mut Batch) {
    let Batch { surfaces, paths, next, samples, draws, .. } = batch;
    draws.at_surfaces(surfaces.iter(), paths, samples);
    if scene.decides(Decision::Lobe) {
        sampler.draw_1d_each(&draws.places, Decision::Lobe, &mut draws.choices);
    } else {
        draws.no_choices();
    }
    if scene.decides(Decision::Direction) {
        sampler.draw_2d_each(&draws.places, Decision::Direction, &mut draws.points);
    } else {
        draws.no_points();
    }
    next.clear();
    for (surface, (&u_lobe, &u)) in surfaces.iter().zip(draws.choices.iter().zip(&draws.points)) {
        let path = &paths[surface.path as usize];
        let id = samples[path.sample as usize].id;
        let frame = frame(scene, path, surface);
        Bounce { scene, sampler, surface, frame, path, id, u_lobe, u }.follow(branch, next);
    }
    std::mem::swap(paths, next);
}

/// A path at a surface.
struct Bounce<'a, S> {
    scene: &'a Scene,
    sampler: &'a S,
    surface: &'a Surface,
    /// Around the surface's shading normal.
    frame: Frame,
    path: &'a Path,
    id: SampleId,
    /// The numbers of the path's own branch for the choice of a lobe and a direction in it.
    u_lobe: f32,
    u: [f32; 2],
}

impl<S: Sampler> Bounce<'_, S> {
    fn follow(&self, branch: Branch, next: &mut Vec<Path>) {
        let interaction = &self.surface.interaction;
        let material = self.scene.material(interaction.object);
        let wo = self.frame.to_local(interaction.wo);
        let vertex = self.path.vertex;
        if let Some(matte) = material.matte(interaction.surface.uv) {
            let sample = matte.sample(wo, self.u);
            next.extend(sample.and_then(|sample| self.path_along(&sample, vertex.branch, 1.0)));
            return;
        }
        let bsdf = material.bsdf(interaction.surface.uv);
        // branches of one path share nothing: each draws at its own vertex
        let direction = |branch: u32| {
            if branch == vertex.branch || !self.scene.calls_for(interaction.object).direction {
                self.u
            } else {
                self.sampler.draw_2d(self.id, Vertex { branch, ..vertex }, Decision::Direction)
            }
        };
        if !bsdf.forks() || branch == Branch::Fresnel {
            next.extend(
                bsdf.sample(wo, self.u_lobe, self.u).and_then(|s| self.path_along(&s, vertex.branch, 1.0)),
            );
            return;
        }
        let reflected = bsdf.branch_probability_fresnel(wo);
        let share = self.path.throughput.max_component() * self.path.eta_scale;
        let can_fork = share * reflected.min(1.0 - reflected) >= FORK_MIN;
        match branch {
            Branch::Both if can_fork => {
                for (child, which) in [(1, MaterialBranch::Reflect), (2, MaterialBranch::Refract)] {
                    let branch = vertex.branch.wrapping_mul(2).wrapping_add(child);
                    next.extend(self.branch(&bsdf, which, direction(branch), branch, 1.0));
                }
            }
            Branch::Half => {
                let which = if self.u_lobe < 0.5 { MaterialBranch::Reflect } else { MaterialBranch::Refract };
                next.extend(self.branch(&bsdf, which, direction(vertex.branch), vertex.branch, 2.0));
            }
            Branch::Both | Branch::Fresnel => {
                let (which, share) = if self.u_lobe < reflected {
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
        let wo = self.frame.to_local(self.surface.interaction.wo);
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
        let ray: Ray = interaction.spawn(self.frame.to_world(sample.wi));
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
