//! Leaves of up to eight items, and the test that passes over most triangles eight at a time.

use glam::Vec3;
use wide::{f32x8, f32x16};

use super::node::{SLACK, WIDTH, limit};
use super::walk::Mode;
use crate::ray::Ray;

/// A block as it lies in memory: coordinates by vertex and axis, NaN in lanes that are empty or of another item, and its `Summary`.
pub(super) type BlockMemory = [f32x16; 5];

/// What is known of a block as a whole, as it lies in memory.
#[derive(Debug, Clone, Copy)]
struct Summary {
    /// Largest magnitude of a coordinate.
    extent: f32,
    /// Largest side of a triangle's bounding box.
    size: f32,
    /// Index of the first item.
    first: u32,
    /// Lanes that are taken, as bits.
    lanes: u32,
    /// Whether it holds triangles, and not another item.
    has_triangles: bool,
}

/// The block of `items`, numbered from `first`, at most eight; `None` for what isn't a triangle.
pub(super) fn block(items: &[Option<[Vec3; 3]>], first: u32) -> BlockMemory {
    let mut memory = [[f32::NAN; WIDTH]; 10];
    let (mut extent, mut size) = (0.0f32, 0.0f32);
    for (lane, triangle) in items.iter().enumerate() {
        let Some(corners) = triangle else { continue };
        for (vertex, corner) in corners.iter().enumerate() {
            for axis in 0..3 {
                memory[3 * vertex + axis][lane] = corner[axis];
            }
            extent = extent.max(corner.abs().max_element());
        }
        let [a, b, c] = corners;
        size = size.max((a.max(*b).max(*c) - a.min(*b).min(*c)).max_element());
    }
    let has_triangles = u32::from(items.iter().any(Option::is_some));
    let summary = [extent.to_bits(), size.to_bits(), first, (1 << items.len()) - 1, has_triangles, 0, 0, 0];
    memory[9] = summary.map(f32::from_bits);
    bytemuck::cast(memory)
}

/// Up to eight triangles in memory, or another item.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlockRef<'a>(&'a [f32x8; 10]);

impl<'a> BlockRef<'a> {
    #[inline]
    pub(super) fn new(memory: &'a BlockMemory) -> Self {
        Self(bytemuck::cast_ref(memory))
    }

    #[inline]
    fn summary(self) -> Summary {
        let &[extent, size, first, lanes, has_triangles, ..]: &[u32; WIDTH] = bytemuck::cast_ref(&self.0[9]);
        let [extent, size] = [extent, size].map(f32::from_bits);
        Summary { extent, size, first, lanes, has_triangles: has_triangles != 0 }
    }

    /// Index of the first item.
    #[inline]
    pub(super) fn first(self) -> usize {
        self.summary().first as usize
    }

    /// Whether it holds triangles, and not another item.
    #[inline]
    pub(super) fn has_triangles(self) -> bool {
        self.summary().has_triangles
    }

    /// The triangle in a lane that is taken.
    #[inline]
    pub(super) fn triangle(self, lane: u32) -> [Vec3; 3] {
        let lane = lane as usize % WIDTH;
        let coordinate = |index: usize| self.0[index].as_array()[lane];
        let corner = |v: usize| Vec3::new(coordinate(v), coordinate(v + 1), coordinate(v + 2));
        // Not by `map`, which isn't inlined.
        [corner(0), corner(3), corner(6)]
    }

    /// The lanes of triangles that the ray may hit, as bits: none that it hits is left out, and few others are in. And the lanes of
    /// triangles that it hits for certain.
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
    ///
    /// Where all three have one sign beyond three times that error, and no sheared coordinate exceeds 2D + 16uM, the hit is
    /// certain if any hit is asked for: R = 2D + 26uM then bounds the exact ones, and the error is below 104·uM·D + 1240·(uM)².
    ///
    /// A hit lies between the nearest and the farthest vertex, whose distances have three roundings here: within `SLACK`.
    #[inline]
    pub(super) fn candidates<M: Mode>(self, ray: &Ray, probe: &mut Option<Probe>) -> (u32, u32) {
        const UNIT: f32 = f32::EPSILON / 2.0;
        let (probe, t_max) = (probe.get_or_insert_with(|| Probe::new(ray)), ray.t_max);
        let [i, j, k] = probe.axes;
        let (sx, sy) = (f32x8::splat(probe.shear[0]), f32x8::splat(probe.shear[1]));
        let [ox, oy, oz] = probe.origin;
        let Summary { extent, size, lanes, .. } = self.summary();
        let project = |vertex: usize| {
            let v = &self.0[vertex..vertex + 3];
            let z = v[k] - f32x8::splat(oz);
            (sx.mul_neg_add(z, v[i] - f32x8::splat(ox)), sy.mul_neg_add(z, v[j] - f32x8::splat(oy)), z)
        };
        let [(ax, ay, az), (bx, by, bz), (cx, cy, cz)] = [0, 3, 6].map(project);
        let u = cx.mul_sub(by, cy * bx);
        let v = ax.mul_sub(cy, ay * cx);
        let w = bx.mul_sub(ay, by * ax);
        let reach = UNIT * (probe.extent + extent);
        let error = reach * (128.0 * size + 512.0 * reach);
        let lowest = u.fast_min(v).fast_min(w);
        let highest = u.fast_max(v).fast_max(w);
        let (below, above) = (f32x8::splat(-error), f32x8::splat(error));
        let outside = lowest.simd_lt(below) & highest.simd_gt(above);
        let scale = f32x8::splat(probe.scale);
        let (one, other) = (az.fast_min(bz).fast_min(cz) * scale, az.fast_max(bz).fast_max(cz) * scale);
        let (near, far) = (one.fast_min(other), one.fast_max(other));
        let beyond = near.simd_gt(f32x8::splat(limit(t_max))) | far.simd_lt(f32x8::ZERO);
        let candidates = !(outside | beyond).to_bitmask() & lanes;
        if !M::ANY {
            return (candidates, 0);
        }
        let certain = f32x8::splat(3.0 * error);
        let inside = lowest.simd_gt(certain) | highest.simd_lt(-certain);
        let largest = [ay, bx, by, cx, cy].iter().fold(ax.abs(), |all, x| all.fast_max(x.abs()));
        let close = largest.simd_le(f32x8::splat(2.0 * size + 16.0 * reach));
        let between = near.simd_gt(f32x8::splat(f32::MIN_POSITIVE))
            & (far * f32x8::splat(SLACK)).simd_lt(f32x8::splat(t_max));
        (candidates, (inside & close & between).to_bitmask() & lanes)
    }
}

/// A ray prepared for blocks: relative to its origin, with its longest component as z and x and y sheared along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 2],
    /// The inverse of the direction's z.
    scale: f32,
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
            scale,
            extent: ray.origin.abs().max_element(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::group::point;
    use crate::accel::walk::Any;
    use crate::shapes::triangle::ShearedRay;

    #[test]
    fn certain_hits_are_hits_and_hits_are_candidates() {
        let (mut certain, mut hits) = (0, 0);
        for n in 0..100_000 {
            let (from, along) = (4.0 * point(3 * n), point(5 * n + 1));
            // From fat triangles to slivers of a few roundings, met on their longer axes' lines, inside and far outside.
            let thin = point(7 * n + 2) * 0.5f32.powi(4 + 2 * (n % 12) as i32);
            let corners = [along * -0.5, along * 0.5, along * 0.3 + thin];
            let target = along * (4.0 * point(n).x) + thin * point(11 * n).y;
            let ray = Ray::new(from, (target - from).normalize(), 0.0);
            let block = block(&[Some(corners)], 0);
            let (candidates, sure) = BlockRef::new(&block).candidates::<Any>(&ray, &mut None);
            let hit = ShearedRay::new(&ray).hit(&corners, ray.t_max).is_some();
            assert!(candidates == 1 || !hit, "{ray:?} {corners:?}");
            assert!(sure == 0 || hit, "{ray:?} {corners:?}");
            certain += sure;
            hits += u32::from(hit);
        }
        assert!(certain > 500 && hits > certain, "{certain} of {hits}");
    }
}
