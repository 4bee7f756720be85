//! A chi-square test of a million samples on both grids, beside the warps that it tests.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use verify::chi_square::ChiSquare;
use verify::claim::Evidence;
use verify::domain::{Directions, Disk, Domain, Triangle};
use verify::error::InputError;
use verify::points::fill;

const SAMPLES: u64 = 1_000_000;

/// A cheap warp to the disk.
fn disk([u, v]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = (TAU * v).sin_cos();
    [u.sqrt() * cos, u.sqrt() * sin]
}

/// A warp of few nanoseconds, to the triangle of vertices (0, 0), (1, 0), (0, 1).
fn triangle([u, v]: [f64; 2]) -> [f64; 2] {
    let s = u.sqrt();
    [1.0 - s, v * s]
}

fn lobe(u: [f64; 2]) -> [f64; 3] {
    let [x, y] = disk(u);
    [x, y, (1.0 - u[0]).sqrt()]
}

fn numbers(index: u64) -> [f64; 2] {
    let mut u = [0.0; 2];
    fill(1, index, &mut u);
    u
}

/// The whole test of a sampler. Its expectations are integrated anew, from a density not known to be constant.
fn test<D: Domain>(
    domain: D,
    density: impl Fn(D::Point) -> f64 + Send + Sync + 'static,
    sampler: impl Fn([f64; 2]) -> D::Point,
) -> Result<Evidence, InputError> {
    let target = ChiSquare::on(domain).density(density);
    let mut histogram = target.histogram();
    (0..SAMPLES).for_each(|i| target.add(&mut histogram, sampler(numbers(i))));
    target.judge(&histogram, 0.02)
}

fn chi_square(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chi-square of a million samples");
    group.sample_size(10);
    for (name, warp) in [
        ("warp to the triangle alone", triangle as fn([f64; 2]) -> [f64; 2]),
        ("warp to the disk alone", disk),
    ] {
        group.bench_function(name, |bench| {
            bench.iter(|| (0..SAMPLES).map(|i| warp(numbers(i))).fold(0.0, |sum, [x, y]| sum + x * y));
        });
    }
    let corner = || Triangle::new([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).expect("not degenerate");
    group.bench_function("triangle", |bench| {
        bench.iter(|| test(corner(), |p| black_box(p)[0].mul_add(0.0, 2.0), triangle));
    });
    group.bench_function("disk", |bench| {
        bench.iter(|| test(Disk::unit(), |p| black_box(p)[0].mul_add(0.0, 1.0 / PI), disk));
    });
    group.bench_function("cosine lobe", |bench| {
        bench.iter(|| test(Directions::hemisphere(), |[_, _, z]| black_box(z) / PI, lobe));
    });
    group.finish();
}

criterion_group!(benches, chi_square);
criterion_main!(benches);
