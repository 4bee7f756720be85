//! The stage that connects surfaces to points on lights.

use std::f32::consts::FRAC_1_PI;

use wide::f32x8;

use super::batch::{Batch, Connection, Path, Surface};
use super::light_paths::{odds_over, weight_from_camera};
use super::stages::frame;
use crate::interaction::{EightPoints, Interaction};
use crate::lights::{EightLightSamples, Light, LightSample};
use crate::math::Rgb;
use crate::math::eight::{Eight, Vec3x8};
use crate::ray::Ray;
use crate::sampling::mis::{power_heuristic, power_heuristic_eight};
use crate::sampling::{Decision, Sampler};
use crate::scene::{Scene, Strategy};

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
    draws.choices(sampler, Decision::LightChoice, scene.lights.needs_choice());
    draws.points(sampler, Decision::LightPoint, scene.lights.have_extent());
    let to = Connector { scene, strategy, alone: last && suffice(scene, strategy), paths };
    let mut connect = |surface: &Surface, contribution: Rgb, ray: Ray| {
        connections.push(Connection { sample: paths[surface.path as usize].sample, contribution });
        shadow_rays.push(ray);
    };
    if let Some(only) = scene.lights.only() {
        for (lit, points) in lit.chunks(LANES).zip(draws.points.chunks(LANES)) {
            to.light(only, lit, &[1.0; LANES], points, |k, contribution, ray| {
                connect(lit[k], contribution, ray);
            });
        }
        return;
    }
    let choose = |(&u, surface): (&f32, &&Surface)| scene.lights.choose(u, surface.interaction.surface.point);
    let (lights, pmfs): (Vec<&Light>, Vec<f32>) = draws.choices.iter().zip(&lit).map(choose).unzip();
    // Light by light, since eight points on one are found at once; what they give is added in the surfaces' order.
    let mut order: Vec<usize> = (0..lit.len()).collect();
    order.sort_by_key(|&k| std::ptr::from_ref(lights[k]));
    let mut found = vec![None; lit.len()];
    for run in order.chunk_by(|&a, &b| std::ptr::eq(lights[a], lights[b])) {
        for lanes in run.chunks(LANES) {
            let mut surfaces = [lit[lanes[0]]; LANES];
            let (mut points, mut pmf) = ([[0.0; 2]; LANES], [1.0; LANES]);
            for (lane, &k) in lanes.iter().enumerate() {
                (surfaces[lane], points[lane], pmf[lane]) = (lit[k], draws.points[k], pmfs[k]);
            }
            let (surfaces, points) = (&surfaces[..lanes.len()], &points[..lanes.len()]);
            to.light(lights[run[0]], surfaces, &pmf, points, |lane, contribution, ray| {
                found[lanes[lane]] = Some((contribution, ray));
            });
        }
    }
    for (surface, found) in lit.iter().zip(found) {
        if let Some((contribution, ray)) = found {
            connect(surface, contribution, ray);
        }
    }
}

/// Whether points on lights are all that is needed for the last edge from the object of that index.
pub(super) fn is_connected(scene: &Scene, strategy: Strategy, object: u32) -> bool {
    suffice(scene, strategy) && scene.is_matte(object)
}

/// Whether they are for diffuse objects.
fn suffice(scene: &Scene, strategy: Strategy) -> bool {
    strategy == Strategy::Both && scene.lights.are_even()
}

/// Surfaces connected together.
const LANES: usize = 8;

/// How surfaces are connected.
struct Connector<'a> {
    scene: &'a Scene,
    strategy: Strategy,
    /// Whether light points are all that diffuse surfaces get.
    alone: bool,
    paths: &'a [Path],
}

impl Connector<'_> {
    /// Connects up to eight surfaces to one light.
    ///
    /// * `pmf`: with which probabilities the light was chosen; `u`: numbers for points on it.
    /// * `connect`: called with each lane whose sample would get something, with that and the shadow ray.
    #[inline]
    fn light(
        &self,
        light: &Light,
        surfaces: &[&Surface],
        pmf: &[f32; LANES],
        u: &[[f32; 2]],
        mut connect: impl FnMut(usize, Rgb, Ray),
    ) {
        let (points, n) = EightPoints::of(surfaces.iter().map(|surface| &surface.interaction.surface));
        let mut matte = MatteLanes { n, ..MatteLanes::NONE };
        let mut from = [&surfaces[0].interaction; LANES];
        for (lane, surface) in surfaces.iter().enumerate().take(LANES) {
            from[lane] = &surface.interaction;
            matte.set(self.scene, lane, surface, &self.paths[surface.path as usize]);
        }
        let samples = light.sample_eight(&self.scene.accel, &from[..surfaces.len()], &points, u);
        let pmf = f32x8::new(*pmf);
        let weighed = !(samples.delta || self.strategy == Strategy::Light);
        let contributions = matte.contributions(&samples, pmf, weighed && !self.alone);
        for (lane, surface) in surfaces.iter().enumerate() {
            let time = surface.interaction.time;
            // Each kind connects for itself: what it gives stays in registers.
            if matte.is_matte >> lane & 1 == 1 {
                let contribution = Rgb::from(contributions.get(lane));
                if let (false, Some(ray)) = (contribution.is_black(), samples.shadow_ray(lane, time)) {
                    connect(lane, contribution, ray);
                }
            } else if let Some(sample) = samples.get(lane, time) {
                // Three of five light points of ground glass are behind its own body, and what it makes of one is dear.
                let object = &self.scene.accel.objects()[surface.interaction.object as usize];
                if object.hides(&sample.shadow_ray) {
                    continue;
                }
                let contribution = self.general(light, surface, &sample, pmf.as_array()[lane], weighed);
                if !contribution.is_black() {
                    connect(lane, contribution, sample.shadow_ray);
                }
            }
        }
    }

    /// What a sample gets from a light point by a surface of any material, if nothing is in the way.
    fn general(
        &self,
        source: &Light,
        surface: &Surface,
        light: &LightSample,
        pmf: f32,
        weighed: bool,
    ) -> Rgb {
        let Interaction { surface: point, wo: to_eye, object, .. } = &surface.interaction;
        let path = &self.paths[surface.path as usize];
        let frame = frame(self.scene, path, surface);
        let bsdf = self.scene.material(*object).bsdf(point.uv);
        let (wo, wi) = (frame.to_local(*to_eye), frame.to_local(light.wi));
        let f_cos = bsdf.eval_cos(wo, wi);
        if f_cos.is_black() {
            return Rgb::BLACK;
        }
        let pdf = pmf * light.pdf;
        let pdf_bsdf = bsdf.pdf(wo, wi);
        let weight = if weighed { power_heuristic(pdf, pdf_bsdf) } else { 1.0 };
        let weight = match source {
            Light::Area(area) if path.odds > 0.0 => {
                let cosines = [*to_eye, light.wi].map(|w| point.ng.dot(w));
                let odds = path.odds * odds_over(&bsdf, [wo, wi], pdf_bsdf, cosines);
                let end = light.shadow_ray.at(light.shadow_ray.t_max);
                weight * weight_from_camera(self.scene, odds, area.object, end, -light.wi)
            }
            _ => weight,
        };
        path.throughput * f_cos * light.radiance * (weight / pdf)
    }
}

/// The diffuse ones of eight surfaces.
struct MatteLanes {
    /// Their lanes, as bits.
    is_matte: u32,
    /// 1 for paths above the surface, −1 below, 0 where nothing is scattered.
    side: f32x8,
    /// Shading normals.
    n: Vec3x8,
    /// Reflectance times the path's throughput.
    weight: Vec3x8,
}

impl MatteLanes {
    const NONE: Self = Self { is_matte: 0, side: f32x8::ZERO, n: Vec3x8::ZERO, weight: Vec3x8::ZERO };

    #[inline]
    fn set(&mut self, scene: &Scene, lane: usize, surface: &Surface, path: &Path) {
        let at = &surface.interaction;
        if let Some(matte) = scene.material(at.object).matte(at.surface.uv) {
            self.is_matte |= 1 << lane;
            self.side.as_mut_array()[lane] = matte.side(at.wo.dot(at.surface.n));
            self.weight.set(lane, (path.throughput * matte.reflectance()).to_array().into());
        }
    }

    /// What the samples get from light points, if nothing is in the way: ρ/π · cos θᵢ · L / pdf, weighed.
    #[inline]
    fn contributions(&self, light: &EightLightSamples, pmf: f32x8, weighed: bool) -> Vec3x8 {
        let cos = (light.wi.dot(self.n) * self.side).fast_max(f32x8::ZERO);
        // The density of the direction, and the value times the cosine for a reflectance of 1.
        let pdf_bsdf = cos * FRAC_1_PI;
        let pdf = pmf * light.pdf;
        let weight = if weighed { power_heuristic_eight(pdf, pdf_bsdf) } else { f32x8::ONE };
        let (Eight([r, g, b]), Eight([lr, lg, lb])) =
            (self.weight * (pdf_bsdf * (weight / pdf)), light.radiance);
        Eight([r * lr, g * lg, b * lb])
    }
}
