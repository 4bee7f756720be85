//! Ray queries: the tree finds what trying every element finds, closed meshes have no gaps, boxes cover motions.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use renderer::accel::{Accel, MotionIndex, Object};
use renderer::math::bounds::Bounds;
use renderer::math::transform::Motion;
use renderer::ray::{Hit, Ray};
use renderer::shapes::{MeshData, Shape, ShapeSettings};

fn inside(rng: &mut Pcg64, size: f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| size * (2.0 * rng.random::<f64>() - 1.0)))
}

fn affine(rng: &mut Pcg64) -> DAffine3 {
    let rotation = DQuat::from_scaled_axis(inside(rng, 3.0));
    DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.2 + rng.random::<f64>()),
        rotation,
        inside(rng, 4.0),
    )
}

/// A motion through `keys` stretched, sheared and turned positions at uneven times from before 0 to about `keys`/2.
fn uneven_motion(rng: &mut Pcg64, keys: usize) -> Motion {
    let stretch = DMat3::from_diagonal(DVec3::new(1.0, 3.0, 0.3));
    let mut time = -0.5;
    let mut key = || {
        time += 0.05 + rng.random::<f64>();
        (time, DAffine3::from_mat3_translation(affine(rng).matrix3 * stretch, inside(rng, 4.0)))
    };
    Motion::keyed((0..keys).map(|_| key()).collect()).expect("regular keys")
}

/// The box between two at a share of the way.
fn interpolate([a, b]: [Bounds; 2], share: f64) -> Bounds {
    // What interpolation itself rounds, in units of 2⁻⁵³ of coordinates up to 64.
    let rounding = DVec3::splat(64.0 * 4.0 * f64::EPSILON);
    Bounds { min: a.min.lerp(b.min, share), max: a.max.lerp(b.max, share) }.grown(rounding)
}

fn settings(rng: &mut Pcg64) -> ShapeSettings {
    match rng.random_range(0..6) {
        0 => ShapeSettings::Rectangle,
        1 => ShapeSettings::Disk,
        2 => ShapeSettings::Cube,
        3 => ShapeSettings::Sphere { center: inside(rng, 1.0), radius: 0.1 + rng.random::<f64>() },
        4 => ShapeSettings::Cylinder {
            p0: inside(rng, 1.0),
            p1: inside(rng, 1.0),
            radius: 0.1 + rng.random::<f64>(),
        },
        _ => ShapeSettings::Mesh(Arc::new(globe(6, |_| 1.0))),
    }
}

/// At rest, turning or only shifting.
fn object(rng: &mut Pcg64) -> Object {
    let shape = Shape::new(&settings(rng), &affine(rng), false).expect("a regular shape");
    let kind = rng.random_range(0..4);
    if kind < 2 {
        return Object::still(shape);
    }
    let mut key = || if kind == 2 { affine(rng) } else { DAffine3::from_translation(inside(rng, 4.0)) };
    let keys = vec![(0.25, key()), (0.5, key()), (0.75, key())];
    Object::moving(shape, Motion::keyed(keys).expect("regular keys"))
}

/// A closed mesh around the origin: `n` rings of 2n quads; `radius` gives each vertex's distance.
fn globe(n: u32, mut radius: impl FnMut(u32) -> f64) -> MeshData {
    let columns = 2 * n;
    let mut mesh = MeshData::default();
    let mut vertex = |theta: f64, phi: f64, index| {
        let p = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * radius(index);
        mesh.positions.push(p.as_vec3().to_array());
    };
    vertex(0.0, 0.0, 0);
    vertex(PI, 0.0, 1);
    for i in 1..n {
        for j in 0..columns {
            let index = 2 + (i - 1) * columns + j;
            vertex(PI * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(columns), index);
        }
    }
    let ring = |i: u32, j: u32| 2 + (i - 1) * columns + j % columns;
    for j in 0..columns {
        mesh.triangles.push([0, ring(1, j), ring(1, j + 1)]);
        mesh.triangles.push([1, ring(n - 1, j + 1), ring(n - 1, j)]);
        for i in 1..n - 1 {
            mesh.triangles.push([ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)]);
            mesh.triangles.push([ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)]);
        }
    }
    mesh
}

/// Distance, object and element of the first hit in that order.
fn every_element(objects: &[Object], ray: &Ray) -> Option<(f32, u32, u32)> {
    let mut query = *ray;
    let mut first = None;
    for (index, object) in (0..).zip(objects) {
        for element in 0..object.shape.element_count() {
            // later ones at the same distance don't count
            if let Some(hit) = object.intersect(element, &query) {
                query.t_max = hit.t;
                first = Some((hit.t, index, element));
            }
        }
    }
    first
}

/// Numbers of objects below and above the one from which on they get a tree, those of them that move, too.
fn few_or_many() -> impl Strategy<Value = usize> {
    prop_oneof![0usize..20, 200usize..300]
}

fn rays(rng: &mut Pcg64, count: u32) -> Vec<Ray> {
    let one = |i: u32| {
        let (origin, aim) = (inside(rng, 8.0), inside(rng, 4.0));
        let axes = [DVec3::X, DVec3::NEG_Y, DVec3::Z];
        let direction =
            if i.is_multiple_of(8) { axes[(i / 8 % 3) as usize] } else { (aim - origin).normalize() };
        let t_max = if i.is_multiple_of(2) { f32::INFINITY } else { 6.0 * rng.random::<f32>() };
        Ray { t_max, ..Ray::new(origin.as_vec3(), direction.as_vec3(), rng.random()) }
    };
    (0..count).map(one).collect()
}

/// What the rays find together, the first hits and whether there are any: what each finds alone.
fn found(accel: &Accel, rays: &[Ray]) -> Result<Vec<Option<Hit>>, TestCaseError> {
    let (mut hits, mut blocked) = (Vec::new(), Vec::new());
    accel.closest(rays, &mut hits);
    accel.occluded(rays, &mut blocked);
    prop_assert_eq!((hits.len(), blocked.len()), (rays.len(), rays.len()));
    for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
        let (mut hit_alone, mut blocked_alone) = (Vec::new(), Vec::new());
        accel.closest(std::slice::from_ref(ray), &mut hit_alone);
        accel.occluded(std::slice::from_ref(ray), &mut blocked_alone);
        prop_assert_eq!((&hit_alone[0], blocked_alone[0]), (hit, blocked));
        prop_assert_eq!(hit.is_some(), blocked);
    }
    Ok(hits)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_tree_finds_what_trying_every_element_finds(seed: u64, count in few_or_many()) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let objects: Vec<Object> = (0..count).map(|_| object(rng)).collect();
        let accel = Accel::new(objects, [0.0, 1.0]);
        let rays = rays(rng, 300);
        for (ray, hit) in rays.iter().zip(found(&accel, &rays)?) {
            prop_assert_eq!(hit.map(|h| (h.t, h.object, h.element)), every_element(accel.objects(), ray));
        }
    }

    #[test]
    fn rays_that_go_together_find_what_each_finds_alone(seed: u64, count in few_or_many(), spread in 0f64..0.02) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let mut objects: Vec<Object> = (0..count).map(|_| object(rng)).collect();
        // Large enough for packets.
        let bumpy = globe(48, |_| 1.0 + 0.1 * rng.random::<f64>());
        let bumpy = Shape::new(&ShapeSettings::Mesh(Arc::new(bumpy)), &DAffine3::IDENTITY, false);
        objects.push(Object::still(bumpy.expect("a regular shape")));
        let accel = Accel::new(objects, [0.0, 1.0]);
        let mut rays = Vec::new();
        for bundle in 0..20 {
            let (origin, aim) = (inside(rng, 12.0), inside(rng, if bundle % 2 == 0 { 0.5 } else { 3.0 }));
            // Along an axis, some rays of a bundle point to its other side, or have no part along it.
            let axis = bundle % 4 == 0;
            for ray in 0..64 {
                let start = origin + if bundle % 2 == 0 { DVec3::ZERO } else { inside(rng, 0.1) };
                let turn = inside(rng, spread) * f64::from(ray % 3);
                let way = if axis { DVec3::X + turn } else { (aim - origin).normalize() + turn };
                let t_max = if ray % 2 == 0 { f32::INFINITY } else { 16.0 * rng.random::<f32>() };
                rays.push(Ray { t_max, ..Ray::new(start.as_vec3(), way.normalize().as_vec3(), rng.random()) });
            }
        }
        let hits = found(&accel, &rays)?;
        prop_assert!(hits.iter().any(Option::is_some) && hits.iter().any(Option::is_none));
        // Among twice as many others, rays stay in the order given, and those of a packet see the trees of several segments.
        let mixed: Vec<Ray> = rays.chunks(32).flat_map(|some| [some, &self::rays(rng, 64)].concat()).collect();
        found(&accel, &mixed)?;
    }

    #[test]
    fn hits_lie_on_their_rays(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let accel = Accel::new((0..8).map(|_| object(rng)).collect(), [0.0, 1.0]);
        let rays = rays(rng, 300);
        let mut hits = Vec::new();
        accel.closest(&rays, &mut hits);
        for (ray, hit) in rays.iter().zip(&hits) {
            let Some(hit) = hit else { continue };
            let at = accel.interaction(ray, hit);
            // Coordinates and distances are below 32, and the few roundings on the way are within 2⁻²⁴ of that,
            // along the surface divided by the cosine at which the ray meets it.
            let limit = 32.0 * 16.0 * f32::EPSILON / at.surface.ng.dot(at.wo).abs();
            prop_assert!(at.surface.point.distance(ray.at(hit.t)) < limit, "{at:?}");
        }
    }

    #[test]
    fn moving_objects_are_found_alike_by_every_index(seed: u64, count in 1usize..20) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let objects: Vec<Object> = (0..count).map(|_| object(rng)).collect();
        let rays = rays(rng, 300);
        let found = |index| {
            let accel = Accel::indexed(objects.clone(), [0.0, 1.0], index);
            let (mut hits, mut blocked) = (Vec::new(), Vec::new());
            accel.closest(&rays, &mut hits);
            accel.occluded(&rays, &mut blocked);
            (hits, blocked)
        };
        let chosen = found(MotionIndex::Chosen);
        for index in [MotionIndex::Swept, MotionIndex::Interpolated(1), MotionIndex::Interpolated(3)] {
            prop_assert_eq!(&chosen, &found(index), "{:?}", index);
        }
    }

    #[test]
    fn objects_that_only_shift_are_where_they_have_come_to(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let (settings, map) = (settings(rng), affine(rng));
        let mut key = |time| (time, DAffine3::from_translation(inside(rng, 4.0)) * map);
        let motion = Motion::keyed(vec![key(0.0), key(0.3), key(1.0)]).expect("regular keys");
        let (start, shift) = motion.shift_from(0.5).expect("it only shifts");
        let shape = |map| Shape::new(&settings, &map, false).expect("a regular shape");
        let moving = Accel::new(vec![Object::moving(shape(start), shift)], [0.0, 1.0]);
        let (mut here, mut there) = (Vec::new(), Vec::new());
        let mut apart = 0;
        for time in [0.0, 0.2, 0.5, 0.9] {
            let still = Accel::new(vec![Object::still(shape(motion.at(f64::from(time))))], [0.0, 1.0]);
            let rays: Vec<Ray> = rays(rng, 100).into_iter().map(|ray| Ray { time, ..ray }).collect();
            moving.closest(&rays, &mut here);
            still.closest(&rays, &mut there);
            for (ray, hits) in rays.iter().zip(here.iter().zip(&there)) {
                let (Some(here), Some(there)) = hits else {
                    apart += usize::from(hits.0.is_some() || hits.1.is_some());
                    continue;
                };
                let [a, b] = [(&moving, here), (&still, there)].map(|(accel, hit)| accel.interaction(ray, hit));
                // As in `hits_lie_on_their_rays`, for two.
                let limit = 2.0 * 32.0 * 16.0 * f32::EPSILON / b.surface.ng.dot(b.wo).abs();
                prop_assert!(a.surface.point.distance(b.surface.point) < limit, "{a:?} {b:?}");
            }
        }
        // A ray within 1e-6 of an edge may meet one of the two only: one of 400 has a chance of 1e-3.
        prop_assert!(apart <= 1, "{apart}");
    }

    #[test]
    fn boxes_hold_the_moving_body_at_every_time(seed: u64, keys in 1usize..5) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let motion = uneven_motion(rng, keys);
        let body = Bounds::of([inside(rng, 2.0), inside(rng, 2.0)]);
        let swept = motion.swept(&body, [0.0, 1.0]);
        let ends = motion.interpolated(&body, [0.0, 1.0]);
        for i in 0..=1000 {
            let time = f64::from(i) / 1000.0;
            let map = motion.at(time);
            let corners = body.corners().map(|c| map.transform_point3(c));
            let moving = interpolate(ends, time);
            prop_assert!(corners.iter().all(|c| swept.contains(*c)), "swept, time {time}");
            prop_assert!(corners.iter().all(|c| moving.contains(*c)), "interpolated, time {time}");
        }
    }

    #[test]
    fn closed_meshes_have_no_gaps(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let mesh = globe(16, |_| 1.0 + 5.0 * rng.random::<f64>());
        let shape = Shape::new(&ShapeSettings::Mesh(Arc::new(mesh.clone())), &DAffine3::IDENTITY, false).unwrap();
        let accel = Accel::new(vec![Object::still(shape)], [0.0, 0.0]);
        let corner = |rng: &mut Pcg64, t: usize| mesh.triangles[t].map(|i| Vec3::from(mesh.positions[i as usize]))[rng.random_range(0..3)];
        let mut rays = Vec::new();
        for i in 0..500 {
            let origin = inside(rng, 0.5).as_vec3();
            let t = rng.random_range(0..mesh.triangles.len());
            let (a, b) = (corner(rng, t), corner(rng, t));
            let target = match i % 3 {
                0 => a,
                1 => a.lerp(b, rng.random()),
                _ => inside(rng, 4.0).as_vec3(),
            };
            rays.push(Ray::new(origin, (target - origin).as_dvec3().normalize().as_vec3(), 0.0));
        }
        let mut hits: Vec<Option<Hit>> = Vec::new();
        accel.closest(&rays, &mut hits);
        for (ray, hit) in rays.iter().zip(&hits) {
            prop_assert!(hit.is_some(), "{ray:?}");
        }
    }
}

#[test]
fn the_ends_of_segments_that_an_object_hides_are_occluded() {
    let rng = &mut Pcg64::seed_from_u64(0);
    let (mut hidden, mut open) = (0, 0);
    for _ in 0..100 {
        let accel = Accel::new((0..20).map(|_| object(rng)).collect(), [0.0, 1.0]);
        let rays = rays(rng, 300);
        let mut hits = Vec::new();
        accel.closest(&rays, &mut hits);
        let leaving = |(ray, hit): (&Ray, &Option<Hit>)| {
            let way = inside(rng, 1.0).as_vec3().normalize();
            let (surface, object) = (accel.interaction(ray, hit.as_ref()?).surface, hit.as_ref()?.object);
            Some((object, Ray { t_max: 4.0 * rng.random::<f32>(), ..surface.spawn(way, ray.time) }))
        };
        let (objects, segments): (Vec<u32>, Vec<Ray>) = rays.iter().zip(&hits).filter_map(leaving).unzip();
        let mut blocked = Vec::new();
        accel.occluded(&segments, &mut blocked);
        for ((object, segment), blocked) in objects.into_iter().zip(&segments).zip(blocked) {
            let hides = accel.objects()[object as usize].hides(segment);
            assert!(blocked || !hides);
            hidden += u32::from(hides);
            open += u32::from(!hides);
        }
    }
    // Half of the objects rest, and half of these are round or cubes, which hide what is on their other side.
    assert!(hidden > 100 && open > 1000, "{hidden} {open}");
}

#[test]
fn a_motion_that_rests_changes_no_hit() {
    let rng = &mut Pcg64::seed_from_u64(0);
    let shapes: Vec<Shape> = (0..12).map(|_| object(rng).shape).collect();
    let rest = Motion::keyed(vec![(0.0, DAffine3::IDENTITY), (1.0, DAffine3::IDENTITY)]).unwrap();
    assert!(rest.is_static());
    let still = Accel::new(shapes.iter().cloned().map(Object::still).collect(), [0.0, 1.0]);
    let moving =
        Accel::new(shapes.iter().cloned().map(|s| Object::moving(s, rest.clone())).collect(), [0.0, 1.0]);
    let rays = rays(rng, 2000);
    let (mut a, mut b) = (Vec::new(), Vec::new());
    still.closest(&rays, &mut a);
    moving.closest(&rays, &mut b);
    assert_eq!(a, b);
    assert!(a.iter().flatten().count() > 100);
}

#[test]
fn turning_bodies_leave_the_boxes_between_their_ends() {
    let turn = |angle| DAffine3::from_axis_angle(DVec3::Z, angle);
    let motion = Motion::keyed(vec![(0.0, turn(0.0)), (1.0, turn(PI / 2.0))]).unwrap();
    let body = Bounds::of([DVec3::new(-3.0, -3.0, -0.1), DVec3::new(3.0, 3.0, 0.1)]);
    let half = body.transformed(&motion.at(0.5));
    let ends = [0.0, 1.0].map(|time| body.transformed(&motion.at(time)));
    // The corner at 45° reaches √2 times as far half way: bounds without the turn's margin lose it.
    assert!(half.corners().iter().any(|c| !interpolate(ends, 0.5).contains(*c)));
    let grown = interpolate(motion.interpolated(&body, [0.0, 1.0]), 0.5);
    assert!(half.corners().iter().all(|c| grown.contains(*c)));
    // The margin is no more than needed: 3·(√2 − 1), up to (π/16)²/8 of the radius 3√2 that a piece leaves its chord.
    assert!((grown.max.x - 3.0 * 2f64.sqrt()).abs() < (PI / 16.0).powi(2) / 8.0 * 18f64.sqrt() * 1.01);
    // A translation needs none.
    let shift = Motion::keyed(vec![(0.0, turn(0.0)), (1.0, DAffine3::from_translation(DVec3::X))]).unwrap();
    let ends = shift.interpolated(&body, [0.0, 1.0]);
    assert!((ends[0].max - body.max).abs().max_element() < 64.0 * f64::EPSILON * 3.0);
    assert!((ends[1].max - body.max - DVec3::X).abs().max_element() < 64.0 * f64::EPSILON * 4.0);
}
