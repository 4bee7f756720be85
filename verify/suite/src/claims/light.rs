//! Points on lights: uniform by area, with the densities that follow from that, which add up to the solid angle; and
//! uniform in the solid angle itself.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec3};
use renderer::accel::{Accel, Object};
use renderer::interaction::{Interaction, SurfacePoint};
use renderer::lights::{AreaLight, LightSampling};
use renderer::math::Rgb;
use renderer::shapes::{MeshData, Shape, ShapeSettings};
use verify::claim::Claim;
use verify::irradiance::{disk_solid_angle, polygon_solid_angle, sphere_solid_angle};
use verify::quadrature::{Tolerance, integrate};

use crate::setup::rectangle_at;

mod density;
mod emission;
mod environment;
mod moving;
mod solid_angle;
mod spot;
mod uniform;

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let mut list = uniform::claims();
    for lamp in [rectangle(), triangle(), disk(), sphere(), mesh()] {
        list.push(density::pdf(lamp.clone()));
        list.push(density::solid_angle(lamp));
    }
    list.extend(density::later(cylinder()));
    list.extend(solid_angle::claims());
    list.extend(emission::claims());
    list.extend(environment::claims());
    list.extend(moving::claims());
    list.extend(spot::claims());
    list
}

/// A light of one shape, and what follows from its geometry.
#[derive(Clone)]
struct Lamp {
    name: &'static str,
    shape: ShapeSettings,
    to_world: DAffine3,
    /// Its area [m²].
    area: f64,
    /// Its curvature [1/m].
    bend: f64,
    /// Points from which it is seen, and the solid angle that it fills there.
    views: [(DVec3, f64); 4],
    /// Points of a replicate, `side`²: more where they jump between triangles or turn away at a limb.
    side: u32,
}

/// Middle of the flat lights, which face `A` × `B`.
const CENTRE: DVec3 = DVec3::new(1.0, -0.5, 3.0);
const A: DVec3 = DVec3::new(0.8, 0.1, 0.3);
const B: DVec3 = DVec3::new(-0.2, 0.6, 0.1);

/// Where flat lights are seen from: height above the middle, and steps along `A` and `B`.
const VIEWS: [[f64; 3]; 4] = [[1.0, 0.0, 0.0], [0.5, 0.5, -0.4], [3.0, 2.0, 1.0], [0.8, -1.5, 1.5]];

/// Radius of the disk and the sphere.
const RADIUS: f64 = 0.8;

/// A point of the parallelogram that `A` and `B` span, coordinates in [−1, 1]².
fn flat([x, y]: [f64; 2]) -> DVec3 {
    CENTRE + x * A + y * B
}

/// Views of a polygon in the plane of `A` and `B`.
fn views_of(corners: &[[f64; 3]]) -> [(DVec3, f64); 4] {
    VIEWS.map(|[height, x, y]| {
        let from = flat([x, y]) + height * A.cross(B).normalize();
        (from, polygon_solid_angle(from.to_array(), corners))
    })
}

const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

fn rectangle() -> Lamp {
    let corners = SQUARE.map(|p| flat(p).to_array());
    Lamp {
        name: "rectangle",
        shape: ShapeSettings::Rectangle,
        to_world: rectangle_at(CENTRE, A, B),
        area: 4.0 * A.cross(B).length(),
        bend: 0.0,
        views: views_of(&corners),
        side: 24,
    }
}

/// A mesh of these vertices, in single precision.
fn mesh_of(vertices: &[DVec3], triangles: &[[u32; 3]]) -> ShapeSettings {
    ShapeSettings::Mesh(Arc::new(MeshData {
        positions: vertices.iter().map(|v| v.as_vec3().to_array()).collect(),
        normals: None,
        uvs: None,
        triangles: triangles.into(),
        face_normals: true,
    }))
}

fn triangle_corners() -> [DVec3; 3] {
    [[-1.0, -1.0], [1.0, -0.5], [0.2, 1.0]].map(flat)
}

fn triangle() -> Lamp {
    let corners = triangle_corners();
    Lamp {
        name: "triangle",
        shape: mesh_of(&corners, &[[0, 1, 2]]),
        to_world: DAffine3::IDENTITY,
        area: 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length(),
        bend: 0.0,
        views: views_of(&corners.map(|c| c.to_array())),
        side: 24,
    }
}

/// Two unit vectors in the plane of `A` and `B`, at right angles.
fn axes() -> [DVec3; 2] {
    let x = A.normalize();
    [x, A.cross(B).normalize().cross(x)]
}

fn disk() -> Lamp {
    let [x, y] = axes();
    Lamp {
        name: "disk",
        shape: ShapeSettings::Disk,
        to_world: rectangle_at(CENTRE, RADIUS * x, RADIUS * y),
        area: std::f64::consts::PI * RADIUS * RADIUS,
        bend: 0.0,
        views: [1.0, 0.5, 3.0, 0.8].map(|h| (CENTRE + h * x.cross(y), disk_solid_angle(RADIUS, h))),
        side: 24,
    }
}

fn sphere() -> Lamp {
    let view = |distance: f64| {
        (CENTRE + distance * DVec3::new(0.6, 0.0, -0.8), sphere_solid_angle(RADIUS, distance))
    };
    Lamp {
        name: "sphere",
        shape: ShapeSettings::Sphere { center: CENTRE, radius: RADIUS },
        to_world: DAffine3::IDENTITY,
        area: 4.0 * std::f64::consts::PI * RADIUS * RADIUS,
        bend: 1.0 / RADIUS,
        views: [2.0, 1.4, 5.0, 1.6].map(view),
        side: 64,
    }
}

/// Length of the cylinder, which stands on `CENTRE` along −z, a direction of its own space.
const LENGTH: f64 = 1.5;

/// A cylinder along −z from `CENTRE`, seen from outside.
fn cylinder() -> Lamp {
    let view = |[distance, height]: [f64; 2]| {
        let from = CENTRE + DVec3::new(0.6 * distance, 0.8 * distance, -height);
        (from, cylinder_solid_angle(RADIUS, LENGTH, distance, height))
    };
    Lamp {
        name: "cylinder",
        shape: ShapeSettings::Cylinder { p0: CENTRE, p1: CENTRE - LENGTH * DVec3::Z, radius: RADIUS },
        to_world: DAffine3::IDENTITY,
        area: std::f64::consts::TAU * RADIUS * LENGTH,
        bend: 1.0 / RADIUS,
        views: [[2.0, 0.75], [1.4, 0.2], [5.0, 3.0], [1.6, -0.5]].map(view),
        side: 64,
    }
}

/// The solid angle of the outer side of a cylinder's lateral surface.
///
/// ∫ n·v/|v|³ dA over what faces the eye: n·v = D cos φ − r at the angle φ from the eye's, |v|² =
/// q² + z² with q² = D² + r² − 2Dr cos φ, and ∫ dz/(q² + z²)^{3/2} = z/(q² √(q² + z²)).
fn cylinder_solid_angle(radius: f64, length: f64, distance: f64, height: f64) -> f64 {
    let strip = |phi: f64| {
        let q2 = distance * distance + radius * radius - 2.0 * distance * radius * phi.cos();
        let along = |z: f64| z / (q2 * (q2 + z * z).sqrt());
        (distance * phi.cos() - radius) * radius * (along(length - height) - along(-height))
    };
    let tolerance = Tolerance { relative: 1e-10, absolute: 1e-12, pieces: 1000 };
    2.0 * integrate(&strip, [0.0, (radius / distance).acos()], tolerance).value
}

/// The parallelogram of `A` and `B` cut into triangles whose areas differ by a factor of up to 600.
const VERTICES: [[f64; 2]; 6] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.8, -0.9], [0.86, -0.96]];
const TRIANGLES: [[u32; 3]; 6] = [[0, 1, 5], [1, 4, 5], [4, 0, 5], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

fn mesh() -> Lamp {
    Lamp {
        name: "mesh",
        shape: mesh_of(&VERTICES.map(flat), &TRIANGLES),
        to_world: DAffine3::IDENTITY,
        side: 64,
        ..rectangle()
    }
}

impl Lamp {
    /// The shape in its place.
    ///
    /// # Panics
    /// If the renderer refuses it: these shapes are valid.
    fn placed(&self) -> Shape {
        Shape::new(&self.shape, &self.to_world, false).expect("shapes of claims are valid")
    }

    /// The shape as a renderer's only object.
    fn alone(&self) -> Accel {
        Accel::new(vec![Object::still(self.placed())], [0.0, 0.0])
    }
}

/// The light that the only object is.
fn light(accel: &Accel, sampling: LightSampling) -> AreaLight {
    AreaLight::new(0, &accel.objects()[0], Rgb::WHITE.into(), sampling)
}

/// A place in the air from which a light is seen.
fn eye(point: DVec3) -> Interaction {
    let (ng, point) = (Vec3::Z, point.as_vec3());
    let surface = SurfacePoint { point, error: Vec3::ZERO, ng, n: ng, uv: [0.0; 2] };
    Interaction { surface, wo: Vec3::Z, time: 0.0, object: 0 }
}
