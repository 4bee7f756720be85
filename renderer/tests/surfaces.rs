//! Points of shapes: on the surface, with normals that face the right way and errors that keep the next ray off.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use renderer::ParamError;
use renderer::accel::Object;
use renderer::interaction::SurfacePoint;
use renderer::math::transform::Motion;
use renderer::ray::Ray;
use renderer::shapes::{MeshData, Shape, ShapeHit, ShapeSettings};

mod cases;

/// A coordinate of either sign, log-uniform over 1e-6 … 1e6.
fn coordinate(rng: &mut Pcg64) -> f64 {
    let size = 10f64.powf(12.0 * rng.random::<f64>() - 6.0);
    if rng.random() { size } else { -size }
}

fn vector(rng: &mut Pcg64) -> DVec3 {
    DVec3::new(coordinate(rng), coordinate(rng), coordinate(rng))
}

fn direction(rng: &mut Pcg64) -> Vec3 {
    let z = 2.0 * rng.random::<f64>() - 1.0;
    let (sin, cos) = (TAU * rng.random::<f64>()).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z).as_vec3()
}

fn rotation(rng: &mut Pcg64) -> DQuat {
    DQuat::from_scaled_axis(direction(rng).as_dvec3() * 3.0 * rng.random::<f64>())
}

/// A random shape, `None` if the draw is one that is refused (a needle), and whether it is flat, or a body with flat faces.
fn shape(rng: &mut Pcg64) -> Option<(Shape, bool)> {
    if rng.random_range(0..6) > 0 {
        return one_surface(rng);
    }
    let linear = DMat3::from_cols(vector(rng), vector(rng), vector(rng));
    let map = DAffine3::from_mat3_translation(linear, vector(rng));
    Shape::new(&ShapeSettings::Cube, &map, rng.random()).ok().map(|s| (s, true))
}

/// The same of one face or a quadric.
fn one_surface(rng: &mut Pcg64) -> Option<(Shape, bool)> {
    let rigid = DAffine3::from_rotation_translation(rotation(rng), vector(rng));
    let linear = DMat3::from_cols(vector(rng), vector(rng), vector(rng));
    let affine = DAffine3::from_mat3_translation(linear, vector(rng));
    let flip = rng.random();
    let (settings, map, flat) = match rng.random_range(0..5) {
        0 => (ShapeSettings::Rectangle, affine, true),
        1 => (ShapeSettings::Disk, affine, true),
        2 => {
            let positions = (0..3).map(|_| vector(rng).as_vec3().to_array()).collect();
            let data = MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() };
            (ShapeSettings::Mesh(Arc::new(data)), DAffine3::IDENTITY, true)
        }
        3 => (ShapeSettings::Sphere { center: vector(rng), radius: coordinate(rng).abs() }, rigid, false),
        _ => {
            let ends = [vector(rng), vector(rng)];
            (
                ShapeSettings::Cylinder { p0: ends[0], p1: ends[1], radius: coordinate(rng).abs() },
                rigid,
                false,
            )
        }
    };
    Shape::new(&settings, &map, flip).ok().map(|s| (s, flat))
}

/// The cosine within which f32 doesn't know on which side of a surface a direction is: unit normals are rounded twice (a shape's own,
/// and its image in motion), by 2⁻²⁵ a component, so by √3·2⁻²⁴, and their product with a direction by up to 3·2⁻²⁴; together below 10·2⁻²⁵.
const NO_SIDE: f64 = 2.5 * f32::EPSILON as f64;

/// Whether a ray from a surface meets it where it started. Directions within [`NO_SIDE`] of the tangent plane are not judged.
///
/// A ray into a sphere or cylinder of radius r meets it again after a chord of 2r cos θ or longer. A start that is off by
/// x sees a normal that is tilted by up to x/r, so directions within that of the tangent plane are not judged, and the
/// chord is shorter by up to 2x / cos θ.
fn comes_back(object: &Object, at: &SurfacePoint, wi: Vec3, time: f32) -> bool {
    let cos = at.ng.as_dvec3().dot(wi.as_dvec3());
    if cos.abs() <= NO_SIDE {
        return false;
    }
    let Some(hit) = object.intersect(0, &at.spawn(wi, time)) else { return false };
    let (radius, flipped) = match &object.shape {
        // Out of a cube it meets nothing more, and through one another face.
        Shape::Cube(c) => {
            let is_outward = (cos > 0.0) != c.is_flipped();
            let mut there = SurfacePoint::default();
            object.put_surface(0, &hit, &at.spawn(wi, time), &mut there);
            return is_outward || there.ng == at.ng;
        }
        Shape::Sphere(s) => (s.radius(), s.is_flipped()),
        Shape::Cylinder(c) => (c.radius(), c.is_flipped()),
        _ => return true,
    };
    // 1e-6 r covers the roundings of f32 normals and directions.
    let off = f64::from(at.error.length() + at.offset(wi).distance(at.point)) + 1e-6 * radius;
    if cos.abs() <= 2.0 * off / radius {
        return false;
    }
    let outward = (cos > 0.0) != flipped;
    outward || f64::from(hit.t) < 2.0 * radius * cos.abs() - 4.0 * off / cos.abs()
}

proptest! {
    #![proptest_config(cases::config(10_000))]

    #[test]
    fn spawned_rays_do_not_come_back(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let Some((shape, _)) = shape(rng) else { return Ok(()) };
        let object = Object::still(shape);
        for _ in 0..20 {
            let at = object.shape.sample_area([rng.random(), rng.random()]);
            for _ in 0..50 {
                prop_assert!(!comes_back(&object, &at, direction(rng), 0.0), "{at:?} {object:?}");
            }
        }
    }

    #[test]
    fn rays_from_hits_do_not_come_back(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let Some((shape, _)) = shape(rng) else { return Ok(()) };
        let object = Object::still(shape);
        for _ in 0..20 {
            let target = object.shape.sample_area([rng.random(), rng.random()]).point;
            let origin = vector(rng).as_vec3();
            let ray = Ray::new(origin, (target - origin).as_dvec3().normalize().as_vec3(), 0.0);
            let Some(hit) = object.shape.intersect(0, &ray) else { continue };
            let at = object.shape.surface(0, &hit, &ray);
            for _ in 0..50 {
                prop_assert!(!comes_back(&object, &at, direction(rng), 0.0), "{at:?} {object:?}");
            }
        }
    }

    #[test]
    fn rays_from_moving_surfaces_do_not_come_back(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let Some((shape, true)) = shape(rng) else { return Ok(()) };
        let key = |rng: &mut Pcg64| DAffine3::from_scale_rotation_translation(DVec3::splat(0.5) + rng.random::<f64>(), rotation(rng), vector(rng));
        let motion = Motion::keyed(vec![(0.0, key(rng)), (1.0, key(rng))]).unwrap();
        let object = Object::moving(shape, motion);
        for _ in 0..20 {
            let time = rng.random();
            let (at, _) = object.sample_area([rng.random(), rng.random()], time);
            for _ in 0..50 {
                prop_assert!(!comes_back(&object, &at, direction(rng), time), "{at:?} {object:?}");
            }
        }
    }

    #[test]
    fn segments_end_before_their_target(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let Some((shape, true)) = one_surface(rng) else { return Ok(()) };
        for _ in 0..100 {
            let start = vector(rng).as_vec3();
            let start = SurfacePoint { point: start, error: start.abs() * f32::EPSILON, ng: direction(rng), n: Vec3::Z, uv: [0.0; 2] };
            let target = shape.sample_area([rng.random(), rng.random()]);
            prop_assert_eq!(shape.intersect(0, &start.spawn_to(&target, 0.0)), None);
        }
    }

    #[test]
    fn near_surfaces_are_not_skipped(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let Some((shape, _)) = one_surface(rng) else { return Ok(()) };
        let at = shape.sample_area([0.5, 0.5]);
        let bounds = shape.bounds();
        let scale = bounds.min.abs().max(bounds.max.abs()).max_element();
        // The target must be wider than where f32 lets the ray aim: 1e-3 · scale from it, that is 2⁻²³ · scale.
        let width = shape.area() / (bounds.max - bounds.min).max_element();
        prop_assume!(width > 1e-5 * scale);
        #[expect(clippy::cast_possible_truncation, reason = "a test's distance")]
        let origin = at.point + at.ng * (1e-3 * scale) as f32;
        prop_assert!(shape.intersect(0, &Ray::new(origin, -at.ng, 0.0)).is_some(), "{at:?} {shape:?}");
    }

    #[test]
    fn sampled_points_lie_on_the_surface_and_are_seen_there(seed: u64) {
        let rng = &mut Pcg64::seed_from_u64(seed);
        let Some((shape, _)) = shape(rng) else { return Ok(()) };
        let bounds = shape.bounds();
        for _ in 0..100 {
            let at = shape.sample_area([rng.random(), rng.random()]);
            prop_assert!(bounds.grown(at.error.as_dvec3()).contains(at.point.as_dvec3()));
            // |n|² is within three roundings of its f32 components, each 2⁻²⁴ and counted twice.
            prop_assert!((at.ng.length_squared() - 1.0).abs() < 6.0 * f32::EPSILON);
            prop_assert_eq!(at.ng, at.n);
        }
    }
}

/// The control of the properties above: without the error bound, rays do come back.
#[test]
fn rays_spawned_without_an_offset_come_back() {
    let rng = &mut Pcg64::seed_from_u64(0);
    let mut back = 0;
    for _ in 0..2000 {
        let Some((shape, _)) = shape(rng) else { continue };
        let object = Object::still(shape);
        let at = SurfacePoint { error: Vec3::ZERO, ..object.shape.sample_area([rng.random(), rng.random()]) };
        back += u32::from(comes_back(&object, &at, direction(rng), 0.0));
    }
    assert!(back > 100, "{back} of 2000");
}

/// The element that a ray meets first, where, and the surface there.
fn nearest(shape: &Shape, ray: &Ray) -> (u32, ShapeHit, SurfacePoint) {
    let hits = (0..shape.element_count()).filter_map(|e| shape.intersect(e, ray).map(|h| (e, h)));
    let (element, hit) = hits.min_by(|a, b| a.1.t.total_cmp(&b.1.t)).expect("the ray meets the shape");
    (element, hit, shape.surface(element, &hit, ray))
}

fn hit(shape: &Shape, origin: [f32; 3], direction: [f32; 3]) -> (ShapeHit, SurfacePoint) {
    let (_, hit, surface) = nearest(shape, &Ray::new(origin.into(), direction.into(), 0.0));
    (hit, surface)
}

#[test]
fn canonical_shapes_have_exact_hits() {
    let place = |s: ShapeSettings| Shape::new(&s, &DAffine3::IDENTITY, false).unwrap();
    let sphere = place(ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 });
    let cylinder = place(ShapeSettings::Cylinder { p0: DVec3::ZERO, p1: DVec3::Z, radius: 1.0 });
    // Shape, origin, direction, distance, point, normal, texture coordinates.
    let cases = [
        (&sphere, [0.0, 3.0, 0.0], [0.0, -1.0, 0.0], 2.0, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.25, 0.5]),
        (&sphere, [0.0, 0.0, 0.0], [0.0, 0.0, -1.0], 1.0, [0.0, 0.0, -1.0], [0.0, 0.0, -1.0], [0.0, 1.0]),
        (&cylinder, [0.0, 2.0, 0.25], [0.0, -1.0, 0.0], 1.0, [0.0, 1.0, 0.25], [0.0, 1.0, 0.0], [0.25, 0.25]),
        (
            &place(ShapeSettings::Rectangle),
            [0.5, -0.5, 2.0],
            [0.0, 0.0, -1.0],
            2.0,
            [0.5, -0.5, 0.0],
            [0.0, 0.0, 1.0],
            [0.75, 0.25],
        ),
        (
            &place(ShapeSettings::Disk),
            [0.0, 0.5, -2.0],
            [0.0, 0.0, 1.0],
            2.0,
            [0.0, 0.5, 0.0],
            [0.0, 0.0, 1.0],
            [0.5, 0.25],
        ),
        (
            &place(ShapeSettings::Cube),
            [0.5, 3.0, 0.0],
            [0.0, -1.0, 0.0],
            2.0,
            [0.5, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.25, 0.5],
        ),
    ];
    for (shape, origin, direction, t, point, normal, uv) in cases {
        let (hit, at) = hit(shape, origin, direction);
        assert_eq!((hit.t, at.point, at.ng), (t, Vec3::from(point), Vec3::from(normal)));
        // The turn is an f32 arctangent times an f32 constant: two roundings of a number below 1.
        assert!((0..2).all(|i| (at.uv[i] - uv[i]).abs() <= f32::EPSILON), "{:?} {uv:?}", at.uv);
    }
}

#[test]
fn the_cube_faces_outward_with_mitsubas_texture_squares() {
    let cube = Shape::new(&ShapeSettings::Cube, &DAffine3::IDENTITY, false).unwrap();
    assert_eq!(cube.area(), 24.0);
    let light = Shape::new(&ShapeSettings::Cube.of_light(), &DAffine3::IDENTITY, false).unwrap();
    assert_eq!((light.area(), light.element_count()), (24.0, 12));
    for axis in Vec3::AXES.into_iter().chain(Vec3::AXES.map(|axis| -axis)) {
        // From inside, where a ray leaves it, and from outside.
        let rays = [Ray::new(0.1 * Vec3::ONE, axis, 0.0), Ray::new(3.0 * axis + 0.1 * Vec3::ONE, -axis, 0.0)];
        for (ray, t) in rays.iter().zip([1.0 - 0.1 * axis.dot(Vec3::ONE), 2.0 + 0.1 * axis.dot(Vec3::ONE)]) {
            let [here, there] = [&cube, &light].map(|shape| nearest(shape, ray));
            // Roundings of a few numbers below 4.
            assert!((here.1.t - t).abs() <= 4.0 * f32::EPSILON && here.2.ng == axis, "{here:?}");
            assert!(here.2.point.abs_diff_eq(there.2.point, 4.0 * f32::EPSILON), "{here:?} {there:?}");
            assert_eq!([here.2.ng, here.2.n, here.2.n], [there.2.ng, there.2.n, here.2.ng]);
            assert!((0..2).all(|i| (here.2.uv[i] - there.2.uv[i]).abs() <= f32::EPSILON));
        }
    }
    // Mitsuba's vertex (1, −1, 1) of the face y = −1 has (1, 1), and (−1, 1, 1) of x = −1 has (1, 1).
    let near = |origin: [f32; 3], direction: [f32; 3]| hit(&cube, origin, direction).1.uv;
    assert_eq!(near([0.5, -3.0, 0.75], [0.0, 1.0, 0.0]), [0.875, 0.75]);
    assert_eq!(near([-3.0, 0.5, 0.75], [1.0, 0.0, 0.0]), [0.75, 0.875]);
}

#[test]
fn tangents_point_where_the_first_texture_coordinate_grows() {
    let turned = DAffine3::from_rotation_translation(DQuat::from_rotation_x(0.7), DVec3::new(1.0, 2.0, -0.5))
        * DAffine3::from_rotation_y(0.4);
    let sheared =
        turned * DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(0.5, 1.5, 0.0), DVec3::Z));
    let triangle = |uvs: Option<[[f32; 2]; 3]>| {
        let positions = vec![[-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [0.0, 2.0, 0.0]];
        let (triangles, uvs) = (vec![[0, 1, 2]], uvs.map(Vec::from));
        ShapeSettings::Mesh(Arc::new(MeshData { positions, triangles, uvs, ..MeshData::default() }))
    };
    let (down, inward) = ([0.3, -0.2, 3.0], [3.0, 0.4, 0.3]);
    let cases = [
        (ShapeSettings::Rectangle, sheared, down),
        (ShapeSettings::Disk, sheared, down),
        (ShapeSettings::Cube, sheared, down),
        (triangle(Some([[0.1, 0.2], [0.9, 0.4], [0.3, 0.7]])), sheared, down),
        (triangle(Some([[0.9, 0.2], [0.1, 0.4], [0.3, 0.7]])), sheared, down), // seen in a mirror
        (triangle(None), sheared, down),
        (ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 }, turned, inward),
        (ShapeSettings::Cylinder { p0: -DVec3::Z, p1: DVec3::Z, radius: 1.0 }, turned, inward),
    ];
    for (settings, map, from) in cases {
        for flip in [false, true] {
            let shape = Shape::new(&settings, &map, flip).unwrap();
            let origin = map.transform_point3(Vec3::from(from).as_dvec3());
            let axis = if from == down { -DVec3::Z } else { -DVec3::X };
            let ray = |origin: DVec3| Ray::new(origin.as_vec3(), map.transform_vector3(axis).as_vec3(), 0.0);
            let (element, _, here) = nearest(&shape, &ray(origin));
            let step = 0.01 * shape.tangent(element, &here).normalize();
            let (_, _, there) = nearest(&shape, &ray(origin + step));
            let [du, dv] = [0, 1].map(|i| there.uv[i] - here.uv[i]);
            // Coordinates change by a hundredth of 0.1 to 1 a metre, f32's rounding is 1e-7; on the sphere a chord of h along
            // a parallel at 20° leaves it by h²·tan 20°/2 = 2e-5, a hundredth of du.
            assert!(du > 1e-4 && dv.abs() < 0.02 * du, "{settings:?} {flip}: {du} {dv}");
        }
    }
}

#[test]
fn flipping_and_mirroring_keep_their_meaning() {
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let sphere = ShapeSettings::Sphere { center: DVec3::ZERO, radius: 1.0 };
    // Whether Mitsuba 3.9.1 shades the outer side of the mirrored shape.
    for (settings, origin, outer) in [
        (ShapeSettings::Rectangle, [0.1, 0.1, 3.0], 1.0),
        (ShapeSettings::Disk, [0.1, 0.1, 3.0], 1.0),
        (ShapeSettings::Cube, [0.1, 0.2, 3.0], 1.0),
        (sphere, [0.0, 0.0, 3.0], -1.0),
    ] {
        for (map, flip, sign) in [
            (DAffine3::IDENTITY, false, 1.0),
            (DAffine3::IDENTITY, true, -1.0),
            (mirror, false, outer),
            (mirror, true, -outer),
        ] {
            let at = hit(&Shape::new(&settings, &map, flip).unwrap(), origin, [0.0, 0.0, -1.0]).1;
            assert_eq!((at.ng, at.n), (Vec3::Z * sign, Vec3::Z * sign), "{settings:?} {flip}");
        }
    }
}

#[test]
fn areas_are_those_of_the_image() {
    let map =
        DAffine3::from_mat3(DMat3::from_cols(DVec3::new(2.0, 0.0, 0.0), DVec3::new(1.0, 3.0, 0.0), DVec3::Z));
    let area = |s: ShapeSettings, m: &DAffine3| Shape::new(&s, m, false).unwrap().area();
    assert_eq!(area(ShapeSettings::Rectangle, &map), 24.0);
    assert_eq!(area(ShapeSettings::Disk, &map), std::f64::consts::PI * 6.0);
    let double = DAffine3::from_scale(DVec3::splat(2.0));
    // The cube root of the determinant, 2, is within one rounding, and the area squares it.
    let relative =
        area(ShapeSettings::Sphere { center: DVec3::ONE, radius: 1.5 }, &double) / (2.0 * TAU * 9.0) - 1.0;
    assert!(relative.abs() <= 4.0 * f64::EPSILON);
}

#[test]
fn a_stretching_motion_stretches_the_density() {
    let square = Shape::new(&ShapeSettings::Rectangle, &DAffine3::IDENTITY, false).unwrap();
    let motion = Motion::fixed(DAffine3::from_scale(DVec3::new(3.0, 2.0, 5.0))).unwrap();
    let (at, pdf) = Object::moving(square, motion).sample_area([0.5, 0.5], 0.0);
    assert_eq!((at.ng, pdf), (Vec3::Z, 1.0 / 24.0));
}

#[test]
fn bad_shapes_are_refused() {
    let refuse = |s: ShapeSettings, m: DAffine3| Shape::new(&s, &m, false).expect_err("refused").to_string();
    let id = DAffine3::IDENTITY;
    let sphere = |radius| ShapeSettings::Sphere { center: DVec3::ZERO, radius };
    assert_eq!(refuse(sphere(-1.0), id), "radius is -1; a positive number is accepted");
    assert_eq!(refuse(sphere(f64::NAN), id), "radius is NaN; a finite number is accepted");
    assert!(
        refuse(sphere(1.0), DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0))).contains("scale of a sphere")
    );
    assert!(
        refuse(ShapeSettings::Rectangle, DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0)))
            .contains("singular")
    );
    assert!(
        refuse(ShapeSettings::Rectangle, DAffine3::from_translation(DVec3::splat(f64::INFINITY)))
            .contains("finite")
    );
    let cylinder = ShapeSettings::Cylinder { p0: DVec3::ONE, p1: DVec3::ONE, radius: 1.0 };
    assert!(refuse(cylinder, id).contains("length of a cylinder"));
    let mesh = |positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>| {
        let data = MeshData { positions, triangles, ..MeshData::default() };
        Shape::new(&ShapeSettings::Mesh(Arc::new(data)), &id, false).expect_err("refused")
    };
    let corner = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(matches!(mesh(corner.clone(), vec![]), ParamError::Empty { .. }));
    assert_eq!(mesh(corner, vec![[0, 1, 3]]), ParamError::Index { name: "vertex index", index: 3, last: 2 });
    let nan = vec![[0.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(matches!(mesh(nan, vec![[0, 1, 2]]), ParamError::NotFinite { name: "vertex position", .. }));
    let line = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    assert!(matches!(mesh(line, vec![[0, 1, 2]]), ParamError::Empty { .. }));
}
