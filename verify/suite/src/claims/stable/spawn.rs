//! Rays that leave a surface don't meet it again, and do meet what is close to it.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use renderer::interaction::SurfacePoint;
use renderer::ray::Ray;
use renderer::shapes::{MeshData, Shape, ShapeSettings};
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::share;

use super::numbers::Numbers;
use super::routine::single;

/// Rays from each shape.
const RAYS: usize = 1000;

/// Of which so many from one point.
const DIRECTIONS: usize = 25;

/// Distance of a neighbour that must be met, relative to the largest coordinate of shape and point.
const NEIGHBOUR: f64 = 1e-4;

/// How a ray starts from a surface.
type Start = fn(&SurfacePoint, Vec3) -> Ray;

const OURS: Start = |surface, direction| surface.spawn(direction, 0.0);

pub(super) fn claims() -> Vec<Claim> {
    let at_once: Start = |surface, direction| Ray::new(surface.point, direction, 0.0);
    let fixed: Start = |surface, direction| Ray::new(surface.point + direction * 1e-4, direction, 0.0);
    let far: Start = |surface, direction| {
        let size = surface.point.abs().max_element();
        Ray::new(surface.point + direction * (3.0e-4 * size), direction, 0.0)
    };
    let hits = |quick: bool, id: &str| {
        let trials = move |run: &Run| if quick { 20 * run.effort } else { 1000 * run.effort };
        claim(
            format!("stable/spawn/{id}"),
            "rays spawned on shapes of sizes 1e-8 to 1e8 don't meet them again",
        )
        .rejects("no offset", move |run| again(run, trials(run), at_once))
        .rejects("an offset of 1e-4 along the ray", move |run| again(run, trials(run), fixed))
        .by(move |run| again(run, trials(run), OURS))
    };
    let misses = |quick: bool, id: &str| {
        let trials = move |run: &Run| if quick { 20 * run.effort } else { 1000 * run.effort };
        let says =
            "rays spawned on shapes of sizes 1e-8 to 1e8 meet a neighbour at 1e-4 of the largest coordinate";
        let builder = claim(format!("stable/spawn/{id}"), says)
            .rejects("3 × the neighbour's distance", move |run| past(run, trials(run), far));
        // It is too far where the largest of four log-uniform numbers is below 1, at a sixteenth of the shapes: twenty may
        // have none of these, a thousand do with probability 1 − 1e-28.
        let builder = if quick {
            builder
        } else {
            builder.rejects("an offset of 1e-4 along the ray", move |run| past(run, trials(run), fixed))
        };
        builder.by(move |run| past(run, trials(run), OURS))
    };
    vec![
        hits(true, "self"),
        misses(true, "neighbour"),
        hits(false, "self-1000-shapes").from_level(Level::Standard),
        misses(false, "neighbour-1000-shapes").from_level(Level::Standard),
    ]
}

/// A shape whose coordinates and sizes have logarithms uniform between those of 1e-8 and 1e8.
fn shape(n: &Numbers) -> Option<Shape> {
    let size = || n.log(1e-8, 1e8);
    let place = || DVec3::new(n.sign() * size(), n.sign() * size(), n.sign() * size());
    let settings = match n.unit() * 5.0 {
        k if k < 1.0 => {
            let positions = [place(), place(), place()].map(|p| p.as_vec3().to_array());
            let data =
                MeshData { positions: positions.into(), triangles: vec![[0, 1, 2]], ..MeshData::default() };
            return Shape::new(&ShapeSettings::Mesh(Arc::new(data)), &DAffine3::IDENTITY, false).ok();
        }
        k if k < 2.0 => ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 },
        k if k < 3.0 => ShapeSettings::Rectangle,
        k if k < 4.0 => ShapeSettings::Disk,
        _ => ShapeSettings::Cylinder { p0: DVec3::ZERO, p1: DVec3::Z, radius: 0.5 },
    };
    let turn = DMat3::from_quat(glam::DQuat::from_scaled_axis(3.0 * n.unit() * n.direction()));
    let map = DAffine3 { matrix3: turn * size(), translation: place() };
    Shape::new(&settings, &map, false).ok()
}

/// A point of a shape that a ray met.
struct Met {
    surface: SurfacePoint,
    /// Parallel neighbours at the distance at which they must be met, on the normal's side and on the other.
    neighbours: [Shape; 2],
}

impl Met {
    fn on(shape: &Shape, n: &Numbers) -> Option<Self> {
        let target = shape.sample_area([single(n.unit()), single(n.unit())]);
        let bounds = shape.bounds();
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let off = target.ng.as_dvec3() * n.log(1e-3, 1.0) + 0.1 * n.direction();
        let from = (target.point.as_dvec3() + largest * off).as_vec3();
        let ray = Ray::new(from, (target.point - from).try_normalize()?, 0.0);
        let surface = shape.surface(0, &shape.intersect(0, &ray)?, &ray);
        let normal = surface.ng.as_dvec3();
        let (x, y) = normal.any_orthonormal_pair();
        let away = NEIGHBOUR * largest;
        let neighbour = |side: f64| {
            // It reaches a hundred times its distance: rays within 60° of the normal don't pass beside it.
            let map = DAffine3 {
                matrix3: DMat3::from_cols(x, y, normal) * (100.0 * away),
                translation: surface.point.as_dvec3() + normal * (away * side),
            };
            Shape::new(&ShapeSettings::Rectangle, &map, false).ok()
        };
        Some(Self { surface, neighbours: [neighbour(1.0)?, neighbour(-1.0)?] })
    }
}

/// Calls `bad` with points of each shape and directions there, `None` for one that says nothing; counts what is bad.
fn judge(
    run: &Run,
    shapes: u64,
    bad: impl Fn(&Shape, &Met, Vec3) -> Option<bool>,
) -> Result<Evidence, InputError> {
    let (mut count, mut trials, mut used) = (0, 0, 0);
    for index in 0.. {
        let n = Numbers::new(run.seed, index);
        let Some(shape) = shape(&n) else { continue };
        // Some places are missed by the ray that looks for them, and some directions say nothing: others take their place.
        let places = (0..4 * RAYS / DIRECTIONS).map(|point| index << 32 | (point as u64) << 16);
        let met = places.filter_map(|place| Some((place, Met::on(&shape, &Numbers::new(run.seed, place))?)));
        for (place, met) in met.take(RAYS / DIRECTIONS) {
            let directions =
                (1..=4 * DIRECTIONS).map(|ray| Numbers::new(run.seed, place | ray as u64).direction());
            let answers = directions.filter_map(|direction| bad(&shape, &met, direction.as_vec3()));
            for is_bad in answers.take(DIRECTIONS) {
                count += u64::from(is_bad);
                trials += 1;
            }
        }
        used += 1;
        if used >= shapes {
            break;
        }
    }
    share::judge("share of rays", count, trials, share_for(trials))
}

/// The smallest share that this many rays without a miss show, a tenth off the limit.
fn share_for(trials: u64) -> f64 {
    1.1 * 1000f64.ln() / trials.max(8) as f64
}

/// Rays that meet the shape they leave: on the outer side of curved ones, either side of flat ones.
fn again(run: &Run, shapes: u64, start: Start) -> Result<Evidence, InputError> {
    judge(run, shapes, |shape, met, direction| {
        let curved = matches!(shape, Shape::Sphere(_) | Shape::Cylinder(_));
        let outward = met.surface.ng.dot(direction);
        if curved && outward <= 0.0 || outward == 0.0 {
            return None;
        }
        Some(shape.intersect(0, &start(&met.surface, direction)).is_some())
    })
}

/// Rays that pass a parallel neighbour on the side to which they leave.
fn past(run: &Run, shapes: u64, start: Start) -> Result<Evidence, InputError> {
    judge(run, shapes, |_, met, direction| {
        let outward = met.surface.ng.dot(direction);
        let neighbour = &met.neighbours[usize::from(outward < 0.0)];
        (outward.abs() >= 0.5).then(|| neighbour.intersect(0, &start(&met.surface, direction)).is_none())
    })
}
