//! Lights whose radiance varies over their surface.

use std::sync::{Arc, LazyLock};

use glam::{Affine2, DVec3};
use renderer::math::Rgb;
use renderer::scene::{ObjectSettings, Scene, Strategy};
use renderer::shapes::ShapeSettings;
use renderer::texture::{Bitmap, Filter, Texture, Wrap};
use verify::claim::{Claim, claim};
use verify::irradiance::from_parallel_rectangle;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::PLACES;
use crate::bounds;
use crate::setup::{built, irradiance, lamp, receiver, rectangle_at, remembering};

/// Radiances of the quarters of a rectangle: rows by v, columns by u. All differ, so that no turn or exchange of axes is missed.
const QUARTERS: [[f32; 2]; 2] = [[0.5, 1.0], [2.0, 4.0]];

/// How much brighter the brightest quarter is in a wrong version: 1.6 % of the irradiance where quarters count alike.
const BRIGHTER: f32 = 1.03;

pub(super) fn claims() -> [Claim; 2] {
    [
        textured("irradiance/textured/connected", Strategy::Light, bounds::IRRADIANCE),
        // a direction that meets the light counts many times: the bound of the quick level
        textured("irradiance/textured/found", Strategy::Material, bounds::PIXEL_QUICK),
    ]
}

/// Large lights, near and aside.
const LAMPS: [[f64; 5]; 3] = [PLACES[0], PLACES[5], PLACES[8]];

/// Samples of a replicate.
const SAMPLES: u32 = 4096;

fn textured(id: &str, strategy: Strategy, bound: f64) -> Claim {
    let how = if strategy == Strategy::Light { "points on it" } else { "directions that meet it" };
    let says =
        format!("{how} see the radiance of a bitmap on a rectangle: the sum of its quarters' closed forms");
    let claims = LAMPS
        .map(|place| MeanClaim { rounding: super::ROUNDING, ..MeanClaim::relative(exact(place), bound) });
    let subject = |radiances| {
        let scenes = LazyLock::new(move || LAMPS.map(|place| scene(place, radiances, strategy)));
        Arc::new(remembering(move |i, seed| irradiance(&scenes[i], SAMPLES, seed)))
    };
    let right = subject(QUARTERS);
    let measured = right.clone();
    let [[a, b], [c, d]] = QUARTERS;
    let upside_down = subject([[c, d], [a, b]]);
    let one_brighter = subject([[a, b], [c, BRIGHTER * d]]);
    claim(id, says)
        .bound(bound)
        .rejects("2.2 × resolution", move |run| joint_control(&claims, run, &*measured))
        .rejects("the image upside down", move |run| joint_evidence(&claims, run, &*upside_down))
        .rejects("one quarter 3 % brighter", move |run| joint_evidence(&claims, run, &*one_brighter))
        .by(move |run| joint_evidence(&claims, run, &*right))
}

/// A textured rectangle over the receiver.
fn scene([x, y, a, b, height]: [f64; 5], [upper, lower]: [[f32; 2]; 2], strategy: Strategy) -> Scene {
    let pixels = [upper, lower].concat().into_iter().map(Rgb::splat).collect();
    let image = Bitmap::new([2, 2], pixels, Affine2::IDENTITY, Filter::Nearest, Wrap::Clamp)
        .expect("four finite texels");
    // a × (−b) points down, towards the receiver: u grows along x, v against y
    let to_world = rectangle_at(DVec3::new(x, y, height), a * DVec3::X, -b * DVec3::Y);
    let radiance = Texture::Bitmap(Arc::new(image));
    let lamp = ObjectSettings { radiance, ..lamp(ShapeSettings::Rectangle, to_world) };
    let mut description = receiver(vec![lamp]);
    description.integrator.strategy = strategy;
    built(&description)
}

/// The irradiance [W m⁻²] of such a rectangle.
fn exact([x, y, a, b, height]: [f64; 5]) -> f64 {
    let columns = [[x - a, x], [x, x + a]];
    let rows = [[y, y + b], [y - b, y]];
    let quarter = |row: usize, column: usize| {
        f64::from(QUARTERS[row][column]) * from_parallel_rectangle(columns[column], rows[row], height)
    };
    quarter(0, 0) + quarter(0, 1) + quarter(1, 0) + quarter(1, 1)
}
