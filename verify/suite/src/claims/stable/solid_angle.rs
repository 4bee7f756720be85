//! Solid angles of triangles and rectangles from 1e-12 sr to the hemisphere, and the places that samplers find by them.

use glam::DVec3;
use renderer::sampling::warp::{SphericalRectangle, SphericalTriangle};

use super::Entry;
use super::numbers::Numbers;
use super::routine::Routine;
use super::tables;

pub(super) fn entries() -> Vec<Entry> {
    vec![TRIANGLE.into(), RECTANGLE.into(), TRIANGLE_PLACE.into(), RECTANGLE_PLACE.into()]
}

fn corners(x: &[f64]) -> [DVec3; 3] {
    [0, 3, 6].map(|i| DVec3::new(x[i], x[i + 1], x[i + 2]))
}

fn of_triangle(corners: [DVec3; 3]) -> f64 {
    SphericalTriangle::new(corners).map_or(0.0, |t| t.solid_angle())
}

/// The solid angle from its half's tangent.
///
/// # Source
/// van Oosterom and Strackee 1983, doi 10.1109/TBME.1983.325207.
fn tangent([a, b, c]: [DVec3; 3]) -> f64 {
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot((b - a).cross(c - a)).abs().atan2(below)
}

/// Corners at distances of about 1, about `size` apart.
fn around(n: &Numbers, size: f64) -> [f64; 9] {
    let centre = n.direction();
    let p = [(); 3].map(|()| centre + size * n.direction());
    std::array::from_fn(|i| p[i / 3][i % 3])
}

const TRIANGLE: Routine<9, 1> = Routine {
    id: "solid-angle/triangle",
    says: "solid angles of triangles from 1e-12 sr to 2π keep their digits, slivers and points in their plane included",
    unit: "relative error, or 1e-16 sr",
    // Edges have 2⁻⁵³ of the corners' size; of a triangle 1e-6 wide that is 1e-10 of them, and some ten such roundings;
    // slivers have an absolute error of 2⁻⁵³ of their size.
    bound: 4e-9,
    one: |x, [exact]| {
        let [a, b, c] = corners(x);
        let size = (b - a).length() + (c - a).length();
        [exact.max(size * 1e-7)]
    },
    table: tables::TRIANGLE_SOLID_ANGLE,
    corners: &[
        // In its plane, in the plane through a corner, on a corner, on an edge.
        [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0],
        [1.0, 0.0, 1.0, 2.0, 0.0, 2.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    ],
    draw: |n| {
        let size = n.log(1e-6, 1e3);
        around(n, size)
    },
    draws: 1024,
    // L'Huilier's theorem, the other exact one, cancels for slivers: this is the same tangent, from edges at the first corner.
    exact: |x| [tangent(corners(x))],
    ours: |x| [of_triangle(corners(x))],
    naive: ("sum of the corners' angles by arc cosine, less π", |x| {
        let [a, b, c] = corners(x).map(DVec3::normalize);
        let angle = |p: DVec3, q: DVec3, r: DVec3| p.cross(q).normalize().dot(p.cross(r).normalize()).acos();
        [angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - std::f64::consts::PI]
    }),
};

fn rectangle([x0, y0, x1, y1, z]: &[f64; 5]) -> SphericalRectangle {
    SphericalRectangle::new([*x0, *y0], [x1 - x0, y1 - y0], *z)
}

const RECTANGLE: Routine<5, 1> = Routine {
    id: "solid-angle/rectangle",
    says: "solid angles of rectangles keep their digits from heights of 1e-8 to 1e6, slivers of 1e-6 included",
    unit: "relative error",
    // A side of 1e-6 at a place of 2 is a difference of numbers that are rounded by 2⁻⁵³: 4e-10 of it, for two sides.
    bound: 2e-9,
    one: |_, exact| *exact,
    table: tables::RECTANGLE_SOLID_ANGLE,
    // Over the middle, over a corner, over an edge.
    corners: &[[-1.0, -1.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0, 1e-8], [-1.0, 0.0, 1.0, 1.0, 1e-8]],
    draw: |n| {
        let [x0, y0] = [n.between(-2.0, 2.0), n.between(-2.0, 2.0)];
        [x0, y0, x0 + n.log(1e-3, 10.0), y0 + n.log(1e-3, 10.0), n.log(1e-3, 1e3)]
    },
    draws: 1024,
    // Two triangles, or four around the foot, by the same tangent as theirs; far triangles keep their digits.
    exact: |[x0, y0, x1, y1, z]| {
        let [a, b, c, d] = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| DVec3::new(*x, *y, *z));
        [tangent([a, b, c]) + tangent([a, c, d])]
    },
    ours: |x| [rectangle(x).solid_angle()],
    naive: ("sum of the edges' angles by arc cosine, less 2π", |[x0, y0, x1, y1, z]| {
        let [n0, n1, n2, n3] = [
            DVec3::new(0.0, *z, -y0),
            DVec3::new(-z, 0.0, *x1),
            DVec3::new(0.0, -z, *y1),
            DVec3::new(*z, 0.0, -x0),
        ]
        .map(DVec3::normalize);
        let angle = |a: DVec3, b: DVec3| (-a.dot(b)).acos();
        [angle(n0, n1) + angle(n1, n2) + angle(n2, n3) + angle(n3, n0) - std::f64::consts::TAU]
    }),
};

const TRIANGLE_PLACE: Routine<10, 1> = Routine {
    id: "solid-angle/triangle-sampler",
    says: "the sampler of a triangle leaves the share u of its solid angle to one side, from 1e-12 sr on",
    unit: "share of the solid angle",
    bound: 1e-6, // What the routine promises; numbers of 24 digits have steps of 6e-8.
    one: |_, _| [1.0],
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        // Seen from outside: more than a hundredth of its size away from its plane.
        let size = n.log(1e-6, 3.0);
        let x = open_triangle(n, size);
        std::array::from_fn(|i| if i < 9 { x[i] } else { n.sampler() })
    },
    draws: 1024,
    exact: |x| [x[9]],
    ours: |x| place(x, |triangle, u| triangle.sample([u, 1.0])[1]),
    naive: ("by area", |x| place(x, |_, u| u)),
};

/// A triangle that is no sliver as seen from the origin: its corners are turned about the view by a third of a circle each.
fn open_triangle(n: &Numbers, size: f64) -> [f64; 9] {
    let centre = n.direction();
    let (x, y) = centre.any_orthonormal_pair();
    let start = n.unit();
    let p = [0.0, 1.0, 2.0].map(|k: f64| {
        let (sin, cos) = (std::f64::consts::TAU * (start + (k + 0.5 * n.unit()) / 3.0)).sin_cos();
        centre + size * (cos * x + sin * y + 0.5 * n.between(-1.0, 1.0) * centre)
    });
    std::array::from_fn(|i| p[i / 3][i % 3])
}

/// The share of a triangle's solid angle on one side of the place at `share` of the side from the first to the third corner.
fn place(x: &[f64; 10], share: impl Fn(&SphericalTriangle, f64) -> f64) -> [f64; 1] {
    let [a, b, c] = corners(x);
    let Some(triangle) = SphericalTriangle::new([a, b, c]) else { return [f64::NAN] };
    let at = a + share(&triangle, x[9]) * (c - a);
    [of_triangle([a, b, at]) / triangle.solid_angle()]
}

const RECTANGLE_PLACE: Routine<6, 1> = Routine {
    id: "solid-angle/rectangle-sampler",
    says: "the sampler of a rectangle leaves the share u of its solid angle to one side, from 1e-12 sr on",
    unit: "share of the solid angle",
    bound: 1e-6, // As for triangles.
    one: |_, _| [1.0],
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        let size = n.log(3e-6, 3.0);
        let [x0, y0] = [n.between(-2.0, 2.0), n.between(-2.0, 2.0)];
        [x0, y0, x0 + size, y0 + size * n.log(0.1, 10.0), n.log(0.1, 10.0), n.sampler()]
    },
    draws: 1024,
    exact: |x| [x[5]],
    ours: |x| placed(x, |rectangle, u| rectangle.sample([u, 0.5])[0]),
    naive: ("by area", |x| placed(x, |_, u| u)),
};

/// The share of a rectangle's solid angle on one side of the line at `share` of its width.
fn placed(x: &[f64; 6], share: impl Fn(&SphericalRectangle, f64) -> f64) -> [f64; 1] {
    let [x0, y0, x1, y1, z, u] = *x;
    let whole = SphericalRectangle::new([x0, y0], [x1 - x0, y1 - y0], z);
    let width = share(&whole, u) * (x1 - x0);
    if width == 0.0 {
        return [0.0];
    }
    [SphericalRectangle::new([x0, y0], [width, y1 - y0], z).solid_angle() / whole.solid_angle()]
}
