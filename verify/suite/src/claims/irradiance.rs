//! Irradiance of area lights through camera, film, integrator and lights, against closed forms.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DMat3, DVec3};
use renderer::scene::ObjectSettings;
use renderer::shapes::{MeshData, ShapeSettings};
use verify::claim::{Claim, Level, Run, claim};
use verify::irradiance::{
    Receiver, from_parallel_disk, from_parallel_rectangle, from_perpendicular_rectangle, from_polygon,
    from_sphere,
};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

mod meter;
mod random;

use crate::bounds;
use crate::setup::{built, irradiance, lamp, receiver, rectangle_at, remembering};

/// A light in a place, and the irradiance that it should give at the origin of a receiver that faces +z.
struct Place {
    lamp: ObjectSettings,
    exact: f64,
}

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let mut list = vec![
        from("irradiance/rectangle/parallel", "a rectangle parallel to the receiver", 256, parallel),
        from(
            "irradiance/rectangle/perpendicular",
            "a rectangle perpendicular to the receiver",
            256,
            perpendicular,
        ),
        from("irradiance/rectangle/tilted", "a tilted rectangle, partly below the horizon", 256, tilted),
        from("irradiance/disk/parallel", "a disk parallel to the receiver, on and off its axis", 512, disk),
        from("irradiance/sphere/tilted", "a sphere at any tilt, partly below the horizon", 1024, sphere),
        from("irradiance/triangle/tilted", "a tilted triangle of a mesh", 256, triangle),
    ];
    list.extend(random::claims());
    list.extend(meter::claims());
    list.into_iter().map(|claim| claim.same_up_to(Level::Standard)).collect()
}

/// Places, densities and sums in f32: 16 roundings of 2⁻²⁴ that all agree.
const ROUNDING: f64 = 1e-6;

/// The claim that a light in each of ten places gives the irradiance of the closed form.
///
/// * `places`: of a light that is as large as it should be times a factor.
fn from(id: &'static str, what: &'static str, samples: u32, places: fn(f64) -> Vec<Place>) -> Claim {
    let says = format!("{what}, in ten places, gives the irradiance of the closed form");
    let lit = LazyLock::new(move || Lit::new(places(1.0), samples));
    // a gross mistake shows with fewer samples too
    let large = LazyLock::new(move || Lit::new(places(2.0), samples / 8));
    let lit = Arc::new(lit);
    let (control, right) = (lit.clone(), lit.clone());
    claim(id, says)
        .bound(bounds::IRRADIANCE)
        .rejects("2.2 × resolution", move |run| joint_control(&control.claims, run, &control.irradiance))
        .rejects("a diameter taken for a radius", move |run| {
            joint_evidence(&right.claims, run, &large.irradiance)
        })
        .by(move |run: &Run| joint_evidence(&lit.claims, run, &lit.irradiance))
}

/// Receivers in light, made when first asked for.
struct Lit {
    claims: Vec<MeanClaim>,
    irradiance: Box<dyn Fn(usize, u64) -> f64 + Send + Sync>,
}

impl Lit {
    fn new(places: Vec<Place>, samples: u32) -> Self {
        let (mut scenes, mut claims) = (Vec::new(), Vec::new());
        for place in places {
            scenes.push(built(&receiver(vec![place.lamp])));
            let claim = MeanClaim::relative(place.exact, bounds::IRRADIANCE);
            claims.push(MeanClaim { rounding: ROUNDING, ..claim });
        }
        let irradiance = remembering(move |i, seed| irradiance(&scenes[i], samples, seed));
        Self { claims, irradiance: Box::new(irradiance) }
    }
}

/// Ten places: the middle x and y, the half sides and the height or distance, from far and small to near and large.
const PLACES: [[f64; 5]; 10] = [
    [0.0, 0.0, 0.5, 0.5, 1.0],
    [0.0, 0.0, 0.05, 0.05, 1.0],
    [1.0, 0.0, 0.5, 0.3, 1.0],
    [1.5, 1.5, 0.4, 0.6, 0.8],
    [-2.0, 0.5, 0.3, 0.3, 2.0],
    [0.3, -0.2, 1.0, 1.0, 1.0],
    [0.0, 0.7, 0.6, 0.2, 0.5],
    [3.0, 0.0, 1.0, 1.0, 1.0],
    [0.2, 0.1, 0.25, 0.75, 0.5],
    [-0.4, -0.9, 0.5, 0.5, 1.5],
];

fn parallel(scale: f64) -> Vec<Place> {
    let place = |[x, y, a, b, h]: [f64; 5]| Place {
        // a × (−b) points down, towards the receiver
        lamp: lamp(
            ShapeSettings::Rectangle,
            rectangle_at(DVec3::new(x, y, h), scale * a * DVec3::X, -scale * b * DVec3::Y),
        ),
        exact: from_parallel_rectangle([x - a, x + a], [y - b, y + b], h),
    };
    PLACES.map(place).into()
}

fn perpendicular(scale: f64) -> Vec<Place> {
    let place = |[x, y, a, b, d]: [f64; 5]| {
        let z = y.abs() + b;
        Place {
            // in the plane y = d, facing −y: x × z = −y
            lamp: lamp(
                ShapeSettings::Rectangle,
                rectangle_at(DVec3::new(x, d, z), scale * a * DVec3::X, scale * b * DVec3::Z),
            ),
            exact: from_perpendicular_rectangle([x - a, x + a], [z - b, z + b], d),
        }
    };
    PLACES.map(place).into()
}

fn tilted(scale: f64) -> Vec<Place> {
    let place = |[x, y, a, b, h]: [f64; 5]| {
        let centre = DVec3::new(x, y, h);
        let (side, other) = facing_origin(centre);
        let corners =
            [(-a, -b), (a, -b), (a, b), (-a, b)].map(|(s, t)| (centre + s * side + t * other).to_array());
        Place {
            lamp: lamp(ShapeSettings::Rectangle, rectangle_at(centre, scale * a * side, scale * b * other)),
            exact: from_polygon(RECEIVER, &corners),
        }
    };
    // lowered, so that some reach below the horizon
    PLACES.map(|[x, y, a, b, h]| place([x + 0.9, y, a, b, 0.4 * h])).into()
}

fn disk(scale: f64) -> Vec<Place> {
    let place = |[x, y, r, _, h]: [f64; 5]| Place {
        lamp: lamp(
            ShapeSettings::Disk,
            rectangle_at(DVec3::new(x, y, h), scale * r * DVec3::X, -scale * r * DVec3::Y),
        ),
        exact: from_parallel_disk(r, h, x.hypot(y)),
    };
    PLACES.map(place).into()
}

fn sphere(scale: f64) -> Vec<Place> {
    let place = |[x, y, r, _, h]: [f64; 5]| {
        // far enough that twice the radius does not reach the receiver; lowered, so that some reach below the horizon
        let centre = DVec3::new(x + 0.6, y, 0.4 * h).normalize() * (2.5 * r).max(0.5);
        let shape = ShapeSettings::Sphere { center: centre, radius: scale * r };
        Place { lamp: lamp(shape, DAffine3::IDENTITY), exact: from_sphere(RECEIVER, centre.to_array(), r) }
    };
    PLACES.map(place).into()
}

fn triangle(scale: f64) -> Vec<Place> {
    let place = |[x, y, a, b, h]: [f64; 5]| {
        let centre = DVec3::new(x, y, h);
        let (side, other) = facing_origin(centre);
        let corner = |s: f64, t: f64| centre + s * side + t * other;
        let corners = [corner(-a, -b), corner(a, -b), corner(0.3 * a, b)].map(|c| c.to_array());
        let data = MeshData {
            positions: corners.map(|c| ((DVec3::from(c) - centre) * scale).as_vec3().to_array()).into(),
            normals: None,
            uvs: None,
            triangles: vec![[0, 1, 2]],
            face_normals: true,
        };
        let to_world = DAffine3 { matrix3: DMat3::IDENTITY, translation: centre };
        Place {
            lamp: lamp(ShapeSettings::Mesh(Arc::new(data)), to_world),
            exact: from_polygon(RECEIVER, &corners),
        }
    };
    PLACES.map(place).into()
}

/// The receiver of [`receiver`].
const RECEIVER: Receiver = Receiver { position: [0.0; 3], normal: [0.0, 0.0, 1.0] };

/// Two unit vectors perpendicular to each other and, nearly, to `centre`, whose cross product points to the origin;
/// turned a little, so that no symmetry helps.
fn facing_origin(centre: DVec3) -> (DVec3, DVec3) {
    let normal = (-centre.normalize() + DVec3::new(0.2, -0.1, 0.15)).normalize();
    let side = normal.any_orthonormal_vector();
    (side, normal.cross(side))
}
