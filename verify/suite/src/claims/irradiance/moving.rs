//! A light that moves and grows while the shutter is open.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DVec3};
use renderer::camera::Shutter;
use renderer::math::transform::Motion;
use renderer::scene::{ObjectSettings, Scene};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, claim};
use verify::irradiance::from_parallel_rectangle;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::quadrature::{Tolerance, integrate};

use crate::bounds;
use crate::setup::{built, irradiance, lamp, receiver, rectangle_at, remembering};

/// The middle's x and y, the half sides and the height, as the shutter opens at 0 and as it closes at 1.
type Ends = [[f64; 5]; 2];

/// One far aside that comes near and grows, and one overhead that leaves, grows in one direction and shrinks in the other.
const LAMPS: [Ends; 2] = [
    [[-1.6, 0.4, 0.2, 0.3, 0.7], [0.2, -0.3, 0.9, 0.5, 1.1]],
    [[0.1, 0.0, 0.5, 0.4, 0.8], [1.4, 0.9, 1.0, 0.2, 2.0]],
];

/// Samples of a replicate.
const SAMPLES: u32 = 1024;

/// What lies between two ends at a time.
fn between([from, to]: Ends, time: f64) -> [f64; 5] {
    std::array::from_fn(|i| from[i] + time * (to[i] - from[i]))
}

pub(super) fn moments() -> Claim {
    let exact = |ends: Ends| {
        let at = |time: f64| {
            let [x, y, a, b, height] = between(ends, time);
            from_parallel_rectangle([x - a, x + a], [y - b, y + b], height)
        };
        integrate(&at, [0.0, 1.0], Tolerance { relative: 1e-9, absolute: 0.0, pieces: 1000 }).value
    };
    let claims = LAMPS.map(|ends| MeanClaim {
        rounding: super::ROUNDING,
        ..MeanClaim::relative(exact(ends), bounds::IRRADIANCE)
    });
    // A lamp whose motion takes place in another part of the time.
    let subject = |from: f64, to: f64| {
        let scenes = LazyLock::new(move || LAMPS.map(|ends| scene([between(ends, from), between(ends, to)])));
        Arc::new(remembering(move |i, seed| irradiance(&scenes[i], SAMPLES, seed)))
    };
    let (right, opening, short) = (subject(0.0, 1.0), subject(0.0, 1e-9), subject(0.0, 0.97));
    let measured = right.clone();
    claim(
        "irradiance/rectangle/moving",
        "a rectangle that moves and grows gives the mean over the shutter's time",
    )
    .bound(bounds::IRRADIANCE)
    .rejects("2.2 × resolution", move |run| joint_control(&claims, run, &*measured))
    .rejects("the light as the shutter opens", move |run| joint_evidence(&claims, run, &*opening))
    .rejects("a motion 3 % short", move |run| joint_evidence(&claims, run, &*short))
    .by(move |run| joint_evidence(&claims, run, &*right))
}

fn scene(ends: Ends) -> Scene {
    // a × (−b) points down, towards the receiver
    let place =
        |[x, y, a, b, height]: [f64; 5]| rectangle_at(DVec3::new(x, y, height), a * DVec3::X, -b * DVec3::Y);
    let to_world =
        Motion::keyed([0.0, 1.0].into_iter().zip(ends.map(place)).collect()).expect("two keys in order");
    let lamp = ObjectSettings { to_world, ..lamp(ShapeSettings::Rectangle, DAffine3::IDENTITY) };
    let mut description = receiver(vec![lamp]);
    description.camera.shutter = Shutter::new(0.0, 1.0).expect("0 is before 1");
    built(&description)
}
