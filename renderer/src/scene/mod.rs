//! Rank 7: everything that is fixed before the first ray.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use crate::accel::{Accel, Object};
use crate::camera::{Camera, CameraSettings, Projection, Shutter};
use crate::error::{Error, ParamError};
use crate::film::Film;
use crate::interaction::Interaction;
use crate::lights::{AreaLight, Emission, Environment, Light, Lights, Spot};
use crate::materials::{Calls, Material};
use crate::math::Frame;
use crate::math::float::round_f32;
use crate::ray::{Hit, Ray};
use crate::sampling::Decision;
use crate::shapes::{Shape, ShapeHit};

pub mod description;
pub mod effects;
pub mod meter;
pub mod transport;

pub use description::{LightSettings, ObjectSettings, SamplerSettings, SceneDescription};
pub use effects::{Effect, Effects};
pub use meter::Meter;
pub use transport::{Branch, IntegratorSettings, Strategy};

/// A scene ready to be rendered, in a frame whose origin is the camera's position as the shutter opens.
///
/// Transforms compose in f64 and become f32 only in that frame, so that a scene far from the world's origin keeps
/// its digits.
#[derive(Debug)]
pub struct Scene {
    /// The eye.
    pub camera: Camera,
    /// The surface that measures irradiance, in the place of the camera.
    pub meter: Option<Meter>,
    /// When light reaches the film.
    pub shutter: Shutter,
    /// The image.
    pub film: Film,
    /// The shapes.
    pub accel: Accel,
    /// The lights.
    pub lights: Lights,
    /// Where paths from lights begin, if they are asked for and can serve: there is a camera of one perspective, a shape that
    /// emits, and a surface that isn't diffuse.
    pub emission: Option<Emission>,
    /// Which light paths are followed.
    pub integrator: IntegratorSettings,
    /// What the scene calls for.
    pub effects: Effects,
    /// Whether a material's frame must lie along the surface's own tangent.
    pub anisotropic: bool,
    surfaces: Vec<SurfaceSettings>,
}

/// What an object's surface does to light.
#[derive(Debug, Clone)]
struct SurfaceSettings {
    material: Arc<Material>,
    calls: Calls,
    light: Option<u32>,
}

impl Scene {
    /// Builds the scene of `description`.
    ///
    /// # Errors
    /// [`Error::Scene`] names the object and the parameter that is not accepted.
    pub fn new(description: &SceneDescription) -> Result<Self, Error> {
        let refuse = |object: &str| {
            let object = object.to_string();
            move |reason: ParamError| Error::Scene { object, reason }
        };
        let settings = &description.camera;
        let shutter = settings.shutter;
        let to_frame = -settings.to_world.at(shutter.open).translation;
        let film = Film::new(&description.film).map_err(refuse("film"))?;
        let camera =
            Camera::new(settings, film.whole[0], film.whole[1], to_frame).map_err(refuse("sensor"))?;

        let mut objects = Vec::new();
        let mut surfaces = Vec::new();
        let mut lights = Vec::new();
        let mut meter = None;
        let measured = measured(settings, description.objects.len()).map_err(refuse("sensor"))?;
        for (number, object) in description.objects.iter().enumerate() {
            if measured == Some(number) {
                meter = Some(Meter { object: index(objects.len())? });
            } else if object.material.is_absent() && object.radiance.is_black() {
                continue;
            }
            let placed = place(object, to_frame, shutter).map_err(refuse(&object.name))?;
            let light = if object.radiance.is_black() { None } else { Some(index(lights.len())?) };
            if light.is_some() {
                check_radiance(object.radiance.range()).map_err(refuse(&object.name))?;
                let sampling = description.integrator.light_sampling;
                let light = AreaLight::new(index(objects.len())?, &placed, object.radiance.clone(), sampling);
                lights.push(Light::Area(light));
            }
            let calls = object.material.calls_for();
            surfaces.push(SurfaceSettings { material: object.material.clone(), calls, light });
            objects.push(placed);
        }
        for light in &description.lights {
            lights.extend(bare_light(light, to_frame).map_err(refuse("emitter"))?);
        }
        let accel = Accel::new(objects, [shutter.open, shutter.close]);
        // By light points alone nothing is counted that a path runs into.
        let finds_sky = description.integrator.strategy != Strategy::Light;
        let lights = Lights::new(lights, &accel, [shutter.open, shutter.close], finds_sky);
        let is_asked = description.integrator.light_paths
            && !description.integrator.hide_emitters
            && matches!(settings.projection, Projection::Perspective { .. });
        let sends_on = |object: u32| !surfaces[object as usize].material.is_matte();
        let begin = || Emission::new(lights.as_slice(), &accel, [shutter.open, shutter.close], sends_on);
        let emission = is_asked.then(begin).flatten();
        let mut scene = Self {
            camera,
            meter,
            shutter,
            film,
            accel,
            lights,
            emission,
            integrator: description.integrator,
            effects: Effects::NONE,
            anisotropic: surfaces.iter().any(|s| s.calls.anisotropic),
            surfaces,
        };
        scene.effects = Effects::of(&scene);
        Ok(scene)
    }

    /// The material of the object of index `object`.
    pub fn material(&self, object: u32) -> &Material {
        &self.surfaces[object as usize].material
    }

    /// Which decisions that object's material makes.
    pub fn calls_for(&self, object: u32) -> Calls {
        self.surfaces[object as usize].calls
    }

    /// Whether that object's material is diffuse.
    pub fn is_matte(&self, object: u32) -> bool {
        self.surfaces[object as usize].material.is_matte()
    }

    /// Whether any material chooses a lobe, or a direction in one.
    pub fn decides(&self, decision: Decision) -> bool {
        self.surfaces.iter().any(|s| match decision {
            Decision::Lobe => s.calls.lobe,
            Decision::Direction => s.calls.direction,
            _ => false,
        })
    }

    /// The materials of all objects.
    pub fn materials(&self) -> impl Iterator<Item = &Material> {
        self.surfaces.iter().map(|s| s.material.as_ref())
    }

    /// The frame at a hit, with its x axis along the surface's tangent where the material looks at it.
    pub fn frame_along(&self, ray: &Ray, hit: &Hit, interaction: &Interaction) -> Frame {
        if !self.calls_for(hit.object).anisotropic {
            return interaction.frame();
        }
        let at = ShapeHit { t: hit.t, uv: hit.uv };
        let tangent = self.accel.objects()[hit.object as usize].tangent(hit.element, &at, ray);
        Frame::from_z_towards(interaction.surface.n, tangent)
    }

    /// The index of the light that the object of index `object` is, and the light, if it is one.
    pub fn light_of(&self, object: u32) -> Option<(u32, &Light)> {
        self.surfaces[object as usize].light.map(|l| (l, self.lights.get(l)))
    }
}

/// Which of `count` objects measures irradiance, if that is what the settings ask for.
fn measured(settings: &CameraSettings, count: usize) -> Result<Option<usize>, ParamError> {
    let Projection::IrradianceMeter { object } = settings.projection else { return Ok(None) };
    if object < count {
        return Ok(Some(object));
    }
    let (index, last) = (object as u64, (count as u64).saturating_sub(1));
    Err(ParamError::Index { name: "the object of the irradiance meter", index, last })
}

/// The object in the render frame: at rest with its geometry there; with its geometry there as the shutter opens, if it moves without turning; or
/// in object space.
fn place(object: &ObjectSettings, to_frame: DVec3, shutter: Shutter) -> Result<Object, ParamError> {
    let motion = object.to_world.then(&DAffine3::from_translation(to_frame))?;
    let moves = !motion.is_static() && shutter.length() > 0.0;
    let settings = if object.radiance.is_black() { object.shape.clone() } else { object.shape.of_light() };
    let shape = |map: &DAffine3| Shape::new(&settings, map, object.flip_normals);
    let (mut shape, motion) = if !moves {
        (shape(&motion.at(shutter.open))?, None)
    } else if let Some((start, shift)) = motion.shift_from(shutter.open)
        && let Ok(shape) = shape(&start)
    {
        (shape, Some(shift))
    } else {
        // It turns, or its kind of shape can't have that map: an ellipsoid is a sphere in a space of its own.
        (shape(&DAffine3::IDENTITY)?, Some(motion))
    };
    if !(object.material.is_textured() || object.radiance.varies()) {
        shape = shape.without_coordinates();
    }
    Ok(Object { shape, motion })
}

/// `n` as an index; scenes hold fewer than 2³² objects because each takes more than a byte of memory.
fn index(n: usize) -> Result<u32, Error> {
    u32::try_from(n).map_err(|_| Error::Scene {
        object: "scene".into(),
        reason: ParamError::Index { name: "object", index: n as u64, last: u64::from(u32::MAX) },
    })
}

/// The light in the render frame; `None` where it is black.
fn bare_light(settings: &LightSettings, to_frame: DVec3) -> Result<Option<Light>, ParamError> {
    let (light, quantity) = match *settings {
        LightSettings::Environment { ref pixels, .. } if pixels.iter().all(|p| p.is_black()) => {
            return Ok(None);
        }
        LightSettings::Environment { size, ref pixels, to_world } => {
            let map = Environment::new(size, pixels.to_vec(), to_world)?;
            let mean = map.mean();
            (Light::Environment(Arc::new(map)), mean)
        }
        LightSettings::Spot { position, axis, intensity, angles } => {
            let axis = unit("the length of axis", axis)?;
            let angles = angles.map(round_f32);
            let spot = Spot::new((position + to_frame).as_vec3(), axis.as_vec3(), intensity, angles)?;
            (Light::Spot(spot), intensity)
        }
        LightSettings::Constant { radiance } => (Light::Constant { radiance }, radiance),
        LightSettings::Point { position, intensity } => {
            (Light::Point { position: (position + to_frame).as_vec3(), intensity }, intensity)
        }
        LightSettings::Directional { direction, irradiance } => {
            let wi = unit("the length of direction", -direction)?;
            (Light::Directional { wi: wi.as_vec3(), irradiance }, irradiance)
        }
    };
    check_radiance(quantity.to_array())?;
    Ok((!quantity.is_black()).then_some(light))
}

/// `v` at length 1.
fn unit(name: &'static str, v: DVec3) -> Result<DVec3, ParamError> {
    let accepted = "a finite length above 0";
    v.try_normalize().ok_or(ParamError::OutOfRange { name, value: v.length(), accepted })
}

/// Refuses values that are not finite, or negative.
fn check_radiance(values: impl IntoIterator<Item = f32>) -> Result<(), ParamError> {
    for value in values.into_iter().map(f64::from) {
        if !value.is_finite() {
            return Err(ParamError::NotFinite { name: "radiance", value });
        }
        if value < 0.0 {
            return Err(ParamError::OutOfRange {
                name: "radiance",
                value,
                accepted: "a value of at least 0",
            });
        }
    }
    Ok(())
}
