//! Soft shadows: a floor under a light with something before it, pixel by pixel against what is seen of the light.

use glam::{DAffine3, DVec3};
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, ObjectSettings, SceneDescription, Strategy};
use renderer::shapes::ShapeSettings;
use std::f64::consts::PI;
use verify::claim::{Claim, Evidence, Level, Picture, Run, claim};
use verify::irradiance::behind_half_plane;
use verify::quadrature::{Tolerance, integrate_2d};
use verify::shadow::{behind_ball, behind_polygon};
use verify::share;

use super::film::{Exact, Films};
use crate::bounds;
use crate::setup::{built, diffuse, flat_at, image, lamp, pixel_middles, rectangle_at, thing};

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    vec![
        half_plane("shadow/half-plane/large", "a large light", &LARGE, (Level::Standard, 2048)),
        half_plane("shadow/half-plane/small", "a small light", &SMALL, (Level::Standard, 2048)),
        half_plane("shadow/half-plane/quick", "a large light", &LARGE, (Level::Quick, 64)),
        rectangle(),
        ball(),
        umbra(),
    ]
}

/// Heights of what hides the light, and of the light.
const HEIGHTS: [f64; 2] = [4.0, 8.0];

/// Height of the eye, which looks down from below what hides the light.
const EYE: f64 = 2.0;

/// Pixels of a row.
const ROW: [u32; 2] = [14, 1];

/// A row of the floor.
struct View {
    /// Half sides of the light.
    light: [f64; 2],
    /// Side of a pixel.
    pixel: f64,
}

/// A penumbra 6 wide.
const LARGE: View = View { light: [3.0, 2.0], pixel: 0.7 };

/// A penumbra 0.6 wide.
const SMALL: View = View { light: [0.3, 0.2], pixel: 0.07 };

/// The edge of the half-plane.
const EDGE: f64 = 0.11;

/// The floor, white, in the light of `lamp` past `blocker`, with light points only.
fn floor(size: [u32; 2], pixel: f64, lamp: ObjectSettings, blocker: ObjectSettings) -> SceneDescription {
    let floor = DAffine3::from_scale(DVec3::new(100.0, 100.0, 1.0));
    let objects = vec![thing(ShapeSettings::Rectangle, floor, diffuse(1.0)), lamp, blocker];
    let mut description = flat_at(EYE, pixel, size, objects);
    description.integrator = IntegratorSettings { strategy: Strategy::Light, ..IntegratorSettings::DIRECT };
    description
}

/// A light of those half sides that faces the floor.
fn light([a, b]: [f64; 2], height: f64) -> ObjectSettings {
    lamp(ShapeSettings::Rectangle, rectangle_at(height * DVec3::Z, a * DVec3::X, -b * DVec3::Y))
}

/// The mean of the radiance over a square pixel around `middle`: irradiance over π.
fn over_pixel(middle: [f64; 2], side: f64, irradiance: impl Fn([f64; 2]) -> f64) -> f64 {
    let range = middle.map(|c| [c - 0.5 * side, c + 0.5 * side]);
    // A hundredth of the bound of a pixel that is as bright as 0.1.
    let tolerance = Tolerance { relative: 2e-5, absolute: 2e-6 * side * side, pieces: 400 };
    integrate_2d(&irradiance, range, tolerance).value / (PI * side * side)
}

/// What is wrong with the scene: lengths as factors of the right ones, and a shift of the blocker in pixels.
#[derive(Clone, Copy)]
struct Mistake {
    light: f64,
    height: f64,
    shift: f64,
}

const RIGHT: Mistake = Mistake { light: 1.0, height: 1.0, shift: 0.0 };

/// The mistakes that every shadow's claim must see.
fn mistakes() -> Vec<(&'static str, Mistake)> {
    vec![
        ("half a pixel to the right", Mistake { shift: 0.5, ..RIGHT }),
        ("the light's sides for its half sides", Mistake { light: 2.0, ..RIGHT }),
        ("the blocker 10 % too high", Mistake { height: 1.1, ..RIGHT }),
    ]
}

fn half_plane(
    id: &'static str,
    what: &'static str,
    view: &'static View,
    (level, samples): (Level, u32),
) -> Claim {
    let scene = move |mistake: Mistake| {
        let edge = EDGE + mistake.shift * view.pixel;
        let middle = DVec3::new(edge - 50.0, 0.0, mistake.height * HEIGHTS[0]);
        let plane = rectangle_at(middle, 50.0 * DVec3::X, 50.0 * DVec3::Y);
        let lamp = light(view.light.map(|a| mistake.light * a), HEIGHTS[1]);
        vec![floor(ROW, view.pixel, lamp, thing(ShapeSettings::Rectangle, plane, diffuse(0.0)))]
    };
    let value = move |x: f64| {
        let ranges = view.light.map(|a| [-a, a]);
        over_pixel([x, 0.0], view.pixel, |at| behind_half_plane(ranges, HEIGHTS, EDGE, at))
    };
    Films {
        id: String::from(id),
        says: format!(
            "the floor behind a half-plane under {what} shows the irradiance of what is seen of it"
        ),
        level,
        samples,
        unit: behind_half_plane(view.light.map(|a| [-a, a]), HEIGHTS, -99.0, [0.0; 2]) / PI,
        bound: if level == Level::Quick { bounds::PIXEL_QUICK } else { bounds::PIXEL },
        right: RIGHT,
        wrong: mistakes(),
    }
    .claim(scene, move || {
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| view.pixel * p[0]).collect();
        vec![Exact::on_curve(["position on the floor", "radiance"], &positions, value)]
    })
}

/// Half sides and middle of the rectangle that hides a part of the large light.
const BLOCKER: [[f64; 2]; 2] = [[1.2, 0.8], [0.15, 0.3]];

fn rectangle() -> Claim {
    let [[a, b], [x, y]] = BLOCKER;
    let scene = move |mistake: Mistake| {
        let middle = DVec3::new(x + mistake.shift * LARGE.pixel, y, mistake.height * HEIGHTS[0]);
        let blocker = rectangle_at(middle, a * DVec3::X, b * DVec3::Y);
        let lamp = light(LARGE.light.map(|a| mistake.light * a), HEIGHTS[1]);
        vec![floor(ROW, LARGE.pixel, lamp, thing(ShapeSettings::Rectangle, blocker, diffuse(0.0)))]
    };
    let around =
        |[x, y]: [f64; 2], [a, b]: [f64; 2]| [[x - a, y - b], [x + a, y - b], [x + a, y + b], [x - a, y + b]];
    let irradiance =
        move |at| behind_polygon(&around([0.0; 2], LARGE.light), &around([x, y], [a, b]), HEIGHTS, at);
    Films {
        id: String::from("shadow/rectangle/visible"),
        says: String::from(
            "the floor behind a rectangle shows the irradiance of the polygon that is seen of the light",
        ),
        level: Level::Standard,
        samples: 2048,
        unit: behind_half_plane(LARGE.light.map(|a| [-a, a]), HEIGHTS, -99.0, [0.0; 2]) / PI,
        bound: bounds::PIXEL,
        right: RIGHT,
        wrong: mistakes(),
    }
    .claim(scene, move || {
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| LARGE.pixel * p[0]).collect();
        let value = |x: f64| over_pixel([x, 0.0], LARGE.pixel, irradiance);
        vec![Exact::on_curve(["position on the floor", "radiance"], &positions, value)]
    })
}

/// Radius of the round light, and radius and height of the ball before it.
const ROUND: f64 = 3.0;
const BALL: [f64; 2] = [0.7, 3.5];

/// Pixels beside the axis, where the ball is seen before the light as a whole.
const NEAR: [u32; 2] = [8, 1];
const NEAR_PIXEL: f64 = 0.2;

fn ball() -> Claim {
    let scene = |mistake: Mistake| {
        let middle = DVec3::new(mistake.shift * 4.0 * NEAR_PIXEL, 0.0, mistake.height * BALL[1]);
        let ball = ShapeSettings::Sphere { center: middle, radius: BALL[0] };
        let radius = mistake.light * ROUND;
        let lamp = lamp(
            ShapeSettings::Disk,
            rectangle_at(HEIGHTS[1] * DVec3::Z, radius * DVec3::X, -radius * DVec3::Y),
        );
        vec![floor(NEAR, NEAR_PIXEL, lamp, thing(ball, DAffine3::IDENTITY, diffuse(0.0)))]
    };
    let irradiance = |[x, y]: [f64; 2]| {
        behind_ball([ROUND, HEIGHTS[1]], BALL, x.hypot(y)).expect("the ball is seen before the light there")
    };
    Films {
        id: String::from("shadow/ball/ring"),
        says: String::from(
            "under a ball before a round light the floor shows the light's irradiance less the ball's",
        ),
        level: Level::Standard,
        samples: 4096,
        unit: verify::irradiance::from_parallel_disk(ROUND, HEIGHTS[1], 0.0) / PI,
        bound: bounds::PIXEL,
        right: RIGHT,
        wrong: vec![
            ("a diameter taken for a radius", Mistake { light: 2.0, ..RIGHT }),
            ("the ball 10 % too high", Mistake { height: 1.1, ..RIGHT }),
        ],
    }
    .claim(scene, move || {
        let positions: Vec<f64> = pixel_middles(NEAR).iter().map(|p| NEAR_PIXEL * p[0]).collect();
        let value = |x: f64| over_pixel([x, 0.0], NEAR_PIXEL, irradiance);
        vec![Exact::on_curve(["position on the floor", "radiance"], &positions, value)]
    })
}

/// Side of the film in the umbra: its pixels settle the bound on misses.
const SIDE: u32 = 280;

fn umbra() -> Claim {
    let lit = |run: &Run, light_side: f64| {
        // A square of 2·3 at half the light's height: its umbra is 2·(6 − s) wide for a light of 2·s.
        let blocker = rectangle_at(HEIGHTS[0] * DVec3::Z, 3.0 * DVec3::X, 3.0 * DVec3::Y);
        let blocker = thing(ShapeSettings::Rectangle, blocker, diffuse(0.0));
        let pixel = 2.0 * 3.999 / f64::from(SIDE);
        let scene = built(&floor([SIDE; 2], pixel, light([light_side; 2], HEIGHTS[1]), blocker));
        let rendering =
            image(&scene, SamplerKind::Sobol, u32::try_from(run.effort).unwrap_or(u32::MAX), run.seed);
        let misses = rendering.pixels.iter().filter(|p| p.mean != [0.0; 3]).count();
        let pixels = u64::from(SIDE) * u64::from(SIDE);
        let evidence =
            share::judge("share of pixels that are not black", misses as u64, pixels, bounds::MISSES)?;
        let row = rendering.pixels.iter().take(SIDE as usize).enumerate();
        let measured: Vec<[f64; 3]> = row.map(|(i, p)| [i as f64, p.mean[0], 0.0]).collect();
        let exact = measured.iter().map(|p| [p[0], 0.0]).collect();
        let axes = ["pixel of the umbra's first row", "radiance"];
        Ok(Evidence { pictures: vec![Picture::Curve { axes, exact, measured }], ..evidence })
    };
    claim("shadow/umbra/black", "where the light is hidden as a whole, every pixel is exactly 0")
        .rejects("the light 5 % wider", move |run| lit(run, 2.1))
        .rejects("light from the blocker's other side", move |run| lit(run, 6.0))
        .by(move |run| lit(run, 2.0))
        .same_up_to(Level::Standard)
}
