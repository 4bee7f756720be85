//! Irradiance of area lights at random places: 200 of each shape, drawn anew for each run.

use glam::{DAffine3, DMat3, DVec3};
use renderer::film::PixelEstimate;
use renderer::lights::LightSampling;
use renderer::sampling::SamplerKind;
use renderer::scene::ObjectSettings;
use renderer::shapes::{MeshData, ShapeSettings};
use std::f64::consts::{PI, TAU};
use std::sync::{Arc, OnceLock};
use verify::claim::{Claim, Evidence, Level, Picture, Run, claim};
use verify::error::InputError;
use verify::estimate::{Estimate, Replicate};
use verify::irradiance::{
    Receiver, disk_solid_angle, from_parallel_disk, from_polygon, from_sphere, polygon_solid_angle,
    sphere_solid_angle,
};
use verify::mean::{FEWEST_REPLICATES, MeanClaim, judge, judge_moved};
use verify::points;
use verify::seeds::derive;

use super::{RECEIVER, ROUNDING};
use crate::bounds;
use crate::setup::{RECEIVER_EYE, built, image, lamp, receiver, rectangle_at};

/// Places of a run, and of a control with a mistake that a few of them show.
const PLACES: usize = 200;
const FEW: usize = 20;

/// Samples a replicate for lights of less than a tenth of their distance, over which little varies.
const SMALL: u32 = 64;

/// At most, for those of less than their distance.
const MEDIUM: u32 = 2048;

/// Share of its solid angle that a light gives at least where it gives something: with less, at the horizon, few samples
/// are bright, and their mean is not near normal.
const LEAST: f64 = 0.25;

/// What lies where is drawn from uniform numbers.
type Draw = [f64; 14];

/// A light, the irradiance that it gives, and the solid angle that it fills, which is what it would give without cosines.
struct Place {
    lamp: ObjectSettings,
    exact: f64,
    solid_angle: f64,
}

/// A place by its numbers and the light's size over its distance, the light a factor larger than it should be.
type Make = fn(&Draw, f64, f64) -> Place;

/// A shape, how it is sampled with how many samples a replicate where it is not small, its sizes over its distance, and its places.
#[derive(Clone, Copy)]
struct Kind {
    id: &'static str,
    what: &'static str,
    sampling: LightSampling,
    samples: u32,
    sizes: [f64; 2],
    place: Make,
}

/// Sizes of lights whose solid angle is sampled, over their distance.
const ANY: [f64; 2] = [1e-4, 1e4];

/// Sizes of lights whose area is sampled: the variance grows as the square of the size.
const UP_TO_TWICE: [f64; 2] = [1e-4, 2.0];

/// Sizes of spheres, which do not reach the receiver.
const BALL: [f64; 2] = [1e-4, 0.99];

pub(super) fn claims() -> Vec<Claim> {
    let solid = |id, what, (samples, sizes), place| {
        of(Kind { id, what, sampling: LightSampling::SolidAngle, samples, sizes, place })
    };
    let area = |id, what, samples, place| {
        of(Kind { id, what, sampling: LightSampling::Area, samples, sizes: UP_TO_TWICE, place })
    };
    vec![
        solid("irradiance/rectangle/any-parallel", "parallel rectangles of any size", (512, ANY), parallel),
        solid(
            "irradiance/rectangle/any-perpendicular",
            "perpendicular rectangles of any size",
            (1024, ANY),
            upright,
        ),
        solid("irradiance/rectangle/any-tilt", "tilted rectangles of any size", (1024, ANY), tilted),
        solid("irradiance/triangle/any-tilt", "tilted triangles of any size", (1024, ANY), triangle),
        solid(
            "irradiance/polygon/any-tilt",
            "tilted pentagons and arrowheads of any size",
            (1024, ANY),
            any_polygon,
        ),
        solid("irradiance/sphere/any-tilt", "spheres of any size at any tilt", (512, BALL), sphere),
        area("irradiance/rectangle/by-area", "tilted rectangles, sampled by area,", 512, tilted),
        area("irradiance/triangle/by-area", "tilted triangles, sampled by area,", 512, triangle),
        area(
            "irradiance/polygon/by-area",
            "tilted pentagons and arrowheads, sampled by area,",
            8192,
            any_polygon,
        ),
        area("irradiance/disk/by-area", "parallel disks on and off their axes, sampled by area,", 1024, disk),
    ]
}

fn of(kind: Kind) -> Claim {
    let first: Arc<OnceLock<(Run, Measured)>> = Arc::default();
    let (again, without) = (first.clone(), first.clone());
    let [low, high] = kind.sizes;
    let says = format!(
        "{}, from {low} to {high} of their distance, give the irradiance of the closed form at {PLACES} random places",
        kind.what
    );
    claim(kind.id, says)
        .bound(bounds::IRRADIANCE)
        .rejects("2 % too large", move |run| kind.measure(run, 1.02, FEW).judge())
        .rejects("without the receiver's cosine", move |run| kind.known(&without, run).flat().judge())
        .rejects("2.2 × resolution", move |run| {
            let Measured { claims, values, .. } = kind.known(&again, run);
            judge_moved(&claims, values)
        })
        .by(move |run| kind.known(&first, run).judge())
        .from_level(Level::Standard)
}

/// Claims, the solid angles of their lights, and their replicates.
#[derive(Clone)]
struct Measured {
    claims: Vec<MeanClaim>,
    solid_angles: Vec<f64>,
    values: Vec<Vec<Replicate>>,
}

impl Measured {
    fn judge(&self) -> Result<Evidence, InputError> {
        let mut evidence = judge(&self.claims, &self.values)?;
        evidence.resolution.quantity = "relative error of the irradiance";
        evidence.pictures = vec![self.picture()];
        Ok(evidence)
    }

    /// Irradiance over the solid angle: measured against exact.
    fn picture(&self) -> Picture {
        let point = |((claim, values), solid_angle): ((&MeanClaim, &Vec<Replicate>), &f64)| {
            let estimate = Estimate::of(values);
            let error = estimate.standard_error.hypot(claim.rounding * claim.unit);
            [claim.exact, estimate.mean, error].map(|value| value / solid_angle)
        };
        let mut measured: Vec<[f64; 3]> =
            self.claims.iter().zip(&self.values).zip(&self.solid_angles).map(point).collect();
        measured.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let exact = measured.iter().map(|&[exact, ..]| [exact; 2]).collect();
        let axes = ["irradiance over solid angle, closed form", "irradiance over solid angle, measured"];
        Picture::Curve { axes, exact, measured }
    }

    /// The same values held against the solid angles.
    fn flat(mut self) -> Self {
        for (claim, solid_angle) in self.claims.iter_mut().zip(&self.solid_angles) {
            claim.exact = *solid_angle;
        }
        self
    }
}

impl Kind {
    /// What `run` measures, remembered for the controls of the first run.
    fn known(&self, first: &OnceLock<(Run, Measured)>, run: &Run) -> Measured {
        let (known, measured) = first.get_or_init(|| (*run, self.measure(run, 1.0, PLACES)));
        if known == run { measured.clone() } else { self.measure(run, 1.0, PLACES) }
    }

    /// Lights at `count` of the run's places, `factor` times as large as they should be.
    fn measure(&self, run: &Run, factor: f64, count: usize) -> Measured {
        let mut measured = Measured { claims: Vec::new(), solid_angles: Vec::new(), values: Vec::new() };
        for index in 0.. {
            if measured.claims.len() == count {
                break;
            }
            let mut draw = [0.0; 14];
            points::fill(derive(run.seed, 0, 1), index, &mut draw);
            let size = self.sizes[0] * (self.sizes[1] / self.sizes[0]).powf(draw[7]);
            let Place { exact, solid_angle, .. } = (self.place)(&draw, size, 1.0);
            if exact > 0.0 && exact < LEAST * solid_angle {
                continue;
            }
            let unit = if exact > 0.0 { exact } else { solid_angle };
            let claim = MeanClaim::in_units_of(unit, exact, bounds::IRRADIANCE);
            measured.claims.push(MeanClaim { rounding: ROUNDING, ..claim });
            measured.solid_angles.push(solid_angle);
            let samples = match size {
                ..0.1 => SMALL,
                ..1.0 => self.samples.min(MEDIUM),
                _ => self.samples,
            };
            let lamp = (self.place)(&draw, size, factor).lamp;
            measured.values.push(self.replicates(lamp, samples, (run, index)));
        }
        measured
    }

    /// One replicate a pixel: pixels are randomised independently, and all of them see the receiver's middle.
    fn replicates(&self, lamp: ObjectSettings, samples: u32, (run, index): (&Run, u64)) -> Vec<Replicate> {
        let mut description = receiver(vec![lamp]);
        description.integrator.light_sampling = self.sampling;
        description.film.width = u32::try_from(FEWEST_REPLICATES * run.effort).unwrap_or(u32::MAX);
        let seed = derive(run.seed, 1, index);
        let rendering = image(&built(&description), SamplerKind::Sobol, samples, seed);
        let irradiance = |pixel: &PixelEstimate| PI * pixel.mean.iter().sum::<f64>() / 3.0;
        rendering.pixels.iter().map(|pixel| irradiance(pixel).into()).collect()
    }
}

/// A direction from two numbers, uniform over the sphere above `lowest`.
fn direction([u, v]: [f64; 2], lowest: f64) -> DVec3 {
    let z = lowest + (1.0 - lowest) * u;
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * (TAU * v).cos(), r * (TAU * v).sin(), z)
}

/// The plane at the distance 1 along `normal`: a point beside its foot by up to 1 or the size, and two directions in it,
/// turned anyhow, whose cross product points to the receiver.
fn plane(normal: DVec3, draw: &Draw, size: f64) -> [DVec3; 3] {
    let side = DMat3::from_axis_angle(normal, TAU * draw[2]) * normal.any_orthonormal_vector();
    let other = side.cross(normal);
    let reach = 2.0 * size.max(1.0);
    [normal + reach * ((draw[5] - 0.5) * side + (draw[6] - 0.5) * other), side, other]
}

fn rectangle(normal: DVec3, draw: &Draw, [size, factor]: [f64; 2]) -> Place {
    let [centre, side, other] = plane(normal, draw, size);
    let (a, b) = (size * (0.3 + 0.7 * draw[3]), size * (0.3 + 0.7 * draw[4]));
    let [middle, s, t] = [centre, a * side, b * other];
    let corners = [middle - s - t, middle + s - t, middle + s + t, middle - s + t].map(|c| c.to_array());
    Place {
        lamp: lamp(ShapeSettings::Rectangle, rectangle_at(centre, factor * a * side, factor * b * other)),
        exact: from_polygon(RECEIVER, &corners),
        solid_angle: polygon_solid_angle(RECEIVER.position, &corners),
    }
}

fn tilted(draw: &Draw, size: f64, factor: f64) -> Place {
    rectangle(direction([draw[0], draw[1]], -0.5), draw, [size, factor])
}

fn parallel(draw: &Draw, size: f64, factor: f64) -> Place {
    rectangle(DVec3::Z, draw, [size, factor])
}

fn upright(draw: &Draw, size: f64, factor: f64) -> Place {
    rectangle(direction([0.0, draw[1]], 0.0), draw, [size, factor])
}

/// A vertex as the renderer keeps it, in f32 and in a frame about its eye: what a mesh then is is what is exact.
fn kept(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// The receiver in that frame.
const FROM_EYE: Receiver =
    Receiver { position: [-RECEIVER_EYE.x, -RECEIVER_EYE.y, -RECEIVER_EYE.z], normal: [0.0, 0.0, 1.0] };

/// A polygon of a mesh, its corners on a tilted plane given by their places along two sides, cut into triangles from the first.
fn polygon(draw: &Draw, [size, factor]: [f64; 2], corners: &[[f64; 2]]) -> Place {
    let [centre, side, other] = plane(direction([draw[0], draw[1]], -0.5), draw, size);
    let local = |scale: f64| {
        let corner = |[s, t]: &[f64; 2]| (scale * size * (s * side + t * other)).as_vec3();
        corners.iter().map(corner).collect::<Vec<_>>()
    };
    let in_frame = |p: &glam::Vec3| kept(p.as_dvec3() + centre - RECEIVER_EYE).to_array();
    let seen: Vec<[f64; 3]> = local(1.0).iter().map(in_frame).collect();
    // Points by solid angle sweep from a triangle's first corner to its third about the second: in this order from each to the next.
    let last = u32::try_from(corners.len() - 1).expect("a few corners");
    let fan = (2..=last).rev().map(|i| [i, 0, i - 1]);
    let data = MeshData {
        positions: local(factor).iter().map(glam::Vec3::to_array).collect(),
        triangles: fan.collect(),
        ..MeshData::default()
    };
    Place {
        lamp: lamp(ShapeSettings::Mesh(Arc::new(data)), DAffine3::from_translation(centre)),
        exact: from_polygon(FROM_EYE, &seen),
        solid_angle: polygon_solid_angle(FROM_EYE.position, &seen),
    }
}

fn triangle(draw: &Draw, size: f64, factor: f64) -> Place {
    let corners = [[-1.0, -0.6], [1.0, -0.4 - 0.5 * draw[3]], [2.0 * draw[4] - 1.0, 0.8]];
    polygon(draw, [size, factor], &corners)
}

/// A pentagon on a circle, or an arrowhead, which is not convex; both can be cut from the first corner.
fn any_polygon(draw: &Draw, size: f64, factor: f64) -> Place {
    let [u, v, w, x, y] = std::array::from_fn(|i| draw[8 + i]);
    if draw[13] < 0.5 {
        let corner = |(i, u): (u8, f64)| {
            let (sin, cos) = (TAU * (f64::from(i) + 0.7 * u) / 5.0).sin_cos();
            [cos, sin]
        };
        polygon(draw, [size, factor], &[(0, u), (1, v), (2, w), (3, x), (4, y)].map(corner))
    } else {
        let notch = [0.4 * u - 0.2, 0.5 * v - 0.3];
        polygon(draw, [size, factor], &[notch, [1.0, -0.3 - 0.4 * w], [x - 0.5, 1.0], [-1.0, -0.3 - 0.4 * y]])
    }
}

fn sphere(draw: &Draw, size: f64, factor: f64) -> Place {
    let centre = direction([draw[0], draw[1]], -0.7);
    // One that is larger than it should be stays before the receiver.
    let shape = ShapeSettings::Sphere { center: centre, radius: (factor * size).min(0.993) };
    Place {
        lamp: lamp(shape, DAffine3::IDENTITY),
        exact: from_sphere(RECEIVER, centre.to_array(), size),
        solid_angle: sphere_solid_angle(size, 1.0),
    }
}

fn disk(draw: &Draw, size: f64, factor: f64) -> Place {
    // A third of them on the axis.
    let offset = if draw[0] < 1.0 / 3.0 { 0.0 } else { 2.0 * draw[1] };
    let centre = DVec3::new(offset * (TAU * draw[2]).cos(), offset * (TAU * draw[2]).sin(), 1.0);
    let shape = rectangle_at(centre, factor * size * DVec3::X, -factor * size * DVec3::Y);
    Place {
        lamp: lamp(ShapeSettings::Disk, shape),
        exact: from_parallel_disk(size, 1.0, offset),
        // On the axis; beside it, of a small disk as far away, less by the cube of the cosine.
        solid_angle: disk_solid_angle(size, 1.0) / (1.0 + offset * offset).powf(1.5),
    }
}
