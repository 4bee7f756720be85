//! Rank 2: rays and the records of their hits.

use glam::Vec3;
use wide::f32x8;

use crate::math::eight::DVec3x8;

/// A half-line, or a segment where `t_max` is finite.
#[derive(Debug, Clone, Copy, PartialEq)]
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

    /// The point at distance `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Eight rays side by side, as shapes are tested against them.
#[derive(Debug, Clone, Copy)]
pub struct EightRays {
    /// Where they start.
    pub origin: DVec3x8,
    /// Their directions.
    pub direction: DVec3x8,
    /// Hits are looked for in (0, `t_max`).
    pub t_max: f32x8,
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
