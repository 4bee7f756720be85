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
const FILM: [u32; 2] = [2, 2];

/// The pixels looked at, column and row: an exchange of axes, or a turn of one, brings another part of the surface there.
const PIXELS: [[u32; 2]; 2] = [[1, 0], [0, 1]];

/// Half sides of the meter, in the plane z = 0.
const HALF: [f64; 2] = [0.6, 0.5];

/// The lamp's ranges of x and y, and its height: aside, so that no two pixels are alike, and large, since a direction that meets it
/// counts 1/p times where p meet it, with the variance 1/p − 1.
const LAMP: ([f64; 2], [f64; 2], f64) = ([-0.8, 2.6], [-1.4, 1.8], 0.7);

pub(super) fn claims() -> [Claim; 2] {
    [
        pixels("irradiance/meter/quick", bounds::PIXEL_QUICK, 512),
        pixels("irradiance/meter/pixels", bounds::IRRADIANCE, 8192).from_level(Level::Standard),
    ]
}

/// * `samples`: of a pixel and replicate.
fn pixels(id: &str, bound: f64, samples: u32) -> Claim {
    let says =
        "pixels of an irradiance meter under a rectangle are the means of the closed form over their parts";
    let right = Pixels::new(bound, samples);
    let (control, flipped, radiance) = (right.clone(), right.clone(), right.clone());
    claim(id, says)
        .bound(bound)
        .rejects("2.2 × resolution", move |run| joint_control(&control.claims, run, &*control.measured))
        .rejects("axes exchanged", move |run| {
            joint_evidence(&flipped.claims, run, |k, seed| (flipped.measured)(1 - k, seed))
        })
        .rejects("mean radiance for irradiance", move |run| {
            joint_evidence(&radiance.claims, run, |k, seed| (radiance.measured)(k, seed) / PI)
        })
        .by(move |run| joint_evidence(&right.claims, run, &*right.measured))
}

/// What each pixel should be, and what it is in a replicate of that seed.
#[derive(Clone)]
struct Pixels {
    claims: Arc<[MeanClaim]>,
    measured: Arc<dyn Fn(usize, u64) -> f64 + Send + Sync>,
}

impl Pixels {
    fn new(bound: f64, samples: u32) -> Self {
        let of_pixel =
            |pixel| MeanClaim { rounding: super::ROUNDING, ..MeanClaim::relative(exact(pixel), bound) };
        let scene = LazyLock::new(metered);
        let measured = move |k: usize, seed| {
            let [column, row] = PIXELS[k];
            let pixel = (row * FILM[0] + column) as usize;
            image(&scene, SamplerKind::Sobol, samples, seed).pixels[pixel].mean[0]
        };
        Self { claims: PIXELS.map(of_pixel).into(), measured: Arc::new(remembering(measured)) }
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
fn exact([column, row]: [u32; 2]) -> f64 {
    let part = |k: u32, count: u32, half: f64| {
        [k, k + 1].map(|edge| half * (2.0 * f64::from(edge) / f64::from(count) - 1.0))
    };
    let (x, y) = (part(column, FILM[0], HALF[0]), part(row, FILM[1], HALF[1]));
    between_parallel_rectangles([x, y], [LAMP.0, LAMP.1], LAMP.2)
}
