//! The stage in which paths leave the surfaces that they have met.

use wide::f32x8;

use super::batch::{Batch, Path, Surface};
use super::light_paths::{odds_at_first, odds_of_sample, pixels_per_area};
use super::stages::frame;
use crate::interaction::EightPoints;
use crate::materials::{Branch as MaterialBranch, Bsdf, BsdfSample, Lobe, Matte};
use crate::math::eight::{Vec3x8, pairs};
use crate::math::{Frame, Rgb};
use crate::ray::Ray;
use crate::sampling::{Decision, SampleId, Sampler, Vertex};
use crate::scene::{Branch, Scene};

/// Share of its sample's light below which a path no longer forks. Forks divide it, and refraction doesn't squeeze it, so that
/// they make at most 64 paths of one that begins with all of the light.
const FORK_MIN: f32 = 1.0 / 64.0;

/// One further ray for each surface, or two where both branches of a dielectric are followed.
pub fn scatter<S: Sampler>(scene: &Scene, sampler: &S, branch: Branch, batch: &mut Batch) {
    let Batch { surfaces, paths, next, samples, draws, .. } = batch;
    draws.at_surfaces(surfaces.iter(), paths, samples);
    draws.choices(sampler, Decision::Lobe, scene.decides(Decision::Lobe));
    draws.points(sampler, Decision::Direction, scene.decides(Decision::Direction));
    next.clear();
    let drawn = surfaces.chunks(LANES).zip(draws.choices.chunks(LANES).zip(draws.points.chunks(LANES)));
    for (surfaces, (choices, points)) in drawn {
        let matte = MatteRays::new(scene, surfaces, points);
        for (lane, (surface, (&u_lobe, &u))) in surfaces.iter().zip(choices.iter().zip(points)).enumerate() {
            let path = &paths[surface.path as usize];
            if let Some(reflectance) = matte.reflectances[lane] {
                let odds = if scene.emission.is_some() && path.vertex.bounce == 0 {
                    let (at, direction) = (&surface.interaction, path.ray.direction);
                    odds_at_first(scene, pixels_per_area(scene, at, direction, surface.hit.t))
                } else {
                    0.0
                };
                next.extend(matte.path(lane, reflectance, path, surface.interaction.time, odds));
                continue;
            }
            let id = samples[path.sample as usize].id;
            let frame = frame(scene, path, surface);
            Bounce { scene, sampler, surface, frame, path, id, u_lobe, u }.follow(branch, next);
        }
    }
    std::mem::swap(paths, next);
}

/// Surfaces that paths leave together.
const LANES: usize = 8;

/// The rays that leave up to eight surfaces, as far as these are diffuse.
struct MatteRays {
    /// `None` where the surface isn't diffuse.
    reflectances: [Option<Rgb>; LANES],
    origin: Vec3x8,
    direction: Vec3x8,
    /// Densities per steradian, 0 where nothing is scattered.
    pdf: f32x8,
}

impl MatteRays {
    /// * `u`: numbers for the directions.
    #[inline]
    fn new(scene: &Scene, surfaces: &[Surface], u: &[[f32; 2]]) -> Self {
        let mut reflectances = [None; LANES];
        let mut side = f32x8::ZERO;
        for (lane, surface) in surfaces.iter().enumerate().take(LANES) {
            let at = &surface.interaction;
            let Some(matte) = scene.material(at.object).matte(at.surface.uv) else { continue };
            reflectances[lane] = Some(matte.reflectance());
            side.as_mut_array()[lane] = matte.side(at.wo.dot(at.surface.n));
        }
        if reflectances.iter().all(Option::is_none) {
            return Self { reflectances, origin: Vec3x8::ZERO, direction: Vec3x8::ZERO, pdf: side };
        }
        let (points, n) = EightPoints::of(surfaces.iter().map(|surface| &surface.interaction.surface));
        let (wi, pdf) = Matte::eight_directions(side, pairs(u));
        let direction = Frame::eight_to_world(n, wi);
        Self { reflectances, origin: points.offset(direction), direction, pdf }
    }

    /// The path that goes on from a lane's surface.
    #[inline]
    fn path(&self, lane: usize, reflectance: Rgb, path: &Path, time: f32, odds: f32) -> Option<Path> {
        let pdf = self.pdf.as_array()[lane];
        let ray = Ray::new(self.origin.get(lane), self.direction.get(lane), time);
        let along = || path.along(ray, reflectance, 1.0, Some(pdf), path.vertex.branch, odds);
        if pdf > 0.0 { along() } else { None }
    }
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
            let sample = bsdf.sample(wo, self.u_lobe, self.u);
            next.extend(sample.and_then(|s| self.path_along(&bsdf, &s, vertex.branch, 1.0)));
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
        self.path_along(bsdf, &BsdfSample { pdf, ..sample }, branch, factor)
    }

    /// The path along a sample of the material, its throughput times `factor`.
    fn path_along(&self, bsdf: &Bsdf, sample: &BsdfSample, branch: u32, factor: f32) -> Option<Path> {
        let at = &self.surface.interaction;
        let wi = self.frame.to_world(sample.wi);
        let odds = if self.path.odds > 0.0 {
            let cosines = [at.wo, wi].map(|w| at.surface.ng.dot(w));
            self.path.odds * odds_of_sample(bsdf, self.frame.to_local(at.wo), sample, cosines)
        } else {
            0.0
        };
        let pdf = (sample.lobe == Lobe::Spread).then_some(sample.pdf);
        self.path.along(at.spawn(wi), sample.weight * factor, sample.squeezing(), pdf, branch, odds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interaction::SurfacePoint;
    use crate::sampling::warp;

    #[test]
    fn eight_rays_leave_as_one() {
        // A point of the unit sphere for each number, without an order.
        let unit = |k: f32| warp::square_to_sphere([(0.754_877 * k).fract(), (0.569_84 * k).fract()]);
        for k in 0..1000_u16 {
            let lane = |j: usize| 8.0 * f32::from(k) + [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0][j];
            let surface = |j: usize| {
                let (ng, point) = (unit(lane(j)), unit(3.0 * lane(j)) * lane(j));
                SurfacePoint { point, error: point.abs() * 1e-7, ng, n: unit(5.0 * lane(j)), uv: [0.0; 2] }
            };
            let u = |j: usize| [(0.618_034 * lane(j)).fract(), (0.414_214 * lane(j)).fract()];
            let side = |j: usize| if j.is_multiple_of(2) { 1.0 } else { -1.0 };
            let surfaces: [SurfacePoint; LANES] = std::array::from_fn(surface);
            let (points, n) = EightPoints::of(surfaces.iter());
            let numbers = [0, 1].map(|c| f32x8::new(std::array::from_fn(|j| u(j)[c])));
            let (wi, _) = Matte::eight_directions(f32x8::new(std::array::from_fn(side)), numbers);
            let direction = Frame::eight_to_world(n, wi);
            let origin = points.offset(direction);
            for j in 0..LANES {
                let local = side(j) * warp::square_to_cosine_hemisphere(u(j));
                let alone = surface(j).spawn(Frame::from_z(surface(j).n).to_world(local), 0.0);
                assert_eq!((origin.get(j), direction.get(j)), (alone.origin, alone.direction));
            }
        }
    }
}
