//! Spheres.

use std::f64::consts::TAU;

use glam::{DAffine3, DMat3, DVec3};
use wide::f32x8;

use super::quadratic::{roots, roots_eight};
use super::{
    EightHits, SMALLEST_SOLID_ANGLE, ShapeHit, accept, accept_eight, check_point, check_radius,
    rounded_curved, turn, uniform_scale,
};
use crate::ParamError;
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::math::eight::DVec3x8;
use crate::ray::{EightRays, Ray64};

/// A sphere; its normals point outward, or inward after a reflection, as in Mitsuba.
#[derive(Debug, Clone)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
    /// Directions of the frame to directions of the sphere's own space.
    to_object: DMat3,
    sign: f64,
    /// Whether points have surface coordinates.
    mapped: bool,
}

impl Sphere {
    pub(super) fn new(
        center: DVec3,
        radius: f64,
        to_frame: &DAffine3,
        flip: bool,
    ) -> Result<Self, ParamError> {
        check_point("center", center)?;
        check_radius(radius)?;
        let scale = uniform_scale("scale of a sphere", to_frame)?;
        let is_reflected = to_frame.matrix3.determinant() < 0.0;
        Ok(Self {
            center: to_frame.transform_point3(center),
            radius: radius * scale,
            to_object: to_frame.matrix3.inverse() * scale,
            sign: if flip == is_reflected { 1.0 } else { -1.0 },
            mapped: true,
        })
    }

    pub(super) fn without_coordinates(self) -> Self {
        Self { mapped: false, ..self }
    }

    /// The centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether the normals point inward.
    pub fn is_flipped(&self) -> bool {
        self.sign < 0.0
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of([self.center]).grown(DVec3::splat(self.radius))
    }

    /// The distance at which a ray first meets the sphere; not above 0 if that is behind it.
    fn met(&self, ray: &Ray64) -> Option<f64> {
        let d = ray.direction;
        let f = ray.origin - self.center;
        let (b, ff) = (-f.dot(d), f.length_squared());
        // Outside and on the way outwards, like the rays that have just left the sphere.
        if b < 0.0 && ff > self.radius * self.radius {
            return None;
        }
        let a = d.length_squared();
        let [near, far] = roots(a, b, ff, (f + d * (b / a)).length_squared(), self.radius)?;
        Some(if near > 0.0 { near } else { far })
    }

    pub(super) fn intersect(&self, ray: &Ray64) -> Option<ShapeHit> {
        Some(ShapeHit { t: accept(self.met(ray)?, ray.t_max)?, uv: [0.0; 2] })
    }

    #[inline]
    pub(super) fn intersect_eight(&self, rays: &EightRays) -> EightHits {
        let d = rays.direction;
        let f = rays.origin - DVec3x8::splat(self.center);
        let (b, ff) = (-f.dot(d), f.dot(f));
        let leaving = b.simd_lt(0.0) & ff.simd_gt(self.radius * self.radius);
        let a = d.dot(d);
        let closest = f + d * (b / a);
        let (met, [near, far]) = roots_eight(a, b, ff, closest.dot(closest), self.radius);
        let (accepted, t) = accept_eight(near.simd_gt(0.0).select(near, far), rays.t_max);
        EightHits { lanes: accepted & met & !leaving.to_bitmask(), t, uv: [f32x8::ZERO; 2] }
    }

    /// Solves again, because the f32 distance is coarser than the surface, and from far away coarser than the sphere: it does not
    /// tell which side was met.
    #[inline]
    pub(super) fn surface(&self, ray: &Ray64, t: f32) -> SurfacePoint {
        let exact = self.met(ray).unwrap_or(f64::from(t));
        let p = ray.origin + ray.direction * exact;
        self.point_towards((p - self.center).normalize())
    }

    fn point_towards(&self, outward: DVec3) -> SurfacePoint {
        let extent = self.center.abs().max_element() + self.radius;
        let (point, error) = rounded_curved(self.center + outward * self.radius, extent, self.radius);
        let n = (outward * self.sign).as_vec3();
        let uv = if self.mapped { self.coordinates(outward) } else { [0.0; 2] };
        SurfacePoint { point, error, ng: n, n, uv }
    }

    /// The turn from the x axis, and the angle from the z axis in half turns.
    #[expect(clippy::cast_possible_truncation, reason = "texture coordinates are f32")]
    fn coordinates(&self, outward: DVec3) -> [f32; 2] {
        let local = self.to_object * outward;
        let v = libm::atan2(local.truncate().length(), local.z) * std::f64::consts::FRAC_1_PI;
        [turn(local.y, local.x), v as f32]
    }

    /// Along the circles of latitude.
    pub(super) fn tangent(&self, surface: &SurfacePoint) -> DVec3 {
        let local = self.to_object * surface.ng.as_dvec3() * self.sign;
        self.to_object.transpose() * DVec3::new(-local.y, local.x, 0.0)
    }

    pub(super) fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius * self.radius
    }

    /// z is uniform on [−1, 1] (Archimedes) and the angle around it on [0, 2π).
    pub(super) fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        let [u0, u1] = u.map(f64::from);
        let z = 1.0 - 2.0 * u0;
        // 1 − z² without cancellation near the poles.
        let r = 2.0 * (u0 * (1.0 - u0)).sqrt();
        let (sin, cos) = libm::sincos(TAU * u1);
        self.point_towards(DVec3::new(r * cos, r * sin, z))
    }

    /// What is seen of its outer side from `from`: the unit vector to the centre, the distance to it, and 1 − cos of
    /// the cone that it fills.
    ///
    /// Returns: `None` from inside, and if the normals point inward: only the inside is of interest then, and a point on
    /// the sphere, which rounding may put outside, must see all of it.
    fn cone_from(&self, from: DVec3) -> Option<(DVec3, f64, f64)> {
        let to = self.center - from;
        let distance = to.length();
        let sine = self.radius / distance;
        let height = sine * sine / (1.0 + ((1.0 - sine) * (1.0 + sine)).sqrt());
        (self.sign > 0.0 && sine < 1.0 && TAU * height > SMALLEST_SOLID_ANGLE)
            .then(|| (to / distance, distance, height))
    }

    /// The density of [`Self::sample_solid_angle`]; `None` from inside.
    pub(super) fn pdf_solid_angle(&self, from: DVec3) -> Option<f64> {
        self.cone_from(from).map(|(_, _, height)| 1.0 / (TAU * height))
    }

    /// 1 − cos θ is uniform on the cone's, and so is the angle around it (Archimedes).
    ///
    /// The distance to the point is d·cos θ − d·√(sin² θmax − sin² θ), the difference of squares from their roots.
    pub(super) fn sample_solid_angle(&self, from: DVec3, u: [f32; 2]) -> Option<(SurfacePoint, f64)> {
        let (axis, distance, height_max) = self.cone_from(from)?;
        let [u0, u1] = u.map(f64::from);
        let height = u0 * height_max;
        let sine = (height * (2.0 - height)).sqrt();
        let spare = (height_max * (1.0 - u0) * (2.0 - height_max * (1.0 + u0))).sqrt();
        let (sin, cos) = libm::sincos(TAU * u1);
        let (x, y) = axis.any_orthonormal_pair();
        let aside = sine * (cos * x + sin * y) - height * axis;
        // The direction is axis + aside; the point as seen from the centre is that times `reach`, less the axis.
        let reach = 1.0 - height - spare;
        let outward = aside * reach - axis * (height + spare);
        let point = self.point_towards((outward * distance).normalize());
        Some((point, 1.0 / (TAU * height_max)))
    }
}
