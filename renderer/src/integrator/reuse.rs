//! The stages in which samples of neighbouring pixels share the light that their paths' second surfaces send.
//!
//! A sample's ray leaves a diffuse surface at x and meets another one at y, where the rest of its path finds the radiance L.
//! Any of up to eight samples, one of each pixel of a group, could have met y: the one at xₖ with the density
//! pₖ = cos θ cos θ′ / (π r²) per area there, or 0 if something is in between. By the balance heuristic over all of them
//! the sample at xⱼ gets Tⱼ · L · pⱼ / Σ qₖ · pₖ, where its path would carry Tⱼ, and goes on with the chance qⱼ. So each mean is
//! right, a sample has up to eight second surfaces in the place of one, and pixels have a part of their errors in common.
//!
//! # Source
//! Bekaert, Sbert, Halton 2002, "Accelerating path tracing by re-using paths" (doi:10.2312/EGWR/EGWR02/125-134).
//!
//! # Verified by
//! claims `relation/reuse/*`

use glam::Vec3;
use wide::f32x8;

use super::batch::{Batch, Connection, Surface};
use super::stages::chance_to_go_on;
use crate::interaction::{EightPoints, SurfacePoint};
use crate::math::Rgb;
use crate::math::eight::Vec3x8;
use crate::scene::Scene;

/// Most samples that share, each of a pixel of its own.
pub const MATES: u32 = 8;

/// Their lanes.
const LANES: usize = MATES as usize;

/// Side of the square whose pixels share, those of either colour of a chessboard: numbers of samples by error follow from
/// the other colour (`film/allocation.rs`).
const SQUARE: u32 = 4;

/// Which pixels share: those with the same square and colour.
pub fn group([x, y]: [u32; 2]) -> [u32; 3] {
    [y / SQUARE, x / SQUARE, (x + y) % 2]
}

/// The surfaces of the samples that share.
#[derive(Debug, Default)]
pub struct Reuse {
    /// The first ones, by the samples' sets.
    first: Vec<Mates>,
    /// The lane of each sample's first surface in its set, if it is there.
    lanes: Vec<Option<usize>>,
    /// The second ones.
    second: Vec<Second>,
}

/// Diffuse first surfaces of one set of samples.
#[derive(Debug, Clone)]
struct Mates {
    samples: [u32; LANES],
    count: usize,
    points: EightPoints,
    /// Shading normals, on the lit side.
    n: Vec3x8,
    /// What paths carry away.
    throughput: [Rgb; LANES],
    /// The chances that paths go on; 0 in the lanes that are left.
    chance: f32x8,
}

/// A diffuse second surface.
#[derive(Debug)]
struct Second {
    sample: u32,
    /// The lane of its first surface.
    own: usize,
    at: SurfacePoint,
    /// The geometric and the shading normal, on the side of the first surface.
    ng: Vec3,
    n: Vec3,
    /// What the sample found before.
    before: Rgb,
    /// Radiance that it sends to the first surface.
    sent: Rgb,
    /// With which density paths from each first surface meet it, but for 1/π.
    density: f32x8,
}

impl Mates {
    const NONE: Self = Self {
        samples: [0; LANES],
        count: 0,
        points: EightPoints::ZERO,
        n: Vec3x8::ZERO,
        throughput: [Rgb::BLACK; LANES],
        chance: f32x8::ZERO,
    };

    /// The densities of the directions to `y` per area there, times π, if nothing is in between.
    fn densities(&self, y: &Second) -> f32x8 {
        let to = self.points.point - Vec3x8::splat(y.at.point);
        let squared = to.dot(to);
        let [leaving, arriving] = [-to.dot(self.n), to.dot(Vec3x8::splat(y.ng))];
        let facing = leaving.simd_gt(f32x8::ZERO)
            & arriving.simd_gt(f32x8::ZERO)
            & to.dot(Vec3x8::splat(y.n)).simd_gt(f32x8::ZERO);
        let mut densities = facing.select(leaving / squared * (arriving / squared), f32x8::ZERO);
        if densities.as_array()[y.own] == 0.0 {
            // Edge-on, as far as roundings let its own path tell: it is nobody else's.
            densities = f32x8::ZERO;
            densities.as_mut_array()[y.own] = 1.0;
        }
        densities
    }
}

/// Notes the diffuse first surfaces.
///
/// * `by_chance`: whether roulette follows.
pub fn leave_first(scene: &Scene, by_chance: bool, batch: &mut Batch) {
    let Batch { surfaces, paths, samples, reuse: Reuse { first, lanes, second }, .. } = batch;
    let sets = samples.iter().map(|sample| sample.set + 1).max().unwrap_or(0);
    first.clear();
    first.resize(sets as usize, Mates::NONE);
    lanes.clear();
    lanes.resize(samples.len(), None);
    second.clear();
    for Surface { path, interaction, .. } in surfaces.iter() {
        let path = &paths[*path as usize];
        let at = &interaction.surface;
        let Some(matte) = scene.material(interaction.object).matte(at.uv) else { continue };
        let side = matte.side(interaction.wo.dot(at.n));
        let throughput = path.throughput * matte.reflectance();
        if side == 0.0 || throughput.is_black() {
            continue;
        }
        let mates = &mut first[samples[path.sample as usize].set as usize];
        let lane = mates.count;
        lanes[path.sample as usize] = Some(lane);
        mates.count += 1;
        mates.samples[lane] = path.sample;
        mates.points.set(lane, at);
        mates.n.set(lane, at.n * side);
        mates.throughput[lane] = throughput;
        let chance = if by_chance { chance_to_go_on(throughput, path.eta_scale) } else { 1.0 };
        mates.chance.as_mut_array()[lane] = chance;
    }
}

/// From here on, a sample whose path has gone from a diffuse surface to another one gathers what the second sends to the first.
pub fn reach_second(scene: &Scene, batch: &mut Batch) {
    let Batch { surfaces, paths, samples, reuse: Reuse { first, lanes, second }, .. } = batch;
    for Surface { path, interaction, .. } in surfaces.iter() {
        let path = &mut paths[*path as usize];
        let sample = &mut samples[path.sample as usize];
        let Some(own) = lanes[path.sample as usize] else { continue };
        if first[sample.set as usize].count < 2 || !scene.is_matte(interaction.object) {
            continue;
        }
        let at = interaction.surface;
        let facing = |n: Vec3| if n.dot(interaction.wo) < 0.0 { -n } else { n };
        second.push(Second {
            sample: path.sample,
            own,
            at,
            ng: facing(at.ng),
            n: facing(at.n),
            before: std::mem::replace(&mut sample.radiance, Rgb::BLACK),
            sent: Rgb::BLACK,
            density: f32x8::ZERO,
        });
        path.throughput = Rgb::WHITE;
    }
}

/// Divides what each second surface sends among the samples that could have met it.
pub fn share(scene: &Scene, batch: &mut Batch) {
    let Batch { samples, shadow_rays, blocked, connections, reuse: Reuse { first, second, .. }, .. } = batch;
    for y in second.iter_mut() {
        let sample = &mut samples[y.sample as usize];
        y.sent = std::mem::replace(&mut sample.radiance, y.before);
        if y.sent.is_black() {
            continue;
        }
        let mates = &first[sample.set as usize];
        y.density = mates.densities(y);
        let segments = mates.points.spawn_to(&EightPoints::splat(&y.at));
        for (lane, density) in y.density.to_array().into_iter().enumerate() {
            if density > 0.0 && lane != y.own {
                shadow_rays.push(segments.get(lane, sample.time));
            }
        }
    }
    scene.accel.occluded(shadow_rays, blocked);
    let mut blocked = blocked.iter();
    for y in second.iter_mut().filter(|y| !y.sent.is_black()) {
        let mates = &first[samples[y.sample as usize].set as usize];
        for (lane, density) in y.density.as_mut_array().iter_mut().enumerate() {
            if *density > 0.0 && lane != y.own && blocked.next() == Some(&true) {
                *density = 0.0;
            }
        }
        let shares = y.density / (y.density * mates.chance).reduce_add();
        for (lane, &share) in shares.as_array().iter().enumerate() {
            if share != 0.0 {
                let contribution = mates.throughput[lane] * y.sent * share;
                connections.push(Connection { sample: mates.samples[lane], contribution });
            }
        }
    }
    shadow_rays.clear();
    for index in 0..batch.connections.len() {
        let Connection { sample, contribution } = batch.connections[index];
        batch.add(sample, contribution);
    }
    batch.connections.clear();
}
