//! The second idea: a scene calls for its effects, and pays for no other.

use super::Scene;
use crate::lights::Light;

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

    /// The effects that the content of `scene` calls for.
    pub fn of(scene: &Scene) -> Self {
        let calls: Vec<_> = scene.materials().map(|m| m.calls_for()).collect();
        let moves = scene.camera.moves() || scene.accel.objects().iter().any(|o| o.motion.is_some());
        Self::NONE
            .with(Effect::Lens, scene.camera.has_lens())
            .with(Effect::Shutter, scene.shutter.length() > 0.0 && moves)
            .with(Effect::AreaLight, scene.lights.as_slice().iter().any(|l| matches!(l, Light::Area(_))))
            .with(Effect::Rough, calls.iter().any(|c| c.rough))
            .with(Effect::Dielectric, calls.iter().any(|c| c.dielectric))
            .with(Effect::InterReflection, scene.integrator.max_depth.is_none_or(|depth| depth > 2))
            .with(Effect::Filter, !scene.film.filter.is_pixel())
    }
}
