//! Maps onto disk, triangle, parallelogram and interval.

use std::f64::consts::FRAC_1_PI;

use glam::{Vec2, Vec3};
use renderer::sampling::warp;
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, claim};
use verify::domain::{Disk, Interval, Parallelogram, Triangle};

use super::super::pointwise::{never, rejecting, same_density, single};
use super::inverse;
use crate::{bounds, wrong};

/// Vertices of the skewed parallelogram that is tested: p0, p1 and p2.
const CORNERS: [[f64; 3]; 3] = [[1.0, -2.0, 0.5], [4.0, -1.0, 1.5], [0.5, 2.0, 2.0]];

/// Radius of the tent that is tested.
const RADIUS: f64 = 2.0;

/// Relative error that rounding leaves in a constant density: two roundings of 2⁻²⁴.
const CONSTANT: f64 = 1.2e-7;

pub(super) fn claims() -> Vec<Claim> {
    let mut list = disk();
    list.extend(triangle());
    list.extend(parallelogram());
    list.extend(tent());
    list
}

fn disk() -> Vec<Claim> {
    let test = |map: fn([f32; 2]) -> Vec2| {
        ChiSquare::on(Disk::unit())
            .density(|_| FRAC_1_PI)
            .samples(move |u: [f64; 2]| Some(map(u.map(single)).to_array().map(f64::from)))
            .rejects("disk without square root", |u: [f64; 2]| Some(wrong::disk_without_root(u)))
            .rejects("disk with exponent 0.51", |u: [f64; 2]| Some(wrong::disk_with_exponent_051(u)))
            .bound(bounds::DISTRIBUTION)
    };
    let concentric = test(warp::square_to_disk)
        .rejects("square stretched along rays", |u: [f64; 2]| Some(wrong::disk_stretched(u)));
    let off_disk = |p: Vec2| p.normalize_or_zero() * (p.length() + 1.001);
    let pdf_misses = move |u: [f64; 2], pdf: &dyn Fn(Vec2) -> f32| {
        let p = warp::square_to_disk(u.map(single));
        !same_density(pdf(p), FRAC_1_PI, CONSTANT) || p != Vec2::ZERO && pdf(off_disk(p)) != 0.0
    };
    let pdf = claim("warp/disk/pdf", "the disk's density is 1/π on it and 0 off it");
    let pdf = rejecting(pdf, "1/π everywhere", move |u| pdf_misses(u, &|_| warp::disk_pdf(Vec2::ZERO)));
    vec![
        concentric.claim("warp/disk/concentric", "points of the concentric map are uniform on the disk"),
        test(warp::square_to_disk_polar)
            .claim("warp/disk/polar", "points at radius √ξ₁ and angle 2πξ₂ are uniform on the disk"),
        never(pdf, "share of points with another density", move |u| pdf_misses(u, &warp::disk_pdf)),
        inverse(
            "warp/disk/concentric-inverse",
            "the concentric map's inverse gives its numbers back",
            |u| warp::disk_to_square(warp::square_to_disk(u)),
            ("inverse of the polar map", |u| warp::disk_polar_to_square(warp::square_to_disk(u))),
        ),
        inverse(
            "warp/disk/polar-inverse",
            "the polar map's inverse gives its numbers back",
            |u| warp::disk_polar_to_square(warp::square_to_disk_polar(u)),
            ("radius in the place of its square", |u| {
                let [square, turn] = warp::disk_polar_to_square(warp::square_to_disk_polar(u));
                [square.sqrt(), turn]
            }),
        ),
    ]
}

fn triangle() -> Vec<Claim> {
    let weights = || Triangle::new([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).expect("half of the unit square");
    let test = |map: fn([f32; 2]) -> [f32; 2]| {
        ChiSquare::on(weights())
            .density(|_| 2.0)
            .samples(move |u: [f64; 2]| Some(map(u.map(single)).map(f64::from)))
            .bound(bounds::SHAPES)
            .rejects("weights divided by their sum", |u: [f64; 2]| Some(wrong::triangle_normalised(u)))
    };
    let root = test(warp::square_to_triangle)
        .rejects("map without square root", |u: [f64; 2]| Some(wrong::triangle_without_root(u)));
    // folding brings u and 1 − u to the same place: an error δ(−1 − ln u) has the RMS 0.42 δ there, and 5.2 · 0.42 = 2.2
    let folded =
        test(warp::square_to_triangle_folded).rejects("not folded", wrong::triangle_unfolded).defect_of(5.2);
    let pdf_misses = |u: [f64; 2], pdf: &dyn Fn([f32; 2]) -> f32| {
        let b = warp::square_to_triangle(u.map(single));
        let outside =
            [[b[0] + 1.001, b[1]], [b[0], b[1] + 1.001], [-0.001 - b[0], b[1]], [b[0], -0.001 - b[1]]];
        !same_density(pdf(b), 2.0, CONSTANT) || outside.into_iter().any(|b| pdf(b) != 0.0)
    };
    let pdf = claim("warp/triangle/pdf", "the triangle's density is 2 per unit of its weights and 0 outside");
    let pdf = rejecting(pdf, "density of the square", move |u| pdf_misses(u, &|_| 1.0));
    vec![
        root.claim("warp/triangle/root", "points of the area-preserving map are uniform on the triangle"),
        folded.claim("warp/triangle/folded", "points folded where ξ₁ + ξ₂ > 1 are uniform on the triangle"),
        never(pdf, "share of points with another density", move |u| pdf_misses(u, &warp::triangle_pdf_uv)),
        inverse(
            "warp/triangle/inverse",
            "the triangle's inverse gives its numbers back",
            |u| warp::triangle_to_square(warp::square_to_triangle(u)),
            ("inverse of the map without square root", |u| {
                let [square, v] = warp::triangle_to_square(warp::square_to_triangle(u));
                [square.sqrt(), v]
            }),
        ),
    ]
}

fn parallelogram() -> Vec<Claim> {
    let corners = || CORNERS.map(|p| Vec3::from_array(p.map(single_exact)));
    let edges = [1, 2].map(|i| std::array::from_fn(|axis| CORNERS[i][axis] - CORNERS[0][axis]));
    let domain = Parallelogram::new(CORNERS[0], edges).expect("the edges are not parallel");
    let area = verify::domain::Domain::measure(&domain);
    let map = move |u: [f64; 2]| {
        let p = warp::square_to_parallelogram(u.map(single), corners());
        Some(p.to_array().map(f64::from))
    };
    let uniform = ChiSquare::on(domain)
        .density(move |_| 1.0 / area)
        .samples(map)
        .bound(bounds::SHAPES)
        .rejects("product of both numbers along one edge", |u| {
            Some(wrong::parallelogram_sheared(u, CORNERS))
        });
    // Two cross products, a sum of squares, a root and a quotient: at most 12 roundings of 2⁻²⁴.
    let misses = move |[scale, _]: [f64; 2], pdf: &dyn Fn([Vec3; 3]) -> f32| {
        let scale = 0.5 + single(scale);
        let closed_form = 1.0 / (area * f64::from(scale) * f64::from(scale));
        !same_density(pdf(corners().map(|p| scale * p)), closed_form, 7.2e-7)
    };
    let pdf = claim(
        "warp/parallelogram/pdf",
        "the parallelogram's density is one over the length of its edges' cross product",
    );
    let of_lengths = |[a, b, c]: [Vec3; 3]| 1.0 / (a.distance(b) * a.distance(c));
    let pdf = rejecting(pdf, "one over the product of its edges", move |u| misses(u, &of_lengths));
    vec![
        uniform.claim(
            "warp/parallelogram/uniform",
            "points (1 − u − v)p0 + u·p1 + v·p2 are uniform on the parallelogram",
        ),
        never(pdf, "share of sizes with another density", move |u| misses(u, &warp::parallelogram_pdf_area)),
        inverse(
            "warp/parallelogram/inverse",
            "the parallelogram's inverse gives its numbers back",
            move |u| warp::parallelogram_to_square(warp::square_to_parallelogram(u, corners()), corners()),
            ("projection onto edges that are not orthogonal", move |u| {
                let [a, b, c] = corners();
                let d = warp::square_to_parallelogram(u, corners()) - a;
                [b - a, c - a].map(|edge| d.dot(edge) / edge.length_squared())
            }),
        ),
    ]
}

/// A coordinate of the tested shapes, each of which has few bits.
fn single_exact(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "exact: few bits")]
    let exact = x as f32;
    exact
}

fn tent() -> Vec<Claim> {
    let radius = single_exact(RADIUS);
    let closed_form = |x: f64| (1.0 - x.abs() / RADIUS).max(0.0) / RADIUS;
    let test = ChiSquare::on(Interval::new(-RADIUS, RADIUS).expect("not empty"))
        .density(closed_form)
        .samples(move |[u]: [f64; 1]| Some(f64::from(warp::unit_to_tent(single(u), radius))))
        .bound(bounds::SHAPES)
        .rejects("right half without its root", |[u]: [f64; 1]| Some(wrong::tent_half_rooted(u, RADIUS)))
        .rejects("box", |[u]: [f64; 1]| Some(wrong::tent_as_box(u, RADIUS)));
    // Quotient, difference and quotient: roundings of 2⁻²⁴ of 1, three at most.
    let misses = move |[u]: [f64; 1], pdf: &dyn Fn(f32) -> f32| {
        let x = 3.0 * radius * (single(u) - 0.5);
        (f64::from(pdf(x)) - closed_form(f64::from(x))).abs() > 1.8e-7
    };
    let pdf = claim("warp/tent/pdf", "the tent's density falls linearly from 1/r to 0 at ±r");
    let pdf = rejecting(pdf, "not divided by the radius", move |u| {
        misses(u, &|x| radius * warp::tent_pdf(x, radius))
    });
    vec![
        test.claim("warp/tent/distribution", "offsets follow the tent's density"),
        never(pdf, "share of points with another density", move |u| {
            misses(u, &|x| warp::tent_pdf(x, radius))
        }),
        inverse(
            "warp/tent/inverse",
            "the tent's inverse gives its number back",
            move |[u, v]| [warp::tent_to_unit(warp::unit_to_tent(u, radius), radius), v],
            ("inverse of the box", move |[u, v]| [0.5 + 0.5 * warp::unit_to_tent(u, radius) / radius, v]),
        ),
    ]
}
