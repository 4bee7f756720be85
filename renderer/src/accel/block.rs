//! Leaves of up to eight items, and the test that passes over most triangles eight at a time.

use glam::Vec3;
use wide::f32x8;

use super::node::{WIDTH, prefetch};
use crate::ray::Ray;

/// Up to eight triangles, or other items in lanes that hold NaN.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Block {
    /// Coordinates by vertex and axis.
    vertices: [[f32x8; 3]; 3],
    /// Largest magnitude of a coordinate.
    extent: f32,
    /// Largest side of a triangle's bounding box.
    size: f32,
    /// Index of the first item.
    pub(super) first: u32,
    /// Lanes that are taken, as bits.
    lanes: u32,
    /// Whether it holds triangles, and not another item.
    has_triangles: bool,
}

impl Block {
    /// The block of `items`, numbered from `first`; `None` for what isn't a triangle.
    pub(super) fn new(items: &[Option<[Vec3; 3]>], first: u32) -> Self {
        let mut lanes = [[[f32::NAN; WIDTH]; 3]; 3];
        let (mut extent, mut size) = (0.0f32, 0.0f32);
        for (lane, triangle) in items.iter().enumerate() {
            let Some(corners) = triangle else { continue };
            for (vertex, corner) in corners.iter().enumerate() {
                for axis in 0..3 {
                    lanes[vertex][axis][lane] = corner[axis];
                }
                extent = extent.max(corner.abs().max_element());
            }
            let [a, b, c] = corners;
            size = size.max((a.max(*b).max(*c) - a.min(*b).min(*c)).max_element());
        }
        Self {
            vertices: lanes.map(|vertex| vertex.map(f32x8::new)),
            extent,
            size,
            first,
            lanes: (1 << items.len()) - 1,
            has_triangles: items.iter().any(Option::is_some),
        }
    }

    /// Fetches the block into the cache.
    #[inline]
    pub(super) fn prefetch(&self) {
        let [a, b, c] = &self.vertices;
        for line in [&a[0], &a[2], &b[1], &c[0], &c[2]] {
            prefetch(line);
        }
    }

    /// The triangle in a lane; `None` for another item.
    #[inline]
    pub(super) fn triangle(&self, lane: u32) -> Option<[Vec3; 3]> {
        let lane = lane as usize % WIDTH;
        let corner =
            |v: &[f32x8; 3]| Vec3::new(v[0].as_array()[lane], v[1].as_array()[lane], v[2].as_array()[lane]);
        let [a, b, c] = &self.vertices;
        let corners = [corner(a), corner(b), corner(c)];
        (!corners[0].x.is_nan()).then_some(corners)
    }

    /// The lanes that the ray may hit, as bits: none that it hits is left out, and few others are in.
    ///
    /// * `probe`: the ray prepared for triangles, made where it is needed first.
    ///
    /// It evaluates in f32 the edge functions whose exact signs `ShearedRay::intersect` takes, and leaves a triangle
    /// out where two of them have opposite signs beyond their error. With u = 2⁻²⁴, M the largest magnitude of a
    /// coordinate relative to the origin and D the largest side of the triangle's box: a sheared coordinate |x| ≤ 2M
    /// has two differences and a product within uM each, the shear's own rounding within 2uM, the sum's within 2uM here
    /// and within 2uM there, together δ ≤ 10uM. If the ray hits, its exact sheared coordinates are 0 within the triangle, so
    /// all are at most R = 2D + 4uM. An edge function, the difference of two products, then errs by at most
    /// 4δR + 2δ² + 3u(R + δ)² with D ≤ 2M, which is below 128·uM·D + 512·(uM)².
    #[inline]
    pub(super) fn candidates(&self, ray: &Ray, probe: &mut Option<Probe>) -> u32 {
        if !self.has_triangles {
            return self.lanes;
        }
        self.triangles(probe.get_or_insert_with(|| Probe::new(ray)))
    }

    #[inline]
    fn triangles(&self, probe: &Probe) -> u32 {
        const UNIT: f32 = f32::EPSILON / 2.0;
        let [i, j, k] = probe.axes;
        let (sx, sy) = (f32x8::splat(probe.shear[0]), f32x8::splat(probe.shear[1]));
        let [ox, oy, oz] = probe.origin;
        let project = |v: &[f32x8; 3]| {
            let z = v[k] - f32x8::splat(oz);
            (sx.mul_neg_add(z, v[i] - f32x8::splat(ox)), sy.mul_neg_add(z, v[j] - f32x8::splat(oy)))
        };
        let [a, b, c] = &self.vertices;
        let ((ax, ay), (bx, by), (cx, cy)) = (project(a), project(b), project(c));
        let u = cx.mul_sub(by, cy * bx);
        let v = ax.mul_sub(cy, ay * cx);
        let w = bx.mul_sub(ay, by * ax);
        let reach = UNIT * (probe.extent + self.extent);
        let error = reach * (128.0 * self.size + 512.0 * reach);
        let lowest = u.fast_min(v).fast_min(w);
        let highest = u.fast_max(v).fast_max(w);
        let outside = lowest.simd_lt(f32x8::splat(-error)) & highest.simd_gt(f32x8::splat(error));
        !outside.to_bitmask() & self.lanes
    }
}

/// A ray prepared for blocks: relative to its origin, with its longest component as z and x and y sheared along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 2],
    /// Largest magnitude of the origin's coordinates.
    extent: f32,
}

impl Probe {
    pub(super) fn new(ray: &Ray) -> Self {
        let z = ray.direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let [dx, dy, dz] = axes.map(|a| ray.direction[a]);
        let scale = 1.0 / dz;
        Self {
            axes,
            origin: axes.map(|a| ray.origin[a]),
            shear: [dx * scale, dy * scale],
            extent: ray.origin.abs().max_element(),
        }
    }
}
