//! Light from an environment map: its directions, their density, and what a surface gets of it.

use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::{Arc, LazyLock};

use glam::{DMat3, DVec3};
use renderer::lights::Environment;
use renderer::math::Rgb;
use renderer::scene::{IntegratorSettings, LightSettings, Strategy};
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level, claim};
use verify::domain::Parallelogram;
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::quadrature::{Tolerance, integrate_2d};

use super::super::jittered;
use super::super::pointwise::single;
use crate::bounds;
use crate::setup::{built, irradiance, receiver, remembering};

pub(super) fn claims() -> Vec<Claim> {
    [directions(), radiance(), received()].map(|claim| claim.from_level(Level::Standard)).into()
}

/// Columns and rows of the map: the cells between its rows are whole cells of the claim's grids of 14² and 140².
const SIZE: [usize; 2] = [20, 15];

/// A sky that grows brighter upwards, with a bright spot and a dark patch.
fn pixels() -> Vec<Rgb> {
    let [columns, rows] = SIZE;
    let value = |k: usize| match (k % columns, k / columns) {
        (4 | 5, 3) => 6.0,
        (9..=11, 6..=9) => 0.0,
        (i, j) => {
            0.3 + 0.1 * f32::from(u8::try_from(rows - j).unwrap_or(0))
                + 0.05 * f32::from(u8::from(i % 3 == 0))
        }
    };
    (0..columns * rows).map(|k| Rgb::splat(value(k))).collect()
}

/// Turned by 0.7 about an axis, so that nothing lies along another.
fn turned() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 0.7)
}

fn map() -> Environment {
    Environment::new(SIZE, pixels(), turned()).expect("the map of claims is valid")
}

/// The map's own direction at the longitude `u` and the latitude `v`, shares of the full and the half turn.
fn direction([u, v]: [f64; 2]) -> DVec3 {
    let ((sin_phi, cos_phi), (sin, cos)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    DVec3::new(sin_phi * sin, cos, -cos_phi * sin)
}

/// The radiance at a longitude and latitude: linear between the middles of columns, and between rows.
fn exact([u, v]: [f64; 2]) -> f64 {
    let ([columns, rows], pixels) = (SIZE, &*PIXELS);
    let tent = |distance: f64| (1.0 - distance.abs()).max(0.0);
    let mut sum = 0.0;
    for (k, pixel) in pixels.iter().enumerate() {
        let (i, j) = (k % columns, k / columns);
        let x = u * columns as f64 - 0.5 - i as f64;
        let across = x - columns as f64 * (x / columns as f64).round();
        sum += f64::from(pixel.g) * tent(across) * tent(v * (rows - 1) as f64 - j as f64);
    }
    sum
}

static PIXELS: LazyLock<Vec<Rgb>> = LazyLock::new(pixels);

fn directions() -> Claim {
    let map = Arc::new(map());
    let density = map.clone();
    let at = |square| turned() * direction(square);
    ChiSquare::on(Parallelogram::unit_square())
        // dω = 2π² sin θ du dv
        .density(move |[u, v]: [f64; 2]| {
            TAU * PI * (PI * v).sin() * f64::from(density.pdf(at([u, v]).as_vec3()))
        })
        .samples(move |u: [f64; 2]| map.sample(u.map(single)).map(|(w, _)| coordinates(w.as_dvec3())))
        .bound(bounds::LOBE)
        .rejects("uniform over the image", |u: [f64; 2]| Some(u))
        .rejects("uniform directions", |[u, v]: [f64; 2]| Some([u, (1.0 - 2.0 * v).acos() * FRAC_1_PI]))
        .claim("light/environment/directions", "directions to an environment map follow its density")
}

/// The longitude and latitude of a direction: the inverse of [`direction`].
fn coordinates(w: DVec3) -> [f64; 2] {
    let w = turned().transpose() * w;
    let longitude = (w.x.atan2(-w.z) / TAU).rem_euclid(1.0);
    [longitude.min(1.0f64.next_down()), (w.x.hypot(w.z).atan2(w.y) * FRAC_1_PI).min(1.0f64.next_down())]
}

/// Claims on ∫ L dω, ∫ L·|w·z| dω and ∫ L² dω by samples of the map.
fn radiance() -> Claim {
    let moments: [fn(f64, f64) -> f64; 3] = [|l, _| l, |l, z| l * z.abs(), |l, _| l * l];
    let means = move || {
        moments.map(|moment| {
            let value = |[u, v]: [f64; 2]| {
                let z = (turned() * direction([u, v])).z;
                TAU * PI * (PI * v).sin() * moment(exact([u, v]), z)
            };
            let integral = over_map(&value);
            MeanClaim { rounding: 1e-5, ..MeanClaim::relative(integral, bounds::SOLID_ANGLE) }
        })
    };
    let means = Arc::new(LazyLock::new(means));
    let mean = move |map: &Environment, i: usize, seed: u64, spoil: fn(f64, f64) -> f64| {
        jittered::mean(seed, 96, |u, _| {
            let Some((w, pdf)) = map.sample(u) else { return 0.0 };
            let sin = w.as_dvec3().dot(turned().y_axis).powi(2);
            let value = moments[i](f64::from(map.radiance(w).g), f64::from(w.z));
            spoil(value / f64::from(pdf), (1.0 - sin).max(0.0).sqrt())
        })
    };
    let (planted, without) = (means.clone(), means.clone());
    let [a, b, c] = [map(), map(), map()];
    let says = "samples of an environment map add up to the radiance that it gives, from all sides and through a plane";
    claim("light/environment/radiance", says)
        .rejects("2.2 × resolution", move |run| {
            joint_control(&**planted, run, |i, seed| mean(&a, i, seed, |x, _| x))
        })
        .rejects("density without the sine of the latitude", move |run| {
            joint_evidence(&**without, run, |i, seed| mean(&b, i, seed, |x, sin| x / sin.max(1e-3)))
        })
        .by(move |run| joint_evidence(&**means, run, |i, seed| mean(&c, i, seed, |x, _| x)))
}

/// The integral of a function of longitude and latitude over the map, cell by cell: it has kinks at pixels' middles.
fn over_map(f: &impl Fn([f64; 2]) -> f64) -> f64 {
    let [columns, rows] = SIZE;
    let tolerance = Tolerance { relative: 1e-6, absolute: 1e-9, pieces: 2000 };
    let mut sum = 0.0;
    for (i, j) in (0..columns).flat_map(|i| (0..rows - 1).map(move |j| (i, j))) {
        let x = [i as f64 + 0.5, i as f64 + 1.5].map(|x| x / columns as f64);
        let y = [j as f64, j as f64 + 1.0].map(|y| y / (rows - 1) as f64);
        sum += integrate_2d(f, [x, y], tolerance).value;
    }
    sum
}

/// The irradiance of the map on a receiver that faces +z, looked for in every way.
fn received() -> Claim {
    let strategies = [Strategy::Light, Strategy::Material, Strategy::Both];
    let exact_irradiance = || {
        let value = |[u, v]: [f64; 2]| {
            let z = (turned() * direction([u, v])).z;
            TAU * PI * (PI * v).sin() * exact([u, v]) * z.max(0.0)
        };
        over_map(&value)
    };
    let family = Arc::new(LazyLock::new(move || {
        let scenes = strategies.map(|strategy| {
            let mut description = receiver(Vec::new());
            description.integrator = IntegratorSettings { strategy, ..IntegratorSettings::DIRECT };
            description.lights.push(LightSettings::Environment {
                size: SIZE,
                pixels: pixels().into(),
                to_world: turned(),
            });
            built(&description)
        });
        let lit = remembering(move |i, seed| irradiance(&scenes[i], 8192, seed));
        let means = vec![MeanClaim::relative(exact_irradiance(), bounds::IRRADIANCE); strategies.len()];
        (means, Box::new(lit) as Box<dyn Fn(usize, u64) -> f64 + Send + Sync>)
    }));
    let (planted, turned_over) = (family.clone(), family.clone());
    let says = "a surface gets the irradiance of an environment map, however light is looked for";
    claim("irradiance/environment/strategies", says)
        .bound(bounds::IRRADIANCE)
        .rejects("2.2 × resolution", move |run| joint_control(&planted.0, run, &planted.1))
        .rejects("radiance taken for irradiance over π²", move |run| {
            joint_evidence(&turned_over.0, run, |i, seed| FRAC_1_PI * turned_over.1(i, seed))
        })
        .by(move |run| joint_evidence(&family.0, run, &family.1))
}
