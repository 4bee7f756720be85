//! Triangle meshes.

use glam::{DAffine3, DVec3, Vec3};

use super::triangle::ShearedRay;
use super::{SMALLEST_SOLID_ANGLE, ShapeHit, rounded};
use crate::ParamError;
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::ray::Ray64;
use crate::sampling::warp::SphericalTriangle;

/// A mesh as files hold it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals of any length, one a position.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Texture coordinates, one a position.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Each triangle's three vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Whether vertex normals are left aside, so that the mesh looks faceted.
    pub face_normals: bool,
}

/// A mesh in its frame.
#[derive(Debug, Clone)]
pub struct Mesh {
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
    uvs: Option<Vec<[f32; 2]>>,
    triangles: Vec<[u32; 3]>,
    /// −1 if the normals are turned over.
    sign: f64,
    /// Area of all triangles up to and with each.
    areas: Vec<f64>,
}

impl Mesh {
    pub(super) fn new(data: &MeshData, to_frame: &DAffine3, flip: bool) -> Result<Self, ParamError> {
        check(data)?;
        let positions: Vec<Vec3> = data
            .positions
            .iter()
            .map(|&p| to_frame.transform_point3(DVec3::from(p.map(f64::from))).as_vec3())
            .collect();
        let sign = if flip { -1.0 } else { 1.0 };
        let to_normal = to_frame.matrix3.inverse().transpose() * sign;
        let turn = |n: &[f32; 3]| {
            (to_normal * DVec3::from(n.map(f64::from)).normalize_or_zero()).normalize_or_zero()
        };
        let normals = data.normals.as_ref().filter(|_| !data.face_normals);
        let mut mesh = Self {
            positions,
            normals: normals.map(|all| all.iter().map(|n| turn(n).as_vec3()).collect()),
            uvs: data.uvs.clone(),
            triangles: data.triangles.clone(),
            sign,
            areas: Vec::new(),
        };
        let mut total = 0.0;
        let sum = |i| {
            total += 0.5 * mesh.cross(i).length();
            total
        };
        mesh.areas = (0..mesh.triangle_count()).map(sum).collect();
        Ok(mesh)
    }

    pub(super) fn triangle_count(&self) -> u32 {
        u32::try_from(self.triangles.len()).expect("`check` bounds the number of triangles")
    }

    /// The vertices of a triangle.
    pub fn vertices(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// The cross product of two edges.
    fn cross(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.vertices(triangle).map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    }

    pub(super) fn triangle_bounds(&self, triangle: u32) -> Bounds {
        Bounds::of(self.vertices(triangle).map(|p| p.as_dvec3()))
    }

    pub(super) fn intersect(&self, triangle: u32, ray: &Ray64) -> Option<ShapeHit> {
        ShearedRay::new(&ray.rounded(0.0)).hit(&self.vertices(triangle), ray.t_max)
    }

    /// The point of a triangle with weights `v` and `w` of its second and third vertex.
    ///
    /// The geometric normal is on the side of the interpolated one, whichever way round the corners go; without vertex
    /// normals they go counter-clockwise around it. Texture coordinates are the weights where the mesh has none.
    #[inline]
    pub(super) fn surface(&self, triangle: u32, weights: [f32; 2]) -> SurfacePoint {
        self.surface_at(triangle, weights.map(f64::from))
    }

    /// The same for weights that need more digits: a millimetre's part of a triangle a thousand kilometres wide.
    #[expect(clippy::cast_possible_truncation, reason = "only the place on the triangle needs the digits")]
    fn surface_at(&self, triangle: u32, place: [f64; 2]) -> SurfacePoint {
        let corners = self.triangles[triangle as usize].map(|i| i as usize);
        let [a, b, c] = corners.map(|i| self.positions[i].as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let cross = e1.cross(e2);
        let (size1, size2) = (e1.length(), e2.length());
        // Heights over the plane are evaluated to within 2⁻⁴⁶ of this size. In a needle e1 × e2 loses digits: edges and
        // products have 4 roundings of 2⁻⁵³ a component, 7 in length, relative to |e1||e2|, and tilt the plane by as much.
        let extent = size1 + size2 + a.abs().max_element();
        let tilt = 2f64.powi(-50) * (size1 + size2) * (size1 * size2 / cross.length());
        let (point, error) = rounded(a + e1 * place[0] + e2 * place[1], extent);
        let error = error + crate::math::float::round_f32(tilt);
        let face = (cross.normalize() * self.sign).as_vec3();
        let [v, w] = place.map(|weight| weight as f32);
        let u = 1.0 - v - w;
        let n = match &self.normals {
            Some(all) => {
                let [na, nb, nc] = corners.map(|i| all[i]);
                (na * u + nb * v + nc * w).try_normalize().unwrap_or(face)
            }
            None => face,
        };
        let ng = if n.dot(face) < 0.0 { -face } else { face };
        let uv = match &self.uvs {
            Some(all) => {
                let [ta, tb, tc] = corners.map(|i| all[i]);
                [0, 1].map(|i| ta[i] * u + tb[i] * v + tc[i] * w)
            }
            None => [v, w],
        };
        SurfacePoint { point, error, ng, n, uv }
    }

    /// Where the first texture coordinate grows and the second does not, up to a factor; the first edge where the mesh has none, whose
    /// texture coordinates are the weights then, and where they don't change over the triangle as two should.
    pub(super) fn tangent(&self, triangle: u32) -> DVec3 {
        let corners = self.triangles[triangle as usize].map(|i| i as usize);
        let [a, b, c] = corners.map(|i| self.positions[i].as_dvec3());
        let Some(uvs) = &self.uvs else { return b - a };
        let [ta, tb, tc] = corners.map(|i| uvs[i].map(f64::from));
        let (v1, v2) = (tb[1] - ta[1], tc[1] - ta[1]);
        let determinant = (tb[0] - ta[0]) * v2 - (tc[0] - ta[0]) * v1;
        if determinant == 0.0 { b - a } else { ((b - a) * v2 - (c - a) * v1) * determinant.signum() }
    }

    pub(super) fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    pub(super) fn sample_area(&self, [u0, u1]: [f32; 2]) -> SurfacePoint {
        let (chosen, place) = choose(&self.areas, u0);
        // An area-preserving map: density 1/2 of the parallelogram's.
        let root = place.sqrt();
        self.surface_at(chosen, [root * (1.0 - f64::from(u1)), root * f64::from(u1)])
    }

    /// How a triangle looks from `from`; `None` where points by area serve better.
    fn seen_from(&self, triangle: u32, from: DVec3) -> Option<SphericalTriangle> {
        let seen = SphericalTriangle::new(self.vertices(triangle).map(|p| p.as_dvec3() - from))?;
        (seen.solid_angle() > SMALLEST_SOLID_ANGLE).then_some(seen)
    }

    /// A triangle's share of the area.
    fn share(&self, triangle: u32) -> f64 {
        let index = triangle as usize;
        let before = if index == 0 { 0.0 } else { self.areas[index - 1] };
        (self.areas[index] - before) / self.area()
    }

    /// The solid angles of all triangles up to and with each; `None` where there are many, or one is not seen.
    fn angles_from(&self, from: DVec3) -> Option<[f64; FEW]> {
        if !(2..=FEW).contains(&self.triangles.len()) {
            return None;
        }
        let (mut sums, mut total) = ([f64::INFINITY; FEW], 0.0);
        for (sum, triangle) in sums.iter_mut().zip(0..self.triangle_count()) {
            total += self.seen_from(triangle, from)?.solid_angle();
            *sum = total;
        }
        Some(sums)
    }

    /// The density of [`Self::sample_solid_angle`] on a triangle.
    pub(super) fn pdf_solid_angle(&self, triangle: u32, from: DVec3) -> Option<f64> {
        match self.angles_from(from) {
            Some(angles) => Some(1.0 / angles[self.triangles.len() - 1]),
            None => self.seen_from(triangle, from).map(|seen| self.share(triangle) / seen.solid_angle()),
        }
    }

    /// A triangle by its share of the solid angle where there are few, and by that of the area where there are many; then a
    /// point of it by the solid angle.
    pub(super) fn sample_solid_angle(&self, from: DVec3, u: [f32; 2]) -> Option<(SurfacePoint, f64)> {
        let angles = self.angles_from(from);
        let (chosen, place) = match &angles {
            Some(angles) => choose(&angles[..self.triangles.len()], u[0]),
            None => choose(&self.areas, u[0]),
        };
        let seen = self.seen_from(chosen, from)?;
        let pdf = match angles {
            Some(angles) => 1.0 / angles[self.triangles.len() - 1],
            None => self.share(chosen) / seen.solid_angle(),
        };
        Some((self.surface_at(chosen, seen.sample([place, f64::from(u[1])])), pdf))
    }
}

/// Up to so many triangles are chosen by the solid angle, which all of them are then looked at for.
const FEW: usize = 8;

/// Chooses one of several parts from `u`, whose place within the part serves again.
///
/// * `sums`: the sizes of all parts up to and with each; the last is above 0.
///
/// # Precision, limits
/// The number has 24 bits, so with T equal parts the place within one has 24 − log₂ T.
pub(super) fn choose(sums: &[f64], u: f32) -> (u32, f64) {
    let target = f64::from(u) * sums[sums.len() - 1];
    let chosen = sums.partition_point(|&sum| sum <= target).min(sums.len() - 1);
    let before = if chosen == 0 { 0.0 } else { sums[chosen - 1] };
    let place = ((target - before) / (sums[chosen] - before)).clamp(0.0, 1.0);
    (u32::try_from(chosen).expect("`check` bounds the number of triangles"), place)
}

/// Refuses numbers that aren't finite, lists of unequal length and indices that point at nothing.
fn check(data: &MeshData) -> Result<(), ParamError> {
    if data.triangles.is_empty() {
        return Err(ParamError::Empty { name: "mesh", accepted: "at least one triangle" });
    }
    check_finite("vertex position", data.positions.iter().flatten().copied())?;
    check_finite("vertex normal", data.normals.iter().flatten().flatten().copied())?;
    check_finite("texture coordinate", data.uvs.iter().flatten().flatten().copied())?;
    let count = data.positions.len() as u64;
    let same = |name, length: Option<usize>| match length {
        Some(n) if n as u64 != count => Err(ParamError::Index { name, index: n as u64, last: count }),
        _ => Ok(()),
    };
    same("number of vertex normals", data.normals.as_ref().map(Vec::len))?;
    same("number of texture coordinates", data.uvs.as_ref().map(Vec::len))?;
    if u32::try_from(data.triangles.len()).is_err() {
        return Err(ParamError::Index {
            name: "number of triangles",
            index: data.triangles.len() as u64,
            last: u64::from(u32::MAX),
        });
    }
    match data.triangles.iter().flatten().find(|&&i| u64::from(i) >= count) {
        Some(&i) => Err(ParamError::Index {
            name: "vertex index",
            index: u64::from(i),
            last: count.saturating_sub(1),
        }),
        None => Ok(()),
    }
}

fn check_finite(name: &'static str, mut list: impl Iterator<Item = f32>) -> Result<(), ParamError> {
    match list.find(|c| !c.is_finite()) {
        Some(value) => Err(ParamError::NotFinite { name, value: f64::from(value) }),
        None => Ok(()),
    }
}
