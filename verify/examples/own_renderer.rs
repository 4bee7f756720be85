//! Is my renderer's irradiance the closed form, and are two of its images the same? `cargo run --release -p verify --example own_renderer`

use std::f64::consts::{PI, TAU};

use verify::claim::{Level, Run, Seed, claim};
use verify::image::{Image, compare};
use verify::irradiance::from_parallel_rectangle;
use verify::mean::MeanClaim;
use verify::points::fill;

/// Columns and rows of the image, and half the side of the square light at height 1 over the plane.
const SIZE: [usize; 2] = [32, 32];
const LIGHT: f64 = 0.5;

/// "My renderer": irradiance of a plane at a point from a square light of radiance 1, by points on the light.
fn irradiance(at: [f64; 2], seed: u64, samples: u64) -> f64 {
    let one = |index| {
        let mut u = [0.0; 2];
        fill(seed, index, &mut u);
        let [x, y] = [0, 1].map(|axis| LIGHT * (2.0 * u[axis] - 1.0) - at[axis]);
        let square = x * x + y * y + 1.0;
        (2.0 * LIGHT).powi(2) / (square * square) // cos·cos/distance² per area, over the density of points
    };
    (0..samples).map(one).sum::<f64>() / samples as f64
}

/// An image of the plane from −1 to 1.
fn render(seed: u64) -> Vec<f64> {
    let centre = |i: usize, count: usize| 2.0 * (i as f64 + 0.5) / count as f64 - 1.0;
    let pixel = |i: usize| {
        let at = [centre(i % SIZE[0], SIZE[0]), centre(i / SIZE[0], SIZE[1])];
        irradiance(at, verify::seeds::derive(seed, 0, i as u64), 64)
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

/// A different way to the same image: directions from a cosine lobe, which hit the light or miss it.
fn render_by_directions(seed: u64) -> Vec<f64> {
    let centre = |i: usize, count: usize| 2.0 * (i as f64 + 0.5) / count as f64 - 1.0;
    let sample = |at: [f64; 2], stream: u64, index: u64| {
        let mut u = [0.0; 2];
        fill(stream, index, &mut u);
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let tangent = (u[0] / (1.0 - u[0])).sqrt();
        let hit = [at[0] + tangent * cos, at[1] + tangent * sin];
        if hit.iter().all(|x| x.abs() < LIGHT) { PI } else { 0.0 }
    };
    let pixel = |i: usize| {
        let at = [centre(i % SIZE[0], SIZE[0]), centre(i / SIZE[0], SIZE[1])];
        (0..512).map(|k| sample(at, verify::seeds::derive(seed, 1, i as u64), k)).sum::<f64>() / 512.0
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

fn main() {
    let exact = from_parallel_rectangle([-LIGHT, LIGHT], [-LIGHT, LIGHT], 1.0);
    let mean = MeanClaim::relative(exact, 0.02);
    let outcome = claim("mine/irradiance/centre", "the irradiance below the light is the closed form")
        .rejects("2.2 resolutions more", move |run: &Run| {
            mean.control(run, |seed| irradiance([0.0; 2], seed, 256))
        })
        .by(move |run: &Run| mean.evidence(run, |seed| irradiance([0.0; 2], seed, 256)))
        .run(Seed::from_env(), Level::Quick)
        .expect("runs");
    println!("{outcome}\n");
    outcome.assert_holds();

    // Four seeds a side, from which the errors of both come.
    let side = |render: fn(u64) -> Vec<f64>, first: u64| (first..first + 4).map(render).collect::<Vec<_>>();
    let [a, b] = [side(render, 0), side(render_by_directions, 10)]
        .map(|files| Image::from_seeds(SIZE, 1, &files).expect("finite"));
    let same = compare(&a, &b, 5.0).expect("one size");
    println!(
        "{}: bias {:.3} % in [{:.3}, {:.3}] %",
        same.verdict, same.bias_percent, same.interval[0], same.interval[1]
    );
}
