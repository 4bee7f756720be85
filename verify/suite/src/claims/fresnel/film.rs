//! Reflection and refraction as images: the reflectance from 5° to 85° in 1,000 pixels, and an edge seen through a slab.

use glam::{DAffine3, DVec3};
use renderer::camera::Projection;
use renderer::film::FilmSettings;
use renderer::math::Rgb;
use renderer::scene::{Branch, IntegratorSettings, LightSettings, SceneDescription};
use renderer::shapes::ShapeSettings;
use std::f64::consts::FRAC_1_SQRT_2;
use verify::claim::{Claim, Level};
use verify::filter::Kernel;
use verify::fresnel::{reflectance, slab_shift};
use verify::quadrature::{Tolerance, integrate};

use super::super::film::{Exact, Films};
use crate::bounds;
use crate::setup::{diffuse, fixed, glass, half_plane, look, pixel_middles, spot, thing};

pub(super) fn claims() -> Vec<Claim> {
    vec![curve(), edge()]
}

/// Index of the glass.
const ETA: f64 = 1.5;

#[expect(clippy::cast_possible_truncation, reason = "the renderer's indices are f32")]
fn single(eta: f64) -> f32 {
    eta as f32
}

/// Pixels from 5° to 85°.
const ANGLES: [u32; 2] = [1000, 1];

/// Half the view at distance 1: tan 40°.
const HALF: f64 = 0.839_099_631_177_28;

/// A sheet of glass over a black floor in light from everywhere, seen at 45° with the image's right towards the point below the eye.
fn sheet(eta: f64) -> SceneDescription {
    let scaled = |side: f64, z: f64| {
        DAffine3::from_translation(z * DVec3::Z) * DAffine3::from_scale(DVec3::new(side, side, 1.0))
    };
    let objects = vec![
        thing(ShapeSettings::Rectangle, scaled(1000.0, 0.0), glass(single(eta))),
        thing(ShapeSettings::Rectangle, scaled(2000.0, -1.0), diffuse(0.0)),
    ];
    let (eye, target) = (DVec3::Z, DVec3::Y);
    let integrator = IntegratorSettings { branch: Branch::Both, ..IntegratorSettings::DIRECT };
    let mut description = spot(eye, target, objects, integrator);
    description.film = FilmSettings { width: ANGLES[0], height: ANGLES[1], ..description.film };
    description.camera.to_world = fixed(look(eye, target, DVec3::X));
    if let Projection::Perspective { fov, .. } = &mut description.camera.projection {
        *fov = 80.0;
    }
    description.lights = vec![LightSettings::Constant { radiance: Rgb::WHITE }];
    description
}

fn curve() -> Claim {
    let exact = || {
        let scale = HALF / (0.5 * f64::from(ANGLES[0]));
        // The cosine at x, in the plane of incidence; a pixel's half height changes it by 3.5e-7 of itself.
        let cosine = |x: f64| (1.0 + x) * FRAC_1_SQRT_2 / (1.0 + x * x).sqrt();
        let pixel = |[x, _]: [f64; 2]| {
            let range = [scale * (x - 0.5), scale * (x + 0.5)];
            let tolerance = Tolerance { relative: 1e-9, absolute: 0.0, pieces: 50 };
            let mean = integrate(&|x: f64| reflectance(cosine(x), ETA), range, tolerance).value / scale;
            [cosine(scale * x).acos().to_degrees(), mean]
        };
        let mut exact = Exact::pixels(
            ["angle of incidence, degrees", "reflectance"],
            pixel_middles(ANGLES).into_iter().map(pixel).collect(),
        );
        exact.curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
        vec![exact]
    };
    Films {
        id: String::from("fresnel/film/angles"),
        says: String::from(
            "a sheet of glass reflects what Fresnel's equations say in each of 1,000 pixels from 5° to 85°",
        ),
        level: Level::Standard,
        samples: 16,
        unit: 1.0,
        bound: bounds::PIXEL,
        right: ETA,
        wrong: vec![("index 1 % too large", 1.01 * ETA), ("the index of water", 1.33)],
    }
    .claim(|eta| vec![sheet(eta)], exact)
}

/// Pixels of the row that sees the edge.
const ROW: [u32; 2] = [8, 1];

/// The angle of view to the slab's normal, and where the edge is below it.
const TILT: f64 = 0.9;
const EDGE: f64 = 0.3;

/// A half-plane at z = −2 seen by parallel rays through a slab from z = 0 to −1; paths of three edges see it without echoes.
fn through_slab([eta, shift]: [f64; 2]) -> SceneDescription {
    let mut lamp = half_plane(EDGE + shift, 0.0);
    lamp.to_world = fixed(DAffine3::from_translation(-2.0 * DVec3::Z) * lamp.to_world.at(0.0));
    let slab = DAffine3::from_translation(-0.5 * DVec3::Z) * DAffine3::from_scale(DVec3::new(1e3, 1e3, 0.5));
    let objects = vec![lamp, thing(ShapeSettings::Cube, slab, glass(single(eta)))];
    let integrator =
        IntegratorSettings { branch: Branch::Both, max_depth: Some(3), ..IntegratorSettings::PATH };
    let eye = 10.0 * DVec3::new(-TILT.sin(), 0.0, TILT.cos());
    let mut description = spot(eye, DVec3::ZERO, objects, integrator);
    let half = 0.5 * f64::from(ROW[0]);
    description.camera.projection = Projection::Orthographic;
    description.camera.to_world =
        fixed(look(eye, DVec3::ZERO, DVec3::Y) * DAffine3::from_scale(DVec3::new(half, half, 1.0)));
    description.film = FilmSettings { width: ROW[0], height: ROW[1], ..description.film };
    description
}

fn edge() -> Claim {
    let exact = || {
        // A ray that meets z = 0 at x reaches z = −2 at x + 2 tan i without the slab, and less far by its shift with it.
        let seen = TILT.cos() * (EDGE - 2.0 * TILT.tan() + slab_shift(1.0, TILT.sin(), ETA));
        let through = (1.0 - reflectance(TILT.cos(), ETA)).powi(2);
        let pixel = Kernel::Box { radius: 0.5 };
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| p[0]).collect();
        let value = |x: f64| through * pixel.edge(seen - x, 0.0);
        vec![Exact::on_curve(["pixel, from the middle", "radiance"], &positions, value)]
    };
    Films {
        id: String::from("fresnel/film/snell"),
        says: String::from(
            "an edge behind a slab is seen where Snell's law puts it, as bright as two faces let through",
        ),
        level: Level::Standard,
        samples: 512,
        unit: (1.0 - reflectance(TILT.cos(), ETA)).powi(2),
        bound: bounds::PIXEL,
        right: [ETA, 0.0],
        wrong: vec![
            ("index 2 % too large", [1.02 * ETA, 0.0]),
            ("half a pixel to the right", [ETA, 0.5]),
            ("as without the slab", [1.0, 0.0]),
        ],
    }
    .claim(|parameter| vec![through_slab(parameter)], exact)
}
