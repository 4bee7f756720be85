//! Generators, samplers, warps and filters: time a number or a point.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use renderer::film::{Filter, FilterSampler, PixelSum, Reconstruction};
use renderer::math::Rgb;
use renderer::sampling::generators::{Generator, Lcg};
use renderer::sampling::{
    Decision, DecisionSet, Independent, SampleId, Sampler, Sobol, Stratified, Vertex, warp,
};

/// Points in one measurement.
const POINTS: u32 = 4096;

/// A loop that has none of the renderer's code: what the other times are compared with from one commit to the next.
fn calibration(c: &mut Criterion) {
    let mix = |state: u64| {
        let bits = state.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31);
        bits ^ (bits as f64).sqrt().to_bits()
    };
    c.bench_function("calibration/loop", |b| {
        b.iter(|| (0..POINTS).fold(black_box(1), |state, _| mix(state)));
    });
}

fn generators(c: &mut Criterion) {
    let mut group = c.benchmark_group("generator");
    group.throughput(Throughput::Elements(u64::from(POINTS)));
    let all = [
        ("lcg", Generator::Lcg(Lcg::new(0))),
        ("mersenne-twister", Generator::mersenne_twister(0)),
        ("pcg", Generator::pcg(0)),
        ("xoshiro", Generator::xoshiro(0)),
    ];
    for (name, mut generator) in all {
        group.bench_function(name, |b| b.iter(|| (0..POINTS).map(|_| generator.next_f32()).sum::<f32>()));
    }
    group.finish();
}

fn samplers(c: &mut Criterion) {
    let mut group = c.benchmark_group("sampler");
    group.throughput(Throughput::Elements(u64::from(POINTS)));
    fn points<S: Sampler>(sampler: &S, bounce: u16, decision: Decision) -> f32 {
        let vertex = Vertex { bounce, ..Vertex::default() };
        let id = |index| SampleId { pixel: [3, 5], replicate: 1, index };
        (0..POINTS).map(|i| sampler.draw_2d(id(i), vertex, decision)).map(|[x, y]| x + y).sum()
    }
    let sobol = Sobol::new(0, DecisionSet::FULL);
    let stratified = Stratified::new(0, POINTS);
    let independent = Independent::new(0);
    group.bench_function("independent", |b| b.iter(|| points(&independent, 0, Decision::Lens)));
    group.bench_function("stratified", |b| b.iter(|| points(&stratified, 0, Decision::Lens)));
    group.bench_function("sobol-joint", |b| b.iter(|| points(&sobol, 0, Decision::Lens)));
    group.bench_function("sobol-padded", |b| b.iter(|| points(&sobol, 2, Decision::Direction)));
    group.finish();
}

fn warps(c: &mut Criterion) {
    let mut group = c.benchmark_group("warp");
    group.throughput(Throughput::Elements(u64::from(POINTS)));
    let grid: Vec<[f32; 2]> = (0..POINTS).map(|i| [(i % 64) as f32 / 64.0, (i / 64) as f32 / 64.0]).collect();
    let mut bench = |name: &str, map: &dyn Fn([f32; 2]) -> f32| {
        group.bench_function(name, |b| b.iter(|| black_box(&grid).iter().map(|&u| map(u)).sum::<f32>()));
    };
    bench("disk-concentric", &|u| warp::square_to_disk(u).x);
    bench("disk-polar", &|u| warp::square_to_disk_polar(u).x);
    bench("triangle", &|u| warp::square_to_triangle(u)[0]);
    bench("triangle-folded", &|u| warp::square_to_triangle_folded(u)[0]);
    bench("sphere", &|u| warp::square_to_sphere(u).x);
    bench("cosine-hemisphere", &|u| warp::square_to_cosine_hemisphere(u).x);
    group.finish();
}

fn film(c: &mut Criterion) {
    let mut group = c.benchmark_group("film");
    group.throughput(Throughput::Elements(u64::from(POINTS)));
    let filter = FilterSampler::new(Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 });
    let filter = filter.expect("the parameters are in [0, 1]");
    group.bench_function("mitchell", |b| {
        b.iter(|| (0..POINTS).map(|i| filter.sample(i as f32 / POINTS as f32).1).sum::<f32>());
    });
    group.bench_function("accumulate", |b| {
        b.iter(|| {
            let mut pixel = PixelSum::new(4);
            (0..POINTS).for_each(|i| pixel.push(i / (POINTS / 4), Rgb::splat(i as f32), 1.0));
            pixel.estimate(Reconstruction::Importance)
        });
    });
    group.finish();
}

criterion_group!(benches, calibration, generators, samplers, warps, film);
criterion_main!(benches);
