//! Closest hit and occlusion on a mesh of about 100,000 triangles: time a ray.

use benches::{bumpy_ball, coherent, incoherent};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Rays in one query.
const RAYS: u32 = 4096;

fn queries(c: &mut Criterion) {
    let accel = bumpy_ball();
    let mut group = c.benchmark_group("query");
    group.throughput(Throughput::Elements(u64::from(RAYS)));
    for (order, rays) in [("coherent", coherent(RAYS)), ("incoherent", incoherent(RAYS))] {
        let (mut hits, mut blocked) = (Vec::new(), Vec::new());
        group.bench_function(format!("closest/{order}"), |b| b.iter(|| accel.closest(&rays, &mut hits)));
        group.bench_function(format!("occluded/{order}"), |b| b.iter(|| accel.occluded(&rays, &mut blocked)));
    }
    group.finish();
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    group.bench_function("mesh", |b| b.iter(bumpy_ball));
    group.finish();
}

criterion_group!(benches, queries, build);
criterion_main!(benches);
