//! Bodies between three pairs of parallel planes.

use std::ops::{Add, Div, Mul, Sub};

use glam::{DAffine3, DMat3, DVec3};
use wide::{f32x8, f64x8};

use super::mesh::choose;
use super::plane::Plane;
use super::{EightHits, MeshData, ShapeHit, accept};
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::math::eight::{self, Eight};
use crate::math::float::round_f32;
use crate::ray::{EightRays, Ray64};

/// Of each face the outward normal, the axis along which u grows and the one along which v grows, as in Mitsuba's `cube`.
const FACES: [[[f32; 3]; 3]; 6] = [
    [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
    [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
];

/// The faces across x, y and z, on the lower and the upper side.
const ACROSS: [[usize; 2]; 3] = [[4, 2], [0, 1], [5, 3]];

/// The image of [−1, 1]³; normals outward.
///
/// A ray is in it between the last of the three pairs of planes that it enters and the first that it leaves.
///
/// # Source
/// Kay and Kajiya 1986, "Ray tracing complex scenes" (doi:10.1145/15886.15916).
#[derive(Debug, Clone)]
pub struct Cube {
    center: DVec3,
    /// Half the edges.
    axes: [DVec3; 3],
    slabs: [Slab; 3],
    faces: [Plane; 6],
    /// The areas of all faces up to and with each.
    areas: [f64; 6],
    is_flipped: bool,
}

/// The space between two parallel planes.
#[derive(Debug, Clone, Copy)]
struct Slab {
    /// Unit, towards the upper plane.
    normal: DVec3,
    /// Half the distance of the planes.
    half: f64,
}

/// What is computed for one ray or for eight.
trait Number:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The smaller number; the second if one is none.
    fn least(self, other: Self) -> Self;

    /// The larger number; the second if one is none.
    fn most(self, other: Self) -> Self;
}

impl Number for f64 {
    #[inline]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline]
    fn most(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl Number for f64x8 {
    #[inline]
    fn least(self, other: Self) -> Self {
        self.fast_min(other)
    }

    #[inline]
    fn most(self, other: Self) -> Self {
        self.fast_max(other)
    }
}

impl Cube {
    pub(super) fn new(to_frame: &DAffine3, flip: bool) -> Self {
        let m = to_frame.matrix3;
        let (center, axes) = (to_frame.translation, [m.x_axis, m.y_axis, m.z_axis]);
        let slab = |k: usize| {
            let normal = axes[(k + 1) % 3].cross(axes[(k + 2) % 3]).normalize() * m.determinant().signum();
            Slab { normal, half: normal.dot(axes[k]) }
        };
        let face = |[n, u, v]: [[f32; 3]; 3]| {
            let [n, u, v] = [n, u, v].map(|axis| DVec3::from(axis.map(f64::from)));
            let face = DAffine3 { matrix3: DMat3::from_cols(u, v, n), translation: n };
            Plane::new(&(*to_frame * face), flip)
        };
        let mut faces = FACES.map(face);
        // Rays are tested around the middle: every face has the roundings of the largest.
        let extent = faces.iter().map(|face| face.extent).fold(0.0, f64::max);
        faces.iter_mut().for_each(|face| face.extent = extent);
        let mut area = 0.0;
        let areas = faces.each_ref().map(|face| {
            area += 4.0 * face.jacobian();
            area
        });
        Self { center, axes, slabs: [0, 1, 2].map(slab), faces, areas, is_flipped: flip }
    }

    /// Whether normals point inward.
    pub fn is_flipped(&self) -> bool {
        self.is_flipped
    }

    pub(super) fn bounds(&self) -> Bounds {
        let [a, b, c] = self.axes.map(DVec3::abs);
        Bounds::of([self.center]).grown(a + b + c)
    }

    /// Where rays enter and leave each of the slabs. A ray within a plane gives no number or any: it touches the body at most.
    #[inline]
    fn crossings<T: Number>(&self, origin: Eight<T>, direction: Eight<T>) -> [[T; 2]; 3] {
        let splat = |v: DVec3| Eight(v.to_array().map(T::from));
        let origin = origin - splat(self.center);
        self.slabs.map(|slab| {
            let (normal, half) = (splat(slab.normal), T::from(slab.half));
            let (height, inverse) = (normal.dot(origin), T::from(1.0) / normal.dot(direction));
            let [lower, upper] = [(T::from(-slab.half) - height) * inverse, (half - height) * inverse];
            [lower.least(upper), lower.most(upper)]
        })
    }

    /// Where rays enter and leave the body, if they enter before they leave.
    #[inline]
    fn span<T: Number>([x, y, z]: [[T; 2]; 3]) -> [T; 2] {
        [x[0].most(y[0]).most(z[0]), x[1].least(y[1]).least(z[1])]
    }

    #[inline]
    fn crossings_of(&self, ray: &Ray64) -> [[f64; 2]; 3] {
        let [o, d] = [ray.origin, ray.direction].map(|v| Eight(v.to_array()));
        self.crossings(o, d)
    }

    pub(super) fn intersect(&self, ray: &Ray64) -> Option<ShapeHit> {
        let [enter, leave] = Self::span(self.crossings_of(ray));
        // The face in front, or from inside the one behind.
        let t = accept(enter, f32::INFINITY).map_or(leave, |_| enter);
        let t = if enter <= leave { accept(t, ray.t_max) } else { None };
        t.map(|t| ShapeHit { t, uv: [0.0; 2] })
    }

    // Of its own, so that the shapes that come with it stay short.
    #[inline(never)]
    pub(super) fn intersect_eight(&self, rays: &EightRays) -> EightHits {
        let [enter, leave] = Self::span(self.crossings(rays.origin, rays.direction));
        let through = enter.simd_le(leave).to_bitmask();
        let [enter, leave] = [enter, leave].map(eight::rounded);
        let t = enter.simd_gt(f32x8::ZERO).select(enter, leave);
        let before = (t.simd_gt(f32x8::ZERO) & t.simd_lt(rays.t_max)).to_bitmask();
        EightHits { lanes: through & before, t, uv: [f32x8::ZERO; 2] }
    }

    /// Texture coordinates run over [0, 1]² on each face.
    #[inline]
    pub(super) fn surface(&self, ray: &Ray64) -> SurfacePoint {
        let crossings = self.crossings_of(ray);
        let span = Self::span(crossings);
        let is_front = accept(span[0], f32::INFINITY).is_some();
        let end = usize::from(!is_front);
        let axis = (0..3).find(|&k| crossings[k][end] == span[end]).unwrap_or(0);
        let direction = ray.direction;
        // It enters by the lower plane, or leaves by the upper one, where it goes up.
        let goes_up = self.slabs[axis].normal.dot(direction) > 0.0;
        let face = &self.faces[ACROSS[axis][usize::from(goes_up != is_front)]];
        let place = face.place(ray.origin + direction * span[end]);
        face.surface_at(place, place.map(|x| round_f32(0.5 * (x + 1.0))))
    }

    /// The side of the face with the point's normal along which u grows.
    pub(super) fn tangent(&self, surface: &SurfacePoint) -> DVec3 {
        self.faces.iter().find(|face| face.normal == surface.ng).map_or(DVec3::ZERO, |face| face.a)
    }

    pub(super) fn area(&self) -> f64 {
        self.areas[5]
    }

    pub(super) fn sample_area(&self, [u, v]: [f32; 2]) -> SurfacePoint {
        let (chosen, along) = choose(&self.areas, u);
        let place = [along, f64::from(v)];
        self.faces[chosen as usize].surface_at(place.map(|x| 2.0 * x - 1.0), place.map(round_f32))
    }
}

/// Two triangles a face, each face with its own vertices, normal and texture square.
pub(super) fn triangles() -> MeshData {
    let mut mesh = MeshData::default();
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    for (face, [n, along_u, along_v]) in (0u32..).zip(FACES) {
        for uv in [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            let [su, sv] = uv.map(|c| 2.0 * c - 1.0);
            mesh.positions.push(std::array::from_fn(|i| n[i] + su * along_u[i] + sv * along_v[i]));
            normals.push(n);
            uvs.push(uv);
        }
        let first = 4 * face;
        // u × v points inward, so the corners go round the other way.
        mesh.triangles.push([first, first + 2, first + 1]);
        mesh.triangles.push([first, first + 3, first + 2]);
    }
    mesh.normals = Some(normals);
    mesh.uvs = Some(uvs);
    mesh
}
