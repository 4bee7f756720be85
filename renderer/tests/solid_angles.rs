//! Maps to shapes by solid angle, from 1e-10 sr to the hemisphere: each number shares out what it says it does.

use glam::DVec3;
use proptest::prelude::*;
use renderer::sampling::warp::{SphericalRectangle, SphericalTriangle};

mod cases;

/// Solid angles for which precision is promised.
const PROMISED: f64 = 1e-10;

/// The relative error that is promised.
const ERROR: f64 = 1e-9;

/// A length between these powers of ten, evenly in its logarithm.
fn power(least: f64, largest: f64) -> impl Strategy<Value = f64> {
    (least..largest).prop_map(|exponent| 10.0_f64.powf(exponent))
}

/// The error of a place within a shape that is promised, in units of its size.
const PLACE: f64 = 1e-6;

fn triangle(corners: [DVec3; 3]) -> f64 {
    SphericalTriangle::new(corners).map_or(0.0, |seen| seen.solid_angle())
}

/// An orthonormal frame's image of the corners of a flat figure.
fn placed(points: [[f64; 3]; 3], [yaw, pitch, roll]: [f64; 3]) -> [DVec3; 3] {
    let turn = glam::DMat3::from_euler(glam::EulerRot::ZYX, yaw, pitch, roll);
    points.map(|p| turn * DVec3::from(p))
}

proptest! {
    #![proptest_config(cases::config(10_000))]

    #[test]
    fn first_number_shares_out_a_rectangle_between_its_sides(
        x in -3.0..3.0_f64, y in -3.0..3.0_f64, a in power(-5.0, 1.0), aspect in power(-2.0, 2.0),
        h in power(-2.0, 1.0), u in 0.0..1.0_f64,
    ) {
        let b = aspect * a;
        let whole = SphericalRectangle::new([x, y], [a, b], h);
        prop_assume!(whole.solid_angle() > PROMISED);
        let [share, _] = whole.sample([u, 0.5]);
        let part = SphericalRectangle::new([x, y], [share * a, b], h).solid_angle();
        prop_assert!((part / whole.solid_angle() - u).abs() <= PLACE, "{} of {whole:?}", part / whole.solid_angle());
    }

    #[test]
    fn second_number_shares_out_a_strip_of_a_rectangle(
        x in -3.0..3.0_f64, y in -3.0..3.0_f64, a in 0.1..3.0_f64, b in 0.1..3.0_f64, h in 0.1..3.0_f64,
        u in 0.0..1.0_f64, v in 0.0..1.0_f64,
    ) {
        let [share_x, share_y] = SphericalRectangle::new([x, y], [a, b], h).sample([u, v]);
        let width = 1e-4 * h;
        let strip = |height| {
            SphericalRectangle::new([x + share_x * a - 0.5 * width, y], [width, height], h).solid_angle()
        };
        // A strip is its middle line but for width²/24 of the second derivative, which is below 60/h².
        prop_assert!((strip(share_y * b) / strip(b) - v).abs() < 1e-7);
    }

    #[test]
    fn a_rectangle_is_two_triangles(
        x in -3.0..3.0_f64, y in -3.0..3.0_f64, a in power(-5.0, 1.0), b in power(-5.0, 1.0), h in power(-2.0, 1.0),
    ) {
        let corner = |i: f64, j: f64| DVec3::new(x + i * a, y + j * b, h);
        let parts = triangle([corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)])
            + triangle([corner(0.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]);
        let whole = SphericalRectangle::new([x, y], [a, b], h).solid_angle();
        prop_assert!((whole - parts).abs() <= ERROR * parts, "{whole} {parts}");
    }

    #[test]
    fn numbers_share_out_a_triangle(
        x in -3.0..3.0_f64, y in -3.0..3.0_f64, size in power(-5.0, 1.0), aspect in power(-2.0, 0.0),
        slant in -1.0..2.0_f64, h in power(-2.0, 1.0), turn in prop::array::uniform3(-3.0..3.0_f64), u in 0.0..1.0_f64, v in 0.0..1.0_f64,
    ) {
        let [p, q, r] = placed([[x, y, h], [x + size, y, h], [x + slant * size, y + aspect * size, h]], turn);
        let seen = SphericalTriangle::new([p, q, r]);
        prop_assume!(seen.is_some_and(|s| s.solid_angle() > PROMISED && s.solid_angle() < 6.0));
        let seen = seen.expect("assumed");
        let at = |v| {
            let [i, j] = seen.sample([u, v]);
            p + i * (q - p) + j * (r - p)
        };
        let part = triangle([p, q, at(1.0)]);
        prop_assert!((part / seen.solid_angle() - u).abs() <= PLACE, "{} of {seen:?}", part / seen.solid_angle());
        // 1 − cos of the angle to the second corner is half the squared distance of unit vectors.
        let fall = |point: DVec3| (point.normalize() - q.normalize()).length_squared();
        prop_assert!((fall(at(v)) - v * fall(at(1.0))).abs() <= PLACE * fall(at(1.0)));
    }
}

#[test]
fn corners_of_the_square_are_corners_of_the_shape() {
    let seen = SphericalRectangle::new([-0.3, 0.4], [2.0, 0.5], 0.7);
    for u in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
        let found = seen.sample(u);
        // A few roundings of numbers below 3.
        assert!((found[0] - u[0]).abs() < 1e-14 && (found[1] - u[1]).abs() < 1e-14, "{u:?}: {found:?}");
    }
    let corners = [DVec3::new(0.1, 0.2, 1.0), DVec3::new(1.0, 0.0, 1.2), DVec3::new(0.3, 1.0, 0.8)];
    let seen = SphericalTriangle::new(corners).expect("its plane misses the origin");
    for (u, exact) in [([0.3, 0.0], [1.0, 0.0]), ([0.0, 1.0], [0.0, 0.0]), ([1.0, 1.0], [0.0, 1.0])] {
        let found = seen.sample(u);
        assert!(
            (found[0] - exact[0]).abs() < 1e-14 && (found[1] - exact[1]).abs() < 1e-14,
            "{u:?}: {found:?}"
        );
    }
}

#[test]
fn a_plane_close_by_fills_the_hemisphere() {
    let seen = SphericalRectangle::new([-1.0, -1.0], [2.0, 2.0], 1e-9);
    // What is missing is seen at elevations below 1e-9 in each direction: less than 2π·√2·1e-9.
    assert!((seen.solid_angle() - std::f64::consts::TAU).abs() < 1e-8);
    assert_eq!(SphericalTriangle::new([DVec3::X, DVec3::Y, DVec3::new(-1.0, -1.0, 0.0)]).map(|_| ()), None);
}
