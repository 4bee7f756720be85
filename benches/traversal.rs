//! Ray queries on a mesh of a million triangles, beside Embree's where that is installed.
//!
//! `cargo bench -p benches --bench traversal [-- ROUNDS]`: rates in million rays a second and ratios to Embree, medians
//! over rounds in which both take turns. Of one thread processor time counts, of two the clock. See README.md.
//! Camera rays are compared with Embree's packets of 16, too.

use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use benches::knot::{RaySet, accel, mesh, ray_sets};
use benches::{busy, median};
use rayon::prelude::*;
use renderer::accel::Accel;
use renderer::ray::Ray;
use renderer::shapes::MeshData;

/// Rays in one query.
const BATCH: usize = 4096;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let once = arguments.iter().any(|argument| argument == "--test");
    let rounds = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(if once { 1 } else { 7 });
    let mesh = Arc::new(mesh(1e6));
    let start = Instant::now();
    let accel = accel(&mesh);
    println!("{} triangles, {:.3} s to load and build", mesh.triangles.len(), start.elapsed().as_secs_f64());
    let sets = ray_sets(&accel, 1024);
    let mut embree = Embree::start(&mesh, &sets);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.unwrap_or_else(|error| panic!("{threads} threads: {error}"));
        println!("\n{threads} threads");
        println!("{:24} {:>9} {:>9} {:>9} {:>7}", "rays", "Mray/s", "Embree's", "default", "ratio");
        for (index, set) in sets.iter().enumerate() {
            let queries = match set.name {
                "coherent" => &["closest", "closest16", "occluded"][..],
                "shadow" => &["occluded"],
                _ => &["closest", "occluded"],
            };
            for query in queries {
                compare(&pool, &accel, &mut embree, &Case { set, index, query, threads, rounds });
            }
        }
    }
}

/// One line of the table.
struct Case<'a> {
    set: &'a RaySet,
    index: usize,
    /// What Embree is asked.
    query: &'static str,
    threads: usize,
    rounds: usize,
}

fn compare(pool: &rayon::ThreadPool, accel: &Accel, embree: &mut Option<Embree>, case: &Case) {
    let rate = |seconds: f64| case.set.rays.len() as f64 * 1e-6 / seconds;
    let (query, occlusion) = (case.query, case.query == "occluded");
    let (mut ours, mut theirs, mut default) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..case.rounds {
        let ([wall, processor], hits) = pool.install(|| time(accel, &case.set.rays, occlusion));
        let seconds = if case.threads == 1 && processor.is_finite() { processor } else { wall };
        ours.push(rate(seconds));
        if let Some(embree) = embree {
            let (seconds, found) = embree.ask(query, case);
            theirs.push(rate(seconds));
            default.push(rate(embree.ask(&format!("{query}-fast"), case).0));
            if hits != found {
                println!("  {hits} of our rays hit and {found} of Embree's");
            }
        }
    }
    let ratio = median(ours.iter().zip(&theirs).map(|(a, b)| a / b).collect());
    let name = format!("{} {query}", case.set.name);
    println!("{name:24} {:9.2} {:9.2} {:9.2} {ratio:7.3}", median(ours), median(theirs), median(default));
}

/// Seconds of the clock and of this thread's processor time, and hits, of one pass over the rays.
fn time(accel: &Accel, rays: &[Ray], occlusion: bool) -> ([f64; 2], usize) {
    let (start, before) = (Instant::now(), busy());
    // As Embree's: each thread takes the next batch, so that neighbours are in the cache that threads share.
    let hits = rays.chunks(BATCH).par_bridge().map(|batch| {
        if occlusion {
            let mut blocked = Vec::new();
            accel.occluded(batch, &mut blocked);
            blocked.iter().filter(|b| **b).count()
        } else {
            let mut hits = Vec::new();
            accel.closest(batch, &mut hits);
            hits.iter().flatten().count()
        }
    });
    let hits = hits.sum();
    ([start.elapsed().as_secs_f64(), busy() - before], hits)
}

/// The program that asks Embree.
struct Embree {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Embree {
    /// Compiles and starts it; `None`, with a message, where that isn't possible.
    fn start(mesh: &MeshData, sets: &[RaySet]) -> Option<Self> {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
        let (program, data) = (folder.join("embree"), folder.join("embree.bin"));
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("embree/embree.cpp");
        let mut compile = Command::new("g++");
        compile.args(["-O3", "-march=native", "-std=c++17", "-pthread"]).arg(&source).arg("-o").arg(&program);
        let compiled = compile.arg("-lembree3").stderr(Stdio::null()).status();
        if !compiled.is_ok_and(|status| status.success()) {
            println!(
                "no comparison with Embree: {} needs g++ and Embree 3 (libembree-dev)",
                source.display()
            );
            return None;
        }
        write_input(&data, mesh, sets).unwrap_or_else(|error| panic!("{}: {error}", data.display()));
        let child = Command::new(&program).arg(&data).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = child.unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        let input = child.stdin.take().expect("it is piped");
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        let mut embree = Self { child, input, output };
        for name in ["robust", "default"] {
            println!("Embree builds its {name} scene in {} s", embree.line());
        }
        Some(embree)
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap_or_else(|error| panic!("Embree's answer: {error}"));
        line.trim().into()
    }

    /// Seconds and hits of a query.
    fn ask(&mut self, query: &str, case: &Case) -> (f64, usize) {
        writeln!(self.input, "{query} {} {}", case.index, case.threads)
            .unwrap_or_else(|error| panic!("asking Embree: {error}"));
        let line = self.line();
        let answer = line.split_once(' ').and_then(|(s, n)| Some((s.parse().ok()?, n.parse().ok()?)));
        answer.unwrap_or_else(|| panic!("Embree's answer {line:?}"))
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // It ends by itself at the end of its input; an error here means that it has ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Writes what embree.cpp reads: counted lists of positions, triangles and sets of rays, all in native byte order.
fn write_input(path: &Path, mesh: &MeshData, sets: &[RaySet]) -> std::io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    let count = |file: &mut BufWriter<_>, n: usize| file.write_all(&(n as u64).to_ne_bytes());
    count(&mut file, mesh.positions.len())?;
    for coordinate in mesh.positions.iter().flatten() {
        file.write_all(&coordinate.to_ne_bytes())?;
    }
    count(&mut file, mesh.triangles.len())?;
    for index in mesh.triangles.iter().flatten() {
        file.write_all(&index.to_ne_bytes())?;
    }
    count(&mut file, sets.len())?;
    for set in sets {
        count(&mut file, set.rays.len())?;
        for ray in &set.rays {
            let [o, d] = [ray.origin, ray.direction];
            for number in [o.x, o.y, o.z, ray.t_max, d.x, d.y, d.z, ray.time] {
                file.write_all(&number.to_ne_bytes())?;
            }
        }
    }
    file.flush()
}
