//! Rank 4: from a point of the image, a point of the lens and a moment to a ray.
//!
//! A pinhole is given by its position o, the vector f to the middle of the image plane, and the vectors `s_x`, `s_y`
//! from there to the middle of the image's right and lower edge: the point (`p_x`, `p_y`) in [−1, 1]² of the image is
//! at `h = o + f + p_x·s_x + p_y·s_y`. With a lens of radius r, f reaches to the plane in focus, and rays start at
//! `o' = o + ζ₁·r·ŝ_x + ζ₂·r·ŝ_y` for (ζ₁, ζ₂) uniform on the unit disk, towards h.

use glam::{DAffine3, DVec3, Vec3};

use crate::error::ParamError;
use crate::math::transform::Motion;
use crate::ray::Ray;

pub mod shutter;

pub use shutter::{Opening, Shutter};

/// Which image coordinate an angle of view spans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    X,
    /// The height.
    Y,
    /// The diagonal.
    Diagonal,
    /// The shorter of width and height.
    Smaller,
    /// The longer of width and height.
    Larger,
}

/// How the camera projects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Rays through one point, or through a lens.
    Perspective {
        /// Full angle of view in degrees, in (0, 180).
        fov: f64,
        /// What the angle spans.
        axis: FovAxis,
        /// Radius of the lens in scene units; 0 for a pinhole.
        lens_radius: f64,
        /// Distance of the plane in focus along the axis, above 0; without effect for a pinhole.
        focus_distance: f64,
    },
    /// Parallel rays; the image spans [−1, 1] of the camera's x coordinate.
    Orthographic,
    /// An object's surface that measures the irradiance on it: the film is spread over the surface by area, and rays leave it
    /// in cosine-distributed directions.
    IrradianceMeter {
        /// Index of the object in the description.
        object: usize,
    },
}

/// The eye as a scene describes it.
///
/// In its own space the camera is at the origin and looks along +z, with +x to the left and +y up (Mitsuba's
/// convention).
#[derive(Debug, Clone)]
pub struct CameraSettings {
    /// How it projects.
    pub projection: Projection,
    /// Camera space to the world, over time.
    pub to_world: Motion,
    /// When the shutter is open.
    pub shutter: Shutter,
}

/// A camera ready to make rays in the render frame.
#[derive(Debug, Clone)]
pub struct Camera {
    parallel: bool,
    forward: DVec3,
    right: DVec3,
    down: DVec3,
    lens_radius: f64,
    motion: Motion,
    at_rest: Option<Pose>,
}

/// The camera's vectors at one moment, in the render frame.
#[derive(Debug, Clone, Copy)]
struct Pose {
    o: Vec3,
    f: Vec3,
    sx: Vec3,
    sy: Vec3,
    lens_x: Vec3,
    lens_y: Vec3,
}

/// How a point is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The point of the lens.
    pub from: Vec3,
    /// Where on the image, as for [`Camera::ray`], beyond [−1, 1]² as well.
    pub place: [f64; 2],
}

impl Camera {
    /// The camera of `settings` for an image of `width` × `height` pixels.
    ///
    /// * `to_frame`: the world to the render frame, a translation.
    ///
    /// # Errors
    /// A parameter out of its range, or a transform that is singular at a key.
    pub fn new(
        settings: &CameraSettings,
        width: u32,
        height: u32,
        to_frame: DVec3,
    ) -> Result<Self, ParamError> {
        let (w, h) = (f64::from(width), f64::from(height));
        let (forward, right, down, lens_radius) = match settings.projection {
            Projection::Perspective { fov, axis, lens_radius, focus_distance } => {
                check(fov > 0.0 && fov < 180.0, "fov", fov, "an angle in (0, 180) degrees")?;
                check(
                    lens_radius >= 0.0 && lens_radius.is_finite(),
                    "aperture_radius",
                    lens_radius,
                    "a finite radius of at least 0",
                )?;
                check(
                    lens_radius == 0.0 || (focus_distance > 0.0 && focus_distance.is_finite()),
                    "focus_distance",
                    focus_distance,
                    "a finite distance above 0",
                )?;
                let distance = if lens_radius > 0.0 { focus_distance } else { 1.0 };
                let half = distance * (0.5 * fov.to_radians()).tan() / half_extent(axis, w, h);
                (distance * DVec3::Z, -half * w * DVec3::X, -half * h * DVec3::Y, lens_radius)
            }
            Projection::Orthographic | Projection::IrradianceMeter { .. } => {
                (DVec3::Z, DVec3::NEG_X, -(h / w) * DVec3::Y, 0.0)
            }
        };
        let parallel = settings.projection == Projection::Orthographic;
        let motion = settings.to_world.then(&DAffine3::from_translation(to_frame))?;
        let mut camera = Self { parallel, forward, right, down, lens_radius, motion, at_rest: None };
        if camera.motion.is_static() {
            camera.at_rest = Some(camera.pose(settings.shutter.open));
        }
        Ok(camera)
    }

    /// Whether rays start on a lens rather than at one point.
    pub fn has_lens(&self) -> bool {
        self.lens_radius > 0.0
    }

    /// Whether the camera moves.
    pub fn moves(&self) -> bool {
        self.at_rest.is_none()
    }

    /// The ray through the middle of the lens and the point `p` of the image at `time`.
    ///
    /// * `p`: in [−1, 1]², rightwards and downwards; beyond where a wide filter reaches over the edge.
    #[inline]
    pub fn ray(&self, p: [f32; 2], time: f32) -> Ray {
        self.at(time, |pose| {
            let on_plane = p[0] * pose.sx + p[1] * pose.sy;
            if self.parallel {
                return Ray::new(pose.o + on_plane, pose.f.normalize(), time);
            }
            Ray::new(pose.o, (pose.f + on_plane).normalize(), time)
        })
    }

    /// The ray from the lens at `zeta` on the unit disk through the plane in focus at `p`: direction h − o'.
    #[inline]
    pub fn lens_ray(&self, p: [f32; 2], zeta: [f32; 2], time: f32) -> Ray {
        self.at(time, |pose| {
            let offset = zeta[0] * pose.lens_x + zeta[1] * pose.lens_y;
            let direction = pose.f + p[0] * pose.sx + p[1] * pose.sy - offset;
            Ray::new(pose.o + offset, direction.normalize(), time)
        })
    }

    /// The share of the image around a ray's direction from the lens; not for parallel rays.
    ///
    /// The plane in focus is at the distance v / |n·d| along the unit vector d, with n = `s_x` × `s_y` and v = |n·f|, and a steradian
    /// there takes (v / |n·d|)² |n| / |n·d| of it; the whole image takes 4·|n|.
    ///
    /// # Measure
    /// Per steradian.
    pub fn per_steradian(&self, direction: Vec3, time: f32) -> f32 {
        self.at(time, |pose| {
            let n = pose.sx.cross(pose.sy);
            let (v, cos) = (n.dot(pose.f), n.dot(direction).abs());
            0.25 * v * v / (cos * cos * cos)
        })
    }

    /// How `point` is seen from the lens at `zeta` on the unit disk; `None` if it is not in front. Not for parallel rays.
    pub fn sight(&self, point: Vec3, zeta: [f32; 2], time: f32) -> Option<Sight> {
        self.at(time, |pose| {
            let offset = zeta[0] * pose.lens_x + zeta[1] * pose.lens_y;
            let from = pose.o + offset;
            let to = point.as_dvec3() - from.as_dvec3();
            let [offset, f, sx, sy] = [offset, pose.f, pose.sx, pose.sy].map(|v| v.as_dvec3());
            let n = sx.cross(sy);
            let scale = n.dot(f) / n.dot(to);
            let on_plane = scale * to + offset - f;
            // Where the axes aren't perpendicular, those across the other one.
            let place = [
                on_plane.dot(sy.cross(n)) / sx.dot(sy.cross(n)),
                on_plane.dot(sx.cross(n)) / sy.dot(sx.cross(n)),
            ];
            (scale > 0.0 && scale.is_finite()).then_some(Sight { from, place })
        })
    }

    /// What comes of the pose at `time`.
    #[inline]
    fn at<T>(&self, time: f32, what: impl Fn(&Pose) -> T) -> T {
        match &self.at_rest {
            Some(pose) => what(pose),
            None => what(&self.pose(f64::from(time))),
        }
    }

    fn pose(&self, time: f64) -> Pose {
        let m = self.motion.at(time);
        let vector = |v: DVec3| m.transform_vector3(v);
        let (sx, sy) = (vector(self.right), vector(self.down));
        Pose {
            o: m.translation.as_vec3(),
            f: vector(self.forward).as_vec3(),
            sx: sx.as_vec3(),
            sy: sy.as_vec3(),
            lens_x: (self.lens_radius * sx.normalize()).as_vec3(),
            lens_y: (self.lens_radius * sy.normalize()).as_vec3(),
        }
    }
}

/// What an angle of view's half corresponds to, in the unit in which the image is `w` × `h` half extents.
fn half_extent(axis: FovAxis, w: f64, h: f64) -> f64 {
    match axis {
        FovAxis::X => w,
        FovAxis::Y => h,
        FovAxis::Diagonal => w.hypot(h),
        FovAxis::Smaller => w.min(h),
        FovAxis::Larger => w.max(h),
    }
}

fn check(holds: bool, name: &'static str, value: f64, accepted: &'static str) -> Result<(), ParamError> {
    if holds { Ok(()) } else { Err(ParamError::OutOfRange { name, value, accepted }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(lens_radius: f64) -> Camera {
        let settings = CameraSettings {
            projection: Projection::Perspective {
                fov: 90.0,
                axis: FovAxis::X,
                lens_radius,
                focus_distance: 4.0,
            },
            to_world: Motion::fixed(DAffine3::IDENTITY).unwrap(),
            shutter: Shutter::INSTANT,
        };
        Camera::new(&settings, 200, 100, DVec3::ZERO).unwrap()
    }

    #[test]
    fn an_angle_of_90_degrees_reaches_the_edge_at_45() {
        let ray = camera(0.0).ray([1.0, 0.0], 0.0);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert!((ray.direction - Vec3::new(-half, 0.0, half)).length() < 1e-7); // one rounding of 0.7071
        let lower = camera(0.0).ray([0.0, 1.0], 0.0).direction;
        assert!((lower.y / lower.z + 0.5).abs() < 1e-7); // the image is half as high as wide
    }

    #[test]
    fn every_lens_point_sees_the_same_point_in_focus() {
        let camera = camera(0.3);
        for zeta in [[0.0, 0.0], [0.7, -0.2], [-1.0, 0.0]] {
            let ray = camera.lens_ray([0.25, -0.5], zeta, 0.0);
            let at_focus = ray.at((4.0 - ray.origin.z) / ray.direction.z);
            // 4 · 2⁻²³ is one ulp at 4; the chain has about ten roundings
            assert!((at_focus - Vec3::new(-1.0, 1.0, 4.0)).length() < 10.0 * 4.0 * f32::EPSILON);
        }
    }

    #[test]
    fn a_point_is_seen_where_the_ray_through_it_starts() {
        let camera = camera(0.3);
        for (zeta, p) in [([0.0, 0.0], [0.3, -0.8]), ([0.7, -0.2], [-0.9, 0.1]), ([-1.0, 0.0], [0.5, 0.5])] {
            let ray = camera.lens_ray(p, zeta, 0.0);
            let sight = camera.sight(ray.at(7.0), zeta, 0.0).unwrap();
            assert_eq!(sight.from, ray.origin);
            // The point is 7 away, its coordinates round by 2⁻²² each, and the half image is 4·4/7 wide there and half as high.
            for axis in 0..2 {
                assert!((sight.place[axis] - f64::from(p[axis])).abs() < 2e-6, "{zeta:?} {p:?}");
            }
            assert_eq!(camera.sight(ray.at(-7.0), zeta, 0.0), None);
            // Directions of neighbouring points of the image, and the solid angle between them.
            let side = 1.0 / 64.0;
            let towards = |x: f32, y: f32| {
                camera.lens_ray([p[0] + x * side, p[1] + y * side], zeta, 0.0).direction.as_dvec3()
            };
            let [right, down] =
                [towards(0.5, 0.0) - towards(-0.5, 0.0), towards(0.0, 0.5) - towards(0.0, -0.5)];
            // Of the image's area 4, by central differences: their error is of the order of side²/24, the f32 directions' 1e-5.
            let exact = f64::from(side * side) / 4.0 / right.cross(down).length();
            let found = f64::from(camera.per_steradian(ray.direction, 0.0));
            assert!((found / exact - 1.0).abs() < 1e-4, "{found} {exact}");
        }
    }

    #[test]
    fn an_impossible_lens_is_refused_by_name() {
        let settings = CameraSettings {
            projection: Projection::Perspective {
                fov: 40.0,
                axis: FovAxis::X,
                lens_radius: 0.1,
                focus_distance: 0.0,
            },
            to_world: Motion::fixed(DAffine3::IDENTITY).unwrap(),
            shutter: Shutter::INSTANT,
        };
        let error = Camera::new(&settings, 8, 8, DVec3::ZERO).unwrap_err();
        assert_eq!(error.to_string(), "focus_distance is 0; a finite distance above 0 is accepted");
    }
}
