//! Parallelograms.

use glam::{DAffine3, DVec3};
use wide::f32x8;

use super::plane::Plane;
use super::{EightHits, SMALLEST_SOLID_ANGLE, ShapeHit};
use crate::interaction::{EightPoints, SurfacePoint};
use crate::math::bounds::Bounds;
use crate::math::eight;
use crate::ray::{EightRays, Ray64};
use crate::sampling::warp::SphericalRectangle;

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

    pub(super) fn intersect(&self, ray: &Ray64) -> Option<ShapeHit> {
        let (t, [x, y]) = self.plane.cross(ray)?;
        if x.abs() > 1.0 || y.abs() > 1.0 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "parameters of a hit are f32")]
        let uv = [x as f32, y as f32];
        Some(ShapeHit { t, uv })
    }

    #[inline]
    pub(super) fn intersect_eight(&self, rays: &EightRays) -> EightHits {
        let (crossed, t, [x, y]) = self.plane.cross_eight(rays);
        let outside = x.abs().simd_gt(1.0) | y.abs().simd_gt(1.0);
        EightHits { lanes: crossed & !outside.to_bitmask(), t, uv: [x, y].map(eight::rounded) }
    }

    /// Texture coordinates run over [0, 1]².
    #[inline]
    pub(super) fn surface(&self, [x, y]: [f32; 2]) -> SurfacePoint {
        self.plane.surface([x, y], [0.5 * (x + 1.0), 0.5 * (y + 1.0)])
    }

    pub(super) fn tangent(&self) -> DVec3 {
        self.plane.a
    }

    pub(crate) fn area(&self) -> f64 {
        4.0 * self.plane.jacobian()
    }

    /// [`Self::sample_area`] of eight numbers, bit for bit.
    #[inline]
    pub(crate) fn sample_area_eight(&self, [u, v]: [f32x8; 2]) -> EightPoints {
        self.plane.points([u * 2.0 - 1.0, v * 2.0 - 1.0])
    }

    #[inline]
    pub(crate) fn sample_area(&self, [u, v]: [f32; 2]) -> SurfacePoint {
        self.plane.surface([2.0 * u - 1.0, 2.0 * v - 1.0], [u, v])
    }

    /// How it looks from `from`; `None` where points by area serve better.
    pub(super) fn seen_from(&self, from: DVec3) -> Option<SphericalRectangle> {
        let [x, y, z] = self.plane.middle_from(from)?;
        let half = [self.plane.a.length(), self.plane.b.length()];
        if z == 0.0 {
            return None;
        }
        let seen = SphericalRectangle::new([x - half[0], y - half[1]], half.map(|h| 2.0 * h), z.abs());
        (seen.solid_angle() > SMALLEST_SOLID_ANGLE).then_some(seen)
    }

    #[expect(clippy::cast_possible_truncation, reason = "a place on the rectangle is two f32 numbers")]
    pub(super) fn sample_solid_angle(&self, from: DVec3, u: [f32; 2]) -> Option<(SurfacePoint, f64)> {
        let seen = self.seen_from(from)?;
        let place = seen.sample(u.map(f64::from));
        let surface = self.plane.surface_at(place.map(|c| 2.0 * c - 1.0), place.map(|c| c as f32));
        Some((surface, 1.0 / seen.solid_angle()))
    }
}
