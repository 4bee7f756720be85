//! Time a ray and memory a triangle against the number of triangles, from a thousand to ten million.
//!
//! `cargo bench -p benches --bench scaling [-- LARGEST]`: a table, and the picture `target/tmp/scaling.svg` beside the
//! logarithm. The growth of Embree's time is told, too, where that is installed. See README.md.

use std::path::Path;
use std::sync::Arc;

use benches::embree::Embree;
use benches::knot::{accel, camera_rays, mesh, ray_sets};
use benches::{busy, median};
use plotters::prelude::*;
use renderer::accel::Accel;
use renderer::ray::Ray;

const COUNTS: [f64; 9] = [1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1e7];

/// Camera rays of one sample a pixel and of 64, as renders trace them, on 512 × 512 pixels; and rays from where the former meet the mesh.
const SETS: [&str; 4] = ["coherent", "64 a pixel", "secondary", "shuffled"];

/// Rays in one query, and measurements whose median counts.
const BATCH: usize = 4096;
const ROUNDS: usize = 5;

/// Seconds that a measurement takes at least: the clock of processor time has steps of 4 ms.
const LEAST: f64 = 0.2;

/// Number of triangles and nanoseconds a ray, for each kind of rays.
type Curves = [Vec<(f64, f64)>; SETS.len()];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let once = arguments.iter().any(|argument| argument == "--test");
    let largest = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(if once { 1e4 } else { 1e7 });
    let least = if once { 0.0 } else { LEAST };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (mut curves, mut embrees) = (Curves::default(), Curves::default());
    let program = Embree::compile(folder);
    println!("ns a ray, and growth over the logarithm's: {}", SETS.join(", "));
    let [ns, growth] = ["ns a ray", "growth"];
    println!("{:>10} {:>10}   {ns:24} {growth:28} {:24} {growth}", "triangles", "bytes each", "Embree's");
    for wanted in COUNTS.into_iter().filter(|count| *count <= largest) {
        let before = resident();
        let data = Arc::new(mesh(wanted));
        let count = data.triangles.len() as f64;
        let accel = accel(&data);
        drop(data);
        let bytes = (resident() - before) / count;
        let side = if once { 32 } else { 512 };
        // Squares of 8 × 8 rays are a pixel each.
        let (sets, many) = (ray_sets(&accel, side), camera_rays(8 * side));
        let sets = [&sets[0].rays, &many, &sets[1].rays, &sets[2].rays].map(Vec::as_slice);
        for (curve, rays) in curves.iter_mut().zip(sets) {
            curve.push((count, median((0..ROUNDS).map(|_| time(&accel, rays, least)).collect())));
        }
        print!("{count:10} {bytes:10.0}   {}", last(&curves));
        drop(accel);
        if let Some(program) = &program {
            let mut embree = Embree::start(program, &mesh(wanted), &sets);
            for (set, (curve, rays)) in embrees.iter_mut().zip(sets).enumerate() {
                curve.push((count, embrees_time(&mut embree, set, rays.len())));
            }
            print!(" {}", last(&embrees));
        }
        println!();
    }
    let path = folder.join("scaling.svg");
    match draw(&path, &curves, &embrees) {
        Ok(()) => println!("drawn in {}", path.display()),
        Err(error) => println!("{}: {error}", path.display()),
    }
}

/// The last points of the curves, and how much faster than the logarithm they have grown since the first.
fn last(curves: &Curves) -> String {
    let ns = curves.each_ref().map(|curve| format!("{:.0}", curve[curve.len() - 1].1)).join(" / ");
    let growth = curves.each_ref().map(|curve| {
        let ((n0, t0), (n, t)) = (curve[0], curve[curve.len() - 1]);
        format!("{:.2}", t / t0 / (n.ln() / n0.ln()))
    });
    format!("{ns:24} {:28}", growth.join(" / "))
}

/// Nanoseconds of processor time that Embree's robust scene takes for a ray of a set, one by one or in packets of 16, whichever are faster.
fn embrees_time(embree: &mut Embree, set: usize, rays: usize) -> f64 {
    let mut ns =
        |query| median((0..ROUNDS).map(|_| embree.ask(query, set, 1).0 * 1e9 / rays as f64).collect());
    f64::min(ns("closest"), ns("closest16"))
}

/// Nanoseconds of processor time a ray, of as many passes as take `least` seconds.
fn time(accel: &Accel, rays: &[Ray], least: f64) -> f64 {
    let mut hits = Vec::new();
    let start = busy();
    let mut passes = 0;
    loop {
        rays.chunks(BATCH).for_each(|batch| accel.closest(batch, &mut hits));
        passes += 1;
        let seconds = busy() - start;
        if seconds.is_nan() || seconds >= least {
            return seconds * 1e9 / (passes * rays.len()) as f64;
        }
    }
}

/// Bytes of memory that the process holds, where the system tells.
fn resident() -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kib = line.and_then(|rest| rest.trim().split(' ').next()?.parse::<f64>().ok());
    kib.map_or(f64::NAN, |kib| kib * 1024.0)
}

fn draw(path: &Path, curves: &Curves, embrees: &Curves) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::new(path, (640, 420)).into_drawing_area();
    area.fill(&WHITE)?;
    let highest = curves.iter().chain(embrees).flatten().map(|point| point.1).fold(0.0, f64::max);
    let mut chart = ChartBuilder::on(&area)
        .caption(
            "Time to the nearest hit, beside the logarithm (dots) and Embree's (pale)",
            ("sans-serif", 16),
        )
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d((1e3..1e7).log_scale(), 0.0..1.1 * highest)?;
    let mut axes = chart.configure_mesh();
    axes.x_desc("triangles").x_label_formatter(&|count| format!("{count:e}")).y_desc("ns a ray").draw()?;
    let colors = [RED, MAGENTA, BLUE, BLACK];
    for (curve, color) in embrees.iter().zip(colors) {
        chart.draw_series(LineSeries::new(curve.iter().copied(), color.mix(0.4)))?;
    }
    for ((curve, name), color) in curves.iter().zip(SETS).zip(colors) {
        let line = LineSeries::new(curve.iter().copied(), color.stroke_width(2));
        let series = chart.draw_series(line)?.label(name);
        series.legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
        let (n0, t0) = curve[0];
        let log = curve.iter().map(|(n, _)| Circle::new((*n, t0 * n.ln() / n0.ln()), 2, color.filled()));
        chart.draw_series(log)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .border_style(BLACK)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    area.present()?;
    Ok(())
}
