//! No ray leaves a closed mesh without meeting it, at rest or in motion.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use renderer::accel::{Accel, Object};
use renderer::math::transform::Motion;
use renderer::ray::{Hit, Ray};
use renderer::shapes::{MeshData, Shape, ShapeSettings};
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::share;

use super::numbers::Numbers;
use super::routine::single;
use crate::setup::subject;

/// The closed mesh that rays are traced in.
#[derive(Debug, Clone, Copy)]
struct Body {
    /// Columns and rows of the mesh.
    side: u32,
    moves: bool,
}

/// A mesh of 32,512 triangles, so many that rays from its inside are walked in turns.
const FINE: Body = Body { side: 128, moves: false };

/// Rays that are traced at once.
const BATCH: u64 = 4096;

pub(super) fn claims() -> Vec<Claim> {
    let cases =
        [("static", "at rest", false), ("moving", "that turns and shifts while the shutter is open", true)];
    let of = |(name, how, moves): (&str, &str, bool)| {
        let body = Body { side: 16, moves };
        let says =
            format!("no ray from inside a closed mesh {how} misses it, aimed at corners and edges too");
        let leaks = move |run: &Run| {
            let bound = 5e-4;
            judge(body, run, share::trials_for(bound)? * run.effort, bound)
        };
        // 1e8 rays at the exhaustive level.
        let many = move |run: &Run| judge(body, run, 12_500_000 * run.effort, 1e-6);
        [
            claim(format!("stable/watertight/{name}"), says.clone())
                .rejects("Möller and Trumbore in single precision", move |run| naive(body, run))
                .rejects("one triangle of 480 is missing", move |run| missing(body, run))
                .by(leaks),
            claim(format!("stable/watertight/{name}-1e7"), says)
                .rejects("Möller and Trumbore in single precision", move |run| naive(body, run))
                .by(many)
                .from_level(Level::Standard),
        ]
    };
    let fine = claim(
        "stable/watertight/fine",
        "no ray from inside a closed mesh misses it that is so fine that rays are walked in turns",
    );
    let fine = fine
        .rejects("one ray of each 4,096 finds no nearest hit", |run| {
            in_turns(run, |hits, _| hits[hits.len() / 2] = None)
        })
        .rejects("one ray of each 4,096 finds nothing in its way", |run| {
            in_turns(run, |_, blocked| blocked[blocked.len() / 2] = false)
        })
        .by(|run| in_turns(run, |_, _| ()));
    cases.map(of).into_iter().flatten().chain([fine]).collect()
}

/// A ball of two poles and `side` − 1 rings of as many corners at distances of 1 to 1.5 from the origin, drawn from `seed`.
pub(super) fn ball(seed: u64, side: u32) -> MeshData {
    let corner = |index: u32, theta: f64, phi: f64| {
        let radius = Numbers::new(seed, u64::from(index)).between(1.0, 1.5);
        let (sin, cos) = (theta.sin(), theta.cos());
        (radius * DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)).as_vec3().to_array()
    };
    let ring = |row: u32| 1 + (row - 1) * side;
    let last = ring(side);
    let mut mesh = MeshData::default();
    mesh.positions.push(corner(0, 0.0, 0.0));
    for row in 1..side {
        for column in 0..side {
            let (theta, phi) =
                (PI * f64::from(row) / f64::from(side), TAU * f64::from(column) / f64::from(side));
            mesh.positions.push(corner(ring(row) + column, theta, phi));
        }
    }
    mesh.positions.push(corner(last, PI, 0.0));
    for column in 0..side {
        let next = (column + 1) % side;
        mesh.triangles.push([0, ring(1) + column, ring(1) + next]);
        for row in 1..side - 1 {
            let (a, b) = (ring(row), ring(row + 1));
            mesh.triangles.push([a + column, b + column, b + next]);
            mesh.triangles.push([a + column, b + next, a + next]);
        }
        mesh.triangles.push([ring(side - 1) + column, last, ring(side - 1) + next]);
    }
    mesh
}

/// How the mesh moves: a turn and a shift.
fn motion() -> Result<Motion, InputError> {
    let turn = DAffine3::from_rotation_translation(
        DQuat::from_scaled_axis(DVec3::new(0.5, -0.9, 0.4)),
        DVec3::new(3.0, -1.0, 2.0),
    );
    Motion::keyed(vec![(0.0, DAffine3::IDENTITY), (1.0, turn)]).map_err(subject)
}

/// A ray from near the middle, a third each in any direction, at a corner, and at a point of an edge.
fn ray(mesh: &MeshData, motion: Option<&Motion>, n: &Numbers) -> Ray {
    let from = 0.5 * n.unit() * n.direction();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "u·n lies in [0, n)")]
    let triangle = mesh.triangles[(n.unit() * mesh.triangles.len() as f64) as usize];
    let corners = triangle.map(|i| Vec3::from(mesh.positions[i as usize]).as_dvec3());
    let kind = n.unit() * 3.0;
    let target = match kind {
        k if k < 1.0 => from + n.direction(),
        k if k < 2.0 => corners[0],
        _ => corners[0].lerp(corners[1], n.unit()),
    };
    let time = if motion.is_some() { single(n.unit()) } else { 0.0 };
    let map = motion.map_or(DAffine3::IDENTITY, |m| m.at(f64::from(time)));
    let [from, target] = [from, target].map(|p| map.transform_point3(p));
    Ray::new(from.as_vec3(), (target - from).normalize().as_vec3(), time)
}

/// Counts rays for which `hits` says false.
fn count(
    mesh: &MeshData,
    moves: bool,
    run: &Run,
    trials: u64,
    mut hits: impl FnMut(&[Ray]) -> u64,
) -> Result<u64, InputError> {
    let motion = moves.then(motion).transpose()?;
    let mut leaks = 0;
    let mut rays = Vec::new();
    let mut next = 0;
    while next < trials {
        let end = trials.min(next + BATCH);
        rays.clear();
        rays.extend((next..end).map(|i| ray(mesh, motion.as_ref(), &Numbers::new(run.seed, i))));
        leaks += end - next - hits(&rays);
        next = end;
    }
    Ok(leaks)
}

fn judge(body: Body, run: &Run, trials: u64, bound: f64) -> Result<Evidence, InputError> {
    traced(&ball(run.seed, body.side), body.moves, run, (trials, bound), |_, _| ())
}

/// The rays of the fine mesh, with what they found spoilt.
fn in_turns(run: &Run, spoil: impl Fn(&mut [Option<Hit>], &mut [bool])) -> Result<Evidence, InputError> {
    let bound = 1e-4;
    let trials = share::trials_for(bound)? * run.effort;
    traced(&ball(run.seed, FINE.side), FINE.moves, run, (trials, bound), spoil)
}

/// The rays of the whole mesh against one with a hole.
fn missing(body: Body, run: &Run) -> Result<Evidence, InputError> {
    let mut holed = ball(run.seed, body.side);
    // At the equator: a three-hundredth of all directions, which a third of the rays take; some 20 find it, none with
    // probability 2e-9.
    holed.triangles.remove(holed.triangles.len() * 17 / 32);
    traced(&holed, body.moves, run, (20_000, 1e-4), |_, _| ())
}

/// Judges how many of so many trials leak, which lack a nearest hit or find nothing in their way, against the bound, after `spoil` has
/// changed what each batch found.
fn traced(
    mesh: &MeshData,
    moves: bool,
    run: &Run,
    (trials, bound): (u64, f64),
    spoil: impl Fn(&mut [Option<Hit>], &mut [bool]),
) -> Result<Evidence, InputError> {
    let settings = ShapeSettings::Mesh(Arc::new(mesh.clone()));
    let shape = Shape::new(&settings, &DAffine3::IDENTITY, false).map_err(subject)?;
    let object = if moves { Object::moving(shape, motion()?) } else { Object::still(shape) };
    let accel = Accel::new(vec![object], [0.0, 1.0]);
    let (mut found, mut blocked) = (Vec::new(), Vec::new());
    let leaks = count(mesh, moves, run, trials, |rays| {
        accel.closest(rays, &mut found);
        accel.occluded(rays, &mut blocked);
        spoil(&mut found, &mut blocked);
        found.iter().zip(&blocked).map(|(hit, blocked)| u64::from(hit.is_some() && *blocked)).sum()
    })?;
    share::judge("share of rays that leak", leaks, trials, bound)
}

/// The same by a test in single precision that knows nothing of its neighbour, on every triangle.
fn naive(Body { side, moves }: Body, run: &Run) -> Result<Evidence, InputError> {
    let (mesh, motion) = (ball(run.seed, side), motion()?);
    let trials = 5_000;
    let leaks = count(&mesh, moves, run, trials, |rays| {
        let meets = |ray: &&Ray| {
            let map = if moves { motion.at(f64::from(ray.time)).inverse() } else { DAffine3::IDENTITY };
            let (o, d) = (
                map.transform_point3(ray.origin.as_dvec3()).as_vec3(),
                map.transform_vector3(ray.direction.as_dvec3()).as_vec3(),
            );
            mesh.triangles.iter().any(|t| moller_trumbore(o, d, t.map(|i| mesh.positions[i as usize].into())))
        };
        rays.iter().filter(meets).map(|_| 1).sum()
    })?;
    share::judge("share of rays that leak", leaks, trials, 1e-4)
}

fn moller_trumbore(origin: Vec3, d: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let (e1, e2, s) = (b - a, c - a, origin - a);
    let p = d.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let q = s.cross(e1);
    let (u, v) = (s.dot(p) * inverse, d.dot(q) * inverse);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && e2.dot(q) * inverse > 0.0
}
