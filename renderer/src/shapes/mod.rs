//! Rank 4: surfaces that rays meet and lights are sampled on. A shape is a list of elements (a mesh's triangles; one
//! for the others), each with a box, an intersection, a surface and a share of the area.

mod cube;
mod cylinder;
mod disk;
mod mesh;
mod plane;
mod quadratic;
mod rectangle;
mod rounding;
mod sphere;
pub mod triangle;

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use wide::f32x8;

pub use cube::Cube;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use mesh::{Mesh, MeshData};
pub use rectangle::Rectangle;
pub use sphere::Sphere;

use rounding::{accept, accept_eight, rounded, rounded_curved, rounded_eight};

use crate::ParamError;
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::math::transform::check_affine;
use crate::ray::{EightRays, Ray, Ray64};

/// A shape before it is placed, with Mitsuba's canonical forms.
#[derive(Debug, Clone)]
pub enum ShapeSettings {
    /// The sphere around `center`; normals outward, or inward after a reflection.
    Sphere {
        /// Its centre.
        center: DVec3,
        /// Its radius, positive.
        radius: f64,
    },
    /// [−1, 1]² in the plane z = 0, facing +z.
    Rectangle,
    /// The unit disk in the plane z = 0, facing +z.
    Disk,
    /// The lateral surface of the cylinder from `p0` to `p1`, open at both ends; normals outward.
    Cylinder {
        /// One end of the axis.
        p0: DVec3,
        /// The other end.
        p1: DVec3,
        /// Its radius, positive.
        radius: f64,
    },
    /// The surface of [−1, 1]³; normals outward.
    Cube,
    /// Triangles.
    Mesh(Arc<MeshData>),
}

impl ShapeSettings {
    /// The same surface for a light: a cube as triangles, whose points can be found by solid angle.
    #[must_use]
    pub fn of_light(&self) -> Self {
        match self {
            Self::Cube => Self::Mesh(Arc::new(cube::triangles())),
            other => other.clone(),
        }
    }

    /// Whether a reflection turns the normals over, as in Mitsuba: a sphere's, and those that follow from the corners' order.
    pub fn turns_over(&self) -> bool {
        match self {
            Self::Sphere { .. } => true,
            Self::Mesh(data) => data.face_normals || data.normals.is_none(),
            _ => false,
        }
    }
}

/// Where a ray met one element of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeHit {
    /// Distance along the ray, in (0, `t_max`).
    pub t: f32,
    /// The element's own parameters of the point.
    pub uv: [f32; 2],
}

/// Where eight rays met one element of a shape, side by side.
#[derive(Debug, Clone, Copy)]
pub struct EightHits {
    /// The lanes of the rays that met it, as bits.
    pub lanes: u32,
    t: f32x8,
    uv: [f32x8; 2],
}

impl EightHits {
    /// The hit in one of `lanes`.
    #[inline]
    pub fn get(&self, lane: usize) -> ShapeHit {
        let [t, u, v] = [&self.t, &self.uv[0], &self.uv[1]].map(|x| x.as_array()[lane]);
        ShapeHit { t, uv: [u, v] }
    }
}

/// A shape placed in its frame.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A parallelogram.
    Rectangle(Rectangle),
    /// An ellipse.
    Disk(Disk),
    /// The lateral surface of a cylinder.
    Cylinder(Cylinder),
    /// A parallelepiped.
    Cube(Box<Cube>),
    /// Triangles.
    Mesh(Mesh),
}

impl Shape {
    /// Places a shape by `to_frame`, composed in f64, with its normals turned over if `flip_normals`.
    ///
    /// # Errors
    /// `NotFinite`; `Singular` transforms; `OutOfRange` for a radius that isn't positive or a scale that would turn a
    /// sphere or cylinder into something else; `Empty` shapes without area; `Index` beyond a mesh's vertices.
    pub fn new(
        settings: &ShapeSettings,
        to_frame: &DAffine3,
        flip_normals: bool,
    ) -> Result<Self, ParamError> {
        check_affine("to_world", to_frame)?;
        let shape = match settings {
            ShapeSettings::Sphere { center, radius } => {
                Self::Sphere(Sphere::new(*center, *radius, to_frame, flip_normals)?)
            }
            ShapeSettings::Rectangle => Self::Rectangle(Rectangle::new(to_frame, flip_normals)),
            ShapeSettings::Disk => Self::Disk(Disk::new(to_frame, flip_normals)),
            ShapeSettings::Cylinder { p0, p1, radius } => {
                Self::Cylinder(Cylinder::new([*p0, *p1], *radius, to_frame, flip_normals)?)
            }
            ShapeSettings::Cube => Self::Cube(Box::new(Cube::new(to_frame, flip_normals))),
            ShapeSettings::Mesh(data) => Self::Mesh(Mesh::new(data, to_frame, flip_normals)?),
        };
        check_extent(&shape)?;
        Ok(shape)
    }

    /// The shape with the surface coordinates (0, 0) everywhere if it takes angles to know them: for materials that don't ask.
    #[must_use]
    pub fn without_coordinates(self) -> Self {
        match self {
            Self::Sphere(s) => Self::Sphere(s.without_coordinates()),
            Self::Disk(d) => Self::Disk(d.without_coordinates()),
            Self::Cylinder(c) => Self::Cylinder(c.without_coordinates()),
            Self::Rectangle(_) | Self::Cube(_) | Self::Mesh(_) => self,
        }
    }

    /// Number of elements, at least 1.
    pub fn element_count(&self) -> u32 {
        match self {
            Self::Mesh(mesh) => mesh.triangle_count(),
            _ => 1,
        }
    }

    /// A box that holds the element.
    pub fn element_bounds(&self, element: u32) -> Bounds {
        match self {
            Self::Sphere(s) => s.bounds(),
            Self::Rectangle(r) => r.bounds(),
            Self::Disk(d) => d.bounds(),
            Self::Cylinder(c) => c.bounds(),
            Self::Cube(c) => c.bounds(),
            Self::Mesh(m) => m.triangle_bounds(element),
        }
    }

    /// A box that holds the whole shape.
    pub fn bounds(&self) -> Bounds {
        (0..self.element_count()).fold(Bounds::EMPTY, |b, e| b.union(&self.element_bounds(e)))
    }

    /// The nearest hit of an element with t in (0, `t_max`).
    #[inline]
    pub fn intersect(&self, element: u32, ray: &Ray) -> Option<ShapeHit> {
        self.intersect_f64(element, &ray.widened())
    }

    /// The same for a ray that no f32 holds; triangles see the nearest one that does.
    pub fn intersect_f64(&self, element: u32, ray: &Ray64) -> Option<ShapeHit> {
        match self {
            Self::Sphere(s) => s.intersect(ray),
            Self::Rectangle(r) => r.intersect(ray),
            Self::Disk(d) => d.intersect(ray),
            Self::Cylinder(c) => c.intersect(ray),
            Self::Cube(c) => c.intersect(ray),
            Self::Mesh(m) => m.intersect(element, ray),
        }
    }

    /// What `intersect` finds for each of eight rays on the only element, bit for bit; `None` for shapes that are
    /// tested ray by ray.
    #[inline]
    pub fn intersect_eight(&self, rays: &EightRays) -> Option<EightHits> {
        match self {
            Self::Sphere(s) => Some(s.intersect_eight(rays)),
            Self::Rectangle(r) => Some(r.intersect_eight(rays)),
            Self::Disk(d) => Some(d.intersect_eight(rays)),
            Self::Cube(c) => Some(c.intersect_eight(rays)),
            Self::Cylinder(_) | Self::Mesh(_) => None,
        }
    }

    /// Whether a ray that has left the shape meets it again: what one test tells of those that can be met again.
    #[inline]
    pub fn meets_again(&self, ray: &Ray) -> bool {
        matches!(self, Self::Sphere(_) | Self::Cylinder(_) | Self::Cube(_))
            && self.intersect(0, ray).is_some()
    }

    /// The surface at a hit that `intersect` found with the same ray.
    pub fn surface(&self, element: u32, hit: &ShapeHit, ray: &Ray) -> SurfacePoint {
        let mut surface = SurfacePoint::default();
        self.put_surface(element, hit, &ray.widened(), &mut surface);
        surface
    }

    /// Writes the surface at a hit to where it stays: a copy would wait for what has just been written.
    #[inline]
    pub fn put_surface(&self, element: u32, hit: &ShapeHit, ray: &Ray64, surface: &mut SurfacePoint) {
        match self {
            Self::Sphere(s) => *surface = s.surface(ray, hit.t),
            Self::Rectangle(r) => *surface = r.surface(hit.uv),
            Self::Disk(d) => *surface = d.surface(hit.uv),
            Self::Cylinder(c) => *surface = c.surface(ray, hit.t),
            Self::Cube(c) => *surface = c.surface(ray),
            Self::Mesh(m) => *surface = m.surface(element, hit.uv),
        }
    }

    /// ∂p/∂u at a point of an element, of any length: the direction in which the first texture coordinate grows; zero
    /// where there is none.
    pub fn tangent(&self, element: u32, surface: &SurfacePoint) -> DVec3 {
        match self {
            Self::Sphere(s) => s.tangent(surface),
            Self::Rectangle(r) => r.tangent(),
            Self::Disk(d) => d.tangent(surface),
            Self::Cylinder(c) => c.tangent(surface),
            Self::Cube(c) => c.tangent(surface),
            Self::Mesh(m) => m.tangent(element),
        }
    }

    /// The area in m².
    pub fn area(&self) -> f64 {
        match self {
            Self::Sphere(s) => s.area(),
            Self::Rectangle(r) => r.area(),
            Self::Disk(d) => d.area(),
            Self::Cylinder(c) => c.area(),
            Self::Cube(c) => c.area(),
            Self::Mesh(m) => m.area(),
        }
    }

    /// The point of the surface for `u` in [0, 1)²: uniform by area.
    ///
    /// # Measure
    /// `pdf_area` = 1 / `area()` per m².
    pub fn sample_area(&self, u: [f32; 2]) -> SurfacePoint {
        match self {
            Self::Sphere(s) => s.sample_area(u),
            Self::Rectangle(r) => r.sample_area(u),
            Self::Disk(d) => d.sample_area(u),
            Self::Cylinder(c) => c.sample_area(u),
            Self::Cube(c) => c.sample_area(u),
            Self::Mesh(m) => m.sample_area(u),
        }
    }

    /// The point of the surface for `u` in [0, 1)², uniform in the solid angle that it is seen under from `from`, and
    /// its density; of a mesh, a triangle is chosen first, one of few by its solid angle, one of many by its area.
    ///
    /// Returns: `None` for shapes without such a map, and where rounding would spoil it: the place of `from`, or the
    /// triangle of `u`, decides alone, and [`Self::pdf_solid_angle`] decides the same.
    ///
    /// # Measure
    /// per steradian at `from`.
    pub fn sample_solid_angle(&self, from: DVec3, u: [f32; 2]) -> Option<(SurfacePoint, f64)> {
        match self {
            Self::Sphere(s) => s.sample_solid_angle(from, u),
            Self::Rectangle(r) => r.sample_solid_angle(from, u),
            Self::Mesh(m) => m.sample_solid_angle(from, u),
            Self::Disk(_) | Self::Cylinder(_) | Self::Cube(_) => None,
        }
    }

    /// The density of [`Self::sample_solid_angle`] on an element.
    ///
    /// # Measure
    /// per steradian at `from`.
    pub fn pdf_solid_angle(&self, element: u32, from: DVec3) -> Option<f64> {
        match self {
            Self::Sphere(s) => s.pdf_solid_angle(from),
            Self::Rectangle(r) => r.seen_from(from).map(|seen| 1.0 / seen.solid_angle()),
            Self::Mesh(m) => m.pdf_solid_angle(element, from),
            Self::Disk(_) | Self::Cylinder(_) | Self::Cube(_) => None,
        }
    }
}

/// Solid angle in steradians from which on points are taken by it.
///
/// A smaller shape looks flat and even, and the digits of maps by solid angle get fewer with the size: with 53 of them
/// the place on a needle of 1e-12 sr is known to 1e-4 of its width.
const SMALLEST_SOLID_ANGLE: f64 = 1e-12;

/// Refuses shapes that f32 can't hold or that have no area.
fn check_extent(shape: &Shape) -> Result<(), ParamError> {
    let b = shape.bounds();
    let value = b.min.abs().max(b.max.abs()).max_element();
    // Squares of distances must stay finite in f32.
    if value.is_nan() || value >= 1e18 {
        return Err(ParamError::OutOfRange { name: "coordinate", value, accepted: "below 1e18" });
    }
    if shape.area() > 0.0 {
        Ok(())
    } else {
        Err(ParamError::Empty { name: "shape", accepted: "a positive area" })
    }
}

/// The uniform scale of a map.
///
/// # Errors
/// `OutOfRange` if it shears or scales axes differently by more than 1e-5 (f32 transforms in files round to 1e-7, and a
/// product of a few of them stays well below).
fn uniform_scale(name: &'static str, map: &DAffine3) -> Result<f64, ParamError> {
    let m = map.matrix3;
    let scale = m.determinant().abs().cbrt();
    let gram = m.transpose() * m * (1.0 / (scale * scale)) - glam::DMat3::IDENTITY;
    let value = gram.to_cols_array().iter().fold(0.0f64, |a, x| a.max(x.abs()));
    if value <= 1e-5 {
        Ok(scale)
    } else {
        Err(ParamError::OutOfRange {
            name,
            value,
            accepted: "a rotation and uniform scale (distortion at most 1e-5)",
        })
    }
}

/// Refuses a radius that isn't finite and positive.
fn check_radius(value: f64) -> Result<(), ParamError> {
    if !value.is_finite() {
        Err(ParamError::NotFinite { name: "radius", value })
    } else if value <= 0.0 {
        Err(ParamError::OutOfRange { name: "radius", value, accepted: "a positive number" })
    } else {
        Ok(())
    }
}

/// Refuses a point with a coordinate that isn't finite.
fn check_point(name: &'static str, p: DVec3) -> Result<(), ParamError> {
    match p.to_array().into_iter().find(|c| !c.is_finite()) {
        Some(value) => Err(ParamError::NotFinite { name, value }),
        None => Ok(()),
    }
}

/// Texture coordinate of an angle: `atan2(y, x)` / 2π in [0, 1).
#[expect(clippy::cast_possible_truncation, reason = "texture coordinates are f32")]
fn turn(y: f64, x: f64) -> f32 {
    let angle = libm::atan2f(y as f32, x as f32) * (0.5 * std::f32::consts::FRAC_1_PI);
    if angle < 0.0 { (angle + 1.0).min(1.0f32.next_down()) } else { angle }
}
