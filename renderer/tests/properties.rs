//! Laws that hold for every input: maps and their inverses, frames, choices, moving bodies, rays, densities that
//! integrate to one. `VERIFY_LEVEL` multiplies the cases as it does those of claims.

use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3};
use proptest::prelude::*;
use renderer::accel::{Accel, Object};
use renderer::math::Frame;
use renderer::math::float::unit_f32;
use renderer::math::transform::Motion;
use renderer::ray::Ray;
use renderer::sampling::Discrete;
use renderer::sampling::warp::*;
use renderer::shapes::{Shape, ShapeSettings};

mod cases;

/// 2⁻²⁴, the relative size of one rounding.
const ROUNDING: f32 = f32::EPSILON / 2.0;

/// Numbers as samplers give them.
fn unit() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(unit_f32)
}

/// Points of the open square: at u = 0 a radius vanishes or an angle is at its seam, and the inverse is not unique.
fn inner() -> impl Strategy<Value = [f32; 2]> {
    let coordinate = || (1_u32..1 << 24).prop_map(|k| unit_f32(k << 8));
    [coordinate(), coordinate()]
}

fn unit_vector() -> impl Strategy<Value = Vec3> {
    [unit(), unit()].prop_map(|u| square_to_sphere(u).normalize())
}

/// The distance on the circle of circumference 1: an angle of 0 and one of 2π are the same.
fn around(a: f32, b: f32) -> f32 {
    let d = (a - b).abs();
    d.min(1.0 - d)
}

/// The shift of the azimuth, in turns, by rounding: φ = 2πv has an error of at most 2 roundings of 2π, the sine and
/// cosine 1 each, the products 1, and atan2 and the quotient 3 of the turn.
const TURN: f32 = 8.0 * ROUNDING;

proptest! {
    #![proptest_config(cases::config(10_000))]

    #[test]
    fn disk_and_back(u in inner()) {
        let back = disk_to_square(square_to_disk(u));
        for k in 0..2 {
            // a = 2u − 1 is exact; sine, cosine, length and angle add at most 8 roundings of |a| ≤ 1, halved.
            prop_assert!((back[k] - u[k]).abs() <= 8.0 * ROUNDING, "{u:?} {back:?}");
        }
    }

    #[test]
    fn polar_disk_and_back(u in inner()) {
        let back = disk_polar_to_square(square_to_disk_polar(u));
        // The root, sine, cosine and two squares: 6 roundings of r².
        prop_assert!((back[0] - u[0]).abs() <= 6.0 * ROUNDING * u[0], "{u:?} {back:?}");
        prop_assert!(around(back[1], u[1]) <= TURN, "{u:?} {back:?}");
    }

    #[test]
    fn hemisphere_and_back(u in inner()) {
        let back = hemisphere_to_square(square_to_hemisphere(u));
        // sin²: 8 roundings relative; 1 + cos: 2 absolute of a number of 1 or more.
        prop_assert!((back[0] - u[0]).abs() <= 12.0 * ROUNDING * u[0], "{u:?} {back:?}");
        prop_assert!(around(back[1], u[1]) <= TURN, "{u:?} {back:?}");
    }

    #[test]
    fn cosine_hemisphere_and_back(u in inner()) {
        let w = square_to_cosine_hemisphere(u);
        let back = cosine_hemisphere_to_square(w);
        for k in 0..2 {
            prop_assert!((back[k] - u[k]).abs() <= 8.0 * ROUNDING, "{u:?} {back:?}"); // As on the disk.
        }
        // Two coordinates of 3 roundings each and a height of 2, all squared: at most 8 roundings of 1.
        prop_assert!((w.length_squared() - 1.0).abs() <= 8.0 * ROUNDING, "{w}");
    }

    #[test]
    fn sphere_and_back(u in inner()) {
        let back = sphere_to_square(square_to_sphere(u));
        // North: 12 roundings relative as on the hemisphere; south: 1 − z has 2 roundings of 1, halved.
        prop_assert!((back[0] - u[0]).abs() <= 12.0 * ROUNDING * u[0], "{u:?} {back:?}");
        prop_assert!(around(back[1], u[1]) <= TURN, "{u:?} {back:?}");
    }

    #[test]
    fn cone_and_back(u in inner(), exponent in -30_i32..=0) {
        let one_minus_cos_max = 2.0_f32.powi(exponent);
        let back = cone_to_square(square_to_cone(u, one_minus_cos_max), one_minus_cos_max);
        // As on the hemisphere, and a quotient.
        prop_assert!((back[0] - u[0]).abs() <= 13.0 * ROUNDING * u[0], "{u:?} {back:?}");
        prop_assert!(around(back[1], u[1]) <= TURN, "{u:?} {back:?}");
    }

    #[test]
    fn phong_and_back(u in inner(), exponent in 0.0_f32..1.0e4) {
        let back = phong_to_square(square_to_phong(u, exponent), exponent);
        // With L = −ln(1 − u): the error of L is at most 24 roundings of it (log1p 2, quotient 1, product 1, expm1 2,
        // root 1, sine and cosine 2, squares 2; sin² and cos amplify by at most 1 near the axis and cos by at most 2
        // at sin² = ½), and 1 − u = e^−L turns it into L·e^−L ≤ u of it.
        prop_assert!((back[0] - u[0]).abs() <= 26.0 * ROUNDING * u[0], "{u:?} {back:?}");
        prop_assert!(around(back[1], u[1]) <= TURN, "{u:?} {back:?}");
    }

    #[test]
    fn tent_and_back(u in unit(), radius in 0.1_f32..10.0) {
        let x = unit_to_tent(u, radius);
        prop_assert!(x.abs() <= radius);
        // Root, difference, product and quotient: 4 roundings of a rest of at most 1, doubled and halved by the
        // square; and one of the result.
        prop_assert!((tent_to_unit(x, radius) - u).abs() <= 5.0 * ROUNDING, "{u} {x}");
    }

    #[test]
    fn triangle_and_back(u in inner()) {
        let b = square_to_triangle(u);
        prop_assert_eq!(triangle_pdf_uv(b), 2.0, "{:?}", b);
        let back = triangle_to_square(b);
        // s = √u: 3 roundings of s in the sum, doubled by the square, and one; v: 1 of the product, 4 of s.
        prop_assert!((back[0] - u[0]).abs() <= 7.0 * ROUNDING * u[0], "{u:?} {back:?}");
        prop_assert!((back[1] - u[1]).abs() <= 5.0 * ROUNDING * u[1], "{u:?} {back:?}");
    }

    #[test]
    fn folded_points_are_on_the_triangle(u in [unit(), unit()]) {
        prop_assert_eq!(triangle_pdf_uv(square_to_triangle_folded(u)), 2.0);
    }

    #[test]
    fn parallelogram_and_back(u in [unit(), unit()], z in unit_vector(), height in 0.5_f32..2.0) {
        let frame = Frame::from_z(z);
        let p = [Vec3::splat(0.5), Vec3::splat(0.5) + frame.x, Vec3::splat(0.5) + 0.5 * frame.x + height * frame.y];
        let back = parallelogram_to_square(square_to_parallelogram(u, p), p);
        for k in 0..2 {
            // Points within 4 of the origin have coordinates of 4 roundings of 4; an edge's length is at least ½ and
            // the angle between them at least 45°, which divides by at least ½·√½; twice two cross products of 4.
            prop_assert!((back[k] - u[k]).abs() <= (16.0 * 2.0 * 1.5 + 16.0) * ROUNDING, "{u:?} {back:?}");
        }
    }

    #[test]
    fn frames_are_orthonormal(z in unit_vector()) {
        let Frame { x, y, z } = Frame::from_z(z);
        // z is unit to 9 roundings squared: its length has 3.5, each coordinate one more. A coordinate of x or y is 1 and a
        // product of three factors of 4 roundings, or that product, at most ½: squares and products of two add 2 (5 + ½·4), and their
        // sum 3. 26 in all; 7.2 is the most that 40 million vectors had.
        let limit = 26.0 * ROUNDING;
        for (product, expected) in [(x.dot(x), 1.0), (y.dot(y), 1.0), (x.dot(y), 0.0), (x.dot(z), 0.0), (y.dot(z), 0.0)] {
            prop_assert!((product - expected).abs() <= limit, "{z}: {product}");
        }
        prop_assert!(x.cross(y).dot(z) > 0.0, "right-handed");
    }

    #[test]
    fn to_local_undoes_to_world(z in unit_vector(), v in unit_vector()) {
        let frame = Frame::from_z(z);
        // Six products of numbers below 1 and three of a basis that is orthonormal to 26 roundings.
        let limit = (6.0 + 3.0 * 26.0) * ROUNDING;
        prop_assert!((frame.to_local(frame.to_world(v)) - v).abs().max_element() <= limit, "{z} {v}");
    }
}

fn point(size: f64) -> impl Strategy<Value = DVec3> {
    [-size..size, -size..size, -size..size].prop_map(DVec3::from)
}

/// Turns, shifts and uniform scales, a third of them mirrored.
fn place() -> impl Strategy<Value = DAffine3> {
    (point(3.0), point(4.0), 0.2..1.5_f64, 0..3_u8).prop_map(|(turn, shift, scale, kind)| {
        let mirror = if kind == 0 { DVec3::new(-scale, scale, scale) } else { DVec3::splat(scale) };
        DAffine3::from_scale_rotation_translation(mirror, DQuat::from_scaled_axis(turn), shift)
    })
}

fn shape() -> impl Strategy<Value = Shape> {
    let settings = prop_oneof![
        Just(ShapeSettings::Rectangle),
        Just(ShapeSettings::Disk),
        Just(ShapeSettings::Cube),
        (point(1.0), 0.1..1.0_f64).prop_map(|(center, radius)| ShapeSettings::Sphere { center, radius }),
        (point(1.0), 0.1..1.0_f64).prop_map(|(p0, radius)| ShapeSettings::Cylinder {
            p0,
            p1: p0 + DVec3::ONE,
            radius
        }),
    ];
    (settings, place()).prop_map(|(settings, to)| Shape::new(&settings, &to, false).unwrap())
}

fn flat() -> impl Strategy<Value = Shape> {
    let settings = prop_oneof![Just(ShapeSettings::Rectangle), Just(ShapeSettings::Disk)];
    (settings, place()).prop_map(|(settings, to)| Shape::new(&settings, &to, false).unwrap())
}

/// A body at rest, or moving between two keys that are mirrored both or not at all.
fn object(shape: impl Strategy<Value = Shape>) -> impl Strategy<Value = Object> {
    (shape, place(), place(), any::<bool>()).prop_map(|(shape, from, to, moves)| {
        let same = from.matrix3.determinant() * to.matrix3.determinant() > 0.0;
        let to = if same { to } else { to * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)) };
        if moves {
            Object::moving(shape, Motion::keyed(vec![(0.0, from), (1.0, to)]).unwrap())
        } else {
            Object::still(shape)
        }
    })
}

/// The nearest distance by trying every element of every object.
fn every_element(objects: &[Object], ray: &Ray) -> Option<f32> {
    let mut query = *ray;
    for object in objects {
        for element in 0..object.shape.element_count() {
            if let Some(hit) = object.intersect(element, &query) {
                query.t_max = hit.t;
            }
        }
    }
    (query.t_max < ray.t_max).then_some(query.t_max)
}

proptest! {
    #![proptest_config(cases::config(10_000))]

    #[test]
    fn a_body_stays_in_its_box_while_the_shutter_is_open(object in object(shape()), u in [unit(), unit()], time in 0.0..=1.0_f32) {
        let (surface, pdf) = object.sample_area(u, time);
        // The point is rounded; its error bound says by how much.
        let bounds = object.bounds([0.0, 1.0]).grown(surface.error.as_dvec3());
        prop_assert!(bounds.contains(surface.point.as_dvec3()), "{:?} {bounds:?}", surface.point);
        prop_assert!(pdf > 0.0 && pdf.is_finite(), "{pdf}");
    }

    #[test]
    fn the_nearest_hit_is_the_least_of_all(
        objects in prop::collection::vec(object(shape()), 0..5), from in point(8.0), to in point(4.0), time in 0.0..=1.0_f32,
    ) {
        let ray = Ray::new(from.as_vec3(), (to - from).normalize().as_vec3(), time);
        let accel = Accel::new(objects, [0.0, 1.0]);
        let (mut hits, mut blocked) = (Vec::new(), Vec::new());
        accel.closest(&[ray], &mut hits);
        accel.occluded(&[ray], &mut blocked);
        prop_assert_eq!(hits[0].map(|h| h.t), every_element(accel.objects(), &ray));
        prop_assert_eq!(hits[0].is_some(), blocked[0]);
    }

    #[test]
    fn a_ray_that_leaves_a_flat_body_does_not_meet_it_again(
        object in object(flat()), u in [unit(), unit()], w in unit_vector(), time in 0.0..=1.0_f32,
    ) {
        let (surface, _) = object.sample_area(u, time);
        prop_assume!(surface.ng.dot(w) != 0.0);
        prop_assert_eq!(object.intersect(0, &surface.spawn(w, time)), None);
    }

    #[test]
    fn a_choice_has_the_probability_that_it_says(weights in prop::collection::vec(0.0..1.0_f64, 1..20), u in unit()) {
        let Ok(discrete) = Discrete::new(&weights) else { return Ok(()) };
        let chosen = discrete.sample(u);
        prop_assert!(weights[chosen.index] > 0.0 && chosen.pmf == discrete.pmf(chosen.index));
        prop_assert!((0.0..1.0).contains(&chosen.u));
        // One rounding of a share of at most 1 to f32, and a few of 2⁻⁵³ a weight before.
        let exact = weights[chosen.index] / weights.iter().sum::<f64>();
        prop_assert!((f64::from(chosen.pmf) - exact).abs() <= f64::from(ROUNDING), "{chosen:?} {exact}");
    }
}

/// The integral of `f` over the unit square by the midpoint rule.
fn square_integral(cells: u32, f: impl Fn([f32; 2]) -> f64) -> f64 {
    let middle = |k: u32| (k as f32 + 0.5) / cells as f32;
    let points = (0..cells).flat_map(|j| (0..cells).map(move |i| [middle(i), middle(j)]));
    points.map(f).sum::<f64>() / f64::from(cells).powi(2)
}

/// The integral of a density over all directions, which the uniform map on the sphere spreads over the square.
fn integral_over_directions(cells: u32, pdf: impl Fn(Vec3) -> f32) -> f64 {
    square_integral(cells, |u| f64::from(pdf(square_to_sphere(u)) / sphere_pdf()))
}

/// How far a midpoint sum of `cells` columns may be from 1: `curvature` bounds |f″| in cos θ over 24, and each cell
/// cut by an edge of the density in cos θ contributes at most `jump` of its width.
fn limit(cells: u32, curvature: f64, jump: f64) -> f64 {
    let width = 1.0 / f64::from(cells);
    let roundings = 16.0 * f64::from(ROUNDING); // Sixteen roundings in map and density.
    curvature * width * width / 24.0 + jump * width + roundings
}

#[test]
fn densities_integrate_to_one() {
    // The edges at the horizon and at the cone's rim of 1 − cos = ½ are edges of cells: no jump counts.
    let cases = [
        ("sphere", integral_over_directions(128, |_| sphere_pdf()), limit(128, 0.0, 0.0)),
        ("hemisphere", integral_over_directions(128, hemisphere_pdf), limit(128, 0.0, 0.0)),
        ("cone", integral_over_directions(128, |w| cone_pdf(w, 0.5)), limit(128, 0.0, 0.0)),
        ("cosine", integral_over_directions(128, cosine_hemisphere_pdf), limit(128, 0.0, 0.0)),
        // 4π·pdf = 2(e + 1)·cosᵉ in u = (1 − cos)/2: second derivative at most 8(e + 1)·e·(e − 1).
        ("phong 4", integral_over_directions(128, |w| phong_pdf(w, 4.0)), limit(128, 480.0, 0.0)),
    ];
    for (name, integral, limit) in cases {
        assert!((integral - 1.0).abs() <= limit, "{name}: {integral}, limit {limit}");
    }
}

#[test]
fn planar_densities_integrate_to_one() {
    // The disk in its square of area 4: cells cut by the circle are at most 8·cells, each wrong by at most its area.
    let disk =
        square_integral(512, |u| 4.0 * f64::from(disk_pdf(Vec2::new(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0))));
    assert!((disk - 1.0).abs() <= 8.0 * 512.0 * 4.0 / std::f64::consts::PI / 512.0_f64.powi(2), "{disk}");
    // The cells on the hypotenuse are wrong by at most half their area of density 2 each.
    let triangle = square_integral(512, |u| f64::from(triangle_pdf_uv(u)));
    assert!((triangle - 1.0).abs() <= 512.0 / 512.0_f64.powi(2), "{triangle}");
    // Linear on each side of 0, which is an edge of cells: only rounding, 4 of each summand.
    let tent = square_integral(64, |u| 4.0 * f64::from(tent_pdf(4.0 * u[0] - 2.0, 2.0)));
    assert!((tent - 1.0).abs() <= 4.0 * f64::from(ROUNDING), "{tent}");
}
