//! Triangles: a watertight test against rays.

use glam::{DVec3, Vec3};
use wide::f64x8;

use super::rounding::accept_eight;
use super::{EightHits, ShapeHit, accept};
use crate::math::eight::{DVec3x8, rounded, widened};
use crate::ray::{EightRays, Ray};

/// A ray prepared for triangles: in coordinates relative to its origin, its direction becomes (0, 0, 1) by taking its
/// longest component as z and shearing x and y.
#[derive(Debug, Clone, Copy)]
pub struct ShearedRay {
    origin: DVec3,
    direction: DVec3,
    /// Which components are x, y and z.
    axes: [usize; 3],
    /// The origin's components in that order.
    start: [f64; 3],
    shear: [f64; 3],
}

impl ShearedRay {
    /// Prepares `ray`, whose direction may have any length but zero.
    // Always inlined: handed over in memory it would be copied before it is there.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let z = ray.direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        // As arrays: a vector's index is a branch.
        let (origin, direction): (&[f32; 3], &[f32; 3]) = (ray.origin.as_ref(), ray.direction.as_ref());
        let [dx, dy, dz] = axes.map(|a| f64::from(direction[a]));
        Self {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
            axes,
            start: axes.map(|a| f64::from(origin[a])),
            shear: [dx / dz, dy / dz, 1.0 / dz],
        }
    }

    /// The vertex's sheared x and y, rounded to f32 once, and its distance along the ray.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the rounding makes the products below exact")]
    fn project(&self, vertex: &Vec3) -> (f64, f64, f64) {
        let v: &[f32; 3] = vertex.as_ref();
        let [i, j, k] = self.axes;
        let z = f64::from(v[k]) - self.start[2];
        let x = f64::from(v[i]) - self.start[0] - self.shear[0] * z;
        let y = f64::from(v[j]) - self.start[1] - self.shear[1] * z;
        (f64::from(x as f32), f64::from(y as f32), z * self.shear[2])
    }

    /// Distance and the weights of the second and third vertex where the ray crosses a triangle, from either side;
    /// the distance may be negative. `None` for a miss, an edge-on triangle and one without area.
    ///
    /// Closed meshes have no gaps: a vertex is projected once, to f32 coordinates, from which each edge function is a
    /// difference of exact f64 products. Its sign is thus exact, and opposite in the two triangles that share the edge.
    /// The distance is that of the plane, kept between the nearest and the farthest vertex.
    ///
    /// # Source
    /// Woop, Benthin, Wald 2013, Watertight Ray/Triangle Intersection, JCGT 2(1). The exact products in f64 take the
    /// place of its test of near-zero edge functions.
    #[inline]
    pub fn intersect(&self, [p0, p1, p2]: &[Vec3; 3]) -> Option<(f64, [f64; 2])> {
        let (ax, ay, az) = self.project(p0);
        let (bx, by, bz) = self.project(p1);
        let (cx, cy, cz) = self.project(p2);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        // Without a branch for each: which sign they have is a matter of chance.
        let (is_below, is_above) = ((u < 0.0) | (v < 0.0) | (w < 0.0), (u > 0.0) | (v > 0.0) | (w > 0.0));
        if is_below & is_above {
            return None;
        }
        let sum = u + v + w;
        let base = p0.as_dvec3();
        let normal = (p1.as_dvec3() - base).cross(p2.as_dvec3() - base);
        let slope = normal.dot(self.direction);
        if sum == 0.0 || slope == 0.0 {
            return None;
        }
        let plane = normal.dot(base - self.origin) / slope;
        let t = plane.clamp(az.min(bz).min(cz), az.max(bz).max(cz));
        Some((t, [v / sum, w / sum]))
    }

    /// The hit of a triangle with t in (0, `t_max`).
    #[inline]
    pub fn hit(&self, vertices: &[Vec3; 3], t_max: f32) -> Option<ShapeHit> {
        let (t, weights) = self.intersect(vertices)?;
        #[expect(clippy::cast_possible_truncation, reason = "parameters of a hit are f32")]
        let uv = weights.map(|w| w as f32);
        Some(ShapeHit { t: accept(t, t_max)?, uv })
    }
}

/// What `ShearedRay::hit` finds for each of eight rays on a triangle of its own, bit for bit, if component `z` is the longest of all
/// directions.
#[inline]
pub(crate) fn hit_eight(rays: &EightRays, z: usize, [a, b, c]: [DVec3x8; 3]) -> EightHits {
    let axes = [(z + 1) % 3, (z + 2) % 3, z];
    let [dx, dy, dz] = axes.map(|axis| rays.direction.0[axis]);
    let start = axes.map(|axis| rays.origin.0[axis]);
    let shear = [dx / dz, dy / dz, f64x8::ONE / dz];
    let project = |v: &DVec3x8| {
        let [x, y, z] = axes.map(|axis| v.0[axis]);
        let z = z - start[2];
        let round = |x: f64x8| widened(rounded(x));
        (round(x - start[0] - shear[0] * z), round(y - start[1] - shear[1] * z), z * shear[2])
    };
    let [(ax, ay, az), (bx, by, bz), (cx, cy, cz)] = [project(&a), project(&b), project(&c)];
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    let some =
        |test: fn(f64x8, f64x8) -> f64x8| test(u, f64x8::ZERO) | test(v, f64x8::ZERO) | test(w, f64x8::ZERO);
    let missed = some(f64x8::simd_lt) & some(f64x8::simd_gt);
    let sum = u + v + w;
    let normal = (b - a).cross(c - a);
    let slope = normal.dot(rays.direction);
    let missed = missed | sum.simd_eq(f64x8::ZERO) | slope.simd_eq(f64x8::ZERO);
    let plane = normal.dot(a - rays.origin) / slope;
    let t = plane.fast_max(az.fast_min(bz).fast_min(cz)).fast_min(az.fast_max(bz).fast_max(cz));
    let (accepted, t) = accept_eight(t, rays.t_max);
    EightHits { lanes: accepted & !missed.to_bitmask(), t, uv: [v / sum, w / sum].map(rounded) }
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use super::*;
    use crate::math::eight::Vec3x8;
    use crate::sampling::warp::point;

    #[test]
    fn eight_triangles_are_tested_as_each_alone() {
        const LANES: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
        let (mut hits, mut misses) = (0, 0);
        for n in 0..20_000 {
            let axis = n as usize % 3;
            let rays = LANES.map(|lane| {
                let way = Vec3::AXES[axis] * if n % 2 == 0 { 2.0 } else { -2.0 } + point(8 * n + lane);
                let t_max = if lane == 0 { 1.0 } else { f32::INFINITY };
                Ray { t_max, ..Ray::new(point(3 * n + lane), way.normalize(), 0.0) }
            });
            // Small ones around a point of the ray, met inside, on a vertex, an edge, from behind, edge-on, and without area.
            let triangles = LANES.map(|lane| {
                let ray = &rays[lane as usize];
                let [a, b] = [5, 7].map(|k| point(k * n + lane) * 0.1);
                let at = ray.at(point(n).x * 2.0);
                match lane {
                    2 => [at, at + a, at + b],
                    3 => [at - a, at + a, at + b],
                    4 => [at, at + ray.direction, at + a],
                    5 => [at, at + a, at + a],
                    _ => [at - a - b, at + a, at + b],
                }
            });
            let corners = from_fn(|corner| {
                let mut eight = Vec3x8::ZERO;
                (0..8).for_each(|lane| eight.set(lane, triangles[lane][corner]));
                eight.widened()
            });
            let found = hit_eight(&EightRays::new(&rays).widened(), axis, corners);
            for lane in 0..8 {
                let alone = ShearedRay::new(&rays[lane]).hit(&triangles[lane], rays[lane].t_max);
                assert_eq!((found.lanes >> lane & 1 == 1).then(|| found.get(lane)), alone, "{n} {lane}");
                *(if alone.is_some() { &mut hits } else { &mut misses }) += 1;
            }
        }
        assert!(hits > 20_000 && misses > 20_000, "{hits} {misses}");
    }
}
