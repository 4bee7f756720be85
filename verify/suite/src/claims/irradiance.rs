//! Irradiance of area lights through camera, film, integrator and lights, against closed forms.

use std::sync::{Arc, LazyLock};

use glam::{DAffine3, DMat3, DVec3};
use renderer::scene::{ObjectSettings, Strategy};
use renderer::shapes::{MeshData, ShapeSettings};
use verify::claim::{Claim, Level, Run, claim};
use verify::irradiance::{
    Receiver, from_parallel_disk, from_parallel_rectangle, from_perpendicular_rectangle, from_polygon,
    from_sphere,
};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

mod meter;
mod moving;
mod random;
mod textured;

use crate::bounds;
use crate::setup::{built, irradiance, lamp, receiver, rectangle_at, remembering};

/// A light in a place, and the irradiance that it should give at the origin of a receiver that faces +z.
struct Place {
    lamp: ObjectSettings,
    exact: f64,
}

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let light = Strategy::Light;
    let mut list = vec![
        from("rectangle/parallel", "a rectangle parallel to the receiver", light, 256, parallel),
        from(
            "rectangle/perpendicular",
            "a rectangle perpendicular to the receiver",
            light,
            256,
            perpendicular,
        ),
        from("rectangle/tilted", "a tilted rectangle, partly below the horizon", light, 256, tilted),
        from("disk/parallel", "a disk parallel to the receiver, on and off its axis", light, 512, disk),
        from("sphere/tilted", "a sphere at any tilt, partly below the horizon", light, 1024, sphere),
        from("triangle/tilted", "a tilted triangle of a mesh", light, 256, triangle),
        from(
            "mesh/smooth",
            "a tilted mesh of bent shading normals, connected and met",
            Strategy::Both,
            512,
            smooth,
        ),
    ];
    list.extend(random::claims());
    list.extend(meter::claims());
    list.extend(textured::claims());
    list.push(moving::moments());
    list.into_iter().map(|claim| claim.same_up_to(Level::Standard)).collect()
}

/// Places, densities and sums in f32: 16 roundings of 2⁻²⁴ that all agree.
const ROUNDING: f64 = 1e-6;

/// The claim that a light in each of ten places gives the irradiance of the closed form.
///
/// * `places`: of a light that is as large as it should be times a factor.
fn from(
    id: &'static str,
    what: &'static str,
    strategy: Strategy,
    samples: u32,
    places: fn(f64) -> Vec<Place>,
) -> Claim {
    let id = format!("irradiance/{id}");
    let says = format!("{what}, in ten places, gives the irradiance of the closed form");
    let lit = LazyLock::new(move || Lit::new(places(1.0), strategy, samples));
    // a gross mistake shows with fewer samples too
    let large = LazyLock::new(move || Lit::new(places(2.0), strategy, samples / 8));
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
    fn new(places: Vec<Place>, strategy: Strategy, samples: u32) -> Self {
        let (mut scenes, mut claims) = (Vec::new(), Vec::new());
        for place in places {
            let mut description = receiver(vec![place.lamp]);
            description.integrator.strategy = strategy;
            scenes.push(built(&description));
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
    PLACES.map(|place| flat_mesh(place, scale, &[[-1.0, -1.0], [1.0, -1.0], [0.3, 1.0]], false)).into()
}

/// Two triangles whose normals for shading lean by up to half a right angle.
fn smooth(scale: f64) -> Vec<Place> {
    PLACES
        .map(|place| flat_mesh(place, scale, &[[-1.0, -1.0], [1.0, -1.0], [0.3, 1.0], [-0.8, 0.7]], true))
        .into()
}

/// A fan of triangles around the first corner, in a place and turned nearly to the origin.
///
/// * `corners`: in half sides.
/// * `bent`: with normals at the vertices that lean away from the middle; none of it may change the irradiance.
fn flat_mesh([x, y, a, b, h]: [f64; 5], scale: f64, corners: &[[f64; 2]], bent: bool) -> Place {
    let centre = DVec3::new(x, y, h);
    let (side, other) = facing_origin(centre);
    let offsets: Vec<DVec3> = corners.iter().map(|[s, t]| s * a * side + t * b * other).collect();
    let lean = |offset: &DVec3| (side.cross(other) + offset.normalize()).normalize().as_vec3().to_array();
    let data = MeshData {
        positions: offsets.iter().map(|offset| (*offset * scale).as_vec3().to_array()).collect(),
        normals: bent.then(|| offsets.iter().map(lean).collect()),
        uvs: None,
        triangles: (2..).zip(&corners[2..]).map(|(last, _)| [0, last - 1, last]).collect(),
        face_normals: !bent,
    };
    let corners: Vec<[f64; 3]> = offsets.iter().map(|offset| (centre + *offset).to_array()).collect();
    let to_world = DAffine3 { matrix3: DMat3::IDENTITY, translation: centre };
    Place {
        lamp: lamp(ShapeSettings::Mesh(Arc::new(data)), to_world),
        exact: from_polygon(RECEIVER, &corners),
    }
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
