//! Disks and ellipses.

use glam::{DAffine3, DVec3};

use super::plane::Plane;
use super::{EightHits, ShapeHit, turn};
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::math::eight;
use crate::ray::{EightRays, Ray64};

/// The image of the unit disk in the plane z = 0; its normal is that of +z.
#[derive(Debug, Clone)]
pub struct Disk {
    plane: Plane,
    /// Whether points have surface coordinates.
    mapped: bool,
}

impl Disk {
    pub(super) fn new(to_frame: &DAffine3, flip: bool) -> Self {
        Self { plane: Plane::new(to_frame, flip), mapped: true }
    }

    pub(super) fn without_coordinates(self) -> Self {
        Self { mapped: false, ..self }
    }

    /// The extreme of x·a + y·b over the unit disk is √(a² + b²) on each axis.
    pub(super) fn bounds(&self) -> Bounds {
        let p = &self.plane;
        let reach = p.a * p.a + p.b * p.b;
        Bounds::of([p.center]).grown(reach.map(|r| r.sqrt() * (1.0 + f64::EPSILON)))
    }

    pub(super) fn intersect(&self, ray: &Ray64) -> Option<ShapeHit> {
        let (t, [x, y]) = self.plane.cross(ray)?;
        if x * x + y * y > 1.0 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "parameters of a hit are f32")]
        let uv = [x as f32, y as f32];
        Some(ShapeHit { t, uv })
    }

    #[inline]
    pub(super) fn intersect_eight(&self, rays: &EightRays) -> EightHits {
        let (crossed, t, [x, y]) = self.plane.cross_eight(rays);
        let outside = (x * x + y * y).simd_gt(1.0).to_bitmask();
        EightHits { lanes: crossed & !outside, t, uv: [x, y].map(eight::rounded) }
    }

    /// Texture coordinates are the radius and the turn from the x axis.
    #[inline]
    pub(super) fn surface(&self, [x, y]: [f32; 2]) -> SurfacePoint {
        let coordinates = || [(x * x + y * y).sqrt().min(1.0), turn(f64::from(y), f64::from(x))];
        self.plane.surface([x, y], if self.mapped { coordinates() } else { [0.0; 2] })
    }

    /// Away from the centre.
    pub(super) fn tangent(&self, surface: &SurfacePoint) -> DVec3 {
        surface.point.as_dvec3() - self.plane.center
    }

    pub(super) fn area(&self) -> f64 {
        std::f64::consts::PI * self.plane.jacobian()
    }

    /// Radius √u, angle 2πv: an affine map keeps it uniform.
    #[expect(clippy::cast_possible_truncation, reason = "a point of the disk is two f32 numbers")]
    pub(super) fn sample_area(&self, [u, v]: [f32; 2]) -> SurfacePoint {
        let radius = f64::from(u).sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(v));
        self.plane.surface([(radius * cos) as f32, (radius * sin) as f32], [radius as f32, v])
    }
}
