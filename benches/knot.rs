//! A mesh of a million triangles, a knotted tube over rough ground, and rays of each kind that a renderer traces on it.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use renderer::accel::{Accel, Object};
use renderer::math::Frame;
use renderer::ray::Ray;
use renderer::sampling::warp;
use renderer::shapes::{MeshData, Shape, ShapeSettings};

/// A rectangular grid of vertices, each axis open or closed to a ring.
struct Grid {
    counts: [u32; 2],
    closed: [bool; 2],
}

impl Grid {
    /// Appends the grid of points `at(i, j)` to a mesh.
    fn append(&self, mesh: &mut MeshData, at: impl Fn(u32, u32) -> DVec3) {
        let base = u32::try_from(mesh.positions.len()).expect("meshes here are small");
        let [nu, nv] = self.counts;
        let cells = |axis: usize| self.counts[axis] - u32::from(!self.closed[axis]);
        for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
            mesh.positions.push(at(i, j).as_vec3().to_array());
        }
        for (i, j) in (0..cells(0)).flat_map(|i| (0..cells(1)).map(move |j| (i, j))) {
            let index = |i: u32, j: u32| base + i % nu * nv + j % nv;
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// The mesh of about `count` triangles; 1,014,800 for a million.
pub fn mesh(count: f64) -> MeshData {
    let scale = (count / 1e6).sqrt();
    #[expect(clippy::cast_possible_truncation, reason = "small positive counts")]
    let scaled = |n: f64| ((n * scale).round() as u32).max(4);
    let mut mesh = MeshData { face_normals: true, ..MeshData::default() };
    let tube = Grid { counts: [scaled(1350.0), scaled(300.0)], closed: [true, true] };
    let [nu, nv] = tube.counts.map(f64::from);
    tube.append(&mut mesh, |i, j| tube_point(TAU * f64::from(i) / nu, TAU * f64::from(j) / nv));
    let side = scaled(320.0) + 1;
    let ground = Grid { counts: [side, side], closed: [false, false] };
    let place = |i: u32| 8.0 * f64::from(i) / f64::from(side - 1) - 4.0;
    ground.append(&mut mesh, |i, j| ground_point(place(j), place(i)));
    mesh
}

fn tube_point(u: f64, v: f64) -> DVec3 {
    let knot = |t: f64| {
        let ring = 1.0 + 0.4 * (3.0 * t).cos();
        DVec3::new((2.0 * t).cos() * ring, 0.45 * (3.0 * t).sin() + 0.1, (2.0 * t).sin() * ring)
    };
    let along = (knot(u + 1e-4) - knot(u - 1e-4)).normalize();
    let side = along.cross(DVec3::Y).normalize();
    let bumps = 0.10 * (24.0 * u + 3.0 * v).sin()
        + 0.06 * (60.0 * u).sin() * (14.0 * v).cos()
        + 0.03 * (150.0 * u + 40.0 * v).sin();
    knot(u) + (side * v.cos() + along.cross(side) * v.sin()) * (0.2 * (1.0 + bumps))
}

fn ground_point(x: f64, z: f64) -> DVec3 {
    let bumps = 0.08 * (3.0 * x).sin() * (2.3 * z).cos()
        + 0.03 * (17.0 * x + 5.0 * z).sin()
        + 0.015 * (41.0 * x - 29.0 * z).cos();
    DVec3::new(x, bumps - 0.75, z)
}

/// The tree over a mesh.
///
/// # Panics
/// If the mesh isn't valid.
pub fn accel(mesh: &Arc<MeshData>) -> Accel {
    let shape = Shape::new(&ShapeSettings::Mesh(mesh.clone()), &DAffine3::IDENTITY, false);
    Accel::new(vec![Object::still(shape.expect("the mesh is valid"))], [0.0, 0.0])
}

/// Rays of one kind.
pub struct RaySet {
    /// What they are.
    pub name: &'static str,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// The camera's rays, `side` pixels each way; cosine-distributed rays from what they meet, in order and shuffled; and segments to a light
/// above.
pub fn ray_sets(accel: &Accel, side: u32) -> Vec<RaySet> {
    let rng = &mut Pcg64::seed_from_u64(0);
    let camera = camera_rays(side);
    let mut hits = Vec::new();
    accel.closest(&camera, &mut hits);
    let found = camera.iter().zip(&hits).filter_map(|(ray, hit)| Some((ray, hit.as_ref()?)));
    let (mut secondary, mut shadow) = (Vec::new(), Vec::new());
    for (ray, hit) in found {
        let at = accel.interaction(ray, hit);
        let side = if at.surface.n.dot(at.wo) < 0.0 { -1.0 } else { 1.0 };
        let frame = Frame::from_z(at.surface.n * side);
        let local = warp::square_to_cosine_hemisphere([rng.random(), rng.random()]);
        secondary.push(at.spawn(frame.to_world(local)));
        let mut coordinate = || 2.0 * rng.random::<f32>();
        shadow.push(at.spawn_to_point(Vec3::new(coordinate(), 4.0, coordinate())));
    }
    let mut shuffled = secondary.clone();
    shuffled.shuffle(rng);
    let set = |name, rays| RaySet { name, rays };
    vec![
        set("coherent", camera),
        set("secondary", secondary),
        set("shuffled", shuffled),
        set("shadow", shadow),
    ]
}

/// Rays from a camera in squares of 8 × 8 pixels, `side` pixels each way.
pub fn camera_rays(side: u32) -> Vec<Ray> {
    let eye = DVec3::new(0.0, 2.2, 4.6);
    let forward = (-eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let half = 20f64.to_radians().tan();
    let ray = |i: u32, j: u32| {
        let place = |k: u32| half * (2.0 * (f64::from(k) + 0.5) / f64::from(side) - 1.0);
        Ray::new(eye.as_vec3(), (forward + right * place(i) - up * place(j)).normalize().as_vec3(), 0.0)
    };
    let tiles = (0..side / 8).flat_map(|y| (0..side / 8).map(move |x| (8 * x, 8 * y)));
    tiles.flat_map(|(x, y)| (0..64).map(move |k| ray(x + k % 8, y + k / 8))).collect()
}
