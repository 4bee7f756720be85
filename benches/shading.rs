//! Processor time of a sample on five scenes, and what a second thread gains, beside what it gains for a loop of arithmetic in the same
//! rounds: 2 on two cores that nothing else uses.
//!
//! `cargo bench -p benches --bench shading [-- SCENE ROUNDS]`: medians over rounds, 128 × 128 pixels of 64 samples. The
//! mesh is written to `target/tmp/mesh.ply`. See README.md.

use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use benches::knot::mesh;
use benches::{median, rendered};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use renderer::io::read_scene;
use renderer::scene::Scene;
use renderer::shapes::MeshData;

const SCENES: [&str; 5] = ["direct", "cornell", "dof", "glass", "mesh"];

/// Pixels each way, and samples a pixel.
const SIDE: u32 = 128;
const SAMPLES: u32 = 64;

/// Steps of arithmetic in each of 256 parts, half a second of one thread's together.
const STEPS: u64 = 1_000_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let once = arguments.iter().any(|argument| argument == "--test");
    let rounds = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(if once { 1 } else { 5 });
    let side = if once { 16 } else { SIDE };
    let chosen = |name: &&str| arguments.iter().any(|argument| argument == name);
    let all = !SCENES.iter().any(&chosen);
    println!(
        "{:8} {:>12} {:>12} {:>10} {:>11}",
        "scene", "ns a sample", "ns, wall", "2 threads", "arithmetic"
    );
    for name in SCENES.into_iter().filter(|name| all || chosen(name)) {
        measure(name, side, rounds, if once { 1 } else { STEPS });
    }
}

/// Prints a scene's line.
fn measure(name: &str, side: u32, rounds: usize, steps: u64) {
    let scene = scene(name, side);
    let pools = [1, 2].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap_or_else(|error| panic!("{threads} threads: {error}"))
    });
    let samples = f64::from(side) * f64::from(side) * f64::from(SAMPLES);
    let (mut processor, mut one, mut gain, mut possible) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for _ in 0..rounds {
        let [first, second] = pools.each_ref().map(|pool| rendered(pool, &scene, SAMPLES));
        processor.push(first[1] * 1e9 / samples);
        one.push(first[0] * 1e9 / samples);
        gain.push(first[0] / second[0]);
        let [first, second] = pools.each_ref().map(|pool| arithmetic(pool, steps));
        possible.push(first / second);
    }
    let [processor, one, gain, possible] = [processor, one, gain, possible].map(median);
    println!("{name:8} {processor:12.1} {one:12.1} {gain:10.2} {possible:11.2}");
}

/// Seconds of the clock for a fixed amount of arithmetic, in parts that threads share.
fn arithmetic(pool: &ThreadPool, steps: u64) -> f64 {
    let step = |x: u64, i: u64| (x ^ i).wrapping_mul(0x5851_f42d_4c95_7f2d).rotate_left(17);
    pool.install(|| {
        let start = Instant::now();
        let parts = (0..256u64).into_par_iter().map(|part| (0..steps).fold(part, step));
        black_box(parts.reduce(|| 0, |a, b| a ^ b));
        start.elapsed().as_secs_f64()
    })
}

fn scene(name: &str, side: u32) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("xml");
    let mut parameters = vec![("res".to_string(), side.to_string())];
    if name == "mesh" {
        let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("mesh.ply");
        write_ply(&file, &mesh(1e6)).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        parameters.push(("ply".into(), file.display().to_string()));
    }
    let read = read_scene(&path, &parameters);
    let (description, _) = read.unwrap_or_else(|error| panic!("the scenes are valid: {error}"));
    Scene::new(&description).unwrap_or_else(|error| panic!("the scenes are valid: {error}"))
}

fn write_ply(path: &Path, mesh: &MeshData) -> std::io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    for coordinate in mesh.positions.iter().flatten() {
        file.write_all(&coordinate.to_le_bytes())?;
    }
    for triangle in &mesh.triangles {
        file.write_all(&[3])?;
        for index in triangle {
            file.write_all(&index.to_le_bytes())?;
        }
    }
    file.flush()
}
