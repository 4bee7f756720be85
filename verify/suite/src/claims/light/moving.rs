//! Densities of points on lights that move: per area of the light as it is at that moment.

use glam::{DAffine3, DMat3, DVec3};
use renderer::accel::Object;
use renderer::math::transform::Motion;
use renderer::shapes::{Shape, ShapeSettings};
use verify::claim::{Claim, Level, Run, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::jittered;
use super::super::pointwise::{EPSILON, never, rejecting, same_density, single};
use crate::bounds;

pub(super) fn claims() -> Vec<Claim> {
    vec![rectangle(), spheroid()].into_iter().map(|claim| claim.from_level(Level::Standard)).collect()
}

/// The sides of the rectangle at both ends of its motion: half lengths along x and y.
const SIDES: [[f64; 2]; 2] = [[1.0, 0.5], [2.0, 3.0]];

/// A shape that is stretched by `scales`, and moves, from time 0 to 1.
fn stretching(shape: &ShapeSettings, scales: [DVec3; 2]) -> Object {
    let [from, to] = scales.map(DMat3::from_diagonal);
    let keys = vec![
        (0.0, DAffine3 { matrix3: from, translation: DVec3::new(1.0, 2.0, 3.0) }),
        (1.0, DAffine3 { matrix3: to, translation: DVec3::new(-1.0, 0.0, 5.0) }),
    ];
    let motion = Motion::keyed(keys).expect("keys in order");
    Object::moving(Shape::new(shape, &DAffine3::IDENTITY, false).expect("valid"), motion)
}

fn rectangle() -> Claim {
    let scales = SIDES.map(|[x, y]| DVec3::new(x, y, 1.0));
    let lamp = move || stretching(&ShapeSettings::Rectangle, scales);
    let misses = |lamp: &Object, [u, v, time]: [f64; 3], spoil: fn(f64) -> f64| {
        let time = single(time);
        let side = |i: usize| SIDES[0][i] + (SIDES[1][i] - SIDES[0][i]) * spoil(f64::from(time));
        let exact = 1.0 / (4.0 * side(0) * side(1));
        let (point, pdf) = lamp.sample_area([u, v].map(single), time);
        // f64 throughout, rounded once; the normal is rounded by 2⁻²⁴.
        let again = lamp.pdf_area(point.ng, time);
        !(same_density(pdf, exact, 8.0 * EPSILON) && same_density(again, exact, 8.0 * EPSILON))
    };
    let says = "the density of a point on a rectangle that grows is one over its area at that moment";
    let builder = claim("light/moving-rectangle/pdf", says);
    let at_open = lamp();
    let builder = rejecting(builder, "its area as the shutter opens", move |u| misses(&at_open, u, |_| 0.0));
    let late = lamp();
    let builder = rejecting(builder, "its area 1e-5 later", move |u| misses(&late, u, |t| t + 1e-5));
    let subject = lamp();
    never(builder, "share of points with another density", move |u| misses(&subject, u, |t| t))
}

/// Half axes across and along the spheroid at both ends.
const AXES: [[f64; 2]; 2] = [[1.0, 1.5], [0.5, 3.0]];

/// Moments at which the spheroid is looked at.
const TIMES: [f32; 3] = [0.0, 0.4, 1.0];

/// The area of a spheroid that is longer than wide: 2πa²(1 + c/(a·e)·arcsin e), e² = 1 − a²/c².
fn area([a, c]: [f64; 2]) -> f64 {
    let e = (1.0 - a * a / (c * c)).sqrt();
    std::f64::consts::TAU * a * a * (1.0 + c / (a * e) * e.asin())
}

fn spheroid() -> Claim {
    let lamp = || {
        let sphere = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
        stretching(&sphere, AXES.map(|[a, c]| DVec3::new(a, a, c)))
    };
    let means = || {
        TIMES.map(|time| {
            let axes = [0, 1].map(|i| AXES[0][i] + (AXES[1][i] - AXES[0][i]) * f64::from(time));
            MeanClaim { rounding: 1e-6, ..MeanClaim::relative(area(axes), bounds::SOLID_ANGLE) }
        })
    };
    let mean = move |lamp: &Object, i: usize, seed: u64, spoil: fn(f64, f64) -> f64| {
        jittered::mean(seed, 32, |u, _| {
            let (point, pdf) = lamp.sample_area(u, TIMES[i]);
            spoil(1.0 / f64::from(pdf), f64::from(point.ng.z))
        })
    };
    let says = "one over the density of points on a sphere that becomes a spheroid averages to its area";
    let [planted, without, subject] = [lamp(), lamp(), lamp()];
    claim("light/moving-sphere/area", says)
        .rejects("2.2 × resolution", move |run| {
            joint_control(&means(), run, |i, seed| mean(&planted, i, seed, |a, _| a))
        })
        .rejects("the stretch of a flat light in the place of the point's", move |run: &Run| {
            joint_evidence(&means(), run, |i, seed| mean(&without, i, seed, |a, z| a * (1.0 + 0.1 * z.abs())))
        })
        .by(move |run| joint_evidence(&means(), run, |i, seed| mean(&subject, i, seed, |a, _| a)))
}
