//! Open cylinders.

use glam::{DAffine3, DVec2, DVec3};

use super::quadratic::roots;
use super::{ShapeHit, accept, check_point, check_radius, rounded_curved, turn, uniform_scale};
use crate::ParamError;
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::ray::Ray64;

/// The lateral surface of a cylinder, without caps; its normals point outward.
#[derive(Debug, Clone)]
pub struct Cylinder {
    base: DVec3,
    /// Unit axes; the third runs along the cylinder.
    axes: [DVec3; 3],
    length: f64,
    radius: f64,
    sign: f64,
    /// Whether points have surface coordinates.
    mapped: bool,
}

impl Cylinder {
    pub(super) fn new(
        [p0, p1]: [DVec3; 2],
        radius: f64,
        to_frame: &DAffine3,
        flip: bool,
    ) -> Result<Self, ParamError> {
        check_point("p0", p0)?;
        check_point("p1", p1)?;
        check_radius(radius)?;
        let scale = uniform_scale("scale of a cylinder", to_frame)?;
        let length = (p1 - p0).length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(ParamError::OutOfRange {
                name: "length of a cylinder",
                value: length,
                accepted: "p0 ≠ p1",
            });
        }
        let along = (p1 - p0) / length;
        let (x, y) = along.any_orthonormal_pair();
        Ok(Self {
            base: to_frame.transform_point3(p0),
            axes: [x, y, along].map(|a| to_frame.transform_vector3(a).normalize()),
            length: length * scale,
            radius: radius * scale,
            sign: if flip { -1.0 } else { 1.0 },
            mapped: true,
        })
    }

    pub(super) fn without_coordinates(self) -> Self {
        Self { mapped: false, ..self }
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether the normals point inward.
    pub fn is_flipped(&self) -> bool {
        self.sign < 0.0
    }

    /// Each end's circle reaches r·√(x² + y²) of its axes' components.
    pub(super) fn bounds(&self) -> Bounds {
        let [x, y, z] = self.axes;
        let reach = (x * x + y * y).map(|c| c.sqrt() * self.radius * (1.0 + 8.0 * f64::EPSILON));
        Bounds::of([self.base, self.base + z * self.length]).grown(reach)
    }

    /// A vector's components across and along the cylinder.
    fn split(&self, v: DVec3) -> (DVec2, f64) {
        let [x, y, z] = self.axes;
        (DVec2::new(x.dot(v), y.dot(v)), z.dot(v))
    }

    /// The distances at which a ray meets the lateral surface between the ends.
    fn distances(&self, ray: &Ray64) -> [Option<f64>; 2] {
        let (f, height) = self.split(ray.origin - self.base);
        let (d, rise) = self.split(ray.direction);
        let (a, b) = (d.length_squared(), -f.dot(d));
        let remainder = (f + d * (b / a)).length_squared();
        match roots(a, b, f.length_squared(), remainder, self.radius) {
            Some(both) => {
                both.map(|t| Some(t).filter(|t| (0.0..=self.length).contains(&(height + rise * t))))
            }
            None => [None; 2],
        }
    }

    /// The distance at which a ray first meets it.
    fn met(&self, ray: &Ray64) -> Option<f64> {
        self.distances(ray).into_iter().flatten().find(|t| *t > 0.0)
    }

    pub(super) fn intersect(&self, ray: &Ray64) -> Option<ShapeHit> {
        Some(ShapeHit { t: accept(self.met(ray)?, ray.t_max)?, uv: [0.0; 2] })
    }

    /// Solves again, because the f32 distance is coarser than the surface, and from far away coarser than the cylinder: it does not
    /// tell which side was met.
    #[inline]
    pub(super) fn surface(&self, ray: &Ray64, t: f32) -> SurfacePoint {
        let exact = self.met(ray).unwrap_or(f64::from(t));
        let (across, height) = self.split(ray.origin + ray.direction * exact - self.base);
        self.point_at(across.normalize(), height)
    }

    fn point_at(&self, across: DVec2, height: f64) -> SurfacePoint {
        let [x, y, z] = self.axes;
        let outward = x * across.x + y * across.y;
        let extent = self.base.abs().max_element() + self.radius + self.length;
        let (point, error) =
            rounded_curved(self.base + z * height + outward * self.radius, extent, self.radius);
        let n = (outward * self.sign).as_vec3();
        #[expect(clippy::cast_possible_truncation, reason = "texture coordinates are f32")]
        let coordinates = || [turn(across.y, across.x), (height / self.length) as f32];
        let uv = if self.mapped { coordinates() } else { [0.0; 2] };
        SurfacePoint { point, error, ng: n, n, uv }
    }

    /// Around the axis.
    pub(super) fn tangent(&self, surface: &SurfacePoint) -> DVec3 {
        self.axes[2].cross(surface.ng.as_dvec3() * self.sign)
    }

    pub(super) fn area(&self) -> f64 {
        std::f64::consts::TAU * self.radius * self.length
    }

    pub(super) fn sample_area(&self, [u, v]: [f32; 2]) -> SurfacePoint {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(u));
        self.point_at(DVec2::new(cos, sin), f64::from(v) * self.length)
    }
}
