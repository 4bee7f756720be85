//! Scenes and inputs that the benchmarks share.

pub mod embree;
pub mod knot;

use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use glam::{DAffine3, Vec3};
use rayon::ThreadPool;
use renderer::accel::{Accel, Object};
use renderer::integrator::PathTracer;
use renderer::ray::Ray;
use renderer::render::{RenderSettings, render};
use renderer::sampling::{Decision, Independent, SampleId, Sampler, SamplerKind, Vertex, warp};
use renderer::scene::Scene;
use renderer::shapes::{MeshData, Shape, ShapeSettings};

/// Rings and segments of the mesh: 2 · 224 · 224 − 2 · 224, about 100,000 triangles.
const DIVISIONS: u32 = 224;

/// Processor time of this thread in seconds; NaN where the system doesn't tell.
pub fn busy() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).map_or(f64::NAN, |ns| ns * 1e-9)
}

/// The middle of a list; NaN of none.
pub fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    list.get(list.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Seconds of the clock and of one thread's processor time that a render by `samples` Sobol points a pixel takes.
///
/// # Panics
/// For a number of samples that isn't accepted.
pub fn rendered(pool: &ThreadPool, scene: &Scene, samples: u32) -> [f64; 2] {
    let integrator = PathTracer { settings: scene.integrator };
    let settings =
        RenderSettings { sampler: SamplerKind::Sobol, samples, replicates: 1, seed: 0, threads: 0 };
    pool.install(|| {
        let (start, busy) = (Instant::now(), busy());
        render(scene, &integrator, &settings, &|_| ())
            .unwrap_or_else(|error| panic!("the settings are valid: {error}"));
        let seconds = start.elapsed().as_secs_f64();
        [seconds, self::busy() - busy]
    })
}

/// The reference scene of that name.
pub fn reference(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/scenes").join(name).with_extension("xml")
}

/// A bumpy ball of radius about 1 around the origin, of about 100,000 triangles.
///
/// # Panics
/// Never: the mesh is valid.
pub fn bumpy_ball() -> Accel {
    let vertex = |i: u32, j: u32| {
        let theta = PI * f64::from(i) / f64::from(DIVISIONS);
        let phi = TAU * f64::from(j % DIVISIONS) / f64::from(DIVISIONS);
        let radius = 1.0 + 0.05 * (9.0 * theta).sin() * (11.0 * phi).cos();
        let direction = glam::DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        (radius * direction).as_vec3().to_array()
    };
    let index = |i: u32, j: u32| i * (DIVISIONS + 1) + j;
    let quads = (0..DIVISIONS).flat_map(|i| (0..DIVISIONS).map(move |j| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        // at the poles one of the two has no area
        [(i + 1 < DIVISIONS).then_some([a, b, c]), (i > 0).then_some([a, c, d])].into_iter().flatten()
    });
    let data = MeshData {
        positions: (0..=DIVISIONS).flat_map(|i| (0..=DIVISIONS).map(move |j| vertex(i, j))).collect(),
        normals: None,
        uvs: None,
        triangles: triangles.collect(),
        face_normals: true,
    };
    let shape = Shape::new(&ShapeSettings::Mesh(Arc::new(data)), &DAffine3::IDENTITY, false)
        .expect("every triangle has an area and valid indices");
    Accel::new(vec![Object { shape, motion: None }], [0.0, 0.0])
}

/// `count` rays of a camera at distance 3, in rows.
pub fn coherent(count: u32) -> Vec<Ray> {
    let side = count.isqrt();
    let ray = |i: u32| {
        let p = |k: u32| 1.2 * (2.0 * (k as f32 + 0.5) / side as f32 - 1.0);
        let target = Vec3::new(p(i % side), p(i / side), 0.0);
        let eye = Vec3::new(0.0, 0.0, 3.0);
        Ray::new(eye, (target - eye).normalize(), 0.0)
    };
    (0..side * side).map(ray).collect()
}

/// `count` rays between random points of a sphere of radius 3 around the ball.
pub fn incoherent(count: u32) -> Vec<Ray> {
    let sampler = Independent::new(0);
    let point = |index: u32, decision: Decision| {
        let id = SampleId { pixel: [0, 0], replicate: 0, index };
        3.0 * warp::square_to_sphere(sampler.draw_2d(id, Vertex::default(), decision))
    };
    let ray = |index: u32| {
        let (from, to) = (point(index, Decision::Lens), point(index, Decision::LightPoint));
        Ray::new(from, (to - from).normalize(), 0.0)
    };
    (0..count).map(ray).collect()
}
