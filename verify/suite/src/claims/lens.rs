//! The lens: where rays start, where they meet, and what it does to edges and points out of focus.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use renderer::camera::{FovAxis, Projection, Shutter};
use renderer::film::FilmSettings;
use renderer::integrator::batch::{Path, Sample};
use renderer::math::transform::Motion;
use renderer::sampling::Decision;
use renderer::scene::{IntegratorSettings, Scene, SceneDescription};
use renderer::shapes::ShapeSettings;
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level, claim};
use verify::domain::Disk;

mod disk;
mod edge;

use super::pointwise::{curve, never_drawn, rejecting, single};
use super::recorded::{Read, Recorded, Wrong};
use crate::bounds;
use crate::setup::{built, diffuse, fixed, look, spot, thing};

const RADIUS: f64 = 0.3;
const FOCUS: f64 = 5.0;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let all = [vec![position(), focus()], edge::claims(), disk::claims()];
    all.into_iter().flatten().map(|claim| claim.same_up_to(Level::Standard)).collect()
}

/// A camera at the world's origin that looks along +z, with a lens, a shutter from 2 to 5, and a ball that moves.
pub(super) fn scene() -> Scene {
    let ball = ShapeSettings::Sphere { center: DVec3::new(0.0, 0.0, 7.0), radius: 1.0 };
    let mut object = thing(ball, DAffine3::IDENTITY, diffuse(0.5));
    let slide = |x: f64| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
    object.to_world = Motion::keyed(vec![(2.0, slide(0.0)), (5.0, slide(1.0))])
        .expect("two finite, invertible keys in order");
    let mut description: SceneDescription =
        spot(DVec3::ZERO, DVec3::Z, vec![object], IntegratorSettings::DIRECT);
    description.film = FilmSettings { width: 64, height: 64, ..description.film };
    description.camera.projection =
        Projection::Perspective { fov: 40.0, axis: FovAxis::X, lens_radius: RADIUS, focus_distance: FOCUS };
    description.camera.to_world = fixed(look(DVec3::ZERO, DVec3::Z, DVec3::Y));
    description.camera.shutter = Shutter::new(2.0, 5.0).expect("2 is before 5");
    built(&description)
}

/// Where the ray leaves the lens; the render frame's origin is the lens's middle, and its plane is z = 0.
fn on_lens(_: &Scene, _: &Sample, path: &Path) -> Option<[f64; 2]> {
    let o = path.ray.origin;
    (o.z == 0.0).then(|| [f64::from(o.x), f64::from(o.y)])
}

fn position() -> Claim {
    let builder =
        claim("lens/position/uniform", "rays of a render start uniformly on a disk of the lens's radius");
    let recorded = Recorded {
        target: ChiSquare::on(Disk::of_radius(RADIUS)),
        decision: Decision::Lens,
        scene: scene(),
        read: on_lens,
        bound: bounds::RECORDED,
    };
    // the root undone: a point at r = √ξ moves to ξ
    let naive: Read<[f64; 2]> =
        |scene, sample, path| on_lens(scene, sample, path).map(|p| p.map(|c| c * p[0].hypot(p[1]) / RADIUS));
    recorded.claim(builder, Wrong { name: "radius ξ in the place of √ξ", scene: None, read: naive })
}

/// All rays of one point of the image meet in the plane in focus, wherever they leave the lens.
fn focus() -> Claim {
    let scene = Arc::new(scene());
    let apart = move |[x, y, a, b]: [f64; 4], depth: f32| {
        let p = [x, y].map(|u| single(u) * 2.0 - 1.0);
        let meet = |zeta: [f32; 2]| {
            let ray = scene.camera.lens_ray(p, zeta, 3.0);
            ray.at((depth - ray.origin.z) / ray.direction.z)
        };
        let zeta = renderer::sampling::warp::square_to_disk([a, b].map(single)).to_array();
        meet(zeta).distance(meet([0.0; 2]))
    };
    // points at most 6 away are computed with about 10 roundings of 2⁻²⁴ relative
    let tolerance = 10.0 * 6.0 / 16_777_216.0;
    #[expect(clippy::cast_possible_truncation, reason = "a distance of order 1")]
    let focus = FOCUS as f32;
    let (wrong, drawn) = (apart.clone(), apart.clone());
    let picture = move || {
        curve(["first number of the lens", "distance from the point in focus (3 σ: rounding)"], |u| {
            let off = f64::from(drawn([0.3, 0.8, u, 0.4], focus));
            Some([u, 0.0, off, f64::from(tolerance)])
        })
    };
    let builder =
        claim("lens/focus/sharp", "all points of the lens see a point of the plane in focus at one place");
    let builder =
        rejecting(builder, "a plane 0.01 % behind it", move |u| wrong(u, focus * 1.0001) > tolerance);
    never_drawn(builder, "share of rays that miss", move |u| apart(u, focus) > tolerance, picture)
}
