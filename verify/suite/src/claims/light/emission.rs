//! The directions in which paths from lights start.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use renderer::accel::{Accel, Object};
use renderer::lights::{AreaLight, Emission, Light, LightSampling};
use renderer::math::Rgb;
use renderer::shapes::{Shape, ShapeSettings};
use verify::claim::{Claim, claim};
use verify::irradiance::sphere_solid_angle;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::jittered;
use crate::bounds;

/// Balls over a square light of area 4: their middles relative to the light's and their radii. Seen from there, the second's cone lies within
/// the first's, and the third's beside it.
const BALLS: [(DVec3, f64); 3] =
    [(DVec3::new(0.0, 0.5, 4.0), 1.5), (DVec3::new(0.1, 0.6, 8.0), 2.0), (DVec3::new(4.0, 0.0, 3.0), 1.0)];

/// Directions of a replicate: `SIDE`².
const SIDE: u32 = 64;

/// The light and the balls.
struct Start {
    accel: Accel,
    emission: Emission,
}

impl Start {
    fn new() -> Self {
        let still = |settings: &ShapeSettings| {
            Object::still(
                Shape::new(settings, &DAffine3::IDENTITY, false).expect("shapes of claims are valid"),
            )
        };
        let mut objects = vec![still(&ShapeSettings::Rectangle)];
        objects.extend(BALLS.map(|(center, radius)| still(&ShapeSettings::Sphere { center, radius })));
        let light = AreaLight::new(0, &objects[0], Rgb::WHITE.into(), LightSampling::Area);
        let accel = Accel::new(objects, [0.0; 2]);
        let emission = Emission::new(&[Light::Area(light)], &accel, [0.0; 2], |object| object > 0);
        Self { accel, emission: emission.expect("a light, and balls to aim at") }
    }

    /// One over the density of a direction from the light's middle, as `density` has it.
    fn inverse(&self, u: [f32; 2], density: impl Fn(Vec3, f32) -> f64) -> f64 {
        let start = self.emission.sample(&self.accel, 0.0, [[0.5; 2], u], 0.0);
        start.map_or(0.0, |start| 1.0 / density(start.direction, 4.0 * start.density))
    }
}

/// The solid angle of a ball.
fn solid_angle((middle, radius): (DVec3, f64)) -> f64 {
    sphere_solid_angle(radius, middle.length())
}

pub(super) fn claims() -> Vec<Claim> {
    let start = Arc::new(Start::new());
    let (control, own) = (start.clone(), start.clone());
    let exact = solid_angle(BALLS[0]) + solid_angle(BALLS[2]);
    // Densities near their exact values, each with its roundings; a few 2⁻²⁴ of the cones' heights are common to all.
    let mean = MeanClaim { rounding: 1e-6, ..MeanClaim::relative(exact, bounds::SOLID_ANGLE) };
    let whole = |start: &Start, seed: u64| {
        jittered::mean(seed, SIDE, |u, _| start.inverse(u, |_, density| f64::from(density)))
    };
    let says = "one over the density of the directions in which paths start averages to the solid angle of what they are aimed at";
    let claim = claim("light/emission/solid-angle", says)
        .bound(bounds::SOLID_ANGLE)
        .rejects("2.2 × resolution", move |run| joint_control(&[mean], run, |_, seed| whole(&control, seed)))
        .rejects("the density of one target", move |run| {
            joint_evidence(&[mean], run, |_, seed| {
                jittered::mean(seed, SIDE, |u, _| {
                    own.inverse(u, |direction, _| {
                        let direction = direction.as_dvec3();
                        let meets = |(middle, radius): &(DVec3, f64)| {
                            direction.cross(*middle).length() < *radius && direction.dot(*middle) > 0.0
                        };
                        let density = |ball| 1.0 / (3.0 * solid_angle(ball));
                        BALLS.into_iter().filter(meets).map(density).fold(0.0, f64::max)
                    })
                })
            })
        })
        .by(move |run| joint_evidence(&[mean], run, |_, seed| whole(&start, seed)));
    vec![claim]
}
