//! Where paths that begin at lights start: a point on a shape that emits, and a direction to what may send light on.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::{AreaLight, Light};
use crate::accel::{Accel, Object};
use crate::interaction::SurfacePoint;
use crate::math::bounds::Bounds;
use crate::math::float::{ONE_MINUS_EPSILON, round_f32};
use crate::math::{Frame, Rgb};
use crate::sampling::warp::{cone_pdf, one_minus_cos, square_to_cone, square_to_sphere};
use crate::sampling::{Discrete, DiscreteSample};
use crate::shapes::Shape;

/// Most objects that are aimed at one by one; of more, all at once.
const MOST_TARGETS: usize = 16;

/// Points on the lights that are shapes, chosen by their power and uniform by area, and directions uniform in the cones that the targets
/// fill, each of which is chosen as often.
#[derive(Debug, Clone)]
pub struct Emission {
    /// The lights that are shapes, and the distribution over them.
    sources: Vec<AreaLight>,
    choice: Discrete,
    /// The density per m² of points on each object that emits, by its index; 0 for the others.
    densities: Vec<f32>,
    targets: Vec<Ball>,
}

/// A ball that holds an object.
#[derive(Debug, Clone, Copy)]
struct Ball {
    center: Vec3,
    radius: f32,
}

/// The start of a path.
#[derive(Debug, Clone, Copy)]
pub struct Emitted {
    /// The point on the light.
    pub surface: SurfacePoint,
    /// The unit direction away from it.
    pub direction: Vec3,
    /// Radiance times the cosine at the light over the density of point and direction \[W\].
    pub power: Rgb,
    /// That density [m⁻² sr⁻¹], as [`Emission::density`] gives it.
    pub density: f32,
}

impl Emission {
    /// The starts of paths from those of `lights` that are shapes of `accel` to the objects of which `sends_on` is true.
    ///
    /// Returns: `None` if there are no such lights or objects.
    pub fn new(
        lights: &[Light],
        accel: &Accel,
        shutter: [f64; 2],
        sends_on: impl Fn(u32) -> bool,
    ) -> Option<Self> {
        let objects = accel.objects();
        let mut densities = vec![0.0; objects.len()];
        let (mut sources, mut powers) = (Vec::new(), Vec::new());
        for light in lights {
            let Light::Area(area) = light else { continue };
            sources.push(area.clone());
            powers.push(f64::from(area.radiance.mean()) * objects[area.object as usize].shape.area());
        }
        let choice = Discrete::new(&powers).ok()?;
        for (AreaLight { object, .. }, power) in sources.iter().zip(&powers) {
            let per_area = objects[*object as usize].pdf_area(Vec3::Z, 0.0);
            densities[*object as usize] = round_f32(power / choice.sum()) * per_area;
        }
        let sending = (0..).zip(objects).filter(|(index, _)| sends_on(*index)).map(|(_, object)| object);
        let mut targets: Vec<Ball> = sending.clone().map(|object| Ball::around(object, shutter)).collect();
        if targets.len() > MOST_TARGETS {
            let all = sending.fold(Bounds::EMPTY, |all, object| all.union(&object.bounds(shutter)));
            targets = vec![Ball::of(&all)];
        }
        (!targets.is_empty()).then_some(Self { sources, choice, densities, targets })
    }

    /// Whether there is more than one light to choose from.
    pub fn needs_choice(&self) -> bool {
        self.sources.len() > 1
    }

    /// The start of a path at `time`.
    ///
    /// * `u_light`: in [0, 1), chooses the light; * `u_point`, `u`: in [0, 1)², choose the point on it, and target and direction.
    ///
    /// Returns: `None` where nothing is sent.
    pub fn sample(
        &self,
        accel: &Accel,
        u_light: f32,
        [u_point, u]: [[f32; 2]; 2],
        time: f32,
    ) -> Option<Emitted> {
        let DiscreteSample { index, pmf, .. } = self.choice.sample(u_light);
        let AreaLight { object, radiance, .. } = &self.sources[index];
        let (surface, pdf_area) = accel.objects()[*object as usize].sample_area(u_point, time);
        let count = self.targets.len() as f32;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index below the count"
        )]
        let target = ((u[0] * count) as usize).min(self.targets.len() - 1);
        let within = (u[0] * count - target as f32).clamp(0.0, ONE_MINUS_EPSILON);
        let direction = self.targets[target].direction(surface.point, [within, u[1]]);
        let cos = surface.ng.dot(direction);
        let aimed = self.aimed(surface.point, direction);
        let radiance = radiance.eval(surface.uv);
        (cos > 0.0 && aimed > 0.0 && !radiance.is_black()).then(|| Emitted {
            surface,
            direction,
            power: radiance * (cos / (pmf * pdf_area * aimed)),
            density: self.densities[*object as usize] * aimed,
        })
    }

    /// The density with which paths start at a point of the object of index `object` in a direction; 0 if that doesn't emit.
    ///
    /// # Measure
    /// Per m² and steradian.
    pub fn density(&self, object: u32, point: Vec3, direction: Vec3) -> f32 {
        self.densities[object as usize] * self.aimed(point, direction)
    }

    /// The density of directions from a point, per steradian.
    fn aimed(&self, point: Vec3, direction: Vec3) -> f32 {
        let sum: f32 = self.targets.iter().map(|target| target.pdf(point, direction)).sum();
        sum / self.targets.len() as f32
    }
}

impl Ball {
    fn around(object: &Object, shutter: [f64; 2]) -> Self {
        let around_box = Self::of(&object.bounds(shutter));
        match &object.shape {
            Shape::Sphere(sphere) if object.motion.is_none() => {
                Self { radius: round_f32(sphere.radius()), ..around_box }
            }
            _ => around_box,
        }
    }

    /// The ball around a box.
    fn of(bounds: &Bounds) -> Self {
        let [middle, half] = bounds.middle_and_half();
        Self { center: middle.as_vec3(), radius: round_f32(half.length()) }
    }

    /// The axis of the cone that it fills from a point, and 1 − cos of its half angle; `None` from inside.
    fn cone(&self, point: Vec3) -> Option<(Vec3, f32)> {
        let to = self.center - point;
        let d2 = to.length_squared();
        let sin2 = self.radius * self.radius / d2;
        (sin2 < 1.0).then(|| (to / d2.sqrt(), one_minus_cos(sin2)))
    }

    /// A direction towards it; from inside, any.
    fn direction(&self, point: Vec3, u: [f32; 2]) -> Vec3 {
        match self.cone(point) {
            Some((axis, height)) => Frame::from_z(axis).to_world(square_to_cone(u, height)),
            None => square_to_sphere(u),
        }
    }

    /// The density of [`Self::direction`], per steradian.
    fn pdf(&self, point: Vec3, direction: Vec3) -> f32 {
        match self.cone(point) {
            Some((axis, height)) => {
                // The direction in the frame of the cone, turned about its axis.
                let (sin, cos) = (axis.cross(direction).length(), axis.dot(direction));
                cone_pdf(Vec3::new(sin, 0.0, cos), height)
            }
            None => 0.25 * FRAC_1_PI,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::lights::LightSampling;
    use crate::shapes::ShapeSettings;

    fn object(settings: &ShapeSettings, to_frame: DAffine3) -> Object {
        Object::still(Shape::new(settings, &to_frame, false).unwrap())
    }

    fn ball(center: DVec3, radius: f64) -> Object {
        object(&ShapeSettings::Sphere { center, radius }, DAffine3::IDENTITY)
    }

    /// Paths from two squares of sides 2 and 1, the second three times as bright, to the other objects.
    fn emission(others: Vec<Object>) -> (Accel, Emission) {
        let square = |z: f64, half: f64| {
            let place = DAffine3::from_translation(z * DVec3::Z) * DAffine3::from_scale(DVec3::splat(half));
            object(&ShapeSettings::Rectangle, place)
        };
        let mut objects = vec![square(0.0, 1.0), square(-20.0, 0.5)];
        objects.extend(others);
        let light = |index: u32, radiance: f32| {
            let radiance = Rgb::splat(radiance).into();
            Light::Area(AreaLight::new(index, &objects[index as usize], radiance, LightSampling::Auto))
        };
        let lights = [light(0, 1.0), light(1, 3.0)];
        let accel = Accel::new(objects, [0.0; 2]);
        let emission = Emission::new(&lights, &accel, [0.0; 2], |object| object > 1).unwrap();
        (accel, emission)
    }

    #[test]
    fn paths_start_with_the_density_of_two_cones() {
        let (accel, emission) =
            emission(vec![ball(DVec3::new(0.0, 0.0, 5.0), 1.0), ball(DVec3::new(4.0, 0.0, 6.0), 2.0)]);
        let mut met = [0; 2];
        for k in 0..1000_u16 {
            let u = |step: f32| (f32::from(k) * step).fract();
            let start =
                emission.sample(&accel, u(0.618_034), [[u(0.7549), u(0.5698)], [u(0.8192), u(0.671)]], 0.0);
            let start = start.unwrap();
            // By power, 4 to 3, over areas of 4 and 1.
            let light = u32::from(start.surface.point.z < -1.0);
            let per_area = [4.0 / 7.0 / 4.0, 3.0 / 7.0][light as usize];
            let solid_angle = |center: DVec3, radius: f64| {
                let sin2 = radius * radius / (center - start.surface.point.as_dvec3()).length_squared();
                std::f64::consts::TAU * (1.0 - (1.0 - sin2).sqrt())
            };
            let angles =
                [solid_angle(DVec3::new(0.0, 0.0, 5.0), 1.0), solid_angle(DVec3::new(4.0, 0.0, 6.0), 2.0)];
            let hit = [2, 3].map(|index| {
                let ray = start.surface.spawn(start.direction, 0.0);
                accel.objects()[index].shape.intersect(0, &ray).is_some()
            });
            let density: f64 = (0..2).filter(|&i| hit[i]).map(|i| 0.5 / angles[i]).sum::<f64>() * per_area;
            // A ray within a rounding of a ball's rim may be counted otherwise: none of these is.
            let relative = f64::from(start.density) / density - 1.0;
            // 1 − cos θ of half angles of some degrees, from coordinates rounded in f32: 1e-5.
            assert!(relative.abs() < 1e-5, "{k} {hit:?} {relative}");
            let radiance = [1.0, 3.0][light as usize];
            let power = radiance * f64::from(start.direction.z) / density;
            assert!((f64::from(start.power.r) / power - 1.0).abs() < 2e-5, "{k}");
            assert_eq!(start.density, emission.density(light, start.surface.point, start.direction));
            hit.iter().zip(&mut met).for_each(|(hit, met)| *met += u32::from(*hit));
        }
        assert!(met.iter().all(|&met| met > 400), "{met:?}");
        assert_eq!(emission.density(2, Vec3::ZERO, Vec3::Z), 0.0);
    }

    #[test]
    fn many_objects_are_aimed_at_together_and_from_inside_everywhere() {
        let balls = (0..20).map(|i| ball(DVec3::new(f64::from(i) - 10.0, 0.0, 30.0), 0.1)).collect();
        let (_, emission) = emission(balls);
        assert_eq!(emission.targets.len(), 1);
        let Ball { center, radius } = emission.targets[0];
        for i in 0..20_u8 {
            let middle = Vec3::new(f32::from(i) - 10.0, 0.0, 30.0);
            assert!((middle - center).length() + 0.1 < radius);
        }
        assert_eq!(emission.targets[0].pdf(center, Vec3::X), 0.25 * FRAC_1_PI);
    }
}
