//! Rank 3: points on surfaces, with the bound on their rounding error that keeps the next ray off them.

use glam::{DVec3, Vec3};
use wide::{f32x8, f64x8};

use crate::math::Frame;
use crate::math::eight::{self, Eight, Vec3x8, next_up};
use crate::ray::Ray;

/// A point on a surface in the render frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
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

    /// The first of what [`EightPoints::spawn_to`] gives.
    #[inline]
    pub fn spawn_to(&self, target: &Self, time: f32) -> Ray {
        EightPoints::splat(self).spawn_to(&EightPoints::splat(target)).get(0, time)
    }

    /// The segment to a point that lies on no surface.
    pub fn spawn_to_point(&self, target: Vec3, time: f32) -> Ray {
        segment(self.offset(target - self.point), target, time)
    }

    /// The first of what [`EightPoints::offset`] gives.
    #[inline]
    pub fn offset(&self, direction: Vec3) -> Vec3 {
        EightPoints::splat(self).offset(Vec3x8::splat(direction)).get(0)
    }
}

/// Eight points on surfaces side by side, as far as rays that leave or reach them go.
#[derive(Debug, Clone, Copy)]
pub struct EightPoints {
    /// Where they are.
    pub point: Vec3x8,
    /// Bounds as those of a [`SurfacePoint`].
    pub error: Vec3x8,
    /// Unit geometric normals.
    pub ng: Vec3x8,
}

impl EightPoints {
    /// Nothing that rays could leave.
    pub const ZERO: Self = Self { point: Vec3x8::ZERO, error: Vec3x8::ZERO, ng: Vec3x8::ZERO };

    /// Up to eight points, and their shading normals; the other lanes hold zeros.
    #[inline]
    pub fn of<'a>(points: impl Iterator<Item = &'a SurfacePoint>) -> (Self, Vec3x8) {
        let mut rows = [[f32x8::ZERO; 8]; 2];
        for (lane, at) in points.enumerate().take(8) {
            // As they lie in memory: a load each, where numbers put into lanes one by one would be waited for.
            let SurfacePoint { point: p, error: e, ng: g, n, uv: [u, v] } = *at;
            rows[0][lane] = f32x8::new([p.x, p.y, p.z, e.x, e.y, e.z, g.x, g.y]);
            rows[1][lane] = f32x8::new([g.x, g.y, g.z, n.x, n.y, n.z, u, v]);
        }
        let [px, py, pz, ex, ey, ez, ..] = f32x8::transpose(rows[0]);
        let [gx, gy, gz, nx, ny, nz, ..] = f32x8::transpose(rows[1]);
        let [point, error, ng] = [[px, py, pz], [ex, ey, ez], [gx, gy, gz]].map(Eight);
        (Self { point, error, ng }, Eight([nx, ny, nz]))
    }

    /// The same point eight times.
    #[inline]
    pub fn splat(at: &SurfacePoint) -> Self {
        let [point, error, ng] = [Vec3x8::splat(at.point), Vec3x8::splat(at.error), Vec3x8::splat(at.ng)];
        Self { point, error, ng }
    }

    /// Puts a point into a lane below 8.
    #[inline]
    pub fn set(&mut self, lane: usize, at: &SurfacePoint) {
        self.point.set(lane, at.point);
        self.error.set(lane, at.error);
        self.ng.set(lane, at.ng);
    }

    /// The points moved along `ng` beyond the error bound, to the side that `direction` points to.
    ///
    /// # Source
    /// Pharr, Jakob, Humphreys, Physically Based Rendering 4e, section 6.8.6 (the bound's projection on the normal,
    /// then one step outwards for the addition's own rounding).
    #[inline]
    pub fn offset(&self, direction: Vec3x8) -> Vec3x8 {
        let distance = self.ng.map(f32x8::abs).dot(self.error) * SLACK;
        let side = self.ng.dot(direction).simd_lt(0.0).select(-f32x8::ONE, f32x8::ONE);
        let step = |p: f32x8, m: f32x8| {
            let to = p + m;
            m.simd_gt(0.0).select(next_up(to), m.simd_lt(0.0).select(-next_up(-to), p))
        };
        let (Eight([x, y, z]), Eight([mx, my, mz])) = (self.point, self.ng * (distance * side));
        Eight([step(x, mx), step(y, my), step(z, mz)])
    }

    /// The segments to `target`, which end before `target`'s surfaces.
    ///
    /// One ends where it meets the tangent plane at `target` moved towards its origin by `target`'s error bound, and
    /// so before the surface itself if that is flat or curved away, however the plane's normal and the direction have been
    /// rounded. A segment within that rounding of the plane has length 0: nothing is in its way.
    ///
    /// # Precision, limits
    /// A direction has f32 components, so the segment passes `target` at up to 2⁻²⁴ of its length to the side.
    #[inline]
    pub fn spawn_to(&self, target: &Self) -> EightSegments {
        let origin = self.offset(target.point - self.point);
        let to = target.point.widened() - origin.widened();
        let length = to.dot(to).sqrt();
        let Eight([x, y, z]) = (to / length).rounded();
        // Two points that coincide have no direction; any with an empty segment will do.
        let (apart, zero) = (eight::rounded(length).simd_gt(0.0), f32x8::ZERO);
        let direction = Eight([apart.select(x, zero), apart.select(y, zero), apart.select(z, f32x8::ONE)]);
        let (ng, along) = (target.ng.widened(), direction.widened());
        let margin = ng.map(f64x8::abs).dot(target.error.widened()) * f64::from(SLACK);
        // By how much the ray passes `target`, as a height over the plane, and how fast it loses height.
        let aside = to - along * length;
        let height = ng.dot(aside).abs() + aside.dot(aside).sqrt() * NORMAL_ERROR + margin;
        let slope = ng.dot(along).abs() - NORMAL_ERROR;
        let before = slope.simd_gt(0.0).select(length - height / slope, f64x8::ZERO);
        // Rounds to nearest, then one step down.
        let t_max = (-next_up(-eight::rounded(before))).fast_max(zero);
        EightSegments { origin, direction, t_max }
    }
}

/// Eight segments side by side.
#[derive(Debug, Clone, Copy)]
pub struct EightSegments {
    /// Where they start.
    pub origin: Vec3x8,
    /// Their unit directions.
    pub direction: Vec3x8,
    /// Their lengths.
    pub t_max: f32x8,
}

impl EightSegments {
    /// The segment in a lane below 8, at `time`.
    #[inline]
    pub fn get(&self, lane: usize, time: f32) -> Ray {
        let t_max = self.t_max.as_array()[lane];
        Ray { t_max, ..Ray::new(self.origin.get(lane), self.direction.get(lane), time) }
    }

    /// Puts a segment into a lane below 8.
    #[inline]
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        self.origin.set(lane, ray.origin);
        self.direction.set(lane, ray.direction);
        self.t_max.as_mut_array()[lane] = ray.t_max;
    }
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
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
