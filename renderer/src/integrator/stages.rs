//! The stages of a batch, each a loop over slices.

use super::connect::is_connected;
pub use super::connect::light_points;
use super::light_paths::weight_from_camera;
pub use super::scatter::scatter;

use super::batch::{Batch, Path, Surface};
use crate::interaction::Interaction;
use crate::math::{Frame, Rgb};
use crate::sampling::mis::power_heuristic;
use crate::sampling::{Decision, Sampler, Vertex, warp};
use crate::scene::{Effect, Meter, Scene, Strategy};

/// The stages from the film to the camera's rays, as far as the scene calls for them.
pub fn camera<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    batch.draws.at_camera(&batch.samples);
    film_points(scene, sampler, batch);
    if scene.effects.contains(Effect::Shutter) {
        shutter_times(scene, sampler, batch);
    }
    if scene.effects.contains(Effect::Lens) {
        lens_points(scene, sampler, batch);
    }
    camera_rays(scene, batch);
}

/// Where on the film each sample lies, and its filter weight; numbers are asked for at the camera.
pub fn film_points<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    let Batch { samples, draws, .. } = batch;
    sampler.draw_2d_each(&draws.places, Decision::Pixel, &mut draws.points);
    for (sample, &u) in samples.iter_mut().zip(&draws.points) {
        (sample.position, sample.weight) = scene.film.place(sample.id.pixel, u);
    }
}

/// When each sample sees the scene; likewise.
pub fn shutter_times<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    let Batch { samples, draws, .. } = batch;
    sampler.draw_1d_each(&draws.places, Decision::Time, &mut draws.choices);
    for (sample, &u) in samples.iter_mut().zip(&draws.choices) {
        sample.time = scene.shutter.time(u);
    }
}

/// Where on the lens each sample's ray starts, of a meter the numbers of its direction; likewise.
pub fn lens_points<S: Sampler>(scene: &Scene, sampler: &S, batch: &mut Batch) {
    let Batch { samples, draws, .. } = batch;
    sampler.draw_2d_each(&draws.places, Decision::Lens, &mut draws.points);
    for (sample, &u) in samples.iter_mut().zip(&draws.points) {
        sample.lens = if scene.meter.is_some() { u } else { warp::square_to_disk(u).to_array() };
    }
}

/// The camera's ray of each sample.
pub fn camera_rays(scene: &Scene, batch: &mut Batch) {
    let (has_lens, meter) = (scene.camera.has_lens(), scene.meter);
    let throughput = if meter.is_some() { Rgb::splat(Meter::WEIGHT) } else { Rgb::WHITE };
    let Batch { samples, order, paths, .. } = batch;
    scene.accel.order(samples.iter().map(|sample| sample.time), order);
    let start = |(sample, ray)| Path {
        sample,
        vertex: Vertex::default(),
        ray,
        throughput,
        eta_scale: 1.0,
        pdf: None,
        odds: 0.0,
    };
    let all = order.iter().map(|&i| {
        let sample = &samples[i as usize];
        (i, (sample, scene.film.to_image(sample.position)))
    });
    // A loop for each kind, which makes its rays where they stay.
    if let Some(meter) = meter {
        paths.extend(all.map(|(i, (s, p))| (i, meter.ray(scene, p, s.lens, s.time))).map(start));
    } else if has_lens {
        paths.extend(all.map(|(i, (s, p))| (i, scene.camera.lens_ray(p, s.lens, s.time))).map(start));
    } else {
        paths.extend(all.map(|(i, (s, p))| (i, scene.camera.ray(p, s.time))).map(start));
    }
}

/// What each path's ray meets first.
pub fn closest_hits(scene: &Scene, batch: &mut Batch) {
    batch.rays.clear();
    batch.rays.extend(batch.paths.iter().map(|p| p.ray));
    scene.accel.closest(&batch.rays, &mut batch.hits);
}

/// Lets rays go on through shapes that emit until they meet another one, as though no such shape were there.
pub fn pass_emitters(scene: &Scene, batch: &mut Batch) {
    let Batch { paths, hits, .. } = batch;
    let (mut passing, mut rays, mut found) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        passing.clear();
        rays.clear();
        for (index, (path, hit)) in paths.iter_mut().zip(&*hits).enumerate() {
            if let Some(hit) = hit.filter(|hit| scene.light_of(hit.object).is_some()) {
                let mut emitter = Interaction::default();
                scene.accel.put_interaction(&path.ray, &hit, &mut emitter);
                path.ray = emitter.spawn(path.ray.direction);
                passing.push(index);
                rays.push(path.ray);
            }
        }
        if passing.is_empty() {
            return;
        }
        scene.accel.closest(&rays, &mut found);
        for (&index, hit) in passing.iter().zip(&found) {
            hits[index] = *hit;
        }
    }
}

/// The surfaces that were hit.
pub fn surfaces(scene: &Scene, batch: &mut Batch) {
    let Batch { surfaces, paths, hits, .. } = batch;
    let met =
        (0..).zip(paths.iter().zip(&*hits)).filter_map(|(index, (path, hit))| Some((index, path, (*hit)?)));
    surfaces.resize(hits.iter().flatten().count(), Surface::default());
    for (surface, (index, path, hit)) in surfaces.iter_mut().zip(met) {
        (surface.path, surface.hit) = (index, hit);
        scene.accel.put_interaction(&path.ray, &hit, &mut surface.interaction);
    }
}

/// The frame in which the material of a surface sees directions.
pub(super) fn frame(scene: &Scene, path: &Path, surface: &Surface) -> Frame {
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
            let mut weight = found_weight(strategy, path.pdf, pdf);
            // From the first surface itself nothing is found by paths from lights.
            if path.odds > 0.0 && path.vertex.bounce > 1 {
                let (point, object) = (interaction.surface.point, interaction.object);
                weight *= weight_from_camera(scene, path.odds, object, point, interaction.wo);
            }
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

/// Leaves out the surfaces from which no last ray is needed.
pub fn leave_connected(scene: &Scene, strategy: Strategy, batch: &mut Batch) {
    batch.surfaces.retain(|surface| !is_connected(scene, strategy, surface.interaction.object));
}

/// The chance of a path to go on, min(0.95, throughput without the squeezing of solid angles).
pub(super) fn chance_to_go_on(throughput: Rgb, eta_scale: f32) -> f32 {
    (throughput.max_component() * eta_scale).min(0.95)
}

/// Ends paths by chance; one that goes on counts in inverse proportion to that.
pub fn roulette<S: Sampler>(sampler: &S, batch: &mut Batch) {
    let Batch { paths, samples, .. } = batch;
    paths.retain_mut(|path| {
        let q = chance_to_go_on(path.throughput, path.eta_scale);
        // the path's vertex is that of its next hit; the decision belongs to the one it leaves
        let vertex = Vertex { bounce: path.vertex.bounce - 1, ..path.vertex };
        let u = sampler.draw_1d(samples[path.sample as usize].id, vertex, Decision::Roulette);
        path.throughput = path.throughput / q;
        u < q
    });
}
