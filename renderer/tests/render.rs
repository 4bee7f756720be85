//! Whole renders of scenes whose answer is known, and the promises about bits.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use renderer::camera::{CameraSettings, FovAxis, Projection, Shutter};
use renderer::film::{Allocation, Crop, FilmSettings, Filter, Part, Reconstruction};
use renderer::integrator::{Integrator, PathTracer};
use renderer::io::read_scene;
use renderer::materials::Material;
use renderer::math::{Rgb, transform::Motion};
use renderer::render::{RenderSettings, Rendering, go_on, pilot, render, render_with};
use renderer::sampling::{Independent, SamplerKind, WithinPlan};
use renderer::scene::{
    Branch, Effect, IntegratorSettings, LightSettings, ObjectSettings, SamplerSettings, Scene,
    SceneDescription, Strategy,
};
use renderer::shapes::ShapeSettings;
use renderer::texture::Texture;

fn at(affine: DAffine3) -> Motion {
    Motion::fixed(affine).unwrap()
}

fn diffuse(albedo: f32) -> Arc<Material> {
    Arc::new(Material::new_diffuse(Texture::Constant(Rgb::splat(albedo))).unwrap())
}

fn object(
    name: &str,
    shape: ShapeSettings,
    to_world: Motion,
    material: Arc<Material>,
    radiance: f32,
) -> ObjectSettings {
    let radiance = Rgb::splat(radiance).into();
    ObjectSettings { name: name.into(), shape, to_world, flip_normals: false, material, radiance }
}

fn scene_of(objects: Vec<ObjectSettings>, integrator: IntegratorSettings) -> SceneDescription {
    let projection =
        Projection::Perspective { fov: 40.0, axis: FovAxis::X, lens_radius: 0.0, focus_distance: 1.0 };
    SceneDescription {
        camera: CameraSettings { projection, to_world: at(DAffine3::IDENTITY), shutter: Shutter::INSTANT },
        film: FilmSettings {
            width: 20,
            height: 18,
            crop: None,
            filter: Filter::PIXEL,
            reconstruction: Reconstruction::Importance,
        },
        sampler: SamplerSettings { kind: SamplerKind::Sobol, spp: 16, seed: 0 },
        integrator,
        objects,
        lights: Vec::new(),
        hash: 0,
    }
}

/// Inside a closed sphere of albedo `rho` that emits 1.
fn furnace(rho: f32, integrator: IntegratorSettings) -> SceneDescription {
    let sphere = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 2.0 };
    let mut wall = object("wall", sphere, at(DAffine3::IDENTITY), diffuse(rho), 1.0);
    wall.flip_normals = true;
    scene_of(vec![wall], integrator)
}

fn run(description: &SceneDescription, sampler: SamplerKind, threads: usize) -> Rendering {
    let scene = Scene::new(description).unwrap();
    let settings = RenderSettings { sampler, samples: 8, replicates: 4, seed: 0, threads };
    render(&scene, &PathTracer { settings: scene.integrator }, &settings, &|_| ()).unwrap()
}

/// Pooled mean of all channels, and its standard error from the pixels' own.
fn pooled(rendering: &Rendering) -> [f64; 2] {
    let n = 3.0 * rendering.pixels.len() as f64;
    let sum: f64 = rendering.pixels.iter().flat_map(|p| p.mean).sum();
    let variance: f64 = rendering.pixels.iter().flat_map(|p| p.standard_error.unwrap()).map(|e| e * e).sum();
    [sum / n, (3.0 * variance).sqrt() / n] // the three channels of a pixel share their samples: 3 times, not √3
}

#[test]
fn hidden_emitters_are_seen_through() {
    let turned = |z: f64| at(DAffine3::from_translation(DVec3::Z * z) * DAffine3::from_rotation_y(PI));
    let wall = object("wall", ShapeSettings::Rectangle, turned(4.0), diffuse(0.5), 0.0);
    let image = |emitters: &[f64], hide_emitters: bool| {
        let settings = IntegratorSettings { hide_emitters, max_depth: Some(2), ..IntegratorSettings::PATH };
        // They face the camera, as the wall does, and the lamp is behind them.
        let emitter = |&z: &f64| object("emitter", ShapeSettings::Disk, turned(z), diffuse(0.0), 3.0);
        let objects = emitters.iter().map(emitter).chain([wall.clone()]).collect();
        let position = DVec3::new(0.0, 0.0, 2.5);
        let lights = vec![LightSettings::Point { position, intensity: Rgb::WHITE }];
        let description = SceneDescription { lights, ..scene_of(objects, settings) };
        pooled(&run(&description, SamplerKind::Sobol, 0))
    };
    let [alone, error] = image(&[], true);
    for emitters in [&[1.5][..], &[1.0, 1.5]] {
        let [hidden, its_error] = image(emitters, true);
        let error = error.hypot(its_error);
        assert!((hidden - alone).abs() < 6.0 * error, "{hidden} against {alone} ± {error}"); // 2e-9 by chance
        // What the disks cover, radiance 3 or in the dark, is seen from a twentieth of the mean on.
        assert!(error < 0.05 / 6.0 * alone, "{error}");
    }
    assert!(image(&[1.0, 1.5], false)[0] > 2.0 * alone);
}

#[test]
fn a_furnace_without_an_end_to_its_paths_is_as_bright_as_the_series_says() {
    for sampler in SamplerKind::ALL {
        let [mean, error] = pooled(&run(&furnace(0.5, IntegratorSettings::PATH), sampler, 0));
        // L = Le / (1 − ρ) = 2; 6 σ of a normal mean, 2e-9 by chance
        assert!((mean - 2.0).abs() < 6.0 * error, "{}: {mean} ± {error}", sampler.name());
        assert!(error < 0.05);
    }
}

#[test]
fn a_furnace_cut_at_a_depth_misses_the_rest_of_the_series() {
    for (depth, sum) in [(1, 1.0), (2, 1.5), (3, 1.75)] {
        let settings = IntegratorSettings { max_depth: Some(depth), ..IntegratorSettings::PATH };
        for strategy in [Strategy::Light, Strategy::Material, Strategy::Both] {
            let [mean, error] = pooled(&run(
                &furnace(0.5, IntegratorSettings { strategy, ..settings }),
                SamplerKind::Sobol,
                0,
            ));
            // 6 σ, and the rounding of f32 values of order 1 through a chain of 10 operations
            assert!(
                (mean - sum).abs() < 6.0 * error + 10.0 * f64::from(f32::EPSILON),
                "{depth}: {mean} ± {error}"
            );
        }
    }
}

#[test]
fn samples_by_error_are_the_same_for_any_threads_and_when_begun_again() {
    let mut description = furnace(0.5, IntegratorSettings::PATH);
    description.film.width = 37;
    let scene = Scene::new(&description).unwrap();
    let integrator = PathTracer { settings: scene.integrator };
    for sampler in SamplerKind::ALL {
        let settings = RenderSettings { sampler, samples: 20, replicates: 2, seed: 0, threads: 1 };
        let Ok(part) = pilot::allocated(&scene, &integrator, &settings, &|_| ()) else {
            assert!(
                [SamplerKind::Stratified, SamplerKind::MultiJitter, SamplerKind::Halton].contains(&sampler)
            );
            continue;
        };
        let counts = part.counts().unwrap().to_vec();
        assert!(counts.iter().min() < counts.iter().max() && counts.iter().all(|n| *n >= 4));
        let finished = |settings, part| {
            let part = go_on(&scene, &integrator, settings, part, &|_| ()).unwrap();
            Rendering::of(&part, Reconstruction::Importance)
        };
        let one = finished(&settings, part);
        let many = RenderSettings { threads: 3, ..settings };
        assert_eq!(finished(&many, pilot::allocated(&scene, &integrator, &many, &|_| ()).unwrap()), one);
        // The same counts without the pilot's samples, which are then taken with the others.
        let film = [scene.film.width, scene.film.height];
        let again = Part::allocated(film, 2, 20, Allocation { counts: counts.clone(), pilot: None }).unwrap();
        assert_eq!(finished(&settings, again), one, "{}", sampler.name());
        assert!(one.pixels.iter().zip(counts).all(|(p, n)| p.samples == u64::from(2 * n)));
    }
}

#[test]
fn shared_paths_are_the_same_for_any_threads_and_in_parts() {
    let mut room = furnace(0.8, IntegratorSettings::PATH);
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.1, 0.0, 1.0), radius: 0.2 };
    room.objects.push(object("ball", ball, at(DAffine3::IDENTITY), diffuse(0.1), 0.0));
    let apart = run(&room, SamplerKind::Sobol, 1);
    room.integrator.reuse = true;
    let together = run(&room, SamplerKind::Sobol, 1);
    assert_ne!(together, apart);
    assert_eq!(run(&room, SamplerKind::Sobol, 3), together);

    let scene = Scene::new(&room).unwrap();
    let integrator = PathTracer { settings: scene.integrator };
    let settings =
        RenderSettings { sampler: SamplerKind::Sobol, samples: 8, replicates: 4, seed: 0, threads: 1 };
    let film = [scene.film.width, scene.film.height];
    let part = |range| go_on(&scene, &integrator, &settings, Part::new(film, 4, range), &|_| ()).unwrap();
    let joined = part([0, 3]).join(&part([3, 8])).unwrap();
    assert_eq!(Rendering::of(&joined, Reconstruction::Importance), together);
}

#[test]
fn nothing_is_shared_by_paths_of_two_edges_nor_where_the_scene_has_a_shutter() {
    let bits = |mut scene: SceneDescription| {
        scene.integrator.reuse = true;
        run(&scene, SamplerKind::Sobol, 0)
    };
    let direct = furnace(0.8, IntegratorSettings::DIRECT);
    assert_eq!(bits(direct.clone()), run(&direct, SamplerKind::Sobol, 0));
    let moving = with_everything();
    assert!(Scene::new(&moving).unwrap().effects.contains(Effect::Shutter));
    assert_eq!(bits(moving.clone()), run(&moving, SamplerKind::Sobol, 0));
}

#[test]
fn a_crop_is_a_part_of_the_whole_image_bit_for_bit() {
    let mut whole = furnace(0.8, IntegratorSettings::PATH);
    // A ball in the view, so that the image tells where a ray went.
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.1, 0.0, 1.0), radius: 0.2 };
    whole.objects.push(object("ball", ball, at(DAffine3::IDENTITY), diffuse(0.1), 0.0));
    let mut part = whole.clone();
    let (offset, size) = ([3, 1], [15, 17]);
    part.film.crop = Some(Crop { offset, size });
    for sampler in SamplerKind::ALL {
        let (whole, part) = (run(&whole, sampler, 1), run(&part, sampler, 2));
        assert_eq!([part.width, part.height], size);
        for (place, pixel) in (0..).zip(&part.pixels) {
            let [x, y] = [offset[0] + place % size[0], offset[1] + place / size[0]];
            assert_eq!(*pixel, whole.pixels[(y * whole.width + x) as usize], "{} {x} {y}", sampler.name());
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let description = furnace(0.8, IntegratorSettings::PATH);
    for sampler in SamplerKind::ALL {
        let one = run(&description, sampler, 1);
        for threads in [2, 5] {
            assert_eq!(one, run(&description, sampler, threads), "{} {threads}", sampler.name());
        }
    }
}

fn with_everything() -> SceneDescription {
    let glass = Arc::new(
        Material::new_dielectric(1.5, Texture::Constant(Rgb::WHITE), Texture::Constant(Rgb::WHITE)).unwrap(),
    );
    let slide = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    let moving = Motion::keyed(vec![(0.0, slide(-0.4)), (1.0, slide(0.4))]).unwrap();
    let ball = |x, z, radius| ShapeSettings::Sphere { center: DVec3::new(x, 0.0, z), radius };
    let wall = DAffine3::from_translation(DVec3::new(0.0, 0.0, 6.0))
        * DAffine3::from_rotation_y(PI)
        * DAffine3::from_scale(DVec3::splat(4.0));
    let lamp = DAffine3::from_translation(DVec3::new(0.0, 3.0, 3.0))
        * DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let mut description = scene_of(
        vec![
            object("ball", ball(0.8, 4.0, 0.5), moving, diffuse(0.6), 0.0),
            object("glass", ball(-0.8, 3.0, 0.5), at(DAffine3::IDENTITY), glass, 0.0),
            object("wall", ShapeSettings::Rectangle, at(wall), diffuse(0.5), 0.0),
            object("lamp", ShapeSettings::Rectangle, at(lamp), diffuse(0.0), 5.0),
        ],
        IntegratorSettings { rr_depth: 1, branch: Branch::Both, ..IntegratorSettings::PATH },
    );
    description.camera.shutter = Shutter::new(0.0, 1.0).unwrap();
    description.camera.projection =
        Projection::Perspective { fov: 40.0, axis: FovAxis::X, lens_radius: 0.1, focus_distance: 4.0 };
    description.film.filter = Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
    description.lights.push(LightSettings::Constant { radiance: Rgb::splat(0.2) });
    description
}

#[test]
fn forks_end_where_panes_squeeze_light_again_and_again() {
    // Each of 40 panes is seen from its glass, as if nothing brought the light back in between: radiance grows by 1.5² at each.
    // Were forks to follow it, 2⁴⁰ paths would come of a sample.
    let glass = Arc::new(Material::new_dielectric(1.5, Rgb::WHITE.into(), Rgb::WHITE.into()).unwrap());
    let pane = |i: u8| {
        let place = DAffine3::from_translation(DVec3::new(0.0, 0.0, f64::from(i)))
            * DAffine3::from_scale(DVec3::splat(50.0));
        object("pane", ShapeSettings::Rectangle, at(place), glass.clone(), 0.0)
    };
    let integrator = IntegratorSettings {
        branch: Branch::Both,
        max_depth: Some(300),
        rr_depth: 300,
        ..IntegratorSettings::PATH
    };
    let mut description = scene_of((1..41).map(pane).collect(), integrator);
    // Straight on: aside, panes would bend rays until they mirror them.
    description.camera.projection = Projection::Orthographic;
    description.lights.push(LightSettings::Constant { radiance: Rgb::splat(0.2) });
    let [mean, _] = pooled(&run(&description, SamplerKind::Independent, 0));
    assert!(mean > 1e12, "{mean}"); // 0.2 · (0.96 · 2.25)⁴⁰ = 5e12 goes straight through
}

#[test]
fn a_scene_calls_for_what_it_contains() {
    let full = Scene::new(&with_everything()).unwrap();
    for (name, effect) in Effect::ALL {
        // no material here has a rough lobe
        assert_eq!(full.effects.contains(effect), effect != Effect::Rough, "{name}");
    }
    let plain = Scene::new(&furnace(0.5, IntegratorSettings::DIRECT)).unwrap();
    for (name, effect) in Effect::ALL {
        assert_eq!(plain.effects.contains(effect), effect == Effect::AreaLight, "{name}");
    }
}

/// Every reference scene, at 12 × 12 pixels.
fn references() -> Vec<SceneDescription> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../references/scenes");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|e| e == "xml"));
    let read = |path: std::path::PathBuf| read_scene(&path, &[("res".into(), "12".into())]).unwrap().0;
    let all: Vec<_> = scenes.map(read).collect();
    assert!(all.len() >= 7, "cornell, glass, mesh, moving, soft-shadow, textured and thin-lens at least");
    all
}

#[test]
fn an_effect_left_out_is_not_called_for() {
    for description in references().into_iter().chain([with_everything()]) {
        let called = Scene::new(&description).unwrap().effects;
        for effect in called.iter() {
            let mut without = description.clone();
            if without.leave_out(effect).is_err() {
                assert_eq!(effect, Effect::Rough, "only Phong's model has no null value");
                continue;
            }
            let rest: Vec<_> = Scene::new(&without).unwrap().effects.iter().collect();
            assert!(!rest.contains(&effect), "{}", effect.name());
            assert!(rest.iter().all(|&e| called.contains(e)), "{}", effect.name());
        }
    }
}

#[test]
fn no_decision_is_made_that_is_not_planned() {
    let built = [with_everything(), furnace(0.5, IntegratorSettings::DIRECT)];
    for description in built.into_iter().chain(references()) {
        for branch in Branch::ALL.map(|(_, branch)| branch) {
            let mut description = description.clone();
            description.integrator.branch = branch;
            let scene = Scene::new(&description).unwrap();
            let integrator = PathTracer { settings: scene.integrator };
            let [first, later] = integrator.decisions(&scene);
            let sampler = WithinPlan::new(Independent::new(0), first, later);
            let settings = RenderSettings {
                sampler: SamplerKind::Independent,
                samples: 4,
                replicates: 2,
                seed: 0,
                threads: 0,
            };
            let rendering = render_with(&scene, &integrator, &sampler, &settings, &|_| ()).unwrap();
            assert_eq!(rendering.dropped, 0);
        }
    }
}

#[test]
fn an_effect_at_its_null_value_changes_no_bit() {
    let still = {
        let mut d = with_everything();
        let Projection::Perspective { lens_radius, .. } = &mut d.camera.projection else {
            unreachable!("perspective")
        };
        *lens_radius = 0.0;
        d.camera.shutter = Shutter::INSTANT;
        d
    };
    let mut never = still.clone();
    never.camera.projection =
        Projection::Perspective { fov: 40.0, axis: FovAxis::X, lens_radius: 0.0, focus_distance: 77.0 };
    never.objects[0].to_world = at(never.objects[0].to_world.at(0.0));
    assert_eq!(run(&still, SamplerKind::Sobol, 0), run(&never, SamplerKind::Sobol, 0));
}

#[test]
fn refusals_name_the_object() {
    let mut description = furnace(0.5, IntegratorSettings::PATH);
    description.objects[0].shape = ShapeSettings::Sphere { center: DVec3::ZERO, radius: -1.0 };
    let message = Scene::new(&description).unwrap_err().to_string();
    assert!(message.starts_with("wall: ") && message.contains("-1"), "{message}");
    description.film.width = 0;
    assert!(Scene::new(&description).unwrap_err().to_string().starts_with("film: the number of pixels is 0"));
}
