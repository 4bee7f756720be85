//! Lights that are not shapes.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::Context;
use super::color::{emission, emission_texture, single};
use super::object::Object;
use super::transform;
use crate::Error;
use crate::io::png;
use crate::lights::Environment;
use crate::lights::spot::check_angles;
use crate::math::Rgb;
use crate::scene::LightSettings;

const PLUGINS: [&str; 6] = ["area", "constant", "directional", "envmap", "point", "spot"];

/// The lights at `indices` of the document, without the area lights, which belong to shapes.
pub(super) fn read(context: &Context, indices: &[usize]) -> Result<Vec<LightSettings>, Error> {
    let mut lights = Vec::new();
    for &index in indices {
        let object = Object::new(context, index)?;
        match object.plugin(&PLUGINS)? {
            "area" => unattached(context, &object)?,
            "constant" => lights.push(LightSettings::Constant { radiance: emission(&object, "radiance")? }),
            "directional" => lights.push(directional(&object)?),
            "envmap" => lights.push(environment(&object)?),
            "spot" => lights.push(spot(&object)?),
            _ => lights.push(point(&object)?),
        }
        object.finish()?;
    }
    let beyond = |light: &&LightSettings| {
        matches!(light, LightSettings::Constant { .. } | LightSettings::Environment { .. })
    };
    if lights.iter().filter(beyond).count() > 1 {
        let second = &context.document.elements[indices[indices.len() - 1]].place;
        return Err(second.refuse("a second constant or envmap emitter; one is accepted"));
    }
    Ok(lights)
}

/// An area emitter beside the shapes is one that a shape refers to.
fn unattached(context: &Context, object: &Object) -> Result<(), Error> {
    if context.attached.borrow().contains(&object.index) {
        emission_texture(object, "radiance")?;
        return Ok(());
    }
    Err(object
        .place()
        .refuse("an area emitter that no shape has; one inside a shape, or referred to there, is accepted"))
}

fn point(object: &Object) -> Result<LightSettings, Error> {
    let intensity = emission(object, "intensity")?;
    let position = match object.point("position")? {
        Some(_) if object.has("to_world") => {
            return Err(
                object.refuse_value("position", "'position' beside 'to_world'; one of them is accepted")
            );
        }
        Some(position) => position,
        None => transform::fixed(object, "to_world")?.translation,
    };
    Ok(LightSettings::Point { position, intensity })
}

fn environment(object: &Object) -> Result<LightSettings, Error> {
    let filename = object.string("filename")?.ok_or_else(|| object.missing("filename"))?;
    let scale = object.float("scale")?.unwrap_or(1.0);
    let to_world = transform::fixed(object, "to_world")?.matrix3;
    if object.boolean("mis_compensation", false)? {
        let why = "directions are drawn in proportion to radiance; the image's mean is the same";
        object.context.note(format!("{}: 'mis_compensation' has no effect: {why}", object.place()));
    }
    let (path, bytes) = object.context.file(filename)?;
    let image = png::decode(&path, &bytes, false)?;
    let pixels: Arc<[Rgb]> = image.rgb.into_iter().map(|p| Rgb::from(p) * single(scale)).collect();
    let size = [image.width, image.height];
    if pixels.iter().any(|p| !p.is_black()) {
        Environment::new(size, pixels.to_vec(), to_world).map_err(|reason| object.refuse(&reason))?;
    }
    Ok(LightSettings::Environment { size, pixels, to_world })
}

fn spot(object: &Object) -> Result<LightSettings, Error> {
    let intensity = emission(object, "intensity")?;
    let cutoff = object.float("cutoff_angle")?.unwrap_or(20.0);
    let beam = object.float("beam_width")?.unwrap_or(0.75 * cutoff);
    check_angles([beam, cutoff]).map_err(|reason| object.refuse(&reason))?;
    let DAffine3 { matrix3: m, translation } = transform::fixed(object, "to_world")?;
    let gram = m.transpose() * m;
    // Matrices in files carry about six digits.
    if !gram.abs_diff_eq(DMat3::IDENTITY * gram.x_axis.x, 1e-4 * gram.x_axis.x) {
        let message = "'to_world' shears a spot; rotation, translation and uniform scale are accepted";
        return Err(object.refuse_value("to_world", message));
    }
    Ok(LightSettings::Spot { position: translation, axis: m.z_axis, intensity, angles: [beam, cutoff] })
}

fn directional(object: &Object) -> Result<LightSettings, Error> {
    let irradiance = emission(object, "irradiance")?;
    let direction = match object.point("direction")? {
        Some(_) if object.has("to_world") => {
            return Err(
                object.refuse_value("direction", "'direction' beside 'to_world'; one of them is accepted")
            );
        }
        Some(direction) => direction,
        None => transform::fixed(object, "to_world")?.matrix3 * DVec3::Z,
    };
    if direction.try_normalize().is_none() {
        return Err(object.refuse_value(
            "direction",
            "'direction' is zero; a direction of any length above 0 is accepted",
        ));
    }
    Ok(LightSettings::Directional { direction, irradiance })
}
