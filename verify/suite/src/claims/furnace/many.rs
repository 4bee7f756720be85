//! Inter-reflection with closed forms: any albedo and depth, parallel plates, the integrating sphere, and what roulette costs.

use glam::DVec3;
use renderer::math::Rgb;
use renderer::scene::{IntegratorSettings, LightSettings, Scene, SceneDescription, Strategy};
use renderer::shapes::ShapeSettings;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};
use verify::claim::{Claim, Level, Run, claim};
use verify::irradiance::{furnace_radiance, integrating_sphere_irradiance};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::counted::edges;
use super::closed_scene;
use crate::bounds;
use crate::setup::{built, diffuse, lamp, radiance, rectangle_at, remembering, spot, thing};

pub(super) fn claims() -> Vec<Claim> {
    vec![albedos(), plates(), integrating_sphere(), roulette()]
}

/// Rounding of paths of up to 40 bounces in single precision.
const ROUNDING: f64 = 5e-6;

/// A claim on the means of several scenes, against right values and against those of mistakes.
fn means(
    (id, says): (&'static str, &'static str),
    bound: f64,
    exact: impl Fn() -> Vec<f64>,
    mistakes: Vec<(&'static str, Vec<f64>)>,
    subject: impl Fn(usize, u64) -> f64 + Send + Sync + 'static,
) -> Claim {
    let claims = move |exact: &[f64]| -> Vec<MeanClaim> {
        exact.iter().map(|&e| MeanClaim { rounding: ROUNDING, ..MeanClaim::relative(e, bound) }).collect()
    };
    let right = claims(&exact());
    let subject = Arc::new(remembering(subject));
    let (control, same) = (subject.clone(), right.clone());
    let mut builder = claim(id, says)
        .rejects("2.2 × resolution", move |run| joint_control(&same, run, |i, seed| control(i, seed)));
    for (name, wrong) in mistakes {
        let (subject, wrong) = (subject.clone(), claims(&wrong));
        builder = builder.rejects(name, move |run| joint_evidence(&wrong, run, |i, seed| subject(i, seed)));
    }
    builder
        .by(move |run: &Run| joint_evidence(&right, run, |i, seed| subject(i, seed)))
        .from_level(Level::Standard)
}

/// Albedos, and longest paths in edges; a path of d edges is reflected d − 1 times.
///
/// At most six edges where much is reflected: longer paths end by roulette, whose noise another claim pays for.
const FURNACES: [(f32, u32); 6] = [(0.2, 2), (0.2, 5), (0.8, 3), (0.8, 6), (0.95, 4), (0.95, 6)];

fn albedos() -> Claim {
    let scenes = LazyLock::new(|| {
        FURNACES.map(|(albedo, edges)| closed_scene(albedo, Some(edges)).expect("albedos are in [0, 1]"))
    });
    let exact = |more: u32| {
        let of = move |(albedo, edges): (f32, u32)| {
            furnace_radiance(1.0, f64::from(albedo), Some(edges - 1 + more))
        };
        FURNACES.map(of).to_vec()
    };
    means(
        (
            "furnace/closed/albedos",
            "inside a sphere of albedo 0.2, 0.8 or 0.95 paths add up to the geometric series, as far as they go",
        ),
        bounds::FURNACE,
        move || exact(0),
        vec![("one reflection more", exact(1))],
        move |i, seed| radiance(&scenes[i], 128, seed),
    )
}

/// Albedos and radiances emitted of two endless plates that face each other.
const PLATES: [[f64; 2]; 2] = [[0.8, 0.5], [1.0, 0.4]];

fn plate_scene(strategy: Strategy) -> Scene {
    let [albedos, emitted] = PLATES;
    // 10⁴ times their distance: 10⁻⁸ of the light escapes.
    let plate = |z: f64, flip: f64, i: usize| {
        let mut plate =
            lamp(ShapeSettings::Rectangle, rectangle_at(z * DVec3::Z, 1e4 * DVec3::X, flip * 1e4 * DVec3::Y));
        #[expect(clippy::cast_possible_truncation, reason = "reflectances and radiances are f32")]
        let (albedo, radiance) = (albedos[i] as f32, emitted[i] as f32);
        plate.material = diffuse(albedo);
        plate.radiance = Rgb::splat(radiance).into();
        plate
    };
    let integrator =
        IntegratorSettings { max_depth: Some(30), rr_depth: 100, strategy, ..IntegratorSettings::PATH };
    built(&spot(
        0.5 * DVec3::Z,
        DVec3::new(0.3, 0.1, 0.0),
        vec![plate(0.0, 1.0, 0), plate(1.0, -1.0, 1)],
        integrator,
    ))
}

fn plates() -> Claim {
    let [[a, b], [first, second]] = PLATES;
    // Paths of 30 edges lack (ρ₁ρ₂)¹⁵ = 1e-6 of the series.
    let right = (first + a * second) / (1.0 - a * b);
    let scenes = LazyLock::new(|| [Strategy::Material, Strategy::Both].map(plate_scene));
    means(
        ("furnace/plates/endless", "between endless plates the first shows (L₁ + ρ₁L₂)/(1 − ρ₁ρ₂)"),
        bounds::FURNACE,
        move || vec![right; 2],
        vec![
            ("the albedos exchanged", vec![(first + b * second) / (1.0 - a * b); 2]),
            ("without the first reflection", vec![first + a * second; 2]),
        ],
        move |i, seed| radiance(&scenes[i], 256, seed),
    )
}

/// Radius and albedo of the integrating sphere.
const SPHERE: f64 = 2.0;
const ALBEDO: f64 = 0.4;

/// Where points of intensity 1 are, and the point of the wall that is seen.
const LAYOUTS: [&[[f64; 3]]; 3] =
    [&[[0.0, 0.0, 0.0]], &[[0.8, -0.4, 0.3]], &[[-0.6, 0.7, 0.2], [0.3, -0.9, -0.5]]];
const WALL: [f64; 3] = [2.0 / 3.0, 4.0 / 3.0, 4.0 / 3.0];

fn sphere_scene(points: &[[f64; 3]]) -> SceneDescription {
    let mut wall = thing(
        ShapeSettings::Sphere { center: DVec3::ZERO, radius: SPHERE },
        glam::DAffine3::IDENTITY,
        diffuse(0.4),
    );
    wall.flip_normals = true;
    // Longer paths lack ρ¹⁶ = 4e-7; roulette would let few of them go on with thousands of times their weight.
    let integrator = IntegratorSettings { max_depth: Some(17), rr_depth: 100, ..IntegratorSettings::PATH };
    let mut description = spot(DVec3::new(0.1, -0.2, 0.15), DVec3::from(WALL), vec![wall], integrator);
    let point = |p: &[f64; 3]| LightSettings::Point { position: DVec3::from(*p), intensity: Rgb::WHITE };
    description.lights = points.iter().map(point).collect();
    description
}

/// The radiance of the wall: ρ/π of its direct and indirect irradiance, the latter times a factor.
fn wall_radiance(points: &[[f64; 3]], factor: f64) -> f64 {
    let wall = DVec3::from(WALL);
    let direct: f64 = points
        .iter()
        .map(|p| {
            let to = DVec3::from(*p) - wall;
            to.dot(-wall) / SPHERE / to.length().powi(3)
        })
        .sum();
    let power = 4.0 * PI * points.len() as f64;
    ALBEDO / PI * (direct + factor * integrating_sphere_irradiance(power, SPHERE, ALBEDO))
}

fn integrating_sphere() -> Claim {
    let scenes = LazyLock::new(|| LAYOUTS.map(|points| built(&sphere_scene(points))));
    let exact = |factor: f64| LAYOUTS.map(|points| wall_radiance(points, factor)).to_vec();
    means(
        (
            "furnace/sphere/any-layout",
            "an integrating sphere adds the same irradiance ρΦ/(4πR²(1 − ρ)) for any layout of its points",
        ),
        bounds::INTEGRATING_SPHERE,
        move || exact(1.0),
        vec![("one reflection only", exact(1.0 - ALBEDO)), ("5 % more", exact(1.05))],
        move |i, seed| radiance(&scenes[i], 2048, seed),
    )
}

/// Albedos, and the edge from which paths go on by chance.
const ROULETTES: [(f64, u32); 3] = [(0.3, 1), (0.5, 3), (0.8, 6)];

/// Samples for each: the variance of d + ρᵈ/(1 − ρ) edges, relative to their square, is 0.30, 0.065 and 0.19. Points of one set share the
/// first choice evenly, which takes about two thirds of it.
const COUNTS: [u32; 3] = [32_768, 8192, 32_768];

/// Paths go on with the probability of their throughput, which is then 1: after d sure edges with ρᵈ, and with ρ from there on.
fn roulette() -> Claim {
    let scenes = LazyLock::new(|| {
        ROULETTES.map(|(albedo, rr_depth)| {
            #[expect(clippy::cast_possible_truncation, reason = "albedos are f32")]
            let mut scene = closed_scene(albedo as f32, None).expect("albedos are in [0, 1]");
            scene.integrator.rr_depth = rr_depth;
            scene
        })
    });
    let exact = ROULETTES.map(|(rho, sure)| {
        let depth = f64::from(sure);
        depth + rho.powf(depth) / (1.0 - rho)
    });
    means(
        ("furnace/roulette/cost", "Russian roulette shortens paths in a furnace to d + ρᵈ/(1 − ρ) edges"),
        bounds::ROULETTE,
        move || exact.to_vec(),
        vec![("one edge more", exact.map(|edges| edges + 1.0).to_vec())],
        move |i, seed| edges(&scenes[i], COUNTS[i], seed),
    )
}
