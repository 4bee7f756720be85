//! Whole renders of the reference scenes, 32 × 32 pixels of 16 samples.

use benches::reference;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use renderer::integrator::PathTracer;
use renderer::io::read_scene;
use renderer::render::{RenderSettings, render};
use renderer::scene::Scene;

const SCENES: [&str; 8] =
    ["coats", "cornell", "soft-shadow", "thin-lens", "moving", "glass", "mesh", "textured"];

fn images(c: &mut Criterion) {
    let mut group = c.benchmark_group("image");
    group.sample_size(10).throughput(Throughput::Elements(32 * 32 * 16));
    for name in SCENES {
        let (description, _) = read_scene(&reference(name), &[("res".into(), "32".into())])
            .unwrap_or_else(|error| panic!("the reference scenes are valid: {error}"));
        let scene = Scene::new(&description)
            .unwrap_or_else(|error| panic!("the reference scenes are valid: {error}"));
        let integrator = PathTracer { settings: scene.integrator };
        let settings = RenderSettings {
            sampler: description.sampler.kind,
            samples: 4,
            replicates: 4,
            seed: 0,
            threads: 0,
        };
        group.bench_function(name, |b| b.iter(|| render(&scene, &integrator, &settings, &|_| ())));
    }
    group.finish();
}

criterion_group!(benches, images);
criterion_main!(benches);
