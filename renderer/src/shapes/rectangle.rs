//! Parallelograms.

use glam::DAffine3;

use super::plane::Plane;
use super::{ShapeHit, accept};
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::ray::Ray;

/// The image of [−1, 1]² in the plane z = 0; its normal is that of +z.
#[derive(Debug, Clone)]
pub struct Rectangle {
    plane: Plane,
}

impl Rectangle {
    pub(super) fn new(to_frame: &DAffine3, flip: bool) -> Self {
        Self { plane: Plane::new(to_frame, flip) }
    }

    pub(super) fn bounds(&self) -> Bounds {
        let p = &self.plane;
        Bounds::of([p.center]).grown(p.a.abs() + p.b.abs())
    }

    pub(super) fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let (t, [x, y]) = self.plane.cross(ray)?;
        if x.abs() > 1.0 || y.abs() > 1.0 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "parameters of a hit are f32")]
        let uv = [x as f32, y as f32];
        Some(ShapeHit { t: accept(t, ray.t_max)?, uv })
    }

    /// Texture coordinates run over [0, 1]².
    pub(super) fn surface(&self, [x, y]: [f32; 2]) -> SurfacePoint {
        self.plane.surface([x, y], [0.5 * (x + 1.0), 0.5 * (y + 1.0)])
    }

    pub(super) fn area(&self) -> f64 {
        4.0 * self.plane.jacobian()
    }

    pub(super) fn sample_area(&self, [u, v]: [f32; 2]) -> SurfacePoint {
        self.plane.surface([2.0 * u - 1.0, 2.0 * v - 1.0], [u, v])
    }
}
