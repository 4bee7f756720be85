//! Points on lights by solid angle: uniform in it, with its inverse as their density.

use glam::{DQuat, DVec3};
use renderer::accel::Accel;
use renderer::lights::LightSampling;
use verify::chi_square::{ChiSquare, Target};
use verify::claim::{Claim, claim};
use verify::domain::{Directions, Domain, Parallelogram, Triangle};
use verify::irradiance::{polygon_solid_angle, sphere_solid_angle};

use super::super::pointwise::{EPSILON, never, rejecting, same_density, single};
use super::density::found;
use super::{A, B, CENTRE, Lamp, RADIUS, SQUARE, eye, light, triangle_corners};
use crate::bounds;
use crate::setup::rectangle_at;

/// The claims.
pub(super) fn claims() -> Vec<Claim> {
    let corners = square_corners();
    let triangle = triangle_corners().map(|p| p.to_array());
    let parallelogram = SQUARE.map(|p| super::flat(p).to_array());
    vec![
        rectangle(),
        self::triangle(),
        sphere(),
        pdf(square(), move |from| polygon_solid_angle(from, &corners)),
        pdf(super::triangle(), move |from| polygon_solid_angle(from, &triangle)),
        // Six triangles, chosen by their solid angles, are one flat light.
        pdf(super::mesh(), move |from| polygon_solid_angle(from, &parallelogram)),
        pdf(super::sphere(), |from| sphere_solid_angle(RADIUS, (DVec3::from(from) - CENTRE).length())),
    ]
}

/// Which of a lamp's views the points are taken for: near and oblique.
const VIEW: usize = 1;

/// A test of the points of `lamp` seen from [`VIEW`], which `to_point` takes to the domain; those by area are wrong.
fn test<D: Domain>(target: Target<D>, lamp: &Lamp, to_point: fn(DVec3, DVec3) -> D::Point) -> ChiSquare<D> {
    let points = |sampling| {
        let (accel, from) = (lamp.alone(), eye(lamp.views[VIEW].0));
        move |u: [f64; 2]| {
            let object = &accel.objects()[0];
            let u = u.map(single);
            let by_angle = || object.sample_solid_angle(from.surface.point, u).map(|(point, _)| point);
            let point = match sampling {
                LightSampling::Area => Some(object.sample_area(u, 0.0).0),
                LightSampling::SolidAngle | LightSampling::Auto => by_angle(),
            };
            point.map(|p| to_point(p.point.as_dvec3(), from.surface.point.as_dvec3()))
        }
    };
    target
        .samples(points(LightSampling::SolidAngle))
        .bound(bounds::LOBE)
        .rejects("points by area", points(LightSampling::Area))
}

/// The density per area of a flat light's points, uniform in the solid angle from `from`: cos θ'/(d²·Ω).
fn flat_density(from: DVec3, solid_angle: f64) -> impl Fn([f64; 3]) -> f64 + Send + Sync {
    let height = A.cross(B).normalize().dot(from - CENTRE);
    move |p| height / ((DVec3::from(p) - from).length().powi(3) * solid_angle)
}

/// The other side of a rectangle with `A`: along the plane of `A` and `B`, at right angles to it.
fn other_side() -> DVec3 {
    0.6 * A.cross(B).cross(A).normalize()
}

fn square_corners() -> [[f64; 3]; 4] {
    SQUARE.map(|[x, y]| (CENTRE + x * A + y * other_side()).to_array())
}

/// The rectangle of [`square_corners`]; a parallelogram has no map by solid angle.
fn square() -> Lamp {
    Lamp {
        to_world: rectangle_at(CENTRE, A, other_side()),
        area: 4.0 * A.cross(other_side()).length(),
        views: super::views_of(&square_corners()),
        ..super::rectangle()
    }
}

fn rectangle() -> Claim {
    let lamp = square();
    let (from, solid_angle) = lamp.views[VIEW];
    let [corner, side, _, other] = square_corners().map(DVec3::from);
    let edges = [side - corner, other - corner].map(|e| e.to_array());
    let domain = Parallelogram::new(corner.to_array(), edges).expect("its sides are at right angles");
    let target = ChiSquare::on(domain).density(flat_density(from, solid_angle));
    test(target, &lamp, |p, _| p.to_array()).claim(
        "light/rectangle/uniform-in-solid-angle",
        "points of a rectangular light by solid angle are uniform in it",
    )
}

fn triangle() -> Claim {
    let lamp = super::triangle();
    let (from, solid_angle) = lamp.views[VIEW];
    let domain = Triangle::new(triangle_corners().map(|p| p.to_array())).expect("not degenerate");
    test(ChiSquare::on(domain).density(flat_density(from, solid_angle)), &lamp, |p, _| p.to_array()).claim(
        "light/triangle/uniform-in-solid-angle",
        "points of a triangular light by solid angle are uniform in it",
    )
}

fn sphere() -> Claim {
    let lamp = super::sphere();
    let distance = (lamp.views[VIEW].0 - CENTRE).length();
    let domain = Directions::cone((RADIUS / distance).asin());
    let to_cone = |point: DVec3, from: DVec3| {
        let turn = DQuat::from_rotation_arc((CENTRE - from).normalize(), DVec3::Z);
        (turn * (point - from).normalize()).to_array()
    };
    test(ChiSquare::on(domain), &lamp, to_cone).claim(
        "light/sphere/uniform-in-solid-angle",
        "points of a light that is a sphere, by solid angle, are uniform in it",
    )
}

/// The claim that the density of points by solid angle is its inverse.
///
/// * `exact`: the solid angle from a place.
fn pdf(lamp: Lamp, exact: impl Fn([f64; 3]) -> f64 + Clone + Send + Sync + 'static) -> Claim {
    let says = format!(
        "the density of a point on a light ({}) by solid angle is the inverse of that, by sampling and by hitting it",
        lamp.name
    );
    let mut builder = claim(format!("light/{}/pdf-in-solid-angle", lamp.name), says);
    for (name, factor) in [("a hemisphere for the sphere", 2.0), ("angle 1e-5 too large", 1.000_01)] {
        let (lamp, accel, exact) = (lamp.clone(), lamp.alone(), exact.clone());
        builder = rejecting(builder, name, move |u| misses(&lamp, &accel, u, |from| factor * exact(from)));
    }
    let accel = lamp.alone();
    never(builder, "share of points with another density", move |u| misses(&lamp, &accel, u, &exact))
}

fn misses(lamp: &Lamp, accel: &Accel, [u, v, place]: [f64; 3], exact: impl Fn([f64; 3]) -> f64) -> bool {
    let from = eye(lamp.views[0].0.lerp(lamp.views[1].0, place));
    let origin = from.surface.point.as_dvec3();
    let light = light(accel, LightSampling::SolidAngle);
    let Some(sample) = light.sample(accel, &from, [u, v].map(single)) else { return true };
    let hit = found(&light, accel, origin, sample.wi.as_dvec3()).or_else(|| {
        // at the rim a rounded direction passes the light; one turned towards its middle by sixteen roundings does not
        let inwards = 16.0 * EPSILON * (CENTRE - origin).normalize();
        found(&light, accel, origin, sample.wi.as_dvec3() + inwards)
    });
    let Some(hit) = hit else {
        // at the limb of a sphere the root of a rounding decides
        let rim = |u: f64| u.min(1.0 - u) < 1e-5;
        return !(lamp.bend > 0.0 && (rim(u) || rim(v)));
    };
    let exact = 1.0 / exact(origin.to_array());
    // A mesh's corners are rounded, by 2⁻²⁴ of coordinates below 4 at heights of 0.5 and more; so are both densities.
    let tolerance = 64.0 * EPSILON;
    !(same_density(sample.pdf, exact, tolerance) && same_density(hit, exact, tolerance))
}
