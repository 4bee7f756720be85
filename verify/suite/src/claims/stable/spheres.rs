//! Where rays meet spheres and cylinders, near and from up to 1e8 radii away.

use glam::{DAffine3, DVec3};
use renderer::interaction::SurfacePoint;
use renderer::shapes::{Shape, ShapeSettings};

use super::Entry;
use super::geometry::{ray, vector};
use super::numbers::{Numbers, rounded};
use super::routine::{ROUNDING, Routine, ulp};
use super::tables;

pub(super) fn entries() -> Vec<Entry> {
    vec![SPHERE.into(), SPHERE_POINT.into(), SPHERE_ROUNDED.into(), CYLINDER.into()]
}

fn ball(x: &[f64]) -> Option<Shape> {
    let settings = ShapeSettings::Sphere { center: vector(x), radius: 1.0 };
    Shape::new(&settings, &DAffine3::IDENTITY, false).ok()
}

const SPHERE: Routine<9, 1> = Routine {
    id: "sphere/1-to-1e8-radii",
    says: "a ray meets a sphere where it does, from inside and from up to 1e8 radii away",
    unit: "ulp",
    bound: 0.51, // Half a last place by the rounding to f32; f64 before adds 2⁻⁵³·D/√(r² − l²) of D, 1e-14·70 of it at most.
    one: |_, [t]| [ulp(*t)],
    table: tables::SPHERE,
    corners: &[[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1e8], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]],
    draw: |n| {
        let o = rounded(3.0 * n.direction());
        let d = rounded(n.direction());
        let side = DVec3::from(d).cross(n.direction()).normalize();
        let far = n.one_of([n.log(1.5, 1e8), n.unit() * 0.4]);
        let off = n.one_of([0.9 * n.unit(), 1.0 - n.log(1e-4, 1.0), 1.0 + n.log(1e-4, 1.0)]);
        let off = if far < 1.0 { 0.8 * off.min(1.0) } else { off };
        let c = DVec3::from(o) + far * DVec3::from(d) + off * side;
        [o[0], o[1], o[2], d[0], d[1], d[2], c.x, c.y, c.z]
    },
    draws: 4096,
    exact: |x| {
        let (o, d, c) = (vector(&x[..3]), vector(&x[3..6]), vector(&x[6..]));
        // Along and across the ray; the sphere's half chord from the distance across.
        let (f, dd) = (c - o, d.length_squared());
        let across = f.cross(d).length_squared() / dd;
        if across > 1.0 {
            return [-1.0];
        }
        let (along, half) = (f.dot(d) / dd, ((1.0 - across) / dd).sqrt());
        let near = if f.length_squared() > 1.0 && along > 0.0 {
            // Both roots' product over the far one keeps the digits of a near one.
            ((f.length() - 1.0) * (f.length() + 1.0)) / dd / (along + half)
        } else {
            along - half
        };
        [if near > 0.0 {
            near
        } else if along + half > 0.0 {
            along + half
        } else {
            -1.0
        }]
    },
    ours: |x| {
        let hit = ball(&x[6..]).and_then(|shape| shape.intersect(0, &ray(x)));
        [hit.map_or(-1.0, |h| f64::from(h.t))]
    },
    naive: ("b² − 4ac in single precision", |x| {
        let (o, d, c) = (vector(&x[..3]).as_vec3(), vector(&x[3..6]).as_vec3(), vector(&x[6..]).as_vec3());
        let f = o - c;
        let (a, b, c) = (d.length_squared(), 2.0 * f.dot(d), f.length_squared() - 1.0);
        let discriminant = b * b - 4.0 * a * c;
        if discriminant < 0.0 {
            return [-1.0];
        }
        let roots = [-1.0, 1.0].map(|sign| (-b + sign * discriminant.sqrt()) / (2.0 * a));
        [roots.into_iter().find(|t| *t > 0.0).map_or(-1.0, f64::from)]
    }),
};

/// The point of the hit of a ray that is given by its numbers.
fn hit_point(x: &[f64; 9]) -> Option<SurfacePoint> {
    let (shape, ray) = (ball(&x[6..])?, ray(x));
    Some(shape.surface(0, &shape.intersect(0, &ray)?, &ray))
}

/// The same in the usual form: origin plus distance times direction, in single precision.
fn usual_point(x: &[f64; 9]) -> Option<DVec3> {
    let ray = ray(x);
    Some(ray.at(ball(&x[6..])?.intersect(0, &ray)?.t).as_dvec3())
}

/// A sphere near the frame's origin, met by a ray from as far as [`SPHERE`]'s: a place far away is rounded by up to 4 at 1e8, and so the
/// sphere is put beside the line that the rounded numbers draw.
fn sphere_at_home(n: &Numbers) -> [f64; 9] {
    let [_, _, _, d @ .., c_x, c_y, c_z] = (SPHERE.draw)(n);
    let (d, c) = (DVec3::from(d), DVec3::new(c_x, c_y, c_z));
    let o = DVec3::from(rounded(-c));
    let nearest = o - o.dot(d) / d.length_squared() * d;
    let off = n.unit() * d.cross(n.direction()).normalize();
    let c = nearest + off;
    [o.x, o.y, o.z, d.x, d.y, d.z, c.x, c.y, c.z]
}

/// How far the point of a hit is from its sphere, as a share of the error bound that it carries.
const SPHERE_POINT: Routine<9, 1> = Routine {
    id: "sphere/point",
    says: "the point of a hit lies within its own error bound of the sphere, from up to 1e7 radii away and, of a sphere near the \
           camera, from up to 1e8",
    unit: "the point's error bound",
    bound: 1.0, // The bound's own claim.
    one: |x, _| [hit_point(x).map_or(1.0, |point| f64::from(point.ng.abs().dot(point.error)))],
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        if n.unit() < 0.5 {
            return sphere_at_home(n);
        }
        let mut x = (SPHERE.draw)(n);
        // From 2²⁴ radii on a place is rounded by more than the radius, and nothing lies near the sphere: what is left to ask there is
        // whether the point is the exact one rounded, as `sphere/point-rounded` does.
        let (o, c) = (vector(&x[..3]), vector(&x[6..]));
        if (c - o).length() > 1e7 {
            x[6..].copy_from_slice(&(o + 0.1 * (c - o)).to_array());
        }
        x
    },
    draws: 2048,
    exact: |_| [0.0],
    ours: |x| [hit_point(x).map_or(0.0, |hit| (hit.point.as_dvec3() - vector(&x[6..])).length() - 1.0)],
    naive: ("origin plus distance times direction", |x| {
        [usual_point(x).map_or(0.0, |point| (point - vector(&x[6..])).length() - 1.0)]
    }),
};

/// The point of a hit against the exact one.
const SPHERE_ROUNDED: Routine<9, 3> = Routine {
    id: "sphere/point-rounded",
    says: "the point of a hit is the exact one rounded to single precision, from inside and from up to 1e8 radii away, wherever the \
           sphere is",
    unit: "half a last place of the coordinate, or 2⁻⁴⁴ of the distance",
    // One by the rounding. Two distances in f64 differ by 2⁻⁵³·D, or 70 times that where the ray nearly passes the sphere (see `SPHERE`),
    // a step that both derivations make: 2·70·2⁻⁵³ = 0.28 of 2⁻⁴⁴.
    bound: 1.3,
    one: |x, exact| {
        let far = (vector(&x[6..]) - vector(&x[..3])).length() + 1.0;
        exact.map(|c| (c.abs() * ROUNDING).max(far * 2f64.powi(-44)))
    },
    table: tables::NONE,
    corners: &[],
    draw: |n| if n.unit() < 0.5 { sphere_at_home(n) } else { (SPHERE.draw)(n) },
    draws: 2048,
    exact: |x| {
        let [t] = (SPHERE.exact)(x);
        if t < 0.0 { [0.0; 3] } else { (vector(&x[..3]) + t * vector(&x[3..6])).to_array() }
    },
    ours: |x| hit_point(x).map_or([0.0; 3], |hit| hit.point.as_dvec3().to_array()),
    naive: ("origin plus distance times direction", |x| {
        usual_point(x).map_or([0.0; 3], |point| point.to_array())
    }),
};

/// Origin, direction and centre in the plane across z.
fn flattened(x: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|i| if i % 3 == 2 { 0.0 } else { x[i] })
}

/// A cylinder of radius 1 along z, longer than any ray gets.
const CYLINDER: Routine<9, 1> = Routine {
    id: "cylinder/1-to-1e8-radii",
    says: "a ray meets a cylinder where it does, from inside and from up to 1e8 radii away",
    bound: 0.51, // As for the sphere: the same quadratic, in the plane across the axis.
    table: tables::NONE,
    corners: &[],
    draw: |n| {
        let o = rounded(3.0 * n.direction());
        let (sin, cos) = (std::f64::consts::TAU * n.unit()).sin_cos();
        let (along, across) = (DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0));
        let d = rounded((along + n.between(-0.5, 0.5) * DVec3::Z).normalize());
        let far = n.one_of([n.log(1.5, 1e8), n.unit() * 0.4]);
        let off = n.one_of([0.9 * n.unit(), 1.0 - n.log(1e-4, 1.0), 1.0 + n.log(1e-4, 1.0)]);
        let off = if far < 1.0 { 0.8 * off.min(1.0) } else { off };
        let c = DVec3::from(o) + far * DVec3::new(d[0], d[1], 0.0).normalize() + off * across;
        [o[0], o[1], o[2], d[0], d[1], d[2], c.x, c.y, o[2]]
    },
    exact: |x| (SPHERE.exact)(&flattened(x)),
    ours: |x| {
        let (c, reach) = (vector(&x[6..]), 4e8 * DVec3::Z);
        let settings = ShapeSettings::Cylinder { p0: c - reach, p1: c + reach, radius: 1.0 };
        let shape = Shape::new(&settings, &DAffine3::IDENTITY, false).ok();
        let hit = shape.and_then(|shape| shape.intersect(0, &ray(x)));
        [hit.map_or(-1.0, |h| f64::from(h.t))]
    },
    naive: ("b² − 4ac in single precision", |x| (SPHERE.naive.1)(&flattened(x))),
    ..SPHERE
};
