//! The second idea: a scene calls for its effects, and pays for no other.

use super::{Scene, SceneDescription};
use crate::camera::{Projection, Shutter};
use crate::error::{Error, ParamError};
use crate::film::Filter;
use crate::lights::Light;
use crate::materials::Material;
use crate::math::Rgb;
use crate::sampling::{Decision, DecisionSet};

/// An effect of distribution ray tracing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Effect {
    /// Depth of field.
    Lens,
    /// Motion blur.
    Shutter,
    /// Lights with an extent: soft shadows.
    AreaLight,
    /// Lobes of finite width other than a diffuse one.
    Rough,
    /// Surfaces that reflect and refract.
    Dielectric,
    /// Light from surface to surface.
    InterReflection,
    /// A filter other than the plain average over the pixel.
    Filter,
}

impl Effect {
    /// Every effect with its name on the command line.
    pub const ALL: [(&'static str, Self); 7] = [
        ("lens", Self::Lens),
        ("shutter", Self::Shutter),
        ("area-light", Self::AreaLight),
        ("rough", Self::Rough),
        ("dielectric", Self::Dielectric),
        ("inter-reflection", Self::InterReflection),
        ("filter", Self::Filter),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|&(_, effect)| effect == self).map_or("", |(name, _)| name)
    }

    /// The decisions that are made for it, at bounce 0 and at later ones.
    ///
    /// Those of rough lobes and of inter-reflection are decisions of one kind, a direction; a wide filter and the plain
    /// average over a pixel share theirs.
    pub fn decisions(self) -> [DecisionSet; 2] {
        let none = DecisionSet::EMPTY;
        let lights = none.with(Decision::LightChoice).with(Decision::LightPoint);
        let lobe = none.with(Decision::Lobe);
        let direction = none.with(Decision::Direction);
        match self {
            Self::Lens => [none.with(Decision::Lens), none],
            Self::Shutter => [none.with(Decision::Time), none],
            Self::AreaLight => [lights; 2],
            Self::Rough => [direction; 2],
            Self::Dielectric => [lobe; 2],
            Self::InterReflection => {
                [lobe.with(Decision::Direction).with(Decision::Roulette), DecisionSet::FULL]
            }
            Self::Filter => [none.with(Decision::Pixel), none],
        }
    }
}

impl SceneDescription {
    /// Takes `effect` out of the scene, by its null value: lens radius 0; a shutter that opens for no time, as it opened;
    /// black shapes instead of light; alpha and blur 0; no surfaces that light passes; paths of two edges; the plain
    /// average over the pixel.
    ///
    /// # Errors
    /// [`Error::Scene`] for a rough material that has no such value.
    pub fn leave_out(&mut self, effect: Effect) -> Result<(), Error> {
        match effect {
            Effect::Lens => match &mut self.camera.projection {
                Projection::Perspective { lens_radius, .. } => *lens_radius = 0.0,
                Projection::Orthographic => (),
                Projection::IrradianceMeter { .. } => {
                    return Err(cannot_leave_out(
                        "sensor",
                        "number of lenses that cannot be left out",
                        "sensors other than an irradiancemeter, whose lens is the hemisphere of directions",
                    ));
                }
            },
            Effect::Shutter => {
                let open = self.camera.shutter.open;
                self.camera.shutter = Shutter { close: open, ..self.camera.shutter };
            }
            Effect::AreaLight => self.objects.iter_mut().for_each(|o| o.radiance = Rgb::BLACK.into()),
            Effect::Rough => {
                for object in &mut self.objects {
                    let name = "number of rough lobes without a sharp form";
                    let accepted = "materials whose roughness is an alpha or a blur";
                    let refused = || cannot_leave_out(&object.name, name, accepted);
                    object.material = object.material.sharp().ok_or_else(refused)?.into();
                }
            }
            Effect::Dielectric => {
                let passes = |m: &Material| m.calls_for().dielectric;
                self.objects.retain(|o| !passes(&o.material));
            }
            Effect::InterReflection => {
                let depth = &mut self.integrator.max_depth;
                *depth = Some(depth.map_or(2, |d| d.min(2)));
            }
            Effect::Filter => self.film.filter = Filter::PIXEL,
        }
        Ok(())
    }
}

/// What `object` has one of, although it is to be left out.
fn cannot_leave_out(object: &str, name: &'static str, accepted: &'static str) -> Error {
    Error::Scene { object: object.into(), reason: ParamError::OutOfRange { name, value: 1.0, accepted } }
}

/// Which effects are called for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effects(u8);

impl Effects {
    /// No effect.
    pub const NONE: Self = Self(0);

    /// This set and `effect`, if `called` for.
    #[must_use]
    const fn with(self, effect: Effect, called: bool) -> Self {
        if called { Self(self.0 | 1 << effect as u8) } else { self }
    }

    /// Whether `effect` is called for.
    pub const fn contains(self, effect: Effect) -> bool {
        self.0 & 1 << effect as u8 != 0
    }

    /// The effects in the set, in the order of [`Effect::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().map(|(_, effect)| effect).filter(move |&effect| self.contains(effect))
    }

    /// The effects that the content of `scene` calls for.
    pub fn of(scene: &Scene) -> Self {
        let calls: Vec<_> = scene.materials().map(|m| m.calls_for()).collect();
        let moves = scene.camera.moves() || scene.accel.objects().iter().any(|o| o.motion.is_some());
        Self::NONE
            .with(Effect::Lens, scene.camera.has_lens() || scene.meter.is_some())
            .with(Effect::Shutter, scene.shutter.length() > 0.0 && moves)
            .with(Effect::AreaLight, scene.lights.as_slice().iter().any(|l| matches!(l, Light::Area(_))))
            .with(Effect::Rough, calls.iter().any(|c| c.rough))
            .with(Effect::Dielectric, calls.iter().any(|c| c.dielectric))
            .with(Effect::InterReflection, scene.integrator.max_depth.is_none_or(|depth| depth > 2))
            .with(Effect::Filter, !scene.film.filter.is_pixel())
    }
}
