//! The shutter: when rays see the scene, and what motion does to edges, disks and turning sectors.

use glam::{DAffine3, DVec3};
use renderer::camera::{Opening, Shutter};
use renderer::math::transform::Motion;
use renderer::sampling::{Decision, SamplerKind};
use renderer::scene::{ObjectSettings, Scene, SceneDescription};
use renderer::shapes::{MeshData, ShapeSettings};
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, LazyLock};
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level, claim};
use verify::domain::Interval;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::motion::{moving_disk_over_pixel, moving_edge, moving_edge_triangle, turning_sector};
use verify::quadrature::{Tolerance, integrate_2d};

use super::film::{Exact, Films};
use super::recorded::{Read, Recorded, Wrong};
use crate::bounds;
use crate::setup::{built, flat, half_plane, image, lamp, mean, pixel_middles, remembering};

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    vec![
        time().same_up_to(Level::Standard),
        edge("shutter/edge/box", Opening::Box, (Level::Standard, 2048)),
        edge("shutter/edge/triangle", Opening::Triangle, (Level::Standard, 2048)),
        edge("shutter/edge/quick", Opening::Box, (Level::Quick, 64)),
        camera(),
        disk("shutter/disk/sweep", (Level::Standard, 4096)),
        disk("shutter/disk/quick", (Level::Quick, 64)),
        sector_claim(),
        energy(),
    ]
}

fn time() -> Claim {
    let builder = claim("shutter/time/uniform", "times of a render are uniform between opening and closing");
    let recorded = Recorded {
        target: ChiSquare::on(Interval::new(2.0, 5.0).expect("2 is below 5")),
        decision: Decision::Time,
        scene: super::lens::scene(),
        read: |_, _, path| Some(f64::from(path.ray.time)),
        bound: bounds::RECORDED,
    };
    let early: Read<f64> = |_, _, path| Some(2.0 + 0.98 * (f64::from(path.ray.time) - 2.0));
    recorded.claim(builder, Wrong { name: "closes 2 % early", scene: None, read: early })
}

/// Pixels of a row.
const ROW: [u32; 2] = [10, 1];

/// Where the edge is when the shutter opens, from the film's middle.
const START: f64 = -1.7;

/// How far it moves until the shutter closes: over several pixels, within one, and back.
const VELOCITIES: [f64; 3] = [3.3, 0.4, -2.0];

/// The motion from rest at `from` to `to` over the time of the shutter, 0 to 1.
fn keyed(from: DAffine3, to: DAffine3) -> Motion {
    Motion::keyed(vec![(0.0, from), (1.0, to)]).expect("two finite, invertible keys in order")
}

fn slide(x: f64) -> DAffine3 {
    DAffine3::from_translation(x * DVec3::X)
}

/// What is wrong: the share of its time that the shutter is open, and a shift in pixels.
type Mistake = [f64; 2];

const RIGHT: Mistake = [1.0, 0.0];

fn mistakes() -> Vec<(&'static str, Mistake)> {
    vec![
        ("closes 10 % early", [0.9, 0.0]),
        ("half a pixel to the right", [1.0, 0.5]),
        ("never opens", [0.0, 0.0]),
    ]
}

fn shutter(opening: Opening, close: f64) -> Shutter {
    Shutter::new(0.0, close).expect("0 is not after the closing").with_opening(opening)
}

fn edge_rows(opening: Opening, [close, shift]: Mistake) -> Vec<SceneDescription> {
    let row = |velocity: f64| {
        let mut object = half_plane(START + shift, 0.0);
        let from = object.to_world.at(0.0);
        // Keys before and after the shutter's time, 3 apart: a share of a segment isn't a time.
        let key = |time: f64| (time, slide(velocity * time) * from);
        object.to_world = Motion::keyed(vec![key(-1.0), key(2.0)]).expect("two keys in order");
        let mut description = flat(ROW, vec![object]);
        description.camera.shutter = shutter(opening, close);
        description
    };
    VELOCITIES.map(row).into()
}

fn edge_exact(opening: Opening) -> Vec<Exact> {
    let row = |velocity: f64| {
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| p[0]).collect();
        let value = |x: f64| {
            let start = START - (x - 0.5);
            match opening {
                Opening::Box => moving_edge(start, velocity),
                Opening::Triangle => moving_edge_triangle(start, velocity),
            }
        };
        Exact::on_curve(["pixel, from the middle", "radiance"], &positions, value)
    };
    VELOCITIES.map(row).into()
}

/// The bound on a pixel's error at a level.
fn pixel_bound(level: Level) -> f64 {
    if level == Level::Quick { bounds::PIXEL_QUICK } else { bounds::PIXEL }
}

fn edge(id: &'static str, opening: Opening, (level, samples): (Level, u32)) -> Claim {
    let how = if opening == Opening::Box { "fully open" } else { "that opens and closes linearly" };
    Films {
        id: String::from(id),
        says: format!(
            "pixels that an edge moves across are covered for the share of their time, under a shutter {how}"
        ),
        level,
        samples,
        unit: 1.0,
        bound: pixel_bound(level),
        right: RIGHT,
        wrong: mistakes(),
    }
    .claim(move |mistake| edge_rows(opening, mistake), move || edge_exact(opening))
}

/// The camera moves, and the edge rests.
fn camera() -> Claim {
    let rows = |factor: f64| {
        let row = |velocity: f64| {
            let mut description = flat(ROW, vec![half_plane(START, 0.0)]);
            let from = description.camera.to_world.at(0.0);
            description.camera.to_world = keyed(from, slide(-factor * velocity) * from);
            description.camera.shutter = shutter(Opening::Box, 1.0);
            description
        };
        VELOCITIES.map(row).into()
    };
    Films {
        id: String::from("shutter/camera/opposite"),
        says: String::from(
            "a moving camera sees an edge at rest as a camera at rest sees it move the other way",
        ),
        level: Level::Standard,
        samples: 2048,
        unit: 1.0,
        bound: bounds::PIXEL,
        right: 1.0,
        wrong: vec![("the same way", -1.0), ("5 % slower", 0.95)],
    }
    .claim(rows, || edge_exact(Opening::Box))
}

/// Film, radius, start and path of the moving disk.
const FILM: [u32; 2] = [7, 3];
const RADIUS: f64 = 1.3;
const DISK_START: f64 = -1.8;
const PATH: f64 = 3.1;

fn moving_disk([close, shift]: Mistake) -> SceneDescription {
    let radius = DAffine3::from_scale(DVec3::new(RADIUS, RADIUS, 1.0));
    let mut object = lamp(ShapeSettings::Disk, radius);
    object.to_world = keyed(slide(DISK_START + shift) * radius, slide(DISK_START + shift + PATH) * radius);
    let mut description = flat(FILM, vec![object]);
    description.camera.shutter = shutter(Opening::Box, close);
    description
}

fn disk(id: &'static str, (level, samples): (Level, u32)) -> Claim {
    let exact = || {
        let value = |[x, y]: [f64; 2]| {
            let x = x - DISK_START;
            moving_disk_over_pixel(RADIUS, PATH, [[x - 0.5, x + 0.5], [y - 0.5, y + 0.5]])
        };
        let pixels: Vec<[f64; 2]> =
            pixel_middles(FILM).into_iter().zip(0u32..).map(|(p, i)| [f64::from(i), value(p)]).collect();
        vec![Exact::pixels(["pixel, row by row", "radiance"], pixels)]
    };
    Films {
        id: String::from(id),
        says: String::from(
            "pixels that a disk moves across are covered for the area and time that it shares with them",
        ),
        level,
        samples,
        unit: 1.0,
        bound: pixel_bound(level),
        right: RIGHT,
        wrong: mistakes(),
    }
    .claim(|mistake| vec![moving_disk(mistake)], exact)
}

/// Width of the sector, where it starts, and how far it turns.
const WIDTH: f64 = 0.9;
const TURN: f64 = 1.3;
const SECTOR_START: f64 = 0.2;
const SECTOR_FILM: [u32; 2] = [4, 4];

/// A bright sector as two triangles that reach beyond the film, turning about the film's middle.
fn sector([close, shift]: Mistake) -> SceneDescription {
    let corner = |angle: f64| [30.0 * angle.cos(), 30.0 * angle.sin(), 0.0];
    let corners = [[0.0; 3], corner(0.0), corner(0.5 * WIDTH), corner(WIDTH)];
    #[expect(clippy::cast_possible_truncation, reason = "a mesh's corners are f32")]
    let positions = corners.map(|c| c.map(|c| c as f32)).into();
    let data = MeshData {
        positions,
        normals: None,
        uvs: None,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        face_normals: true,
    };
    let mut object: ObjectSettings = lamp(ShapeSettings::Mesh(Arc::new(data)), DAffine3::IDENTITY);
    let turned = |angle: f64| slide(shift) * DAffine3::from_rotation_z(angle);
    object.to_world = keyed(turned(SECTOR_START), turned(SECTOR_START + TURN));
    let mut description = flat(SECTOR_FILM, vec![object]);
    description.camera.shutter = shutter(Opening::Box, close);
    description
}

fn sector_claim_exact() -> Vec<Exact> {
    let covered = |[x, y]: [f64; 2]| turning_sector(WIDTH, TURN, (y.atan2(x) - SECTOR_START).rem_euclid(TAU));
    let pixel = |[x, y]: [f64; 2]| {
        let tolerance = Tolerance { relative: 0.0, absolute: 1e-5, pieces: 4000 };
        let range = [[x - 0.5, x + 0.5], [y - 0.5, y + 0.5]];
        integrate_2d(&covered, range, tolerance).value
    };
    let by_angle = |p: [f64; 2]| [p[1].atan2(p[0]), pixel(p)];
    let pixels: Vec<[f64; 2]> = pixel_middles(SECTOR_FILM).into_iter().map(by_angle).collect();
    let mut exact = Exact::pixels(["direction of the pixel from the middle, rad", "radiance"], pixels);
    exact.curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    vec![exact]
}

fn sector_claim() -> Claim {
    Films {
        id: String::from("shutter/sector/turn"),
        says: String::from(
            "pixels that a sector turns across are covered for the time that its angle holds theirs",
        ),
        level: Level::Standard,
        samples: 4096,
        unit: 1.0,
        bound: bounds::PIXEL,
        right: RIGHT,
        wrong: mistakes(),
    }
    .claim(|mistake| vec![sector(mistake)], sector_claim_exact)
}

/// The mean of a film over which the disk moves, with a shutter open for a share of its time.
fn flux(close: f64, radius: f64) -> Scene {
    let mut description = moving_disk([close, 0.0]);
    let scale = DAffine3::from_scale(DVec3::new(radius, radius, 1.0));
    let keys = [0.0, 1.0].map(|t| description.objects[0].to_world.at(t) * scale);
    description.objects[0].to_world = keyed(keys[0], keys[1]);
    built(&description)
}

fn energy() -> Claim {
    const TIMES: [f64; 3] = [0.0, 0.5, 1.0];
    let film = f64::from(FILM[0] * FILM[1]);
    let exact = PI * RADIUS * RADIUS / film;
    let claims = [MeanClaim { rounding: 1e-6, ..MeanClaim::relative(exact, bounds::FLUX) }; 3];
    let subject = |radius: f64, samples: u32| {
        let scenes = LazyLock::new(move || TIMES.map(|close| flux(close, radius)));
        remembering(move |i, seed| mean(&image(&scenes[i], SamplerKind::Sobol, samples, seed)))
    };
    let right = Arc::new(subject(1.0, 2048));
    let (control, larger) = (right.clone(), subject(1.02, 128));
    claim(
        "shutter/flux/any-time",
        "motion spreads a disk's light and keeps its flux, however long the shutter is open",
    )
    .rejects("2.2 × resolution", move |run| joint_control(&claims, run, |i, s| control(i, s)))
    .rejects("the disk 2 % larger", move |run| joint_evidence(&claims, run, &larger))
    .by(move |run| joint_evidence(&claims, run, |i, s| right(i, s)))
    .from_level(Level::Standard)
}
