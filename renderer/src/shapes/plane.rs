//! Planes with two axes: what parallelograms and ellipses share.

use glam::{DAffine3, DVec3};
use wide::{f32x8, f64x8};

use super::{accept, accept_eight, rounded, rounded_eight};
use crate::interaction::{EightPoints, SurfacePoint};
use crate::math::eight::{self, DVec3x8, Vec3x8};
use crate::ray::{EightRays, Ray64};

/// The image of the plane z = 0 under an affine map: points center + x·a + y·b.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    pub(super) center: DVec3,
    pub(super) a: DVec3,
    pub(super) b: DVec3,
    /// a × b, not unit.
    cross: DVec3,
    /// Vectors whose dot product with a point of the plane is its x or y.
    dual_a: DVec3,
    dual_b: DVec3,
    pub(super) normal: glam::Vec3,
    pub(super) extent: f64,
    jacobian: f64,
}

impl Plane {
    pub(super) fn new(to_frame: &DAffine3, flip: bool) -> Self {
        let m = to_frame.matrix3;
        let (center, a, b) = (to_frame.translation, m.x_axis, m.y_axis);
        let cross = a.cross(b);
        let square = cross.length_squared();
        // The normal is the inverse transpose's image of +z: a × b unless the map reflects.
        let outward = cross.normalize() * m.determinant().signum();
        Self {
            center,
            a,
            b,
            cross,
            jacobian: cross.length(),
            dual_a: b.cross(cross) / square,
            dual_b: cross.cross(a) / square,
            normal: if flip { -outward } else { outward }.as_vec3(),
            // Heights over the plane are evaluated to within this size: skew axes lose digits in a × b.
            extent: (center.abs().max_element() + a.length() + b.length())
                * (1.0 + a.length() * b.length() / square.sqrt()),
        }
    }

    /// Where the middle of the plane lies from `from`, along a, across a in the plane, and along its normal; `None` if
    /// the plane's axes are not at right angles, to 1e-6 (transforms in files have that many digits).
    pub(super) fn middle_from(&self, from: DVec3) -> Option<[f64; 3]> {
        let (x, z) = (self.a.normalize(), self.cross.normalize());
        let square = self.a.dot(self.b).abs() <= 1e-6 * self.a.length() * self.b.length();
        let to = self.center - from;
        square.then(|| [to.dot(x), to.dot(z.cross(x)), to.dot(z)])
    }

    /// |a × b|: the area per unit of x and y.
    pub(super) fn jacobian(&self) -> f64 {
        self.jacobian
    }

    /// Distance and coordinates of the point where a ray crosses the plane, with a distance in (0, `t_max`).
    #[inline]
    pub(super) fn cross(&self, ray: &Ray64) -> Option<(f32, [f64; 2])> {
        let (o, d) = (ray.origin - self.center, ray.direction);
        let (height, slope) = (self.cross.dot(o), self.cross.dot(d));
        // Away from it, or along it: many rays have just left the plane, and pay no quotient.
        if (height > 0.0) == (slope > 0.0) || slope == 0.0 {
            return None;
        }
        let t = -height / slope;
        let distance = accept(t, ray.t_max)?;
        let p = o + d * t;
        Some((distance, [self.dual_a.dot(p), self.dual_b.dot(p)]))
    }

    /// The coordinates of a point of the plane.
    #[inline]
    pub(super) fn place(&self, point: DVec3) -> [f64; 2] {
        let p = point - self.center;
        [self.dual_a.dot(p), self.dual_b.dot(p)]
    }

    /// What `cross` gives for eight rays: the lanes of those that cross, as bits, the distances and the coordinates.
    #[inline]
    pub(super) fn cross_eight(&self, rays: &EightRays) -> (u32, f32x8, [f64x8; 2]) {
        let along = |v: DVec3, p: DVec3x8| DVec3x8::splat(v).dot(p);
        let (o, d) = (rays.origin - DVec3x8::splat(self.center), rays.direction);
        let (height, slope) = (along(self.cross, o), along(self.cross, d));
        let t = -height / slope;
        let (accepted, distance) = accept_eight(t, rays.t_max);
        let away = (height.simd_gt(0.0) ^ slope.simd_gt(0.0)).to_bitmask();
        let p = o + d * t;
        (accepted & away, distance, [along(self.dual_a, p), along(self.dual_b, p)])
    }

    /// Eight points at (x, y).
    #[inline]
    pub(super) fn points(&self, [x, y]: [f32x8; 2]) -> EightPoints {
        let of = |v: DVec3| DVec3x8::splat(v);
        let p = of(self.center) + of(self.a) * eight::widened(x) + of(self.b) * eight::widened(y);
        let (point, error) = rounded_eight(p, self.extent);
        EightPoints { point, error, ng: Vec3x8::splat(self.normal) }
    }

    /// The point at (x, y), with texture coordinates `uv`.
    #[inline]
    pub(super) fn surface(&self, at: [f32; 2], uv: [f32; 2]) -> SurfacePoint {
        self.surface_at(at.map(f64::from), uv)
    }

    /// The same for a place that needs more digits: a millimetre's part of a plane a thousand kilometres wide.
    #[inline]
    pub(super) fn surface_at(&self, [x, y]: [f64; 2], uv: [f32; 2]) -> SurfacePoint {
        let p = self.center + self.a * x + self.b * y;
        let (point, error) = rounded(p, self.extent);
        SurfacePoint { point, error, ng: self.normal, n: self.normal, uv }
    }
}
