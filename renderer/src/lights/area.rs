//! Shapes that emit.

use glam::Vec3;

use super::LightSample;
use crate::accel::{Accel, Object};
use crate::interaction::{Interaction, SurfacePoint};
use crate::math::Rgb;
use crate::math::float::round_f32;
use crate::ray::{Hit, Ray};
use crate::shapes::{Rectangle, Shape};
use crate::texture::Texture;

/// How points on a shape that emits are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LightSampling {
    /// Uniformly by area.
    Area,
    /// Uniformly in the solid angle, where the shape has a map for it: rectangles, triangles, and spheres from outside.
    SolidAngle,
    /// In the solid angle where that pays: spheres, and flat shapes close by.
    #[default]
    Auto,
}

impl LightSampling {
    /// Every way, with its name in scene files.
    pub const ALL: [(&'static str, Self); 3] =
        [("area", Self::Area), ("solid-angle", Self::SolidAngle), ("auto", Self::Auto)];
}

/// Distance, in units of the half diagonal of a flat light's box, up to which `Auto` takes its solid angle.
///
/// Measured on a square over a floor, as variance × time by solid angle over that by area: 0.55 at 1.8 half diagonals,
/// 1.2 at 3.5 and at 9.4, where less variance no longer pays for the longer map.
const NEAR: f32 = 2.5;

/// A shape whose points emit the same radiance in every direction from the side of its normal.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaLight {
    /// Index of the shape.
    pub object: u32,
    /// Radiance [W m⁻² sr⁻¹] by surface coordinates.
    pub radiance: Texture,
    /// Whether its points are uniform in the solid angle wherever it is near.
    even: bool,
    middle: Vec3,
    /// Squared distance from the middle up to which points are taken by solid angle.
    near: f32,
}

impl AreaLight {
    /// The light that `shape`, the object of index `object`, is.
    pub fn new(object: u32, shape: &Object, radiance: Texture, sampling: LightSampling) -> Self {
        let bounds = shape.bounds([0.0; 2]);
        let (middle, half) = (0.5 * (bounds.min + bounds.max), 0.5 * (bounds.max - bounds.min));
        let near = match (sampling, &shape.shape) {
            (LightSampling::Area, _) => 0.0,
            (LightSampling::SolidAngle, _) | (LightSampling::Auto, Shape::Sphere(_)) => f32::INFINITY,
            (LightSampling::Auto, _) => half.as_vec3().length_squared() * NEAR * NEAR,
        };
        let middle = middle.as_vec3();
        let outside = middle + shape.shape.sample_area([0.5; 2]).ng * (2.0 * half.as_vec3().length());
        let is_single = shape.shape.element_count() == 1;
        let even = near > 0.0 && is_single && shape.sample_solid_angle(outside, [0.5; 2]).is_some();
        Self { object, radiance, even, middle, near }
    }

    /// Whether its points are uniform in the solid angle wherever it is near.
    pub fn is_even(&self) -> bool {
        self.even
    }

    /// Whether points are taken by solid angle where `from` sees them.
    fn is_near(&self, from: Vec3) -> bool {
        (from - self.middle).length_squared() < self.near
    }

    /// A point on the light for `u` in [0, 1)², as seen from `from`; where it lies does not depend on the radiance there.
    ///
    /// By solid angle its density is 1 / Ω. By area it is, with the distance d and the cosine at the light cos θ',
    /// d² / (A·cos θ'), so that L / pdf = L·A·cos θ' / d².
    ///
    /// Returns: `None` where the light's point sends nothing this way.
    ///
    /// # Measure
    /// per steradian at `from`.
    ///
    /// # Source
    /// Shirley, Wang and Zimmerman 1996, "Monte Carlo techniques for direct lighting calculations", section 3
    /// (doi:10.1145/226150.226151).
    pub fn sample(&self, accel: &Accel, from: &Interaction, u: [f32; 2]) -> Option<LightSample> {
        let object = &accel.objects()[self.object as usize];
        let eye = from.surface.point;
        let by_angle = if self.is_near(eye) { object.sample_solid_angle(eye, u) } else { None };
        let (target, pdf_area) = by_angle.unwrap_or_else(|| object.sample_area(u, from.time));
        let radiance = self.radiance.eval(target.uv);
        let (is_seen, sample) = seen(&target, radiance, pdf_area, &from.surface, from.time);
        let pdf = by_angle.map_or(sample.pdf, |(_, pdf)| pdf);
        (is_seen && !radiance.is_black()).then_some(LightSample { pdf, ..sample })
    }

    /// What [`Self::sample`] gives for each of `from` and its point of `u`, appended to `out`.
    pub fn sample_each(
        &self,
        accel: &Accel,
        from: &[&Interaction],
        u: &[[f32; 2]],
        out: &mut Vec<Option<LightSample>>,
    ) {
        let object = &accel.objects()[self.object as usize];
        match (&object.shape, &self.radiance) {
            (Shape::Rectangle(rectangle), Texture::Constant(radiance))
                if object.motion.is_none() && from.len() >= 8 =>
            {
                let first = out.len();
                sample_rectangle(rectangle, *radiance, from, u, out);
                for (out, (from, u)) in out[first..].iter_mut().zip(from.iter().zip(u)) {
                    if self.is_near(from.surface.point) {
                        *out = self.sample(accel, from, *u);
                    }
                }
            }
            _ => out.extend(from.iter().zip(u).map(|(from, u)| self.sample(accel, from, *u))),
        }
    }

    /// Density per steradian with which [`Self::sample`] would have drawn the point `hit` of this light from the
    /// origin of `ray`.
    ///
    /// * `ng`: geometric normal at the hit.
    pub fn pdf(&self, accel: &Accel, ray: &Ray, hit: &Hit, ng: Vec3) -> f32 {
        let object = &accel.objects()[self.object as usize];
        let by_angle =
            if self.is_near(ray.origin) { object.pdf_solid_angle(hit.element, ray.origin) } else { None };
        by_angle.unwrap_or_else(|| {
            per_steradian(object.pdf_area(ng, ray.time), hit.t * hit.t, -ng.dot(ray.direction))
        })
    }
}

/// Points on a light of constant radiance by area, many at once: the loop over lanes becomes one of vectors.
fn sample_rectangle(
    rectangle: &Rectangle,
    radiance: Rgb,
    from: &[&Interaction],
    u: &[[f32; 2]],
    out: &mut Vec<Option<LightSample>>,
) {
    let pdf_area = round_f32(1.0 / rectangle.area());
    let mut lanes = Lanes::EMPTY;
    for (from, u) in from.chunks(LANES).zip(u.chunks(LANES)) {
        lanes.fill(from, u);
        // Whole vectors, whatever lies beyond the end.
        for lane in 0..from.len().next_multiple_of(8).min(LANES) {
            let target = rectangle.sample_area([lanes.u[0][lane], lanes.u[1][lane]]);
            let (is_seen, sample) = seen(&target, radiance, pdf_area, &lanes.surface(lane), 0.0);
            lanes.set(lane, is_seen, &sample);
        }
        out.extend(from.iter().enumerate().map(|(lane, from)| {
            let (wi, pdf, ray) = lanes.sample(lane);
            let shadow_ray = Ray { time: from.time, ..ray };
            let sample = LightSample { wi, shadow_ray, radiance, pdf, delta: false };
            lanes.is_seen[lane].then_some(sample)
        }));
    }
}

/// The sample at `target`, a point of that radiance taken by area, as seen from `from` at `time`; and whether the light sends anything this way.
#[inline]
fn seen(
    target: &SurfacePoint,
    radiance: Rgb,
    pdf_area: f32,
    from: &SurfacePoint,
    time: f32,
) -> (bool, LightSample) {
    let d = target.point - from.point;
    let inverse = d.length_recip();
    let wi = d * inverse;
    let cos = -wi.dot(target.ng);
    let pdf = per_steradian(pdf_area, d.length_squared(), cos);
    let shadow_ray = from.spawn_to(target, time);
    // `inverse` is infinite where the points coincide; no branch, so that a loop can be one of vectors.
    let is_seen = (inverse < f32::INFINITY) & (cos > 0.0);
    (is_seen, LightSample { wi, shadow_ray, radiance, pdf, delta: false })
}

/// Surfaces whose light points are found at once.
const LANES: usize = 64;

/// Three coordinates of each lane.
#[derive(Debug, Clone, Copy)]
struct Vectors([[f32; LANES]; 3]);

impl Vectors {
    const ZERO: Self = Self([[0.0; LANES]; 3]);

    #[inline]
    fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.0[0][lane], self.0[1][lane], self.0[2][lane])
    }

    #[inline]
    fn set(&mut self, lane: usize, v: Vec3) {
        for (axis, value) in self.0.iter_mut().zip(v.to_array()) {
            axis[lane] = value;
        }
    }
}

/// Surfaces and the samples that they see, number by number.
struct Lanes {
    point: Vectors,
    error: Vectors,
    ng: Vectors,
    u: [[f32; LANES]; 2],
    wi: Vectors,
    origin: Vectors,
    direction: Vectors,
    t_max: [f32; LANES],
    pdf: [f32; LANES],
    is_seen: [bool; LANES],
}

impl Lanes {
    const EMPTY: Self = Self {
        point: Vectors::ZERO,
        error: Vectors::ZERO,
        ng: Vectors::ZERO,
        u: [[0.0; LANES]; 2],
        wi: Vectors::ZERO,
        origin: Vectors::ZERO,
        direction: Vectors::ZERO,
        t_max: [0.0; LANES],
        pdf: [0.0; LANES],
        is_seen: [false; LANES],
    };

    /// Puts in surfaces, with the numbers for their points, from the first lane on.
    fn fill(&mut self, from: &[&Interaction], u: &[[f32; 2]]) {
        for (lane, (from, u)) in from.iter().zip(u).enumerate() {
            self.point.set(lane, from.surface.point);
            self.error.set(lane, from.surface.error);
            self.ng.set(lane, from.surface.ng);
            [self.u[0][lane], self.u[1][lane]] = *u;
        }
    }

    /// What matters of a surface.
    #[inline]
    fn surface(&self, lane: usize) -> SurfacePoint {
        let ng = self.ng.get(lane);
        let (point, error) = (self.point.get(lane), self.error.get(lane));
        SurfacePoint { point, error, ng, n: ng, uv: [0.0; 2] }
    }

    #[inline]
    fn set(&mut self, lane: usize, is_seen: bool, sample: &LightSample) {
        self.wi.set(lane, sample.wi);
        self.origin.set(lane, sample.shadow_ray.origin);
        self.direction.set(lane, sample.shadow_ray.direction);
        self.t_max[lane] = sample.shadow_ray.t_max;
        self.pdf[lane] = sample.pdf;
        self.is_seen[lane] = is_seen;
    }

    /// Direction, density and shadow ray; its time is left at 0.
    fn sample(&self, lane: usize) -> (Vec3, f32, Ray) {
        let ray = Ray::new(self.origin.get(lane), self.direction.get(lane), 0.0);
        (self.wi.get(lane), self.pdf[lane], Ray { t_max: self.t_max[lane], ..ray })
    }
}

/// A density per m² at squared distance `d2`, seen under the cosine `cos`, as one per steradian: p·d² / cos.
#[inline]
fn per_steradian(pdf_area: f32, d2: f32, cos: f32) -> f32 {
    pdf_area * d2 / cos
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::ShapeSettings;
    use glam::{DAffine3, DVec3};

    #[test]
    fn samples_taken_together_are_those_taken_one_by_one() {
        let to_frame = DAffine3::from_translation(DVec3::new(0.3, 0.1, 2.0)) * DAffine3::from_rotation_x(2.8);
        let shape = Shape::new(&ShapeSettings::Rectangle, &to_frame, false).unwrap();
        let accel = Accel::new(vec![Object::still(shape)], [0.0; 2]);
        let light = AreaLight::new(0, &accel.objects()[0], Rgb::WHITE.into(), LightSampling::Auto);
        // Near and far, before and behind the light, and on it.
        let place = |i: f32| Vec3::new((0.7 * i).sin() * 5.0, (0.3 * i).cos(), 2.0 - (0.11 * i).cos() * 9.0);
        let at = |i: f32| {
            let (point, ng) = (place(i), place(3.0 * i).normalize());
            let surface = SurfacePoint { point, error: point.abs() * 1e-7, ng, n: ng, uv: [0.0; 2] };
            Interaction { surface, wo: ng, time: 0.25, object: 0 }
        };
        let mut from: Vec<Interaction> = (0..150_u8).map(|i| at(f32::from(i))).collect();
        from[7].surface.point = accel.objects()[0].sample_area([0.5; 2], 0.0).0.point;
        let u: Vec<[f32; 2]> = (0..150_u8).map(|i| [f32::from(i) / 150.0, 0.5]).collect();
        for count in [0, 3, 8, 61, 64, 65, 150] {
            let (from, mut found) = (from.iter().take(count).collect::<Vec<_>>(), Vec::new());
            light.sample_each(&accel, &from, &u[..count], &mut found);
            let single: Vec<_> =
                from.iter().zip(&u).map(|(from, u)| light.sample(&accel, from, *u)).collect();
            assert!(found == single, "{count}");
            assert!(count < 8 || found.iter().any(Option::is_some) && found.iter().any(Option::is_none));
        }
    }
}
