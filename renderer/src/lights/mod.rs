//! Rank 6: where light comes from, and points on lights to connect to.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use wide::f32x8;

use crate::accel::Accel;
use crate::interaction::{EightPoints, EightSegments, Interaction};
use crate::math::Rgb;
use crate::math::eight::Vec3x8;
use crate::ray::{Hit, Ray};
use crate::sampling::warp;

pub mod area;
pub mod emission;
pub mod environment;
pub mod select;
pub mod spot;
mod tree;

pub use area::{AreaLight, LightSampling};
pub use emission::Emission;
pub use environment::Environment;
pub use select::Lights;
pub use spot::Spot;

/// A source of light.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// A shape that emits.
    Area(AreaLight),
    /// The same radiance from every direction beyond all shapes.
    Constant {
        /// Radiance [W m⁻² sr⁻¹].
        radiance: Rgb,
    },
    /// Radiance by direction from beyond all shapes.
    Environment(Arc<Environment>),
    /// The same intensity in every direction from one point.
    Point {
        /// Position in the render frame.
        position: Vec3,
        /// Intensity [W sr⁻¹].
        intensity: Rgb,
    },
    /// A cone of light from one point.
    Spot(Spot),
    /// Parallel light.
    Directional {
        /// Unit vector towards the light.
        wi: Vec3,
        /// Irradiance [W m⁻²] on a surface that faces it.
        irradiance: Rgb,
    },
}

/// A point on a light, seen from a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Unit direction towards it.
    pub wi: Vec3,
    /// The segment that must be free, from the surface to just before the point.
    pub shadow_ray: Ray,
    /// Radiance arriving per unit density: L [W m⁻² sr⁻¹], or for lights without extent the irradiance [W m⁻²] on a
    /// surface that faces them.
    pub radiance: Rgb,
    /// Density per steradian; 1 for lights without extent.
    pub pdf: f32,
    /// Whether the light has no extent, so that no other way of sampling can find it.
    pub delta: bool,
}

/// Points on lights seen from eight surfaces, side by side.
#[derive(Debug, Clone, Copy)]
pub struct EightLightSamples {
    /// The lanes in which there is a sample, as bits.
    pub seen: u32,
    /// As in a [`LightSample`].
    pub wi: Vec3x8,
    /// The segments that must be free.
    pub shadow: EightSegments,
    /// As in a [`LightSample`].
    pub radiance: Vec3x8,
    /// As in a [`LightSample`].
    pub pdf: f32x8,
    /// Whether the lights have no extent.
    pub delta: bool,
}

impl EightLightSamples {
    /// The samples that `sample` makes at up to eight surfaces.
    fn one_by_one(
        from: &[&Interaction],
        u: &[[f32; 2]],
        sample: impl Fn(&Interaction, [f32; 2]) -> Option<LightSample>,
    ) -> Self {
        let zero = Vec3x8::ZERO;
        let shadow = EightSegments { origin: zero, direction: zero, t_max: f32x8::ZERO };
        let mut samples = Self { seen: 0, wi: zero, shadow, radiance: zero, pdf: f32x8::ZERO, delta: false };
        for (lane, (from, u)) in from.iter().zip(u).enumerate().take(8) {
            samples.set(lane, sample(from, *u));
        }
        samples
    }

    /// Puts what there is into a lane below 8.
    fn set(&mut self, lane: usize, sample: Option<LightSample>) {
        self.seen &= !(1 << lane);
        if let Some(sample) = sample {
            self.seen |= 1 << lane;
            self.wi.set(lane, sample.wi);
            self.shadow.set(lane, &sample.shadow_ray);
            self.radiance.set(lane, sample.radiance.to_array().into());
            self.pdf.as_mut_array()[lane] = sample.pdf;
            self.delta |= sample.delta;
        }
    }

    /// The shadow ray in a lane below 8, at `time`.
    #[inline]
    pub fn shadow_ray(&self, lane: usize, time: f32) -> Option<Ray> {
        (self.seen >> lane & 1 == 1).then(|| self.shadow.get(lane, time))
    }

    /// The sample in a lane below 8, at `time`.
    #[inline]
    pub fn get(&self, lane: usize, time: f32) -> Option<LightSample> {
        (self.seen >> lane & 1 == 1).then(|| LightSample {
            wi: self.wi.get(lane),
            shadow_ray: self.shadow.get(lane, time),
            radiance: self.radiance.get(lane).into(),
            pdf: self.pdf.as_array()[lane],
            delta: self.delta,
        })
    }
}

impl Light {
    /// A point on the light for `u` in [0, 1)², as seen from `from`.
    ///
    /// Returns: `None` where the light sends nothing this way.
    ///
    /// # Measure
    /// per steradian at `from`.
    pub fn sample(&self, accel: &Accel, from: &Interaction, u: [f32; 2]) -> Option<LightSample> {
        match *self {
            Self::Area(ref light) => light.sample(accel, from, u),
            Self::Environment(ref map) => {
                let (wi, pdf) = map.sample(u)?;
                let (radiance, shadow_ray) = (map.radiance(wi), from.spawn(wi));
                Some(LightSample { wi, shadow_ray, radiance, pdf, delta: false })
            }
            Self::Spot(ref spot) => {
                let d = spot.position - from.surface.point;
                let wi = d.try_normalize()?;
                let radiance = spot.towards(-wi) / d.length_squared();
                let shadow_ray = from.spawn_to_point(spot.position);
                (!radiance.is_black()).then_some(LightSample {
                    wi,
                    shadow_ray,
                    radiance,
                    pdf: 1.0,
                    delta: true,
                })
            }
            Self::Constant { radiance } => {
                let wi = warp::square_to_sphere(u);
                Some(LightSample { wi, shadow_ray: from.spawn(wi), radiance, pdf: 0.25 / PI, delta: false })
            }
            Self::Point { position, intensity } => {
                let d = position - from.surface.point;
                let wi = d.try_normalize()?;
                let shadow_ray = from.spawn_to_point(position);
                Some(LightSample {
                    wi,
                    shadow_ray,
                    radiance: intensity / d.length_squared(),
                    pdf: 1.0,
                    delta: true,
                })
            }
            Self::Directional { wi, irradiance } => Some(LightSample {
                wi,
                shadow_ray: from.spawn(wi),
                radiance: irradiance,
                pdf: 1.0,
                delta: true,
            }),
        }
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
        match self {
            Self::Area(light) => light.sample_eight(accel, from, points, u),
            _ => EightLightSamples::one_by_one(from, u, |from, u| self.sample(accel, from, u)),
        }
    }

    /// Whether [`Self::sample`] looks at its numbers.
    pub fn has_extent(&self) -> bool {
        match self {
            Self::Area(_) | Self::Constant { .. } | Self::Environment(_) => true,
            Self::Point { .. } | Self::Spot(_) | Self::Directional { .. } => false,
        }
    }

    /// Radiance that a shape sends from the point of surface coordinates `uv`; black for lights that are no shapes.
    pub fn radiance_at(&self, uv: [f32; 2]) -> Rgb {
        match self {
            Self::Area(light) => light.radiance.eval(uv),
            _ => Rgb::BLACK,
        }
    }

    /// Density per steradian with which [`Self::sample`] would have drawn the point `hit` of this light from the
    /// origin of `ray`.
    ///
    /// * `ng`: geometric normal at the hit.
    pub fn pdf(&self, accel: &Accel, ray: &Ray, hit: &Hit, ng: Vec3) -> f32 {
        match self {
            Self::Area(light) => light.pdf(accel, ray, hit, ng),
            Self::Constant { .. }
            | Self::Environment(_)
            | Self::Point { .. }
            | Self::Spot(_)
            | Self::Directional { .. } => self.pdf_escaped(ray.direction),
        }
    }

    /// Radiance from beyond all shapes, looking along the unit vector `direction`.
    pub fn radiance_escaped(&self, direction: Vec3) -> Rgb {
        match self {
            Self::Constant { radiance } => *radiance,
            Self::Environment(map) => map.radiance(direction),
            Self::Area(_) | Self::Point { .. } | Self::Spot(_) | Self::Directional { .. } => Rgb::BLACK,
        }
    }

    /// Density per steradian with which [`Self::sample`] would have drawn the unit vector `direction`, which meets no
    /// shape.
    pub fn pdf_escaped(&self, direction: Vec3) -> f32 {
        match self {
            Self::Constant { .. } => 0.25 / PI,
            Self::Environment(map) => map.pdf(direction),
            Self::Area(_) | Self::Point { .. } | Self::Spot(_) | Self::Directional { .. } => 0.0,
        }
    }

    /// Whether it is beyond all shapes.
    pub fn is_background(&self) -> bool {
        matches!(self, Self::Constant { .. } | Self::Environment(_))
    }
}
