//! Boxes that a ray meets, and time a ray, against how far objects move, for each way to index them.
//!
//! The last column is the time in units of that for the same cubes without a motion, of turns of both. A second table is that of
//! renders of the moving cubes under a sky, in units of those at rest.
//! `cargo bench -p benches --bench motion`: a table, and the picture `target/tmp/motion.svg` beside the model.

use std::f64::consts::PI;
use std::path::Path;

use benches::{busy, median, rendered};
use glam::{DAffine3, DVec3, Vec3};
use plotters::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use renderer::accel::{Accel, MotionIndex, Object};
use renderer::io::read_scene;
use renderer::math::transform::Motion;
use renderer::ray::Ray;
use renderer::sampling::warp;
use renderer::scene::Scene;
use renderer::shapes::{Shape, ShapeSettings};

/// Lengths of the motion in sides of the cubes.
const LENGTHS: [f64; 8] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0];

/// Pixels each way and samples a pixel of a render.
const SIDE: u32 = 64;
const SAMPLES: u32 = 64;

/// Turns of the moving and the still scene.
const ROUNDS: usize = 5;

const INDICES: [(&str, MotionIndex); 4] = [
    ("swept", MotionIndex::Swept),
    ("interpolated", MotionIndex::Interpolated(1)),
    ("interpolated, 4 segments", MotionIndex::Interpolated(4)),
    ("chosen", MotionIndex::Chosen),
];

/// How much larger the box is on average that a cube of side 1 sweeps on a way of `m` in a random direction d:
/// Σ (1 + m|dᵢ|)(1 + m|dⱼ|) / 3 over the pairs of axes, with E|dᵢ| = 1/2 and E|dᵢdⱼ| = 2/3π.
fn model(m: f64) -> f64 {
    1.0 + m + m * m * 2.0 / (3.0 * PI)
}

fn main() {
    let rng = &mut Pcg64::seed_from_u64(0);
    let ways: Vec<Vec3> = (0..1000).map(|_| warp::square_to_sphere([rng.random(), rng.random()])).collect();
    let ways: Vec<DVec3> = ways.iter().map(|way| way.as_dvec3()).collect();
    let places: Vec<DVec3> = ways.iter().map(|_| place(rng).as_dvec3()).collect();
    let rays: Vec<Ray> = (0..100_000).map(|_| ray(rng)).collect();
    let still = Accel::new(places.iter().map(|place| resting(*place)).collect(), [0.0, 1.0]);
    let mut curves = Vec::new();
    println!(
        "{:26} {:>6} {:>10} {:>10} {:>8} {:>9} {:>8}",
        "index", "length", "leaf boxes", "to rest", "model", "ns a ray", "to still"
    );
    for (name, index) in INDICES {
        let mut curve: Vec<(f64, f64)> = Vec::new();
        let mut rest = 0.0;
        for m in LENGTHS {
            let objects = places.iter().zip(&ways).map(|(place, way)| cube(*place, *way * m)).collect();
            let accel = Accel::indexed(objects, [0.0, 1.0], index);
            let [ns, ratio] = in_turns(|| time(&accel, &rays), || time(&still, &rays));
            let met = accel.boxes_met(&rays)[1] as f64 / rays.len() as f64;
            if m == 0.0 {
                rest = met;
            }
            let (grown, model) = (met / rest, model(m));
            println!("{name:26} {m:6} {met:10.3} {grown:10.2} {model:8.2} {ns:9.0} {ratio:8.2}");
            curve.push((m, met / rest));
        }
        curves.push((name, curve));
    }
    println!("\n{:>33} {:>9} {:>8}", "length", "ns", "to still");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let sample = |scene: &Scene| rendered(&pool, scene, SAMPLES)[1] * 1e9 / f64::from(SIDE * SIDE * SAMPLES);
    let still = scene(&places, &ways, 0.0);
    for m in LENGTHS {
        let moving = scene(&places, &ways, m);
        let [ns, ratio] = in_turns(|| sample(&moving), || sample(&still));
        println!("{:26} {m:6} {ns:9.0} {ratio:8.2}", "render, a sample");
    }
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("motion.svg");
    match draw(&path, &curves) {
        Ok(()) => println!("drawn in {}", path.display()),
        Err(error) => println!("{}: {error}", path.display()),
    }
}

/// Medians over turns: of what `one` takes, and of that in units of what `other` takes.
fn in_turns(one: impl Fn() -> f64, other: impl Fn() -> f64) -> [f64; 2] {
    let turns: Vec<[f64; 2]> = (0..ROUNDS).map(|_| [one(), other()]).collect();
    let middle = |of: fn(&[f64; 2]) -> f64| median(turns.iter().map(of).collect());
    [middle(|turn| turn[0]), middle(|turn| turn[0] / turn[1])]
}

/// Nanoseconds of processor time a ray.
fn time(accel: &Accel, rays: &[Ray]) -> f64 {
    let mut hits = Vec::new();
    let start = busy();
    rays.chunks(4096).for_each(|batch| accel.closest(batch, &mut hits));
    (busy() - start) * 1e9 / rays.len() as f64
}

fn place(rng: &mut Pcg64) -> Vec3 {
    let mut coordinate = || 40.0 * rng.random::<f32>() - 20.0;
    Vec3::new(coordinate(), coordinate(), coordinate())
}

fn ray(rng: &mut Pcg64) -> Ray {
    let origin = 50.0 * warp::square_to_sphere([rng.random(), rng.random()]);
    Ray::new(origin, (place(rng) - origin).normalize(), rng.random())
}

/// A cube of side 1 that moves by `way` around `place` while the shutter is open; every cube has the same motion's form,
/// so that the boxes at length 0 are those of objects at rest.
fn cube(place: DVec3, way: DVec3) -> Object {
    let small = DAffine3::from_scale(DVec3::splat(0.5));
    let shape = Shape::new(&ShapeSettings::Cube, &small, false);
    let at = |s: f64| DAffine3::from_translation(place + way * s);
    let motion = Motion::keyed(vec![(0.0, at(-0.5)), (1.0, at(0.5))]);
    Object::moving(shape.expect("a regular shape"), motion.expect("regular keys"))
}

/// A cube of side 1 around `place` that has no motion.
fn resting(place: DVec3) -> Object {
    let map = DAffine3::from_translation(place) * DAffine3::from_scale(DVec3::splat(0.5));
    Object::still(Shape::new(&ShapeSettings::Cube, &map, false).expect("a regular shape"))
}

/// The cubes under a sky, seen from outside, paths of up to three edges; on a way of 0 they rest.
fn scene(places: &[DVec3], ways: &[DVec3], m: f64) -> Scene {
    let key = |time: f64, p: DVec3| {
        let place = format!("<translate x=\"{}\" y=\"{}\" z=\"{}\"/>", p.x, p.y, p.z);
        format!("<transform time=\"{time}\"><scale value=\"0.5\"/>{place}</transform>")
    };
    let cube = |(place, way): (&DVec3, &DVec3)| {
        let keys = [(0.0, -0.5), (1.0, 0.5)].map(|(time, s)| key(time, *place + *way * m * s)).concat();
        format!(
            "<shape type=\"cube\"><animation name=\"to_world\">{keys}</animation><bsdf type=\"diffuse\"/></shape>"
        )
    };
    let cubes: String = places.iter().zip(ways).map(cube).collect();
    let text = format!(
        "<scene version=\"3.0.0\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"3\"/></integrator>
         <sensor type=\"perspective\"><float name=\"fov\" value=\"45\"/>
         <float name=\"shutter_open\" value=\"0\"/><float name=\"shutter_close\" value=\"1\"/>
         <transform name=\"to_world\"><lookat origin=\"0, 0, 50\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>
         <film type=\"hdrfilm\"><integer name=\"width\" value=\"{SIDE}\"/><integer name=\"height\" value=\"{SIDE}\"/>
         <rfilter type=\"box\"/></film></sensor>{cubes}<emitter type=\"constant\"/></scene>"
    );
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("motion.xml");
    std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let (description, _) = read_scene(&path, &[]).unwrap_or_else(|error| panic!("it is valid: {error}"));
    Scene::new(&description).unwrap_or_else(|error| panic!("it is valid: {error}"))
}

fn draw(path: &Path, curves: &[(&str, Vec<(f64, f64)>)]) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::new(path, (640, 420)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption("Leaf boxes met by a ray, in units of those at rest", ("sans-serif", 16))
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(44)
        .build_cartesian_2d(0.0..8.0, (0.9..25.0).log_scale())?;
    chart.configure_mesh().x_desc("length of the motion in sides of the cubes").draw()?;
    let colors = [RED, BLUE, GREEN, BLACK];
    for ((name, curve), color) in curves.iter().zip(colors) {
        let line = LineSeries::new(curve.iter().copied(), color.stroke_width(2));
        chart
            .draw_series(line)?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color));
    }
    let dots = (0..=80).map(|i| f64::from(i) / 10.0).map(|m| Circle::new((m, model(m)), 1, RED.mix(0.5)));
    chart.draw_series(dots)?.label("model, swept").legend(|(x, y)| Circle::new((x + 8, y), 2, RED.mix(0.5)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .border_style(BLACK)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    area.present()?;
    Ok(())
}
