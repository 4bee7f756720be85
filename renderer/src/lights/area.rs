//! Shapes that emit.

use std::ops::{Div, Mul};

use glam::Vec3;
use wide::f32x8;

use super::{EightLightSamples, LightSample};
use crate::accel::{Accel, Object};
use crate::interaction::{EightPoints, Interaction};
use crate::math::Rgb;
use crate::math::eight::{self, Vec3x8};
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
        let [middle, half] = bounds.middle_and_half();
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
        let d = target.point - eye;
        let inverse = d.length_recip();
        let wi = d * inverse;
        let cos = -wi.dot(target.ng);
        // `inverse` is infinite where the points coincide.
        let is_seen = inverse < f32::INFINITY && cos > 0.0 && !radiance.is_black();
        let by_area = || per_steradian(pdf_area, d.length_squared(), cos);
        is_seen.then(|| {
            let pdf = by_angle.map_or_else(by_area, |(_, pdf)| pdf);
            LightSample { wi, shadow_ray: from.spawn_to(&target), radiance, pdf, delta: false }
        })
    }

    /// What [`Self::sample`] gives at up to eight surfaces for the points of `u`, bit for bit.
    ///
    /// * `points`: those surfaces side by side.
    pub fn sample_eight(
        &self,
        accel: &Accel,
        from: &[&Interaction],
        points: &EightPoints,
        u: &[[f32; 2]],
    ) -> EightLightSamples {
        let object = &accel.objects()[self.object as usize];
        let mut samples = match (&object.shape, &self.radiance) {
            (Shape::Rectangle(rectangle), Texture::Constant(radiance)) if object.motion.is_none() => {
                sample_rectangle(rectangle, *radiance, points, u)
            }
            _ => return EightLightSamples::one_by_one(from, u, |from, u| self.sample(accel, from, u)),
        };
        samples.seen &= (1 << from.len()) - 1;
        for (lane, (from, u)) in from.iter().zip(u).enumerate() {
            if self.is_near(from.surface.point) {
                samples.set(lane, self.sample(accel, from, *u));
            }
        }
        samples
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

/// Points on a light of constant radiance by area, seen from eight surfaces: the formulas of [`AreaLight::sample`].
fn sample_rectangle(
    rectangle: &Rectangle,
    radiance: Rgb,
    from: &EightPoints,
    u: &[[f32; 2]],
) -> EightLightSamples {
    let target = rectangle.sample_area_eight(eight::pairs(u));
    let d = target.point - from.point;
    let d2 = d.dot(d);
    let inverse = f32x8::ONE / d2.sqrt();
    let wi = d * inverse;
    let cos = -wi.dot(target.ng);
    let pdf = per_steradian(f32x8::splat(round_f32(1.0 / rectangle.area())), d2, cos);
    let is_seen = inverse.simd_lt(f32::INFINITY) & cos.simd_gt(0.0);
    let radiance = Vec3x8::splat(radiance.to_array().into());
    EightLightSamples {
        seen: is_seen.to_bitmask(),
        wi,
        shadow: from.spawn_to(&target),
        radiance,
        pdf,
        delta: false,
    }
}

/// A density per m² at squared distance `d2`, seen under the cosine `cos`, as one per steradian: p·d² / cos.
#[inline]
fn per_steradian<T: Mul<Output = T> + Div<Output = T>>(pdf_area: T, d2: T, cos: T) -> T {
    pdf_area * d2 / cos
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interaction::SurfacePoint;
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
        let (mut seen, mut hidden) = (0, 0);
        for (from, u) in from.chunks(7).zip(u.chunks(7)) {
            let from: Vec<&Interaction> = from.iter().collect();
            let (points, _) = EightPoints::of(from.iter().map(|from| &from.surface));
            let found = light.sample_eight(&accel, &from, &points, u);
            for (lane, (from, u)) in from.iter().zip(u).enumerate() {
                let single = light.sample(&accel, from, *u);
                assert_eq!(found.get(lane, from.time), single);
                *if single.is_some() { &mut seen } else { &mut hidden } += 1;
            }
        }
        assert!(seen > 20 && hidden > 20, "{seen} {hidden}");
    }
}
