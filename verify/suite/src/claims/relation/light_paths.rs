//! Paths from lights, and what is left to those from the camera beside them, give each pixel what the latter give alone.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use renderer::camera::{Projection, Shutter};
use renderer::film::{FilmSettings, Filter};
use renderer::materials::Ggx;
use renderer::math::Rgb;
use renderer::math::transform::Motion;
use renderer::scene::{IntegratorSettings, ObjectSettings, Scene, SceneDescription};
use renderer::shapes::{MeshData, ShapeSettings};
use verify::claim::Claim;

use super::lines::{Line, SIDE, same_lines};
use crate::bounds;
use crate::setup::{built, diffuse, glass, ground_glass, lamp, rectangle_at, rough_mirror, spot, thing};

pub(super) fn claims() -> Vec<Claim> {
    let line = |i: usize| Line { room: i / OF_ROOM, unit: i / OF_ROOM, line: i % OF_ROOM };
    let says = "with paths from lights, the means of an image's rows and columns are those of paths from the camera alone";
    vec![same_lines(
        ["relation/light-paths/same-lines", says],
        bounds::CAUSTIC,
        (0..2 * OF_ROOM).map(line).collect(),
        || [smooth, ground].map(|room| [false, true].map(room)),
        ("upside down", |_, with| with.iter().rev().copied().collect()),
    )]
}

/// The rows and columns of an image.
const OF_ROOM: usize = 2 * SIDE as usize;

/// A floor seen from above, with a ball of glass over it and a rough mirror beside, flat but for its shading normals.
fn smooth(light_paths: bool) -> Scene {
    let ball = ShapeSettings::Sphere { center: DVec3::new(-0.4, -0.6, 0.3), radius: 0.25 };
    let mirror = MeshData {
        positions: vec![[0.7, -1.0, -0.5], [0.7, -1.0, 0.3], [0.7, -0.3, 0.3], [0.7, -0.3, -0.5]],
        normals: Some(vec![[-1.0, 0.6, 0.3], [-1.0, 0.6, -0.3], [-1.0, -0.2, -0.3], [-1.0, -0.2, 0.3]]),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    };
    let objects = vec![
        thing(ball, DAffine3::IDENTITY, glass(1.5)),
        thing(ShapeSettings::Mesh(Arc::new(mirror)), DAffine3::IDENTITY, rough_mirror(0.2, 0.9)),
        lamp_at(DVec3::new(0.1, 0.9, 0.0), 0.2, 1.0),
    ];
    let integrator = IntegratorSettings { light_paths, ..IntegratorSettings::PATH };
    built(&room(objects, [0.0, 1.25], Filter::PIXEL, integrator))
}

/// The same with a ball of ground glass that moves, two lamps, a lens, a shutter and a filter wider than a pixel, by roulette from the first
/// surface on.
fn ground(light_paths: bool) -> Scene {
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.3, -0.6, 0.3), radius: 0.3 };
    let moved = DAffine3::from_translation(DVec3::new(-0.3, 0.1, -0.2));
    let slide = Motion::keyed(vec![(0.0, DAffine3::IDENTITY), (1.0, moved)]).expect("two keys in order");
    let ball = thing(ball, DAffine3::IDENTITY, ground_glass(Ggx { alpha: [0.2; 2] }.into(), 1.5));
    let objects = vec![
        ObjectSettings { to_world: slide, ..ball },
        lamp_at(DVec3::new(-0.3, 0.9, 0.2), 0.3, 1.0),
        lamp_at(DVec3::new(0.6, 0.7, 0.3), 0.1, 6.0),
    ];
    let integrator = IntegratorSettings { light_paths, rr_depth: 1, ..IntegratorSettings::PATH };
    let mut description = room(objects, [0.05, 1.0], Filter::Tent { radius: 1.0 }, integrator);
    description.camera.shutter = Shutter { close: 1.0, ..Shutter::INSTANT };
    built(&description)
}

/// A square lamp that shines downwards.
fn lamp_at(middle: DVec3, half: f64, radiance: f32) -> ObjectSettings {
    let to_world = rectangle_at(middle, half * DVec3::X, half * DVec3::Z);
    ObjectSettings { radiance: Rgb::splat(radiance).into(), ..lamp(ShapeSettings::Rectangle, to_world) }
}

/// `objects` over a floor, of which a camera with a lens of that radius and distance of focus sees the middle.
fn room(
    mut objects: Vec<ObjectSettings>,
    lens: [f64; 2],
    filter: Filter,
    integrator: IntegratorSettings,
) -> SceneDescription {
    let floor = rectangle_at(-DVec3::Y, DVec3::Z, DVec3::X);
    objects.push(thing(ShapeSettings::Rectangle, floor, diffuse(0.8)));
    let integrator = IntegratorSettings { max_depth: Some(5), ..integrator };
    let mut description = spot(0.25 * DVec3::Y, -DVec3::Y, objects, integrator);
    description.film = FilmSettings { width: SIDE, height: SIDE, filter, ..description.film };
    if let Projection::Perspective { fov, lens_radius, focus_distance, .. } =
        &mut description.camera.projection
    {
        *fov = 60.0;
        [*lens_radius, *focus_distance] = lens;
    }
    description
}
