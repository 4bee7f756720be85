//! Points of every shape are uniform by area.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level};
use verify::domain::{Directions, Disk, Domain, Parallelogram, Triangle};

use super::super::pointwise::single;
use super::{A, B, CENTRE, LENGTH, Lamp, RADIUS, TRIANGLES, VERTICES, axes, flat, triangle_corners};
use crate::{bounds, wrong};

pub(super) fn claims() -> Vec<Claim> {
    vec![rectangle(), triangle(), disk(), sphere(), mesh(), cylinder()]
}

/// A test of the points of `lamp`, which `to_point` takes to the domain.
fn test<D: Domain>(
    domain: D,
    lamp: &Lamp,
    to_point: impl Fn(DVec3, DVec3) -> D::Point + Send + Sync + 'static,
) -> ChiSquare<D> {
    let shape = lamp.placed();
    let sample = move |u: [f64; 2]| {
        let surface = shape.sample_area(u.map(single));
        Some(to_point(surface.point.as_dvec3(), surface.ng.as_dvec3()))
    };
    ChiSquare::on(domain).samples(sample).bound(bounds::LOBE)
}

fn parallelogram() -> Parallelogram<3> {
    let corner = flat([-1.0, -1.0]).to_array();
    Parallelogram::new(corner, [(2.0 * A).to_array(), (2.0 * B).to_array()])
        .expect("A and B are not parallel")
}

fn rectangle() -> Claim {
    test(parallelogram(), &super::rectangle(), |p, _| p.to_array())
        .rejects("filled like a disk", |u: [f64; 2]| Some(flat(wrong::rectangle_as_disk(u)).to_array()))
        .claim("light/rectangle/uniform", "points of a rectangular light are uniform on it")
}

fn triangle() -> Claim {
    let [a, b, c] = triangle_corners();
    let at = move |[u, v]: [f64; 2]| (a + u * (b - a) + v * (c - a)).to_array();
    let domain = Triangle::new([a, b, c].map(|p| p.to_array())).expect("not degenerate");
    test(domain, &super::triangle(), |p, _| p.to_array())
        .rejects("not folded", move |u: [f64; 2]| wrong::triangle_unfolded(u).map(at))
        .rejects("weights divided by their sum", move |u: [f64; 2]| Some(at(wrong::triangle_normalised(u))))
        .claim("light/triangle/uniform", "points of a triangular light are uniform on it")
}

fn disk() -> Claim {
    let [x, y] = axes();
    let to_disk = move |p: DVec3, _| [x, y].map(|axis| axis.dot(p - CENTRE));
    test(Disk::of_radius(RADIUS), &super::disk(), to_disk)
        .rejects("disk without square root", |u: [f64; 2]| {
            Some(wrong::disk_without_root(u).map(|c| RADIUS * c))
        })
        .rejects("disk 1 % too small", |[u, v]: [f64; 2]| {
            Some(wrong::rectangle_as_disk([u, v]).map(|c| 0.99 * RADIUS * c))
        })
        .claim("light/disk/uniform", "points of a light that is a disk are uniform on it")
}

fn sphere() -> Claim {
    test(Directions::sphere(), &super::sphere(), |_, n| n.to_array())
        .rejects("uniform angles", |u: [f64; 2]| Some(wrong::sphere_by_angles(u)))
        .rejects("a cube's points normalised", |u: [f64; 3]| Some(wrong::sphere_from_cube(u)))
        .claim("light/sphere/uniform", "points of a light that is a sphere are uniform on it")
}

fn cylinder() -> Claim {
    let domain = Parallelogram::rectangle([0.0; 2], [TAU * RADIUS, LENGTH]).expect("not degenerate");
    let unrolled = |p: DVec3, n: DVec3| {
        let turn = n.y.atan2(n.x).rem_euclid(TAU);
        [RADIUS * turn.min(TAU.next_down()), (CENTRE.z - p.z).clamp(0.0, LENGTH)]
    };
    test(domain, &super::cylinder(), unrolled)
        .rejects("crowded at the ends", |[u, v]: [f64; 2]| {
            Some([TAU * RADIUS * u, LENGTH * 0.5 * (1.0 - (PI * v).cos())])
        })
        .claim("light/cylinder/uniform", "points of a light that is a cylinder are uniform on it")
        .from_level(Level::Standard)
}

fn mesh() -> Claim {
    let triangles = TRIANGLES.map(|t| t.map(|i| flat(VERTICES[i as usize]).to_array()));
    test(parallelogram(), &super::mesh(), |p, _| p.to_array())
        .rejects("triangles chosen by index", move |u: [f64; 3]| wrong::mesh_by_index(u, &triangles))
        .rejects("one triangle 5 % too rare", move |u: [f64; 3]| rarer(u, &triangles))
        .claim("light/mesh/uniform", "points of a mesh of unequal triangles are uniform on it")
}

/// Points by area, but 1 in 20 points of the largest triangle, the fifth, falls on the sixth instead.
fn rarer([w, u, v]: [f64; 3], triangles: &[[[f64; 3]; 3]; 6]) -> Option<[f64; 3]> {
    let doubled = |[a, b, c]: [[f64; 3]; 3]| {
        let [a, b, c] = [a, b, c].map(DVec3::from);
        DMat3::from_cols(b - a, c - a, A.cross(B).normalize()).determinant()
    };
    let whole: f64 = triangles.iter().map(|t| doubled(*t)).sum();
    let (mut index, mut place) = (0, w * whole);
    while index < 5 && place > doubled(triangles[index]) {
        place -= doubled(triangles[index]);
        index += 1;
    }
    if index == 4 && place < 0.05 * doubled(triangles[4]) {
        index = 5;
    }
    wrong::mesh_by_index([0.0, u, v], &triangles[index..=index])
}
