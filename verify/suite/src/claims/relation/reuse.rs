//! Paths that neighbours share give each pixel what its own would.

use glam::{DAffine3, DVec3};
use renderer::camera::Projection;
use renderer::film::FilmSettings;
use renderer::integrator::reuse::group;
use renderer::scene::{IntegratorSettings, Scene};
use renderer::shapes::ShapeSettings;
use verify::claim::Claim;
use verify::estimate::Moments;

use super::lines::{Line, SIDE, same_lines};
use crate::bounds;
use crate::setup::{built, diffuse, lamp, phong, rectangle_at, spot, thing};

pub(super) fn claims() -> Vec<Claim> {
    // Rows of an image, and columns of one by roulette from the first surface on, whose means are the same.
    let line = |line: usize| Line { room: line / SIDE as usize, unit: 0, line };
    vec![same_lines(
        [
            "relation/reuse/same-lines",
            "paths that neighbours share leave the means of an image's rows and columns as they are",
        ],
        bounds::SHARED,
        (0..2 * SIDE as usize).map(line).collect(),
        || [u32::MAX, 1].map(|rr| [false, true].map(|reuse| shared(rr, reuse))),
        ("pixels that share get the same", |own, _| evened(own)),
    )]
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

/// Columns and rows of pixels, row by row.
fn places() -> impl Iterator<Item = [u32; 2]> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| [x, y]))
}

/// Each pixel as the mean of those that share with it.
fn evened(pixels: &[f64]) -> Vec<f64> {
    let mean = |place: [u32; 2]| {
        let mates = places().zip(pixels).filter(|(other, _)| group(*other) == group(place));
        mates.map(|(_, value)| value).copied().collect::<Moments>().mean()
    };
    places().map(mean).collect()
}
