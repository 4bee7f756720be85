//! Paths from lights: promises about bits, plans and what is refused.

use std::path::Path;
use std::sync::Mutex;

use renderer::film::{Crop, Part};
use renderer::integrator::{Integrator, PathTracer};
use renderer::io::read_scene;
use renderer::render::{Progress, RenderSettings, Rendering, go_on, pilot, render, render_with};
use renderer::sampling::{Independent, SamplerKind, WithinPlan};
use renderer::scene::{Scene, SceneDescription, Strategy};

/// A reference scene at 24 × 24 pixels.
fn reference(name: &str) -> SceneDescription {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../references/scenes/{name}.xml"));
    let (mut description, _) = read_scene(&path, &[("res".into(), "24".into())]).unwrap();
    description.integrator.light_paths = true;
    description
}

fn settings(sampler: SamplerKind, threads: usize) -> RenderSettings {
    RenderSettings { sampler, samples: 16, replicates: 2, seed: 0, threads }
}

fn run(description: &SceneDescription, threads: usize) -> Rendering {
    let scene = Scene::new(description).unwrap();
    let integrator = PathTracer { settings: scene.integrator };
    render(&scene, &integrator, &settings(SamplerKind::Sobol, threads), &|_| ()).unwrap()
}

#[test]
fn bits_do_not_depend_on_threads_nor_on_what_is_cut_off() {
    let whole = reference("glass");
    let image = run(&whole, 1);
    assert_eq!(run(&whole, 3), image);
    let mut without = whole.clone();
    without.integrator.light_paths = false;
    assert_ne!(run(&without, 1).pixels, image.pixels);
    let (offset, size) = ([3, 5], [15, 17]);
    let mut part = whole;
    part.film.crop = Some(Crop { offset, size });
    let part = run(&part, 2);
    for (place, pixel) in (0..).zip(&part.pixels) {
        let [x, y] = [offset[0] + place % size[0], offset[1] + place / size[0]];
        assert_eq!(*pixel, image.pixels[(y * image.width + x) as usize], "{x} {y}");
    }
}

#[test]
fn what_does_not_call_for_them_is_as_it_was() {
    // Diffuse surfaces alone, and a sky alone.
    for name in ["cornell", "coats"] {
        let with = reference(name);
        assert!(Scene::new(&with).unwrap().emission.is_none(), "{name}");
        let mut without = with.clone();
        without.integrator.light_paths = false;
        assert_eq!(run(&with, 0), run(&without, 0), "{name}");
    }
}

#[test]
fn they_decide_nothing_that_is_not_planned() {
    for strategy in [Strategy::Light, Strategy::Material, Strategy::Both] {
        let mut description = reference("glass");
        description.integrator.strategy = strategy;
        description.integrator.rr_depth = 2;
        let scene = Scene::new(&description).unwrap();
        let integrator = PathTracer { settings: scene.integrator };
        let [first, later] = integrator.decisions(&scene);
        let sampler = WithinPlan::new(Independent::new(0), first, later);
        let settings = settings(SamplerKind::Independent, 0);
        let rendering = render_with(&scene, &integrator, &sampler, &settings, &|_| ()).unwrap();
        assert_eq!(rendering.dropped, 0);
    }
}

#[test]
fn parts_of_the_samples_and_samplers_that_must_know_their_number_are_refused() {
    let scene = Scene::new(&reference("glass")).unwrap();
    let integrator = PathTracer { settings: scene.integrator };
    let refused = |sampler, range| {
        let part = Part::new([scene.film.width, scene.film.height], 2, range);
        let result = go_on(&scene, &integrator, &settings(sampler, 0), part, &|_| ());
        result.err().map(|error| error.to_string())
    };
    for (sampler, range) in [(SamplerKind::Sobol, [0, 8]), (SamplerKind::MultiJitter, [0, 16])] {
        let error = refused(sampler, range).unwrap();
        assert!(error.contains("paths from lights") && error.contains("sobol"), "{error}");
    }
    assert_eq!(refused(SamplerKind::Sobol, [0, 16]), None);
}

#[test]
fn each_stage_of_a_render_tells_how_far_it_is() {
    let scene = Scene::new(&reference("glass")).unwrap();
    let integrator = PathTracer { settings: scene.integrator };
    let settings = settings(SamplerKind::Sobol, 0);
    let told = Mutex::new(Vec::new());
    let watch = |progress: Progress| {
        told.lock().unwrap().push(match progress {
            Progress::Pilot(share) => (0, share),
            Progress::LightPaths(share) => (1, share),
            Progress::Image(part) => (2, part.share()),
        });
    };
    let part = pilot::allocated(&scene, &integrator, &settings, &watch).unwrap();
    go_on(&scene, &integrator, &settings, part, &watch).unwrap();
    let told = told.into_inner().unwrap();
    assert!(told.is_sorted_by(|a, b| a < b), "{told:?}");
    assert!((0..3).all(|stage| told.contains(&(stage, 1.0))), "{told:?}");
}
