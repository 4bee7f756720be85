//! A shape and how it moves.

use glam::{DVec3, Vec3};

use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::math::eight::widened;
use crate::math::transform::{Motion, Pose};
use crate::ray::{EightRays, Ray, Ray64};
use crate::shapes::{EightHits, Shape, ShapeHit};

/// A shape at rest or in motion.
#[derive(Debug, Clone)]
pub struct Object {
    /// The shape: in the render frame without a motion, else in its own space.
    pub shape: Shape,
    /// The map from the shape's space to the render frame at each time.
    pub motion: Option<Motion>,
}

impl Object {
    /// A shape that rests.
    pub fn still(shape: Shape) -> Self {
        Self { shape, motion: None }
    }

    /// A shape that moves.
    pub fn moving(shape: Shape, motion: Motion) -> Self {
        Self { shape, motion: Some(motion) }
    }

    /// A box that holds the object at every time in `shutter`.
    pub fn bounds(&self, shutter: [f64; 2]) -> Bounds {
        let own = self.shape.bounds();
        self.motion.as_ref().map_or(own, |m| m.swept(&own, shutter))
    }

    /// A ray of the render frame in the shape's space. Distances along it stay what they are, so its direction isn't
    /// unit under a scale.
    pub fn to_object(&self, ray: &Ray) -> Ray64 {
        match &self.motion {
            None => ray.widened(),
            Some(motion) => match motion.offset(f64::from(ray.time)) {
                Some(offset) => back(offset, ray),
                None => to_own(&motion.pose(f64::from(ray.time)), ray),
            },
        }
    }

    /// The nearest hit of a ray of the render frame on an element.
    #[inline]
    pub fn intersect(&self, element: u32, ray: &Ray) -> Option<ShapeHit> {
        self.shape.intersect_f64(element, &self.to_object(ray))
    }

    /// The hits of eight rays of the render frame, if they can be found at once: by a motion that only shifts, of shapes that can.
    #[inline]
    pub fn intersect_eight(&self, rays: &EightRays) -> Option<EightHits> {
        let Some(motion) = &self.motion else { return self.shape.intersect_eight(rays) };
        let offset = motion.offset_eight(widened(rays.time))?;
        self.shape.intersect_eight(&EightRays { origin: rays.origin - offset, ..*rays })
    }

    /// Whether it hides the end of a segment that leaves it, where that is known before the other objects are looked at.
    #[inline]
    pub fn hides(&self, segment: &Ray) -> bool {
        self.motion.is_none() && self.shape.meets_again(segment)
    }

    /// Writes the surface in the render frame at a hit of `ray` to where it stays.
    #[inline]
    pub fn put_surface(&self, element: u32, hit: &ShapeHit, ray: &Ray, surface: &mut SurfacePoint) {
        match &self.motion {
            None => self.shape.put_surface(element, hit, &ray.widened(), surface),
            Some(motion) => {
                let time = f64::from(ray.time);
                if let Some(offset) = motion.offset(time) {
                    self.shape.put_surface(element, hit, &back(offset, ray), surface);
                    shift(surface, offset);
                } else {
                    let pose = motion.pose(time);
                    self.shape.put_surface(element, hit, &to_own(&pose, ray), surface);
                    *surface = moved(surface, &pose);
                }
            }
        }
    }

    /// ∂p/∂u in the render frame at a hit of `ray`, up to a factor; zero where there is none.
    pub fn tangent(&self, element: u32, hit: &ShapeHit, ray: &Ray) -> Vec3 {
        let mut surface = SurfacePoint::default();
        self.shape.put_surface(element, hit, &self.to_object(ray), &mut surface);
        let own = self.shape.tangent(element, &surface);
        let map = self.motion.as_ref().map(|motion| motion.at(f64::from(ray.time)).matrix3);
        map.map_or(own, |m| m * own).normalize_or_zero().as_vec3()
    }

    /// A point of the surface at `time` for `u` in [0, 1)², with its density.
    ///
    /// # Measure
    /// The density is per m² of the object as it is at `time`.
    pub fn sample_area(&self, u: [f32; 2], time: f32) -> (SurfacePoint, f32) {
        let surface = self.shape.sample_area(u);
        match &self.motion {
            None => (surface, self.pdf_area(surface.ng, time)),
            Some(motion) => {
                let surface = moved(&surface, &motion.pose(f64::from(time)));
                (surface, self.pdf_area(surface.ng, time))
            }
        }
    }

    /// A point of the surface for `u` in [0, 1)², uniform in the solid angle that it is seen under from `from`.
    ///
    /// Returns: with its density per steradian at `from`; `None` in motion, and where [`Shape::sample_solid_angle`]
    /// has none.
    #[expect(clippy::cast_possible_truncation, reason = "densities are f32")]
    pub fn sample_solid_angle(&self, from: Vec3, u: [f32; 2]) -> Option<(SurfacePoint, f32)> {
        let rests = self.motion.is_none();
        let (surface, pdf) = rests.then(|| self.shape.sample_solid_angle(from.as_dvec3(), u))??;
        Some((surface, pdf as f32))
    }

    /// The density with which `sample_solid_angle` takes a point of `element`, if it takes one.
    ///
    /// # Measure
    /// per steradian at `from`.
    #[expect(clippy::cast_possible_truncation, reason = "densities are f32")]
    pub fn pdf_solid_angle(&self, element: u32, from: Vec3) -> Option<f32> {
        let rests = self.motion.is_none();
        rests.then(|| self.shape.pdf_solid_angle(element, from.as_dvec3()))?.map(|pdf| pdf as f32)
    }

    /// The density with which `sample_area` takes a point with geometric normal `ng`.
    ///
    /// A map M stretches the area of a surface whose image has the unit normal n by |det M| / |Mᵀn|.
    ///
    /// # Measure
    /// Per m² of the object as it is at `time`.
    #[expect(clippy::cast_possible_truncation, reason = "densities are f32")]
    pub fn pdf_area(&self, ng: Vec3, time: f32) -> f32 {
        let stretch = self.motion.as_ref().map_or(1.0, |motion| {
            let m = motion.at(f64::from(time)).matrix3;
            m.determinant().abs() / (m.transpose() * ng.as_dvec3()).length()
        });
        (1.0 / (self.shape.area() * stretch)) as f32
    }
}

/// A ray in the space that `pose` maps to the render frame.
fn to_own(pose: &Pose, ray: &Ray) -> Ray64 {
    let Ray64 { origin, direction, t_max } = ray.widened();
    Ray64 {
        origin: pose.inverse * (origin - pose.map.translation),
        direction: pose.inverse * direction,
        t_max,
    }
}

/// A ray in the space that `offset` shifts to the render frame.
#[inline]
fn back(offset: DVec3, ray: &Ray) -> Ray64 {
    let ray = ray.widened();
    Ray64 { origin: ray.origin - offset, ..ray }
}

/// Half a unit in the last place of a number in units of the number, with 2⁻³³ for what f64 and the bound itself round.
const HALF_ULP: f32 = 0.5 * f32::EPSILON * 1.002;

/// Shifts a point of a surface, with the error bound that `moved` derives: the f64 sum rounds sizes up to that of the point before and after.
#[inline]
fn shift(surface: &mut SurfacePoint, offset: DVec3) {
    let own = surface.point;
    surface.point = (own.as_dvec3() + offset).as_vec3();
    let sizes = own.abs() + surface.point.abs();
    surface.error = (surface.error + sizes * HALF_ULP) * (1.0 + f32::EPSILON);
}

/// The image of a point of a surface, with the error bound that holds for rays traced in the shape's own space.
fn moved(surface: &SurfacePoint, Pose { map, inverse }: &Pose) -> SurfacePoint {
    let m = map.matrix3;
    let normal_map = inverse.transpose();
    let turn = |n: Vec3| (normal_map * n.as_dvec3()).normalize().as_vec3();
    let own = surface.point.as_dvec3();
    let point = map.transform_point3(own).as_vec3();
    // How far an error in the shape's space reaches, and sizes that the map rounds.
    let magnitudes = glam::DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
    let scale: DVec3 = magnitudes * own.abs() + map.translation.abs();
    // A ray that starts here is rounded to f32 in a mesh's space, by half a unit in the last place of each coordinate,
    // on top of the surface's own error; this point is rounded too, and the f64 map rounds sizes like `scale`.
    let half_ulp = f64::from(0.5 * f32::EPSILON);
    let own_error = surface.error.as_dvec3() + own.abs() * (half_ulp * 1.001);
    let error = magnitudes * own_error + point.as_dvec3().abs() * half_ulp + scale * (32.0 * f64::EPSILON);
    let error = error.as_vec3() * (1.0 + f32::EPSILON);
    SurfacePoint { point, error, ng: turn(surface.ng), n: turn(surface.n), ..*surface }
}
