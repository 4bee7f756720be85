//! Relations between renders that hold whatever the right image is.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DVec3};
use renderer::film::FilmSettings;
use renderer::lights::LightSampling;
use renderer::materials::Material;
use renderer::math::Rgb;
use renderer::sampling::SamplerKind;
use renderer::scene::{IntegratorSettings, LightSettings, Scene, SceneDescription, Strategy};
use renderer::shapes::{MeshData, ShapeSettings};
use renderer::texture::Texture;
use verify::claim::{Claim, Level, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

mod allocation;
mod light_paths;
mod lines;
mod reuse;
mod unchanged;

use crate::bounds;
use crate::setup::{
    built, difference_of_images, diffuse, fixed, image, lamp, mean, receiver, rectangle_at, remembering,
    spot, thing,
};

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let later = |claim: Claim| claim.from_level(Level::Standard);
    let mut list = vec![
        later(same(
            bounds::ESTIMATORS,
            "relation/light-sampling/same-mean",
            "points on lights by area, by solid angle and by both in turn, weighted or not, give the mean of the \
             material's directions",
            estimators,
        )),
        later(same(
            bounds::RELATION,
            "relation/sampler/same-mean",
            "every sampler gives the same mean, of direct light at a point",
            under_a_square,
        )),
        same(
            bounds::RELATION_QUICK,
            "relation/camera/rigid-quick",
            "a scene and its camera, moved and turned together, give the same mean",
            || RIGID.map(|outer| Version::of(moved(outer()))).into(),
        ),
        same(
            bounds::INVARIANCE,
            "relation/camera/rigid",
            "a scene and its camera, moved and turned together, give the same mean of light from the same points",
            || RIGID.map(|outer| Version::of(transformed(by_points(), outer()))).into(),
        ),
        same(
            bounds::INVARIANCE,
            "relation/scale/powers-of-two",
            "a scene 1024 times as large or small gives the same mean",
            || {
                let scale = |factor| DAffine3::from_scale(DVec3::splat(factor));
                [1.0, 1024.0, 1.0 / 1024.0].map(|factor| Version::of(moved(scale(factor)))).into()
            },
        ),
    ];
    list.extend(allocation::claims());
    list.extend(light_paths::claims());
    list.extend(reuse::claims());
    let seldom = [
        ("relation/light/many-quick", "six lights give the sum of what each gives", six_lights as Versions),
        ("relation/sampler/same-mean-quick", "every sampler gives the same mean of a room", samplers),
    ];
    list.extend(seldom.map(|(id, says, versions)| later(same(bounds::RELATION_QUICK, id, says, versions))));
    // Its finer part is what `light-sampling/same-mean` says of one point.
    list.push(same(
        bounds::RELATION_QUICK,
        "relation/strategy/same-mean-quick",
        "light points, the material's directions, and both weighted give the same mean of a room",
        || [Strategy::Light, Strategy::Material, Strategy::Both].map(with_strategy).into(),
    ));
    for (id, says, versions, times) in RELATIONS {
        list.push(same(bounds::RELATION_QUICK, &format!("{id}-quick"), says, versions));
        list.push(fine(id, says, versions, times));
    }
    list.extend(unchanged::claims());
    list.into_iter().map(|claim| claim.same_up_to(Level::Standard)).collect()
}

/// Makes the versions of a relation.
type Versions = fn() -> Vec<Version>;

/// Relations of a room that are looked at coarsely at the quick level, and finely later: name, sentence, versions, and how many times the
/// samples the fine look takes.
const RELATIONS: [(&str, &str, Versions, u32); 3] = [
    (
        "relation/light/split",
        "a light cut in two gives what it gave whole",
        || [room(), split_light()].map(Version::of).into(),
        16,
    ),
    (
        "relation/light/additive",
        "two lights give the sum of what each gives",
        || {
            let parts = [[1.0, 0.0], [0.0, 1.0]].map(two_lights).into();
            let both = Version::of(two_lights([1.0, 1.0]));
            vec![Version { parts, ..Version::of(two_lights([1.0, 1.0])) }, both]
        },
        96,
    ),
    (
        "relation/roulette/same-mean",
        "Russian roulette changes the cost and not the mean",
        || [u32::MAX, 1].map(roulette_from).into(),
        96,
    ),
];

/// One of several versions of a render that should have the same mean: the sum of its parts.
struct Version {
    parts: Vec<SceneDescription>,
    sampler: SamplerKind,
    /// Samples a pixel and replicate.
    samples: u32,
}

impl Version {
    fn of(description: SceneDescription) -> Self {
        Self { parts: vec![description], sampler: SamplerKind::Sobol, samples: SAMPLES }
    }

    /// The same with `times` the samples in each of a quarter as many pixels, since more points of a set are worth more than as many
    /// in several, and under a brighter sky, which leaves less to chance.
    fn finer(mut self, times: u32) -> Self {
        self.samples *= times;
        for description in &mut self.parts {
            description.film = FilmSettings { width: 4, height: 4, ..description.film };
            for light in &mut description.lights {
                *light = LightSettings::Constant { radiance: Rgb::splat(BRIGHT_SKY) };
            }
        }
        self
    }
}

/// Radiance of the sky where a relation is looked at finely.
const BRIGHT_SKY: f32 = 0.5;

/// Samples a pixel and replicate where a coarse bound is to be settled.
const SAMPLES: u32 = 32;

/// Versions of a render that should have the same mean, and the claims on their differences, made when first asked for.
struct Family {
    mean: Box<dyn Fn(usize, u64) -> f64 + Send + Sync>,
    differences: Vec<MeanClaim>,
}

impl Family {
    fn new(versions: Vec<Version>, bound: f64) -> Self {
        let others = versions.len() - 1;
        let scenes: Vec<Vec<Scene>> =
            versions.iter().map(|version| version.parts.iter().map(built).collect()).collect();
        let mean = move |i: usize, seed: u64| -> f64 {
            let Version { sampler, samples, .. } = versions[i];
            scenes[i].iter().map(|scene| mean(&image(scene, sampler, samples, seed))).sum()
        };
        let differences = vec![difference_of_images(mean(0, 0), bound); others];
        Self { differences, mean: Box::new(remembering(mean)) }
    }

    /// The difference of another version, times `factor`, to the first, both from the same seed: what noise they share
    /// cancels, and the spread over seeds is that of the difference.
    fn difference(&self, other: usize, seed: u64, factor: f64) -> f64 {
        factor * (self.mean)(other + 1, seed) - (self.mean)(0, seed)
    }
}

/// The claim of versions of a room in as many times the samples as the group's bound takes.
fn fine(id: &str, says: &str, versions: Versions, times: u32) -> Claim {
    let finer = move || versions().into_iter().map(|version| version.finer(times)).collect();
    same(bounds::RELATION, id, says, finer).from_level(Level::Standard)
}

/// The claim that all versions have the mean of the first.
fn same(
    bound: f64,
    id: &str,
    says: &str,
    versions: impl Fn() -> Vec<Version> + Send + Sync + 'static,
) -> Claim {
    let family = Arc::new(LazyLock::new(move || Family::new(versions(), bound)));
    let (control, brighter) = (family.clone(), family.clone());
    claim(id, says)
        .bound(bound)
        .rejects("2.2 × resolution", move |run| {
            joint_control(&control.differences, run, |i, seed| control.difference(i, seed, 1.0))
        })
        .rejects(format!("one of them {} % brighter", 250.0 * bound), move |run| {
            joint_evidence(&brighter.differences, run, |i, seed| {
                brighter.difference(i, seed, 1.0 + 2.5 * bound)
            })
        })
        .by(move |run| joint_evidence(&family.differences, run, |i, seed| family.difference(i, seed, 1.0)))
}

/// A floor, a wall, a diffuse and a rough metal ball under a square light, and a dim sky; paths of up to 4 edges.
pub(super) fn room() -> SceneDescription {
    let metal =
        Material::new_phong(Texture::Constant(Rgb::splat(0.3)), Texture::Constant(Rgb::splat(0.4)), 10.0);
    let metal = Arc::new(metal.expect("0.3 + 0.4 is at most 1"));
    let ball = |x: f64| ShapeSettings::Sphere { center: DVec3::new(x, 0.5, 0.0), radius: 0.5 };
    let floor = rectangle_at(DVec3::ZERO, 3.0 * DVec3::Z, 3.0 * DVec3::X);
    let wall = rectangle_at(DVec3::new(0.0, 1.0, -1.5), 3.0 * DVec3::X, 2.0 * DVec3::Y);
    let objects = vec![
        thing(ShapeSettings::Rectangle, floor, diffuse(0.5)),
        thing(ShapeSettings::Rectangle, wall, diffuse(0.6)),
        thing(ball(-0.6), DAffine3::IDENTITY, diffuse(0.7)),
        thing(ball(0.6), DAffine3::IDENTITY, metal),
        lamp(
            ShapeSettings::Rectangle,
            rectangle_at(DVec3::new(0.0, 2.5, 0.5), 1.2 * DVec3::X, 1.2 * DVec3::Z),
        ),
    ];
    let integrator = IntegratorSettings { max_depth: Some(4), ..IntegratorSettings::PATH };
    let mut description = spot(DVec3::new(0.3, 1.5, 4.0), DVec3::new(0.0, 0.6, 0.0), objects, integrator);
    description.film = FilmSettings { width: 8, height: 8, ..description.film };
    if let renderer::camera::Projection::Perspective { fov, .. } = &mut description.camera.projection {
        *fov = 40.0;
    }
    description.lights.push(LightSettings::Constant { radiance: Rgb::splat(0.1) });
    description
}

fn with_strategy(strategy: Strategy) -> Version {
    let mut description = room();
    description.integrator.strategy = strategy;
    Version::of(description)
}

/// A point close under a square, a triangle and a ball that emit, by every way to find their light.
fn estimators() -> Vec<Version> {
    let ways = [
        (Strategy::Light, LightSampling::SolidAngle, 2048),
        (Strategy::Material, LightSampling::Area, 32_768),
        (Strategy::Both, LightSampling::Area, 4096),
        (Strategy::Both, LightSampling::Auto, 4096),
    ];
    let version = |(strategy, light_sampling, samples)| {
        let square = rectangle_at(DVec3::new(0.0, 0.2, 1.0), 0.6 * DVec3::Y, 0.6 * DVec3::X);
        let corners = [[-1.5, -1.0, 0.5], [-0.7, 0.5, 0.6], [-1.6, 1.0, 0.5]];
        let triangle =
            MeshData { positions: corners.into(), triangles: vec![[0, 1, 2]], ..MeshData::default() };
        let ball = ShapeSettings::Sphere { center: DVec3::new(1.3, 0.0, 0.7), radius: 0.6 };
        let mut description = receiver(vec![
            lamp(ShapeSettings::Rectangle, square),
            lamp(ShapeSettings::Mesh(Arc::new(triangle)), DAffine3::IDENTITY),
            lamp(ball, DAffine3::IDENTITY),
        ]);
        description.integrator =
            IntegratorSettings { strategy, light_sampling, ..IntegratorSettings::DIRECT };
        Version { samples, ..Version::of(description) }
    };
    ways.map(version).into()
}

fn roulette_from(rr_depth: u32) -> Version {
    let mut description = room();
    description.integrator.rr_depth = rr_depth;
    Version::of(description)
}

fn split_light() -> SceneDescription {
    let mut description = room();
    description.objects.pop();
    for x in [-0.6, 0.6] {
        let half = rectangle_at(DVec3::new(x, 2.5, 0.5), 0.6 * DVec3::X, 1.2 * DVec3::Z);
        description.objects.push(lamp(ShapeSettings::Rectangle, half));
    }
    description
}

/// The six lights one by one, and together.
fn six_lights() -> Vec<Version> {
    let parts = (0..6).map(|i| many_lights(i..i + 1)).collect();
    let few = |version| Version { samples: 8, ..version };
    vec![few(Version { parts, ..Version::of(room()) }), few(Version::of(many_lights(0..6)))]
}

/// The room by every sampler.
fn samplers() -> Vec<Version> {
    SamplerKind::ALL.map(|sampler| Version { sampler, samples: 64, ..Version::of(room()) }).into()
}

/// A point close under a square that emits and the sky, by every sampler; the noisiest comes last, and is not the one that the others are held
/// against.
fn under_a_square() -> Vec<Version> {
    let version = |sampler| {
        let square = rectangle_at(DVec3::new(0.0, 0.2, 1.0), 0.6 * DVec3::Y, 0.6 * DVec3::X);
        let mut description = receiver(vec![lamp(ShapeSettings::Rectangle, square)]);
        description.integrator = IntegratorSettings::DIRECT;
        description.lights.push(LightSettings::Constant { radiance: Rgb::splat(0.3) });
        let samples = if sampler == SamplerKind::Independent { 65_536 } else { 8192 };
        Version { sampler, samples, ..Version::of(description) }
    };
    SamplerKind::ALL.into_iter().rev().map(version).collect()
}

/// The room's light and a bright ball, each times a factor, under no sky.
fn two_lights(factors: [f32; 2]) -> SceneDescription {
    let mut description = room();
    description.lights.clear();
    let ball = ShapeSettings::Sphere { center: DVec3::new(-1.5, 1.2, 1.0), radius: 0.4 };
    description.objects.push(lamp(ball, DAffine3::IDENTITY));
    let lamps = description.objects.iter_mut().rev().take(2);
    for (lamp, factor) in lamps.zip(factors) {
        lamp.radiance = Rgb::splat(4.0 * factor).into();
    }
    description
}

/// The room under some of six small lamps of different sizes and powers, every third a ball; no sky.
fn many_lights(which: std::ops::Range<u32>) -> SceneDescription {
    let mut description = room();
    description.lights.clear();
    description.objects.pop();
    for i in which {
        let [x, z] = [f64::from(i) * 0.8 - 2.0, f64::from(i % 2) - 0.3];
        let side = 0.1 + 0.02 * f64::from(i % 7);
        let at = DVec3::new(x, 2.2 + 0.05 * f64::from(i % 4), z);
        let mut one = match i % 3 {
            0 => lamp(ShapeSettings::Sphere { center: at, radius: side }, DAffine3::IDENTITY),
            1 => lamp(ShapeSettings::Rectangle, rectangle_at(at, side * DVec3::X, side * DVec3::Z)),
            _ => {
                lamp(ShapeSettings::Disk, rectangle_at(at, side * DVec3::X, side * DVec3::new(0.0, 0.3, 1.0)))
            }
        };
        one.radiance = Rgb::splat([1.0, 8.0, 3.0, 20.0][i as usize % 4]).into();
        description.objects.push(one);
    }
    description
}

/// As it is, far away, and turned.
const RIGID: [fn() -> DAffine3; 3] = [
    || DAffine3::IDENTITY,
    || DAffine3::from_translation(DVec3::new(100.0, -40.0, 7.0)),
    || DAffine3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 2.0),
];

/// The room with light from points on its lamp alone, without inter-reflection and sky: directions are drawn in frames of their own, which a
/// turn or a mirror does not keep, and their noise with them; points on the lamp stay the same points of it.
pub(super) fn by_points() -> SceneDescription {
    let mut description = room();
    description.integrator.max_depth = Some(2);
    description.integrator.strategy = Strategy::Light;
    description.lights.clear();
    description
}

/// The room with everything in it, the camera too, moved by `outer`.
fn moved(outer: DAffine3) -> SceneDescription {
    transformed(room(), outer)
}

/// The scene with everything in it, the camera too, moved by `outer`; what a reflection turns over is turned back.
pub(super) fn transformed(mut description: SceneDescription, outer: DAffine3) -> SceneDescription {
    let then = |motion: &renderer::math::transform::Motion| fixed(outer * motion.at(0.0));
    let is_reflected = outer.matrix3.determinant() < 0.0;
    for object in &mut description.objects {
        object.to_world = then(&object.to_world);
        object.flip_normals ^= is_reflected && object.shape.turns_over();
    }
    description.camera.to_world = then(&description.camera.to_world);
    description
}
