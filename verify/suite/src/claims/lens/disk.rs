//! Depth of field of small things: a bright disk out of focus, its image, its flux, and where a point's light goes.

use glam::DVec3;
use renderer::camera::Camera;
use renderer::sampling::warp::square_to_disk;
use renderer::scene::{Scene, SceneDescription};
use renderer::shapes::ShapeSettings;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, OnceLock};
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level, Run, claim};
use verify::coverage::{circle_in_rectangle, lens_area};
use verify::domain::Disk;
use verify::estimate::Replicate;
use verify::lens::circle_of_confusion;
use verify::mean::{FEWEST_REPLICATES, MeanClaim, judge, judge_moved};
use verify::quadrature::{Tolerance, integrate_2d};
use verify::seeds::derive;

use super::super::film::{Exact, Films};
use super::super::pointwise::single;
use super::edge::{FOCUS, lens_view};
use crate::setup::{built, image, lamp, pixel_middles, rectangle_at};
use crate::{bounds, wrong};

/// Pixels of the film.
const SIZE: [u32; 2] = [7, 7];

/// The middle rows of it, for an image pixel by pixel.
const STRIP: [u32; 2] = [7, 3];

/// Depth of the disk, and radius of the lens: the circle of confusion has the radius 2.25.
const DEPTH: f64 = 16.0;
const APERTURE: f64 = 9.0;

/// Radius of the disk as it is seen, in pixels, and its middle.
const SEEN: f64 = 1.1;
const MIDDLE: [f64; 2] = [0.1, -0.05];

pub(super) fn claims() -> Vec<Claim> {
    vec![spot_image(), flux(), point()]
}

/// A bright disk at `depth`, seen through a lens of radius `aperture`.
fn disk(size: [u32; 2], aperture: f64, depth: f64) -> SceneDescription {
    let scale = depth / FOCUS;
    let middle = DVec3::new(MIDDLE[0] * scale, MIDDLE[1] * scale, -depth);
    let radius = SEEN * scale;
    let shape = rectangle_at(middle, radius * DVec3::X, radius * DVec3::Y);
    lens_view(size, aperture, vec![lamp(ShapeSettings::Disk, shape)])
}

/// The share of the lens through which a point of the image sees the disk, `distance` from its middle.
fn share(aperture: f64, distance: f64) -> f64 {
    let confusion = circle_of_confusion(aperture, FOCUS, DEPTH);
    if confusion == 0.0 {
        return f64::from(u8::from(distance < SEEN));
    }
    lens_area(confusion, SEEN, distance) / (PI * confusion * confusion)
}

/// What a pixel shows of the disk, and how far its middle is from the disk's.
fn pixel(aperture: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (x, y) = (x - MIDDLE[0], y - MIDDLE[1]);
    let range = [[x - 0.5, x + 0.5], [y - 0.5, y + 0.5]];
    if aperture == 0.0 {
        return [x.hypot(y), circle_in_rectangle(SEEN, range)];
    }
    let tolerance = Tolerance { relative: 0.0, absolute: 1e-6, pieces: 4000 };
    [x.hypot(y), integrate_2d(&|[x, y]: [f64; 2]| share(aperture, x.hypot(y)), range, tolerance).value]
}

fn spot_image() -> Claim {
    let exact = || {
        let pixels: Vec<[f64; 2]> =
            pixel_middles(STRIP).into_iter().map(|middle| pixel(APERTURE, middle)).collect();
        let mut exact = Exact::pixels(["distance from the disk's middle, pixels", "radiance"], pixels);
        exact.curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
        vec![exact]
    };
    Films {
        id: String::from("lens/disk/image"),
        says: String::from(
            "a disk out of focus is seen through the share of the lens that two overlapping disks have",
        ),
        level: Level::Standard,
        samples: 8192,
        unit: 1.0,
        bound: bounds::PIXEL,
        right: [APERTURE, DEPTH],
        wrong: vec![
            ("a diameter taken for a radius", [2.0 * APERTURE, DEPTH]),
            ("as far behind the focus", [APERTURE, 2.0 * FOCUS - DEPTH]),
            ("a lens 5 % smaller", [0.95 * APERTURE, DEPTH]),
        ],
    }
    .claim(|[aperture, depth]| vec![disk(STRIP, aperture, depth)], exact)
}

/// Radii of the lens for the flux.
const APERTURES: [f64; 3] = [0.0, 4.0, APERTURE];

/// What the whole film sees of the disk, and the mean square distance from its middle times that.
fn moments(scene: &Scene, samples: u32, seed: u64) -> [f64; 2] {
    let rendering = image(scene, renderer::sampling::SamplerKind::Sobol, samples, seed);
    let mut sums = [0.0; 2];
    for (middle, pixel) in pixel_middles(SIZE).into_iter().zip(&rendering.pixels) {
        let square = (middle[0] - MIDDLE[0]).powi(2) + (middle[1] - MIDDLE[1]).powi(2);
        sums[0] += pixel.mean[0];
        sums[1] += pixel.mean[0] * square;
    }
    sums
}

/// Samples a pixel and replicate for each of them: more where the disk is spread over more pixels.
const SAMPLES: [u32; 3] = [8192, 16_384, 16_384];

/// Both moments of each aperture, times a factor, in the run's replicates, of so many times fewer samples.
///
/// Two moments of one image have their noise in common: the test at the level of independent ones is conservative then (Šidák 1967,
/// 10.1080/01621459.1967.10482935).
fn all_moments(run: &Run, factor: f64, fewer: u32) -> Vec<Vec<Replicate>> {
    let of = |(stream, (aperture, samples)): (u64, (f64, u32))| {
        let scene = built(&disk(SIZE, factor * aperture, DEPTH));
        let seeds = (0..FEWEST_REPLICATES * run.effort).map(|i| derive(run.seed, stream, i));
        let both = seeds.map(|seed| moments(&scene, samples / fewer, seed).map(Replicate::from));
        let (flux, square) = both.map(|[flux, square]| (flux, square)).unzip();
        [flux, square]
    };
    (0..).zip(APERTURES.into_iter().zip(SAMPLES)).flat_map(of).collect()
}

/// The exact moments: the disk's area, and the second moment of the exact pixels.
fn exact_moments() -> Vec<MeanClaim> {
    let of = |aperture: f64| {
        let area = PI * SEEN * SEEN;
        let squares = pixel_middles(SIZE).into_iter().map(|middle| pixel(aperture, middle));
        let square: f64 = squares.map(|[distance, value]| value * distance * distance).sum();
        [area, square].map(|exact| MeanClaim { rounding: 1e-6, ..MeanClaim::relative(exact, bounds::FLUX) })
    };
    APERTURES.map(of).as_flattened().to_vec()
}

/// For each aperture: the flux is the disk's area; and the second moment of the image is that of its exact pixels, which grows
/// with the squared radius of the circle of confusion.
fn flux() -> Claim {
    let claims = Arc::new(LazyLock::new(exact_moments));
    let (claims_2, claims_3) = (claims.clone(), claims.clone());
    // The first run's, which the control moves.
    let first: Arc<OnceLock<(Run, Vec<Vec<Replicate>>)>> = Arc::default();
    let known = move |run: &Run| {
        let (known, values) = first.get_or_init(|| (*run, all_moments(run, 1.0, 1)));
        if known == run { values.clone() } else { all_moments(run, 1.0, 1) }
    };
    let same = known.clone();
    claim(
        "lens/flux/any-aperture",
        "a wider lens spreads a disk's light and keeps its flux; the image's second moment grows by half the squared radius of the circle of confusion",
    )
    .rejects("2.2 × resolution", move |run| judge_moved(&claims_2, same(run)))
    .rejects("a lens 10 % wider", move |run| judge(&claims_3, &all_moments(run, 1.1, 32)))
    .by(move |run: &Run| judge(&claims, &known(run)))
    .from_level(Level::Standard)
}

/// Where on the film, in pixels from the middle, a point on the axis at [`DEPTH`] is seen through the point `u` of the lens.
///
/// The place p of the image whose ray through that point of the lens meets the point: where the ray of p = 0 passes it, over
/// what a step of p moves it.
fn seen_at(camera: &Camera, u: [f64; 2]) -> [f64; 2] {
    let zeta = square_to_disk(u.map(single)).to_array();
    let passes = |p: [f32; 2]| {
        let ray = camera.lens_ray(p, zeta, 0.0);
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        o + (-DEPTH - o.z) / d.z * d
    };
    let missed = passes([0.0; 2]);
    let step = [passes([1.0, 0.0]).x - missed.x, passes([0.0, 1.0]).y - missed.y];
    let half = 0.5 * f64::from(SIZE[0]);
    // Rounding to f32 must not leave the disk: 1e-6 are sixteen roundings.
    [-missed.x / step[0], -missed.y / step[1]].map(|p| (1.0 - 1e-6) * half * p)
}

/// A point out of focus becomes a uniform disk.
fn point() -> Claim {
    let camera = built(&disk(SIZE, APERTURE, DEPTH)).camera;
    let wider = built(&disk(SIZE, 0.98 * APERTURE, DEPTH)).camera;
    ChiSquare::on(Disk::of_radius(circle_of_confusion(APERTURE, FOCUS, DEPTH)))
        .samples(move |u: [f64; 2]| Some(seen_at(&camera, u)))
        .bound(bounds::RECORDED)
        .rejects("a lens 2 % smaller", move |u: [f64; 2]| Some(seen_at(&wider, u)))
        .rejects("radius ξ in the place of √ξ", |u: [f64; 2]| {
            let confusion = circle_of_confusion(APERTURE, FOCUS, DEPTH);
            Some(wrong::disk_without_root(u).map(|c| confusion * c))
        })
        .claim("lens/point/disk", "a point out of focus is a uniform disk of the radius A·|1 − Sf/S|")
        .from_level(Level::Standard)
}
