//! Triangles: a watertight test against rays.

use glam::{DVec3, Vec3};

use super::{ShapeHit, accept};
use crate::ray::Ray;

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
    pub fn new(ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let z = ray.direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let [dx, dy, dz] = axes.map(|a| direction[a]);
        Self { origin, direction, axes, start: axes.map(|a| origin[a]), shear: [dx / dz, dy / dz, 1.0 / dz] }
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
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
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
