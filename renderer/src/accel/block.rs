//! Leaves of up to eight items, and the test that passes over most triangles eight at a time.

use glam::Vec3;
use wide::{f32x8, f32x16, u32x8};

use super::node::{SLACK, WIDTH, limit};
use crate::math::eight::permuted;
use crate::ray::{EightRays, Ray};

/// A block as it lies in memory, in two lines of the cache: x, y and z of up to eight vertices, and a word for each triangle. Its lower
/// half tells which vertices are the triangle's, in three bits each; the upper halves together are the `Summary`.
pub(super) type BlockMemory = [f32x16; 2];

/// What is known of a block as a whole.
#[derive(Debug, Clone, Copy)]
struct Summary {
    /// Largest magnitude of a coordinate, rounded up to eight bits.
    extent: f32,
    /// Largest side of a triangle's bounding box, rounded up to eight bits.
    size: f32,
    /// Index of the first item.
    first: u32,
    /// Lanes that hold triangles, as bits; none if the block is another item's.
    lanes: u32,
}

/// The vertices of a leaf's triangles, each once.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Vertices {
    coordinates: [[f32; WIDTH]; 3],
    count: usize,
}

impl Vertices {
    /// The index of a vertex that is equal to `vertex` in every bit, added if there is none; `None` if there is no room.
    #[inline]
    fn index(&mut self, vertex: Vec3) -> Option<usize> {
        let equal = |axis: usize| {
            let all: u32x8 = bytemuck::cast(self.coordinates[axis]);
            all.simd_eq(u32x8::splat(vertex[axis].to_bits()))
        };
        let equal = (equal(0) & equal(1) & equal(2)).to_bitmask() & !(u32::MAX << self.count);
        if equal != 0 {
            return Some(equal.trailing_zeros() as usize);
        }
        let slot = self.count;
        for (coordinates, coordinate) in self.coordinates.iter_mut().zip(vertex.to_array()) {
            *coordinates.get_mut(slot)? = coordinate;
        }
        self.count += 1;
        Some(slot)
    }

    /// Those of a triangle.
    pub(super) fn of(corners: [Vec3; 3]) -> Self {
        let mut vertices = Self::default();
        for corner in corners {
            vertices.index(corner);
        }
        vertices
    }

    /// Those of both; `None` if a leaf has no room for them.
    pub(super) fn union(mut self, other: &Self) -> Option<Self> {
        let [x, y, z] = &other.coordinates;
        for slot in 0..other.count {
            self.index(Vec3::new(x[slot], y[slot], z[slot]))?;
        }
        Some(self)
    }
}

/// The block of `items`, numbered from `first`, at most eight with at most eight vertices; `None` for what isn't a triangle.
#[expect(clippy::cast_possible_truncation, reason = "indices are below 8")]
pub(super) fn block(items: impl Iterator<Item = Option<[Vec3; 3]>>, first: u32) -> BlockMemory {
    let mut vertices = Vertices::default();
    let (mut extent, mut size, mut lanes) = (0.0f32, 0.0f32, 0);
    let mut words = [0; WIDTH];
    for (lane, triangle) in items.enumerate() {
        let Some(corners) = triangle else { continue };
        for (corner, bits) in corners.into_iter().zip([0, 3, 6]) {
            let index = vertices.index(corner).expect("a leaf has room for its vertices");
            words[lane] |= (index as u32) << bits;
            extent = extent.max(corner.abs().max_element());
        }
        let [a, b, c] = corners;
        size = size.max((a.max(b).max(c) - a.min(b).min(c)).max_element());
        lanes |= 1 << lane;
    }
    // The upper half of a number that isn't negative, rounded up.
    let upper = |x: f32| (x.to_bits() + 0xffff) >> 16;
    let summary = [upper(extent), upper(size), first & 0xffff, first >> 16, lanes];
    for (word, half) in words.iter_mut().zip(summary) {
        *word |= half << 16;
    }
    let [x, y, z] = vertices.coordinates;
    bytemuck::cast([x, y, z, words.map(f32::from_bits)])
}

/// Up to eight triangles in memory, or another item.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlockRef<'a>(&'a [f32x8; 4]);

impl<'a> BlockRef<'a> {
    #[inline]
    pub(super) fn new(memory: &'a BlockMemory) -> Self {
        Self(bytemuck::cast_ref(memory))
    }

    #[inline]
    fn words(self) -> &'a [u32; WIDTH] {
        bytemuck::cast_ref(&self.0[3])
    }

    #[inline]
    fn summary(self) -> Summary {
        let words = self.words();
        let float = |word: u32| f32::from_bits(word >> 16 << 16);
        Summary {
            extent: float(words[0]),
            size: float(words[1]),
            first: words[2] >> 16 | words[3] >> 16 << 16,
            lanes: words[4] >> 16,
        }
    }

    /// Index of the first item.
    #[inline]
    pub(super) fn first(self) -> usize {
        self.summary().first as usize
    }

    /// Whether it holds triangles, and not another item.
    #[inline]
    pub(super) fn has_triangles(self) -> bool {
        self.summary().lanes != 0
    }

    /// The triangle in a lane that is taken.
    #[inline]
    pub(super) fn triangle(self, lane: usize) -> [Vec3; 3] {
        let word = self.words()[lane % WIDTH];
        let corner = |bits: u32| {
            let vertex = (word >> bits) as usize % WIDTH;
            let coordinate = |axis: usize| self.0[axis].as_array()[vertex];
            Vec3::new(coordinate(0), coordinate(1), coordinate(2))
        };
        // Not by `map`, which isn't inlined.
        [corner(0), corner(3), corner(6)]
    }

    /// The triangles relative to where a ray begins.
    ///
    /// In f32 edge functions are evaluated whose exact signs `ShearedRay::intersect` takes, and a triangle is left
    /// out where two of them have opposite signs beyond their error. With u = 2⁻²⁴, M the largest magnitude of a
    /// coordinate relative to the origin, m = uM and D the largest side of the triangle's box: a sheared coordinate x
    /// differs from the exact test's by m and m for two differences, 2m for the shear, and u|x| for each sum: if all |x| are
    /// at most R, by δ ≤ 5m + 2uR. If the ray hits, the exact test's coordinates are 0 within the triangle, so R = 2D + 4m and
    /// δ ≤ 6m + 4uD. An edge function, the difference of two products, then errs by at most 4δR + 2δ² + 3u(R + δ)², which is
    /// below E = 50mD + 48uD² + 192m².
    ///
    /// Where all three have one sign beyond 4E, and the first vertex's coordinates are at most 2D + 16m, the hit is
    /// certain: then R = 4D + 26m, δ ≤ 6m + 8uD, and the error is below 97mD + 176uD² + 700m².
    #[inline(always)]
    pub(super) fn relative(self, probe: &Probe) -> Relative {
        const UNIT: f32 = f32::EPSILON / 2.0;
        let [i, j, k] = probe.axes;
        let [ox, oy, oz] = probe.origin;
        let Summary { extent, size, lanes, .. } = self.summary();
        let vertices =
            [self.0[i] - f32x8::splat(ox), self.0[j] - f32x8::splat(oy), self.0[k] - f32x8::splat(oz)];
        let words: u32x8 = bytemuck::cast(self.0[3]);
        let corners @ [a, b, c] = [words, words >> 3, words >> 6];
        let (az, bz, cz) = (permuted(vertices[2], a), permuted(vertices[2], b), permuted(vertices[2], c));
        let reach = UNIT * (probe.extent + extent);
        Relative {
            vertices,
            corners,
            z: [az.fast_min(bz).fast_min(cz), az.fast_max(bz).fast_max(cz)],
            lanes,
            error: size * (50.0 * reach + 48.0 * UNIT * size) + 192.0 * reach * reach,
            close: 2.0 * size + 16.0 * reach,
        }
    }
}

/// Triangles of a block relative to where a ray begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Relative {
    vertices: [f32x8; 3],
    /// Which vertices are the triangles' first, second and third corners, in the three lowest bits.
    corners: [u32x8; 3],
    /// The lowest and the highest z.
    z: [f32x8; 2],
    /// Lanes that are taken, as bits.
    lanes: u32,
    /// Bound on the error of an edge function.
    error: f32,
    /// How far to the sides of the ray a vertex of a triangle that it hits may lie.
    close: f32,
}

impl Relative {
    /// The triangles that the ray may hit: none that it hits is left out, and few others are in.
    ///
    /// A hit lies between the nearest and the farthest vertex, whose distances have three roundings here: within `SLACK`.
    #[inline(always)]
    pub(super) fn candidates(&self, probe: &Probe, t_max: f32) -> Candidates {
        let (sx, sy) = (f32x8::splat(probe.shear[0]), f32x8::splat(probe.shear[1]));
        let [x, y, z] = self.vertices;
        let (x, y) = (sx.mul_neg_add(z, x), sy.mul_neg_add(z, y));
        let [a, b, c] = self.corners;
        let (ax, ay) = (permuted(x, a), permuted(y, a));
        let (bx, by) = (permuted(x, b), permuted(y, b));
        let (cx, cy) = (permuted(x, c), permuted(y, c));
        let u = cx.mul_sub(by, cy * bx);
        let v = ax.mul_sub(cy, ay * cx);
        let w = bx.mul_sub(ay, by * ax);
        let lowest = u.fast_min(v).fast_min(w);
        let highest = u.fast_max(v).fast_max(w);
        let error = f32x8::splat(self.error);
        let outside = lowest.simd_lt(-error) & highest.simd_gt(error);
        let scale = f32x8::splat(probe.scale);
        let (one, other) = (self.z[0] * scale, self.z[1] * scale);
        let (near, far) = (one.fast_min(other), one.fast_max(other));
        let beyond = near.simd_gt(f32x8::splat(limit(t_max))) | far.simd_lt(f32x8::ZERO);
        let lanes = !(outside | beyond).to_bitmask() & self.lanes;
        let certain = error * f32x8::splat(4.0);
        let inside = lowest.simd_gt(certain) | highest.simd_lt(-certain);
        let close = ax.abs().fast_max(ay.abs()).simd_le(f32x8::splat(self.close));
        let between = near.simd_gt(f32x8::splat(f32::MIN_POSITIVE))
            & (far * f32x8::splat(SLACK)).simd_lt(f32x8::splat(t_max));
        Candidates { lanes, certain: (inside & close & between).to_bitmask() & self.lanes, far }
    }
}

/// The triangles of a block that a ray may hit.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Candidates {
    /// Their lanes, as bits.
    pub(super) lanes: u32,
    /// Those that it hits for certain.
    pub(super) certain: u32,
    /// The distances of their farthest vertices.
    pub(super) far: f32x8,
}

/// Rays of a packet prepared for blocks, all with the same longest component of their directions.
#[derive(Debug, Default)]
pub(super) struct Probes {
    axes: [usize; 3],
    origin: [f32x8; 3],
    shear: [f32x8; 2],
    scale: f32x8,
    extent: f32x8,
}

impl Probes {
    #[inline]
    pub(super) fn new(rays: &EightRays<f32x8>, z: usize) -> Self {
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let [dx, dy, dz] = axes.map(|a| rays.direction.0[a]);
        let scale = f32x8::ONE / dz;
        let [x, y, z] = rays.origin.0;
        Self {
            axes,
            origin: axes.map(|a| rays.origin.0[a]),
            shear: [dx * scale, dy * scale],
            scale,
            extent: x.abs().fast_max(y.abs()).fast_max(z.abs()),
        }
    }

    /// The ray in a lane.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Probe {
        let at = |x: &f32x8| x.as_array()[lane];
        let ([ox, oy, oz], [sx, sy]) = (&self.origin, &self.shear);
        Probe {
            axes: self.axes,
            origin: [at(ox), at(oy), at(oz)],
            shear: [at(sx), at(sy)],
            scale: at(&self.scale),
            extent: at(&self.extent),
        }
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
    // Always inlined: handed over in memory it would be copied before it is there.
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let z = ray.direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let (origin, direction): (&[f32; 3], &[f32; 3]) = (ray.origin.as_ref(), ray.direction.as_ref());
        let [dx, dy, dz] = axes.map(|a| direction[a]);
        let scale = 1.0 / dz;
        Self {
            axes,
            origin: axes.map(|a| origin[a]),
            shear: [dx * scale, dy * scale],
            scale,
            extent: ray.origin.abs().max_element(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::warp::point;
    use crate::shapes::triangle::ShearedRay;

    #[test]
    fn blocks_hold_their_triangles() {
        for n in 0..1000 {
            // A fan of up to six triangles around the first of eight points.
            let points: Vec<Vec3> =
                (0..8).map(|k| point(8 * n + k) * 2f32.powi(n as i32 % 40 - 20)).collect();
            let fan = (0..1 + n as usize % 6).map(|k| [points[0], points[k + 1], points[k + 2]]);
            let triangles: Vec<_> = fan.map(Some).collect();
            let first = n * 4_294_967;
            let memory = block(triangles.iter().copied(), first);
            let block = BlockRef::new(&memory);
            assert_eq!(block.first(), first as usize);
            for (lane, triangle) in triangles.iter().enumerate() {
                assert_eq!(Some(block.triangle(lane)), *triangle);
            }
            let Summary { extent, size, lanes, .. } = block.summary();
            assert_eq!(lanes, (1 << triangles.len()) - 1);
            let corners = triangles.iter().flatten();
            let largest = corners.clone().flatten().fold(0.0, |all: f32, v| all.max(v.abs().max_element()));
            let sides = corners.map(|[a, b, c]| (a.max(*b).max(*c) - a.min(*b).min(*c)).max_element());
            let longest = sides.fold(0.0, f32::max);
            // Seven bits follow the first.
            for (bound, exact) in [(extent, largest), (size, longest)] {
                assert!((exact..=exact * (1.0 + 2f32.powi(-7))).contains(&bound), "{bound} for {exact}");
            }
        }
        let other = block([None].into_iter(), 7);
        assert!(!BlockRef::new(&other).has_triangles() && BlockRef::new(&other).first() == 7);
    }

    #[test]
    fn leaves_have_room_for_eight_vertices() {
        let triangle = |k: u32| [k, k + 1, k + 2].map(point);
        let strip = |count: u32| {
            (1..count).try_fold(Vertices::of(triangle(0)), |all, k| all.union(&Vertices::of(triangle(k))))
        };
        assert_eq!(strip(6).map(|vertices| vertices.count), Some(WIDTH));
        assert!(strip(7).is_none());
        // Zeros of two signs are two vertices: tests of triangles may tell them apart.
        assert_eq!(Vertices::of([Vec3::ZERO, -Vec3::ZERO, Vec3::ZERO]).count, 2);
    }

    #[test]
    fn certain_hits_are_hits_and_hits_are_candidates() {
        let (mut certain, mut hits) = (0, 0);
        for n in 0..200_000 {
            let (from, along) = (4.0 * point(3 * n), point(5 * n + 1));
            // From fat triangles to slivers of a few roundings, met on their longer axes' lines, inside and far outside, and on an edge:
            // errors bounded a fiftieth as wide would be found out.
            let thin = point(7 * n + 2) * 0.5f32.powi(4 + 2 * (n % 12) as i32);
            let corners = [along * -0.5, along * 0.5, along * 0.3 + thin];
            let target = match n % 4 {
                0 => corners[0].lerp(corners[2], point(n).x.abs()),
                _ => along * (4.0 * point(n).x) + thin * point(11 * n).y,
            };
            let ray = Ray::new(from, (target - from).normalize(), 0.0);
            let block = block([Some(corners)].into_iter(), 0);
            let probe = Probe::new(&ray);
            let found = BlockRef::new(&block).relative(&probe).candidates(&probe, ray.t_max);
            let hit = ShearedRay::new(&ray).hit(&corners, ray.t_max);
            assert!(found.lanes == 1 || hit.is_none(), "{ray:?} {corners:?}");
            assert!(found.certain == 0 || hit.is_some(), "{ray:?} {corners:?}");
            assert!(hit.is_none_or(|hit| hit.t < found.far.to_array()[0] * SLACK), "{ray:?} {corners:?}");
            certain += found.certain;
            hits += u32::from(hit.is_some());
        }
        assert!(certain > 500 && hits > certain, "{certain} of {hits}");
    }
}
