//! Scenes that break renderers: each gives finite, non-negative pixels, counts what it drops, and the mean that it should.

use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use glam::{DAffine3, DMat3, DVec3};
use renderer::camera::{CameraSettings, Projection, Shutter};
use renderer::film::FilmSettings;
use renderer::integrator::PathTracer;
use renderer::math::Rgb;
use renderer::math::transform::Motion;
use renderer::render::{RenderSettings, Rendering, render};
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, LightSettings, SceneDescription, Strategy};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, ClaimBuilder, Level, Run, claim};
use verify::error::InputError;
use verify::irradiance::{from_parallel_rectangle, from_perpendicular_rectangle};
use verify::mean::CONTROL_FACTOR;

use super::routine::worst_case;
use crate::setup::{built, glass, lamp, mean, receiver, rectangle_at, spot, subject, thing};

/// A scene, how many samples a pixel it takes, the mean that it should have and how far from it it may be.
struct Hard {
    id: &'static str,
    shows: &'static str,
    samples: u32,
    /// Mean of the image.
    exact: f64,
    /// Largest relative error; of an exact 0, largest value.
    tolerance: f64,
    scene: fn() -> SceneDescription,
}

pub(super) fn claims() -> Vec<Claim> {
    let mut claims: Vec<Claim> =
        lights().into_iter().chain(cameras()).chain(motions()).map(Hard::claim).collect();
    claims.extend([long_pixel(), long_film()].map(|long| long.claim().from_level(Level::Standard)));
    claims
}

impl Hard {
    fn claim(self) -> Claim {
        let Self { id, shows, samples, exact, tolerance, scene } = self;
        // Controls spoil the image that the subject's run has rendered.
        let known: Arc<Mutex<Option<(u64, Rendering)>>> = Arc::default();
        let trial = move |run: &Run, spoil: Spoil| {
            let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
            let mut image = match known.take_if(|(seed, _)| *seed == run.seed) {
                Some((_, image)) => image,
                None => rendered(&scene(), samples, run.seed)?,
            };
            *known = Some((run.seed, image.clone()));
            let size = if exact == 0.0 { 1.0 } else { exact };
            spoil(&mut image, CONTROL_FACTOR * tolerance * size);
            let off = (mean(&image) - exact).abs() / size;
            let sound = is_sound(&image);
            let n = image.pixels.iter().map(|p| p.samples).sum();
            let error = if sound { off } else { f64::INFINITY };
            Ok(worst_case("relative error of the mean", error, n, tolerance, None))
        };
        let controls: [(&str, Spoil); 4] = [
            ("2.2 × tolerance", |image, defect| {
                image.pixels.iter_mut().for_each(|p| p.mean = p.mean.map(|m| m + defect));
            }),
            ("one pixel is NaN", |image, _| image.pixels[0].mean[1] = f64::NAN),
            ("one pixel is negative", |image, _| image.pixels[0].mean[2] = -1e-300),
            ("one sample is dropped", |image, _| image.dropped = 1),
        ];
        let says = format!("{shows}: finite, not negative, nothing dropped, the right mean");
        let with = |builder: ClaimBuilder, (name, spoil): (&str, Spoil)| {
            let trial = trial.clone();
            builder.rejects(name, move |run| trial(run, spoil))
        };
        let builder = controls.into_iter().fold(claim(format!("stable/scene/{id}"), says), with);
        builder.by(move |run| trial(run, |_, _| ()))
    }
}

/// A defect planted in an image; the number is that of a mean.
type Spoil = fn(&mut Rendering, f64);

/// The image of a scene in two replicates, so that it has errors.
fn rendered(description: &SceneDescription, samples: u32, seed: u64) -> Result<Rendering, InputError> {
    let scene = built(description);
    let settings = RenderSettings { sampler: SamplerKind::Sobol, samples, replicates: 2, seed, threads: 0 };
    render(&scene, &PathTracer { settings: scene.integrator }, &settings, &|_| ()).map_err(subject)
}

/// Whether every pixel and its error is finite and not negative, and no sample was dropped.
fn is_sound(image: &Rendering) -> bool {
    let sound = |v: f64| v.is_finite() && v >= 0.0;
    image.dropped == 0
        && image.pixels.iter().all(|p| {
            p.mean.into_iter().all(sound) && p.standard_error.is_some_and(|e| e.into_iter().all(sound))
        })
}

/// A lamp over the receiver at the origin, found by light points and the material's directions.
fn under(lamp: renderer::scene::ObjectSettings) -> SceneDescription {
    let mut description = receiver(vec![lamp]);
    description.integrator.strategy = Strategy::Both;
    description
}

/// A lamp of half side `half` in the height `height`, facing down.
fn ceiling(half: f64, height: f64) -> renderer::scene::ObjectSettings {
    let at = rectangle_at(DVec3::new(0.0, 0.0, height), half * DVec3::Y, half * DVec3::X);
    lamp(ShapeSettings::Rectangle, at)
}

/// A floor lit by a lamp of some radiance in a height of 1, of side 2.
fn radiance(value: f32) -> SceneDescription {
    let mut lamp = ceiling(1.0, 1.0);
    lamp.radiance = Rgb::splat(value).into();
    under(lamp)
}

/// A floor under a map whose top and bottom have these radiances.
fn sky(rows: [f32; 2]) -> SceneDescription {
    let mut description = receiver(Vec::new());
    description.integrator.strategy = Strategy::Both;
    // Upwards is +y in the map, and +z here.
    let to_world = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    let pixels = rows.map(Rgb::splat).into();
    description.lights.push(LightSettings::Environment { size: [1, 2], pixels, to_world });
    description
}

/// The radiance of a white receiver below the middle of a square lamp.
fn below(half: f64, height: f64) -> f64 {
    from_parallel_rectangle([-half, half], [-half, half], height) / PI
}

fn lights() -> Vec<Hard> {
    // 2048 points on a lamp as large as it is high leave 0.2 %; a smaller or a larger one far less.
    let noise = 0.01;
    vec![
        Hard {
            id: "light-1e-6-wide",
            shows: "a light 1e-6 wide at a distance of 1",
            samples: 64,
            exact: below(5e-7, 1.0),
            tolerance: 1e-4, // The lamp looks the same from all points of the light; f32 rounds by 1e-7.
            scene: || under(ceiling(5e-7, 1.0)),
        },
        Hard {
            id: "light-1e6-wide",
            shows: "a light 1e6 wide at a distance of 1e-3, nearer than the eye",
            samples: 1024,
            exact: below(5e5, 1e-3),
            tolerance: noise,
            scene: || {
                let mut description = under(ceiling(5e5, 1e-3));
                let eye = DVec3::new(3e-4, 2e-4, 4e-4);
                description.camera.to_world =
                    crate::setup::fixed(crate::setup::look(eye, DVec3::ZERO, DVec3::Y));
                description
            },
        },
        Hard {
            id: "receiver-in-the-lights-plane",
            shows: "a receiver in its light's plane gets nothing",
            samples: 256,
            exact: 0.0,
            tolerance: 1e-12,
            scene: || {
                let at = rectangle_at(DVec3::new(2.0, 0.0, 0.0), DVec3::Y, -DVec3::X);
                under(lamp(ShapeSettings::Rectangle, at))
            },
        },
        Hard {
            id: "light-touching-the-floor",
            shows: "a light that stands on the floor, seen from 1e-4 before its foot",
            samples: 1024,
            exact: from_perpendicular_rectangle([-1.0, 1.0], [0.0, 2.0], 1e-4) / PI,
            tolerance: noise,
            scene: || {
                let at = rectangle_at(DVec3::new(-1e-4, 0.0, 1.0), DVec3::Y, DVec3::Z);
                under(lamp(ShapeSettings::Rectangle, at))
            },
        },
        Hard {
            id: "light-behind-the-horizon",
            shows: "a receiver whose light is behind its horizon gets nothing",
            samples: 256,
            exact: 0.0,
            tolerance: 1e-12,
            scene: || {
                let at = rectangle_at(DVec3::new(0.5, 0.0, -1.0 - 1e-6), DVec3::Y, -DVec3::Z);
                under(lamp(ShapeSettings::Rectangle, at))
            },
        },
        Hard {
            id: "sky-1e30-to-1e-30",
            shows: "a sky of 1e30 overhead that falls to 1e-30 below",
            samples: 1024,
            exact: 0.75e30, // Linear in the angle θ: 2 ∫ (1 − θ/π) cos θ sin θ dθ over the upper half.
            tolerance: noise,
            scene: || sky([1e30, 1e-30]),
        },
        Hard {
            id: "sky-1e-30-to-1e30",
            shows: "a sky of 1e-30 overhead that rises to 1e30 below",
            samples: 1024,
            exact: 0.25e30, // The rest of the above.
            tolerance: noise,
            scene: || sky([1e-30, 1e30]),
        },
        Hard {
            id: "radiance-1e-20",
            shows: "a light of radiance 1e-20",
            samples: 1024,
            exact: 1e-20 * below(1.0, 1.0),
            tolerance: noise,
            scene: || radiance(1e-20),
        },
        Hard {
            id: "radiance-1e30",
            shows: "a light of radiance 1e30",
            samples: 1024,
            exact: 1e30 * below(1.0, 1.0),
            tolerance: noise,
            scene: || radiance(1e30),
        },
        Hard {
            id: "glass-1000-bounces",
            shows: "a glass ball under an even sky, followed for 1000 bounces",
            samples: 32,
            exact: 1.0, // A furnace: what is refracted in and out again has the same radiance.
            tolerance: 1e-3,
            scene: || {
                let ball = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
                let objects = vec![thing(ball, DAffine3::IDENTITY, glass(1.5))];
                let integrator = IntegratorSettings {
                    max_depth: Some(1001),
                    rr_depth: 10_000,
                    ..IntegratorSettings::PATH
                };
                let mut description = spot(DVec3::new(0.2, 0.1, -4.0), DVec3::ZERO, objects, integrator);
                description.lights.push(LightSettings::Constant { radiance: Rgb::WHITE });
                wide(description, 8, 8)
            },
        },
    ]
}

/// The scene on a film of `width` by `height` pixels, seen under 40°.
pub(super) fn wide(mut description: SceneDescription, width: u32, height: u32) -> SceneDescription {
    description.film = FilmSettings { width, height, ..description.film };
    if let Projection::Perspective { fov, .. } = &mut description.camera.projection {
        *fov = 40.0;
    }
    description
}

/// A wall of radiance 1 that fills the view, and a sky of radiance 1 behind it: 1 everywhere.
fn wall() -> SceneDescription {
    let at = rectangle_at(DVec3::new(0.0, 0.0, 2.0), 3.0 * DVec3::Y, 3.0 * DVec3::X);
    let objects = vec![lamp(ShapeSettings::Rectangle, at)];
    let mut description = spot(DVec3::ZERO, DVec3::Z, objects, IntegratorSettings::DIRECT);
    description.lights.push(LightSettings::Constant { radiance: Rgb::WHITE });
    wide(description, 8, 8)
}

fn lens(radius: f64, focus: f64) -> SceneDescription {
    let mut description = wall();
    if let Projection::Perspective { lens_radius, focus_distance, .. } = &mut description.camera.projection {
        (*lens_radius, *focus_distance) = (radius, focus);
    }
    description
}

/// A scene of radiance 1 everywhere.
const EVEN: Hard = Hard { id: "", shows: "", samples: 64, exact: 1.0, tolerance: 1e-6, scene: wall };

fn cameras() -> Vec<Hard> {
    vec![
        Hard { id: "lens-0", shows: "a lens of radius 0", ..EVEN },
        Hard { id: "lens-1e-9", shows: "a lens of radius 1e-9", scene: || lens(1e-9, 2.0), ..EVEN },
        Hard {
            id: "lens-beyond-focus",
            shows: "a lens larger than its distance of focus",
            scene: || lens(5.0, 1.0),
            ..EVEN
        },
        Hard { id: "focus-1e-3", shows: "a lens in focus at 1e-3", scene: || lens(0.1, 1e-3), ..EVEN },
        Hard { id: "focus-1e9", shows: "a lens in focus at 1e9", scene: || lens(0.1, 1e9), ..EVEN },
        Hard { id: "film-1x1", shows: "a film of one pixel", scene: || wide(wall(), 1, 1), ..EVEN },
    ]
}

fn long_film() -> Hard {
    Hard {
        id: "film-1x100000",
        shows: "a film of 1 by 100,000 pixels",
        samples: 1,
        scene: || wide(wall(), 1, 100_000),
        ..EVEN
    }
}

fn long_pixel() -> Hard {
    Hard {
        id: "samples-2-to-the-20",
        shows: "2²⁰ samples in a pixel",
        samples: 1 << 19,
        scene: || wide(wall(), 1, 1),
        ..EVEN
    }
}

/// A disk of radius ½ before an orthographic camera that sees a square of side 2, moved through `keys` in a shutter of `length`.
fn moving(keys: Vec<(f64, DAffine3)>, length: f64) -> SceneDescription {
    let mut disk = lamp(ShapeSettings::Disk, DAffine3::IDENTITY);
    disk.to_world = Motion::keyed(keys).expect("the keys of claims are finite and invertible");
    let mut description =
        spot(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, vec![disk], IntegratorSettings::DIRECT);
    description.camera = CameraSettings {
        projection: Projection::Orthographic,
        shutter: Shutter { close: length, ..Shutter::INSTANT },
        ..description.camera
    };
    description.film = FilmSettings { width: 8, height: 8, ..description.film };
    description
}

/// The disk of half its size, turned by `degrees` about an axis askew in its plane or about its own.
fn disk(degrees: f64) -> DAffine3 {
    DAffine3::from_rotation_z(degrees.to_radians()) * DAffine3::from_scale(DVec3::splat(0.5))
}

fn motions() -> Vec<Hard> {
    // A disk of radius ½ in a square of side 2: of 64 by 64 samples a third lie in pixels that its edge cuts, and have an even
    // error of ½: √(64·64/3)·½/(64·64·0.196) = 2.3 % if they were independent, and a fifth of that as they are.
    let turning = Hard {
        id: "",
        shows: "",
        samples: 32,
        exact: PI / 16.0,
        tolerance: 0.025,
        scene: || moving(vec![], 1.0),
    };
    vec![
        Hard {
            id: "shutter-0",
            shows: "a moving disk in a shutter of length 0",
            scene: || {
                moving(vec![(0.0, disk(0.0)), (1.0, DAffine3::from_translation(DVec3::X) * disk(0.0))], 0.0)
            },
            ..turning
        },
        Hard {
            id: "turn-179.9",
            shows: "a disk that turns by 179.9° about itself while the shutter is open",
            scene: || moving(vec![(0.0, disk(0.0)), (1.0, disk(179.9))], 1.0),
            ..turning
        },
        Hard {
            id: "turn-720",
            shows: "a disk that turns twice about itself while the shutter is open",
            scene: || moving((0..=8).map(|k| (f64::from(k) / 8.0, disk(90.0 * f64::from(k)))).collect(), 1.0),
            ..turning
        },
        Hard {
            id: "motion-1e6",
            shows: "a disk that flies 1e6 away while the shutter is open",
            // It is in the square for the first 1e-6 of the time, during which less and less of it is seen.
            exact: 0.0,
            tolerance: 1e-3,
            scene: || {
                moving(
                    vec![(0.0, disk(0.0)), (1.0, DAffine3::from_translation(1e6 * DVec3::X) * disk(0.0))],
                    1.0,
                )
            },
            ..turning
        },
    ]
}
