//! A surface that measures the irradiance on it, pixel by pixel.

use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use glam::DVec3;
use renderer::camera::Projection;
use renderer::film::FilmSettings;
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, Scene};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, Level, claim};
use verify::irradiance::between_parallel_rectangles;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use crate::bounds;
use crate::setup::{built, diffuse, image, lamp, rectangle_at, remembering, spot, thing};

/// Columns and rows of the film.
const FILM: [u32; 2] = [3, 2];

/// Half sides of the meter, in the plane z = 0.
const HALF: [f64; 2] = [0.6, 0.5];

/// The lamp's ranges of x and y, and its height: over one corner, so that no two pixels are alike.
const LAMP: ([f64; 2], [f64; 2], f64) = ([0.1, 1.3], [0.2, 0.9], 0.7);

/// Samples a pixel and replicate.
const SAMPLES: u32 = 8192;

pub(super) fn claim_of_pixels() -> Claim {
    let says =
        "pixels of an irradiance meter under a rectangle are the means of the closed form over their parts";
    let right = Pixels::new();
    let (control, flipped, radiance) = (right.clone(), right.clone(), right.clone());
    let below = FILM[0] as usize;
    claim("irradiance/meter/pixels", says)
        .bound(bounds::IRRADIANCE)
        .rejects("2.2 × resolution", move |run| joint_control(&control.claims, run, &*control.measured))
        .rejects("rows from the bottom", move |run| {
            joint_evidence(&flipped.claims, run, |k, seed| {
                (flipped.measured)((k + below) % (2 * below), seed)
            })
        })
        .rejects("mean radiance for irradiance", move |run| {
            joint_evidence(&radiance.claims, run, |k, seed| (radiance.measured)(k, seed) / PI)
        })
        .by(move |run| joint_evidence(&right.claims, run, &*right.measured))
        .from_level(Level::Standard)
}

/// What each pixel should be, and what it is in a replicate of that seed.
#[derive(Clone)]
struct Pixels {
    claims: Arc<[MeanClaim]>,
    measured: Arc<dyn Fn(usize, u64) -> f64 + Send + Sync>,
}

impl Pixels {
    fn new() -> Self {
        let exact = |pixel| MeanClaim::relative(exact(pixel), bounds::IRRADIANCE);
        let rounding = super::ROUNDING;
        let claims = (0..FILM[0] * FILM[1]).map(|k| MeanClaim { rounding, ..exact(k) }).collect();
        let scene = LazyLock::new(metered);
        let of = move |k: usize, seed| image(&scene, SamplerKind::Sobol, SAMPLES, seed).pixels[k].mean[0];
        Self { claims, measured: Arc::new(remembering(of)) }
    }
}

/// The meter's scene.
fn metered() -> Scene {
    let ([x0, x1], [y0, y1], z) = LAMP;
    let (centre, half) =
        (DVec3::new(x0 + x1, y0 + y1, 2.0 * z) * 0.5, DVec3::new(x1 - x0, y1 - y0, 0.0) * 0.5);
    let plate = rectangle_at(DVec3::ZERO, HALF[0] * DVec3::X, HALF[1] * DVec3::Y);
    let objects = vec![
        // a × (−b) points down, towards the meter
        lamp(ShapeSettings::Rectangle, rectangle_at(centre, half.x * DVec3::X, -half.y * DVec3::Y)),
        thing(ShapeSettings::Rectangle, plate, diffuse(0.5)),
    ];
    let integrator = IntegratorSettings { max_depth: Some(1), ..IntegratorSettings::DIRECT };
    let mut description = spot(DVec3::Z, DVec3::ZERO, objects, integrator);
    description.camera.projection = Projection::IrradianceMeter { object: 1 };
    description.film = FilmSettings { width: FILM[0], height: FILM[1], ..description.film };
    built(&description)
}

/// The mean irradiance of a pixel: columns along the meter's own x, rows along its own y.
fn exact(pixel: u32) -> f64 {
    let part = |k: u32, count: u32, half: f64| {
        [k, k + 1].map(|edge| half * (2.0 * f64::from(edge) / f64::from(count) - 1.0))
    };
    let (x, y) = (part(pixel % FILM[0], FILM[0], HALF[0]), part(pixel / FILM[0], FILM[1], HALF[1]));
    between_parallel_rectangles([x, y], [LAMP.0, LAMP.1], LAMP.2)
}
