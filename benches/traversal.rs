//! Ray queries on a mesh of a million triangles, beside Embree's where that is installed.
//!
//! `cargo bench -p benches --bench traversal [-- ROUNDS]`: rates in million rays a second and ratios to Embree, medians
//! over rounds in which both take turns. Of one thread processor time counts, of two the clock. See README.md.
//! Camera rays are compared with Embree's packets of 16, too.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use benches::embree::Embree;
use benches::knot::{RaySet, accel, mesh, ray_sets};
use benches::{busy, median};
use rayon::prelude::*;
use renderer::accel::Accel;
use renderer::ray::Ray;

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
    let rays: Vec<&[Ray]> = sets.iter().map(|set| &set.rays[..]).collect();
    let program = Embree::compile(Path::new(env!("CARGO_TARGET_TMPDIR")));
    let mut embree = program.map(|program| Embree::start(&program, &mesh, &rays));
    for (name, seconds) in embree.iter().flat_map(|embree| &embree.builds) {
        println!("Embree builds its {name} scene in {seconds} s");
    }
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
            let (seconds, found) = embree.ask(query, case.index, case.threads);
            theirs.push(rate(seconds));
            default.push(rate(embree.ask(&format!("{query}-fast"), case.index, case.threads).0));
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
