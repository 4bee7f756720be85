//! Rank 2: rays and the records of their hits.

use glam::{DVec3, Vec3};
use wide::{f32x8, f64x8};

use crate::math::eight::Eight;

/// A half-line, or a segment where `t_max` is finite; eight numbers in a row, so that rays are put side by side by a transposition.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Hits are looked for in (0, `t_max`); infinity for a half-line.
    pub t_max: f32,
    /// The moment at which the scene is seen, in the shutter's unit.
    pub time: f32,
}

impl Ray {
    /// The half-line from `origin` along the unit vector `direction` at `time`.
    pub fn new(origin: Vec3, direction: Vec3, time: f32) -> Self {
        Self { origin, direction, t_max: f32::INFINITY, time }
    }

    /// The same ray in f64.
    #[inline]
    pub fn widened(&self) -> Ray64 {
        Ray64 { origin: self.origin.as_dvec3(), direction: self.direction.as_dvec3(), t_max: self.t_max }
    }

    /// The point at distance `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// A ray in f64, in which shapes are tested against it: in the space of an object that moves no f32 holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray64 {
    /// Where it starts.
    pub origin: DVec3,
    /// Its direction, of any length.
    pub direction: DVec3,
    /// Hits are looked for in (0, `t_max`).
    pub t_max: f32,
}

impl Ray64 {
    /// The nearest ray in f32.
    #[inline]
    pub fn rounded(&self, time: f32) -> Ray {
        let Self { origin, direction, t_max } = self;
        Ray { origin: origin.as_vec3(), direction: direction.as_vec3(), t_max: *t_max, time }
    }
}

/// Eight rays side by side; shapes are tested against them in f64.
#[derive(Debug, Clone, Copy)]
pub struct EightRays<T = f64x8> {
    /// Where they start.
    pub origin: Eight<T>,
    /// Their directions.
    pub direction: Eight<T>,
    /// Hits are looked for in (0, `t_max`).
    pub t_max: f32x8,
    /// The moments at which the scene is seen.
    pub time: f32x8,
}

impl EightRays<f32x8> {
    /// Up to eight rays; the other lanes hold rays from 0 along (1, 1, 1).
    #[inline]
    pub fn new(rays: &[Ray]) -> Self {
        let mut rows = [f32x8::new([0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]); 8];
        for (row, ray) in rows.iter_mut().zip(rays) {
            let Ray { origin: o, direction: d, t_max, time } = *ray;
            *row = f32x8::new([o.x, o.y, o.z, d.x, d.y, d.z, t_max, time]);
        }
        let [ox, oy, oz, dx, dy, dz, t_max, time] = f32x8::transpose(rows);
        Self { origin: Eight([ox, oy, oz]), direction: Eight([dx, dy, dz]), t_max, time }
    }

    /// The same rays in f64.
    #[inline]
    pub fn widened(self) -> EightRays {
        let Self { origin, direction, t_max, time } = self;
        EightRays { origin: origin.widened(), direction: direction.widened(), t_max, time }
    }
}

/// Where a ray met the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// Index of the object met.
    pub object: u32,
    /// Index of the shape's element met: a mesh's triangle, else 0.
    pub element: u32,
    /// The shape's own parameters of the point; a triangle's barycentric weights of its second and third vertex.
    pub uv: [f32; 2],
}
