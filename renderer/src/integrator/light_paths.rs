//! Paths from lights, for light that reaches a diffuse first surface by way of surfaces that are not diffuse: caustics.
//!
//! Such a path E x₁ x₂ … xₖ L, with x₁ diffuse and x₂ to xₖ not, is found from either end. From the camera, x₂ has to be
//! met and then the light, by directions that know of neither; from the light, directions are aimed at what isn't diffuse, and x₁ is
//! connected to the camera. Both count, by the balance heuristic: a path found from the light q / (1 + q), one found from the
//! camera 1 / (1 + q), with the odds
//!
//! q = N · π / J(x₁) · ∏ᵢ (p(xᵢ → xᵢ₋₁) / |cos|) / (p(xᵢ → xᵢ₊₁) / |cos|) · `p_A` `p_ω`, i from 2 to k,
//!
//! where J is the density of the camera's samples \[pixels per m²\], N the number of paths from lights for each sample of a pixel
//! times the number of pixels, p the densities of materials' directions, which a choice between the sides of glass leaves equal but for the square
//! of its indices, and `p_A` `p_ω` that of the start of a path from the light. Squared distances and all other cosines cancel. The cosine at the light and
//! connections to lights are left out of q: any weights serve that are the same from both ends.
//!
//! # Source
//! Veach 1997, "Robust Monte Carlo methods for light transport simulation", sections 10.2 for the weights, 5.3 for what
//! shading normals and refraction do to paths from lights; Dutré, Lafortune, Willems 1993, "Monte Carlo light tracing with
//! direct computation of pixel intensities".
//!
//! # Verified by
//! claims `relation/light-paths/*`

use std::f32::consts::{FRAC_1_PI, PI};
use std::ops::Range;

use glam::Vec3;

use super::batch::{Batch, Draws, Path, Sample, Surface};
use super::stages;
use crate::interaction::Interaction;
use crate::lights::Emission;
use crate::materials::{Bsdf, BsdfSample, Lobe, Matte};
use crate::math::Rgb;
use crate::ray::Ray;
use crate::sampling::{Decision, SampleId, Sampler, Vertex};
use crate::scene::{Effect, Scene};

/// Paths from lights for each sample of a pixel; measured in benches/README.md.
pub const PER_SAMPLE: f32 = 0.25;

/// What a path from a light brings to the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splat {
    /// Where, in pixels from the upper left corner of the whole film.
    pub position: [f64; 2],
    /// Radiance [W m⁻² sr⁻¹] times pixels, for one path in all.
    pub value: Rgb,
}

/// Where samples of the camera are on a surface, in pixels per m².
///
/// * `direction`: the unit direction from the camera to the point `at`; `distance`: how far that is.
pub(super) fn pixels_per_area(scene: &Scene, at: &Interaction, direction: Vec3, distance: f32) -> f32 {
    let cos = at.surface.ng.dot(direction).abs();
    pixels(scene) * scene.camera.per_steradian(direction, at.time) * cos / (distance * distance)
}

/// Pixels of the whole film.
fn pixels(scene: &Scene) -> f32 {
    let [width, height] = scene.film.whole.map(|n| n as f32);
    width * height
}

/// The odds behind a diffuse first surface with so many pixels per m², up to the density of the start at the light.
pub(super) fn odds_at_first(scene: &Scene, pixels_per_area: f32) -> f32 {
    PER_SAMPLE * PI * pixels(scene) / pixels_per_area
}

/// By what a surface that is met between directions to the camera's side, `wo`, and to the light's side, `wi`, multiplies the odds.
///
/// * `pdf`: the density of `wi`; `cosines`: of `wo` and `wi` to the geometric normal.
pub(super) fn odds_over(bsdf: &Bsdf, [wo, wi]: [Vec3; 2], pdf: f32, cosines: [f32; 2]) -> f32 {
    let [cos_o, cos_i] = cosines.map(f32::abs);
    bsdf.pdf(wi, wo) * cos_i / (pdf * cos_o)
}

/// The same for a direction `wi` that has been drawn.
pub(super) fn odds_of_sample(bsdf: &Bsdf, wo: Vec3, sample: &BsdfSample, cosines: [f32; 2]) -> f32 {
    match sample.lobe {
        Lobe::Delta => 1.0 / sample.squeezing(),
        Lobe::Spread => odds_over(bsdf, [wo, sample.wi], sample.pdf, cosines),
    }
}

/// The weight of light that a path from the camera has found, where paths from the object of index `object` could have started at `point`
/// in a direction.
pub(super) fn weight_from_camera(scene: &Scene, odds: f32, object: u32, point: Vec3, direction: Vec3) -> f32 {
    let density = scene.emission.as_ref().map_or(0.0, |emission| emission.density(object, point, direction));
    let odds = odds * density;
    if odds > 0.0 { 1.0 / (1.0 + odds) } else { 1.0 }
}

/// How paths from lights are followed.
#[derive(Debug)]
pub struct LightPaths<'a, S> {
    /// The scene.
    pub scene: &'a Scene,
    /// Where they begin.
    pub emission: &'a Emission,
    /// Where numbers come from.
    pub sampler: &'a S,
}

impl<S: Sampler> LightPaths<'_, S> {
    /// What the paths `indices` of one set bring to the film.
    ///
    /// * `set`: names the set beside the replicate; its numbers are of no pixel.
    pub fn trace(&self, replicate: u32, set: u32, indices: Range<u32>, batch: &mut Batch) -> Vec<Splat> {
        let Self { scene, sampler, .. } = self;
        batch.clear();
        let id = |index| (0, SampleId { pixel: [u32::MAX, set], replicate, index });
        batch.extend(indices.map(id));
        batch.draws.at_camera(&batch.samples);
        if scene.effects.contains(Effect::Shutter) {
            stages::shutter_times(scene, *sampler, batch);
        }
        if scene.effects.contains(Effect::Lens) {
            stages::lens_points(scene, *sampler, batch);
        }
        self.begin(batch);
        let settings = &scene.integrator;
        let mut splats = Vec::new();
        batch.shadow_rays.clear();
        // One more edge leads to the camera.
        for depth in 1..settings.max_depth.unwrap_or(u32::MAX) {
            if batch.paths.is_empty() {
                break;
            }
            stages::closest_hits(scene, batch);
            stages::surfaces(scene, batch);
            self.meet(depth, batch, &mut splats);
            if depth >= settings.rr_depth {
                stages::roulette(*sampler, batch);
            }
        }
        scene.accel.occluded(&batch.shadow_rays, &mut batch.blocked);
        batch.shadow_rays.clear();
        let mut blocked = batch.blocked.iter();
        splats.retain(|_| blocked.next() == Some(&false));
        splats
    }

    /// Puts in the paths' first edges; a sample's radiance is what its path begins with.
    fn begin(&self, batch: &mut Batch) {
        let Self { scene, emission, sampler } = self;
        let Batch { samples, order, paths, draws, .. } = batch;
        draws.choices(*sampler, Decision::LightChoice, emission.needs_choice());
        draws.points(*sampler, Decision::LightPoint, true);
        let mut directions = Vec::new();
        sampler.draw_2d_each(&draws.places, Decision::Direction, &mut directions);
        scene.accel.order(samples.iter().map(|sample| sample.time), order);
        for &index in &*order {
            let i = index as usize;
            let (sample, u) = (&mut samples[i], [draws.points[i], directions[i]]);
            let start = emission.sample(&scene.accel, draws.choices[i], u, sample.time);
            let Some(start) = start else { continue };
            sample.radiance = start.power;
            paths.push(Path {
                sample: index,
                vertex: Vertex { bounce: 1, ..Vertex::default() },
                ray: start.surface.spawn(start.direction, sample.time),
                throughput: Rgb::WHITE,
                eta_scale: 1.0,
                pdf: None,
                odds: start.density,
            });
        }
    }

    /// Connects diffuse surfaces to the camera, where paths end, and lets them go on from the others.
    fn meet(&self, depth: u32, batch: &mut Batch, splats: &mut Vec<Splat>) {
        let Self { scene, sampler, .. } = self;
        let Batch { surfaces, paths, next, samples, shadow_rays, draws, dropped, .. } = batch;
        draws.at_surfaces(surfaces.iter(), paths, samples);
        draws.choices(*sampler, Decision::Lobe, scene.decides(Decision::Lobe));
        draws.points(*sampler, Decision::Direction, scene.decides(Decision::Direction));
        next.clear();
        let Draws { choices, points, .. } = draws;
        for (surface, (&u_lobe, &u)) in surfaces.iter().zip(choices.iter().zip(points.iter())) {
            let path = &paths[surface.path as usize];
            let sample = &samples[path.sample as usize];
            let at = &surface.interaction;
            match scene.material(at.object).matte(at.surface.uv) {
                // Light without a surface on its way is found by points on lights.
                Some(_) if depth == 1 => {}
                Some(matte) => {
                    let Some((splat, ray)) = self.connect(sample, path, at, &matte) else { continue };
                    if splat.value.is_finite() {
                        splats.push(splat);
                        shadow_rays.push(ray);
                    } else {
                        *dropped += 1;
                    }
                }
                None => next.extend(self.go_on(path, surface, u_lobe, u)),
            }
        }
        std::mem::swap(paths, next);
    }

    /// What a diffuse surface sends to the camera, and the segment that must be free; `None` if it sends nothing there.
    fn connect(&self, sample: &Sample, path: &Path, at: &Interaction, matte: &Matte) -> Option<(Splat, Ray)> {
        let Self { scene, .. } = self;
        let point = &at.surface;
        let sight = scene.camera.sight(point.point, sample.lens, sample.time)?;
        let to = point.point - sight.from;
        let distance = to.length();
        let direction = to / distance;
        let cos_shading = matte.side(-direction.dot(point.n)) * at.wo.dot(point.n);
        let cos = at.wo.dot(point.ng).abs();
        if cos_shading <= 0.0 || cos == 0.0 {
            return None;
        }
        let pixels_per_area = pixels_per_area(scene, at, direction, distance);
        let odds = path.odds * odds_at_first(scene, pixels_per_area);
        let weight = 1.0 / (1.0 + 1.0 / odds);
        // Light arrives on the surface itself, and what it sends is a matter of the shading normal.
        let sent = FRAC_1_PI * (cos_shading / cos) * weight;
        let value = sample.radiance * path.throughput * matte.reflectance() * (sent * pixels_per_area);
        let position = scene.film.to_pixels(sight.place);
        (!value.is_black()).then(|| (Splat { position, value }, at.spawn_to_point(sight.from)))
    }

    /// The path after a surface that isn't diffuse.
    fn go_on(&self, path: &Path, surface: &Surface, u_lobe: f32, u: [f32; 2]) -> Option<Path> {
        let at = &surface.interaction;
        let frame = stages::frame(self.scene, path, surface);
        // Here wo points to the light, and wi to the camera.
        let wo = frame.to_local(at.wo);
        let bsdf = self.scene.material(at.object).bsdf(at.surface.uv);
        let sample = bsdf.sample(wo, u_lobe, u)?;
        let wi = frame.to_world(sample.wi);
        let cosines = [at.wo, wi].map(|w| at.surface.ng.dot(w).abs());
        let shading = [wo, sample.wi].map(|w| w.z.abs());
        // f·η² is the same in both directions, and so is a flow of light through the surface itself.
        let adjoint = sample.squeezing() * (shading[0] * cosines[1]) / (shading[1] * cosines[0]);
        if !adjoint.is_finite() {
            // Along the surface: nothing flows through it that way.
            return None;
        }
        let odds = path.odds / odds_of_sample(&bsdf, wo, &sample, cosines);
        path.along(at.spawn(wi), sample.weight * adjoint, 1.0, None, path.vertex.branch, odds)
    }
}
