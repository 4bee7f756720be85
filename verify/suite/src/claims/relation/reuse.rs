//! Paths that neighbours share give each pixel what its own would.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DVec3};
use renderer::camera::Projection;
use renderer::film::FilmSettings;
use renderer::integrator::reuse::group;
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, Scene};
use renderer::shapes::ShapeSettings;
use verify::claim::{Claim, claim};
use verify::estimate::Moments;
use verify::mean::{joint_control, joint_evidence};

use crate::bounds;
use crate::setup::{
    built, difference_of_images, diffuse, image, lamp, mean, phong, rectangle_at, remembering, spot, thing,
};

/// Samples a pixel and replicate.
const SAMPLES: u32 = 512;

/// Pixels in a row, and rows: those of two groups.
const SIDE: u32 = 4;

/// The rows of an image, and the columns of one by roulette from the first surface on.
const LINES: usize = 2 * SIDE as usize;

pub(super) fn claims() -> Vec<Claim> {
    let rooms = LazyLock::new(|| [u32::MAX, 1].map(|rr| [false, true].map(|reuse| shared(rr, reuse))));
    let rooms = Arc::new(rooms);
    let known = rooms.clone();
    let value = Arc::new(remembering(move |way, seed| pixels(&rooms[way / 2][way % 2], seed)));
    let differences = Arc::new(LazyLock::new(move || {
        let unit = mean(&image(&known[0][0], SamplerKind::Sobol, SAMPLES, 0));
        [difference_of_images(unit, bounds::SHARED); LINES]
    }));
    // What an image made of that with paths of their own, or one with shared paths, has more of in a line.
    let own = |i: usize| 2 * (i / SIDE as usize);
    let more = move |value: &dyn Fn(usize, u64) -> Arc<[f64]>, i: usize, seed: u64| {
        line(i, &value(own(i) + 1, seed)) - line(i, &value(own(i), seed))
    };
    let (differences_2, differences_3) = (differences.clone(), differences.clone());
    let (control, even) = (value.clone(), value.clone());
    let same = claim(
        "relation/reuse/same-lines",
        "paths that neighbours share leave the means of an image's rows and columns as they are",
    )
    .bound(bounds::SHARED)
    .rejects("2.2 × resolution", move |run| {
        joint_control(differences_2.as_slice(), run, |i, seed| more(&*control, i, seed))
    })
    .rejects("pixels that share get the same", move |run| {
        joint_evidence(differences_3.as_slice(), run, |i, seed| {
            let pixels = even(own(i), seed);
            line(i, &evened(&pixels)) - line(i, &pixels)
        })
    })
    .by(move |run| joint_evidence(differences.as_slice(), run, |i, seed| more(&*value, i, seed)));
    vec![same]
}

/// A room seen from above, with paths that neighbours share or not, and with roulette from an edge on: the floor has a dark or a bright
/// stripe in each column, and its light comes from the ceiling, half of it of metal, which a lamp lights from below.
fn shared(rr_depth: u32, reuse: bool) -> Scene {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let face = |centre, side, other, material| {
        thing(ShapeSettings::Rectangle, rectangle_at(centre, side, other), material)
    };
    let stripe = |i: u32| {
        let albedo = if i.is_multiple_of(2) { 0.1 } else { 0.9 };
        face((f64::from(i) * 0.5 - 0.75) * x - y, z, 0.25 * x, diffuse(albedo))
    };
    let mut objects: Vec<_> = (0..SIDE).map(stripe).collect();
    objects.extend([
        face(y - 0.5 * x, 0.5 * x, z, diffuse(0.8)),
        face(y + 0.5 * x, 0.5 * x, z, phong([0.0, 0.9], 20.0)),
        face(-x, y, z, diffuse(0.8)),
        face(x, z, y, diffuse(0.8)),
        face(-z, x, y, diffuse(0.8)),
        face(z, y, x, diffuse(0.8)),
        lamp(ShapeSettings::Rectangle, rectangle_at(0.3 * y, 0.3 * z, 0.3 * x)),
    ]);
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.3, -0.5, 0.2), radius: 0.25 };
    objects.push(thing(ball, DAffine3::IDENTITY, diffuse(0.5)));
    let integrator = IntegratorSettings { max_depth: Some(4), rr_depth, reuse, ..IntegratorSettings::PATH };
    let mut description = spot(0.25 * y, -y, objects, integrator);
    description.film = FilmSettings { width: SIDE, height: SIDE, ..description.film };
    if let Projection::Perspective { fov, .. } = &mut description.camera.projection {
        // As wide as the floor.
        *fov = 2.0 * (1.0_f64 / 1.25).atan().to_degrees();
    }
    built(&description)
}

/// The means of an image's pixels over channels, in the order of [`places`].
fn pixels(scene: &Scene, seed: u64) -> Arc<[f64]> {
    let image = image(scene, SamplerKind::Sobol, SAMPLES, seed);
    image.pixels.iter().map(|pixel| pixel.mean.iter().sum::<f64>() / 3.0).collect()
}

/// Columns and rows of pixels, row by row.
fn places() -> impl Iterator<Item = [u32; 2]> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [x, y]))
}

/// The mean of a row, or after the rows of a column.
fn line(i: usize, pixels: &[f64]) -> f64 {
    let side = SIDE as usize;
    let inside = |[x, y]: [u32; 2]| if i < side { y as usize == i } else { x as usize == i - side };
    let values = places().zip(pixels).filter(|(place, _)| inside(*place)).map(|(_, value)| value);
    values.sum::<f64>() / f64::from(SIDE)
}

/// Each pixel as the mean of those that share with it.
fn evened(pixels: &[f64]) -> Vec<f64> {
    let mean = |place: [u32; 2]| {
        let mates = places().zip(pixels).filter(|(other, _)| group(*other) == group(place));
        mates.map(|(_, value)| value).copied().collect::<Moments>().mean()
    };
    places().map(mean).collect()
}
