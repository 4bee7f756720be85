//! Rank 3: points on surfaces, with the bound on their rounding error that keeps the next ray off them.

use glam::{DVec3, Vec3};
use wide::f32x8;

use crate::math::Frame;
use crate::math::eight::{Eight, Vec3x8, next_up};
use crate::ray::Ray;

/// A point on a surface in the render frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Where it is.
    pub point: Vec3,
    /// Bound on the distance of each coordinate of `point` from the surface that rays are traced against.
    pub error: Vec3,
    /// Unit geometric normal, on the side that the shape (or `flip_normals`) says.
    pub ng: Vec3,
    /// Unit shading normal.
    pub n: Vec3,
    /// Texture coordinates.
    pub uv: [f32; 2],
}

/// Slack for the roundings inside `offset` itself: it does a few f32 operations, each within 2⁻²⁴.
const SLACK: f32 = 1.0 + 8.0 * f32::EPSILON;

/// How far a unit normal is from the exact one: three components are rounded by 2⁻²⁵ each, and once more as they are computed.
const NORMAL_ERROR: f64 = f32::EPSILON as f64;

impl SurfacePoint {
    /// The ray from this surface along the unit vector `direction`, starting just beyond the error bound on the side
    /// that `direction` points to.
    #[inline]
    pub fn spawn(&self, direction: Vec3, time: f32) -> Ray {
        Ray::new(self.offset(direction), direction, time)
    }

    /// The segment to `target`, which ends before `target`'s surface.
    ///
    /// It ends where it meets the tangent plane at `target` moved towards its origin by `target`'s error bound, and
    /// so before the surface itself if that is flat or curved away, however the plane's normal and the direction have been
    /// rounded. A segment within that rounding of the plane has length 0: nothing is in its way.
    ///
    /// # Precision, limits
    /// A direction has f32 components, so the segment passes `target` at up to 2⁻²⁴ of its length to the side.
    #[inline]
    pub fn spawn_to(&self, target: &Self, time: f32) -> Ray {
        let to = (target.point - self.point).as_dvec3();
        let origin = self.offset(to.as_vec3());
        let ray = segment(origin, target.point, time);
        let (ng, to) = (target.ng.as_dvec3(), target.point.as_dvec3() - origin.as_dvec3());
        let (length, direction) = (to.length(), ray.direction.as_dvec3());
        let margin = ng.abs().dot(target.error.as_dvec3()) * f64::from(SLACK);
        // By how much the ray passes `target`, as a height over the plane, and how fast it loses height.
        let aside = to - length * direction;
        let height = ng.dot(aside).abs() + NORMAL_ERROR * aside.length() + margin;
        let slope = ng.dot(direction).abs() - NORMAL_ERROR;
        let before = if slope > 0.0 { length - height / slope } else { 0.0 };
        Ray { t_max: round_down(before), ..ray }
    }

    /// The segment to a point that lies on no surface.
    pub fn spawn_to_point(&self, target: Vec3, time: f32) -> Ray {
        segment(self.offset(target - self.point), target, time)
    }

    /// The point moved along `ng` beyond the error bound, to the side that `direction` points to.
    ///
    /// # Source
    /// Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 6.8.6 (the bound's projection on the normal,
    /// then one step outwards for the addition's own rounding).
    #[inline]
    pub fn offset(&self, direction: Vec3) -> Vec3 {
        let distance = self.ng.abs().dot(self.error) * SLACK;
        let side = if self.ng.dot(direction) < 0.0 { -1.0 } else { 1.0 };
        let moved = self.ng * (distance * side);
        let step = |p: f32, m: f32| {
            // All three are made, so that a loop over points can be one of vectors.
            let (up, down) = ((p + m).next_up(), (p + m).next_down());
            if m > 0.0 {
                up
            } else if m < 0.0 {
                down
            } else {
                p
            }
        };
        let p = self.point;
        Vec3::new(step(p.x, moved.x), step(p.y, moved.y), step(p.z, moved.z))
    }
}

/// What [`SurfacePoint::offset`] gives for eight points, bit for bit.
#[inline]
pub fn offset_eight(point: Vec3x8, error: Vec3x8, ng: Vec3x8, direction: Vec3x8) -> Vec3x8 {
    let distance = ng.abs().dot(error) * SLACK;
    let side = ng.dot(direction).simd_lt(0.0).select(-f32x8::ONE, f32x8::ONE);
    let (moved, Eight([x, y, z])) = (ng * (distance * side), point);
    let step = |p: f32x8, m: f32x8| {
        let to = p + m;
        m.simd_gt(0.0).select(next_up(to), m.simd_lt(0.0).select(-next_up(-to), p))
    };
    let Eight([mx, my, mz]) = moved;
    Eight([step(x, mx), step(y, my), step(z, mz)])
}

/// The segment between two points; its length is rounded down.
#[inline]
fn segment(origin: Vec3, end: Vec3, time: f32) -> Ray {
    let to: DVec3 = end.as_dvec3() - origin.as_dvec3();
    let length = to.length();
    // Two points that coincide have no direction; any with an empty segment will do.
    let direction = if length > 0.0 { (to / length).as_vec3() } else { Vec3::Z };
    Ray { t_max: round_down(length), ..Ray::new(origin, direction, time) }
}

#[inline]
#[expect(clippy::cast_possible_truncation, reason = "rounds to nearest, then one step down")]
fn round_down(t: f64) -> f32 {
    (t as f32).next_down().max(0.0)
}

/// Where a ray met the scene, as materials and lights see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interaction {
    /// The point and its normals.
    pub surface: SurfacePoint,
    /// Unit vector back along the ray.
    pub wo: Vec3,
    /// The ray's moment.
    pub time: f32,
    /// Index of the object.
    pub object: u32,
}

impl Interaction {
    /// The ray that leaves along the unit vector `wi`.
    pub fn spawn(&self, wi: Vec3) -> Ray {
        self.surface.spawn(wi, self.time)
    }

    /// The segment to a point on another surface.
    pub fn spawn_to(&self, target: &SurfacePoint) -> Ray {
        self.surface.spawn_to(target, self.time)
    }

    /// The segment to a point that lies on no surface.
    pub fn spawn_to_point(&self, target: Vec3) -> Ray {
        self.surface.spawn_to_point(target, self.time)
    }

    /// The local frame, whose z axis is the shading normal.
    pub fn frame(&self) -> Frame {
        Frame::from_z(self.surface.n)
    }
}
