//! Anti-aliasing: an edge at any angle through each filter, against the filter's integral over the half-plane.

use renderer::film::Filter;
use renderer::scene::SceneDescription;
use verify::claim::{Claim, Level};

use super::super::film::{Exact, Films};
use super::kernel;
use crate::bounds;
use crate::setup::{flat, half_plane, pixel_middles};

/// Pixels of a row.
const ROW: [u32; 2] = [8, 1];

/// Angles of the edges' normals to the row: upright, leaning, and nearly along the row, where the blur spans it.
const ANGLES: [f64; 3] = [0.0, 0.4, 1.1];

/// Distance of the edge from the film's middle.
const EDGE: f64 = 0.3;

/// A filter, how far the image is shifted to the right, and which way the edges lean.
type Parameter = (Filter, f64, f64);

fn rows((filter, shift, lean): Parameter) -> Vec<SceneDescription> {
    let row = |angle: f64| {
        let mut description = flat(ROW, vec![half_plane(EDGE + shift * angle.cos(), lean * angle)]);
        description.film.filter = filter;
        description
    };
    ANGLES.map(row).into()
}

/// The distance from a pixel's middle to the edge is what its value depends on.
fn exact(filter: Filter) -> Vec<Exact> {
    let kernel = kernel(filter);
    let row = |angle: f64| {
        let distances: Vec<f64> =
            pixel_middles(ROW).iter().map(|p| EDGE - p[0] * angle.cos() - p[1] * angle.sin()).collect();
        let axes = ["distance from the pixel to the edge, pixels", "radiance"];
        Exact::on_curve(axes, &distances, |d| kernel.edge(d, angle))
    };
    ANGLES.map(row).into()
}

pub(super) fn any_angle(name: &'static str, filter: Filter) -> Claim {
    let wider = match filter {
        Filter::Box { radius } => Filter::Box { radius: 2.0 * radius },
        Filter::Tent { radius } => Filter::Tent { radius: 2.0 * radius },
        Filter::Gaussian { stddev } => Filter::Gaussian { stddev: std::f64::consts::SQRT_2 * stddev },
        Filter::Mitchell { .. } => Filter::Mitchell { b: 1.0, c: 0.0 },
        Filter::Lanczos { .. } => Filter::Lanczos { lobes: 2.0 },
    };
    Films {
        id: format!("filter/{name}/edge"),
        says: format!("pixels along an edge at any angle are the {name} filter's share of the half-plane"),
        level: Level::Standard,
        samples: match filter {
            // Large negative lobes leave signed weights four times the noise.
            Filter::Mitchell { b: 0.0, .. } => 8192,
            Filter::Lanczos { .. } => 16_384,
            Filter::Mitchell { .. } => 4096,
            Filter::Gaussian { .. } => 4096,
            Filter::Box { .. } | Filter::Tent { .. } => 2048,
        },
        unit: 1.0,
        bound: bounds::PIXEL,
        right: (filter, 0.0, 1.0),
        wrong: vec![("half a pixel to the right", (filter, 0.5, 1.0)), ("another width", (wider, 0.0, 1.0))],
    }
    .claim(rows, move || exact(filter))
}

/// The same for one filter in little time.
pub(super) fn representative() -> Claim {
    let filter = Filter::Tent { radius: 1.0 };
    Films {
        id: String::from("filter/tent/edge-quick"),
        says: String::from("pixels along an edge are the tent's share of the half-plane"),
        level: Level::Quick,
        samples: 128,
        unit: 1.0,
        bound: bounds::PIXEL_QUICK,
        right: (filter, 0.0, 1.0),
        wrong: vec![("half a pixel to the right", (filter, 0.5, 1.0))],
    }
    .claim(rows, move || exact(filter))
}
