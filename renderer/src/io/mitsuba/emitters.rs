//! Lights that are not shapes.

use glam::DVec3;

use super::Context;
use super::color::emission;
use super::object::Object;
use super::{shapes, transform};
use crate::Error;
use crate::scene::LightSettings;

const PLUGINS: [&str; 4] = ["area", "constant", "directional", "point"];

/// The lights at `indices` of the document, without the area lights, which belong to shapes.
pub(super) fn read(context: &Context, indices: &[usize]) -> Result<Vec<LightSettings>, Error> {
    let mut lights = Vec::new();
    for &index in indices {
        let object = Object::new(context, index)?;
        match object.plugin(&PLUGINS)? {
            "area" => unattached(context, &object)?,
            "constant" => lights.push(LightSettings::Constant { radiance: emission(&object, "radiance")? }),
            "directional" => lights.push(directional(&object)?),
            _ => lights.push(point(&object)?),
        }
        object.finish()?;
    }
    let constant = |light: &&LightSettings| matches!(light, LightSettings::Constant { .. });
    if lights.iter().filter(constant).count() > 1 {
        let second = &context.document.elements[indices[indices.len() - 1]].place;
        return Err(second.refuse("a second constant emitter; one is accepted"));
    }
    Ok(lights)
}

/// An area emitter beside the shapes is one that a shape refers to.
fn unattached(context: &Context, object: &Object) -> Result<(), Error> {
    if context.attached.borrow().contains(&object.index) {
        shapes::area_radiance(object)?;
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
