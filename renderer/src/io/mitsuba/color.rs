//! Values that are colours: `rgb`, `spectrum`, `srgb`, plain numbers, textures, and indices of refraction by name.

use super::document::Attribute;
use super::object::{Object, number, numbers};
use super::textures;
use crate::Error;
use crate::math::Rgb;
use crate::math::spectrum::{Kind, Knot, rgb_of_constant_emission, rgb_of_knots};
use crate::texture::Texture;

const CONSTANT: [&str; 4] = ["rgb", "spectrum", "float", "integer"];

/// Indices of refraction at 589 nm by the names that Mitsuba gives them (`ior.h`).
const INDICES: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// The colour called `name`.
pub(super) fn color(object: &Object, name: &str, kind: Kind) -> Result<Option<Rgb>, Error> {
    object.part(name, &CONSTANT)?.map(|index| constant(object, index, kind)).transpose()
}

/// The emission called `name`, 1 where there is none.
pub(super) fn emission(object: &Object, name: &str) -> Result<Rgb, Error> {
    let rgb = color(object, name, Kind::Emission)?.unwrap_or(Rgb::WHITE);
    if rgb.to_array().iter().any(|&c| c < 0.0) {
        return Err(negative(object, name));
    }
    Ok(rgb)
}

/// The emission called `name`, a colour or a texture, 1 where there is none.
pub(super) fn emission_texture(object: &Object, name: &str) -> Result<Texture, Error> {
    let texture = varying(object, name, Kind::Emission)?.unwrap_or(Rgb::WHITE.into());
    if texture.range()[0] < 0.0 {
        return Err(negative(object, name));
    }
    Ok(texture)
}

fn negative(object: &Object, name: &str) -> Error {
    object.refuse_value(name, format!("'{name}' has a negative channel; 0 or more is accepted"))
}

/// The reflectance or transmittance called `name`, a colour or a texture, `default` where there is none.
pub(super) fn texture(object: &Object, name: &str, default: f32) -> Result<Texture, Error> {
    Ok(varying(object, name, Kind::Reflectance)?.unwrap_or(Rgb::splat(default).into()))
}

/// The colour or texture called `name`.
fn varying(object: &Object, name: &str, kind: Kind) -> Result<Option<Texture>, Error> {
    let tags = [&CONSTANT[..], &["texture"]].concat();
    let Some(index) = object.part(name, &tags)? else { return Ok(None) };
    if object.context.document.elements[index].tag == "texture" {
        return textures::read(object.context, index).map(Some);
    }
    constant(object, index, kind).map(|value| Some(value.into()))
}

fn constant(object: &Object, index: usize, kind: Kind) -> Result<Rgb, Error> {
    let element = &object.context.document.elements[index];
    if element.tag == "spectrum" && element.text("type").is_some() {
        let spectrum = Object::new(object.context, index)?;
        spectrum.plugin(&["srgb"])?;
        let rgb = srgb(&spectrum)?;
        spectrum.finish()?;
        return Ok(rgb);
    }
    element.only(&["name", "value", "id"])?;
    let value = element.required("value")?;
    match element.tag.as_str() {
        "rgb" => rgb(value),
        "spectrum" => spectrum(value, kind),
        _ => number(value).map(|v| Rgb::splat(single(v))),
    }
}

/// The colour of the plugin `srgb`, which holds one in linear sRGB, 0 to 1 unless it is `unbounded`.
pub(super) fn srgb(object: &Object) -> Result<Rgb, Error> {
    let index = object.part("color", &["rgb"])?.ok_or_else(|| object.missing("color"))?;
    let color = constant(object, index, Kind::Reflectance)?;
    let inside = |c: &f32| (0.0..=1.0).contains(c);
    if object.boolean("unbounded", false)? || color.to_array().iter().all(inside) {
        return Ok(color);
    }
    Err(object.refuse_value(
        "color",
        "'color' has a channel outside 0 to 1; beside 'unbounded' true it is accepted",
    ))
}

fn rgb(value: &Attribute) -> Result<Rgb, Error> {
    match numbers(value)?[..] {
        [grey] => Ok(Rgb::splat(single(grey))),
        [r, g, b] => Ok(Rgb::new(single(r), single(g), single(b))),
        ref other => {
            Err(value.place.refuse(format!("a colour of {} numbers; one or three are accepted", other.len())))
        }
    }
}

fn spectrum(value: &Attribute, kind: Kind) -> Result<Rgb, Error> {
    if !value.value.contains(':') {
        let constant = number(value)?;
        return Ok(match kind {
            Kind::Emission => rgb_of_constant_emission(constant),
            Kind::Reflectance | Kind::Index => Rgb::splat(single(constant)),
        });
    }
    let words = value.value.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
    let knot = |word: &str| -> Option<Knot> {
        let (wavelength, amount) = word.split_once(':')?;
        Some((wavelength.parse().ok()?, amount.parse().ok()?))
    };
    let knots: Option<Vec<Knot>> = words.map(knot).collect();
    let knots = knots.ok_or_else(|| {
        value.place.refuse("spectrum; a number, or a list such as 400:0.5, 700:0.6, is accepted")
    })?;
    rgb_of_knots(&knots, kind).map_err(|reason| value.place.refuse(format!("spectrum: {reason}")))
}

/// The index of refraction called `name`: a positive number, or a name.
pub(super) fn index(object: &Object, name: &str) -> Result<Option<f64>, Error> {
    let Some(part) = object.part(name, &["float", "integer", "string"])? else { return Ok(None) };
    let element = &object.context.document.elements[part];
    element.only(&["name", "value"])?;
    let value = element.required("value")?;
    if element.tag == "string" {
        let found = INDICES.iter().find(|(known, _)| *known == value.value);
        let names: Vec<&str> = INDICES.iter().map(|(known, _)| *known).collect();
        let refuse = || {
            value.place.refuse(format!(
                "'{name}' is '{}'; a number, or {} are accepted",
                value.value,
                names.join(", ")
            ))
        };
        return found.map(|(_, index)| Some(*index)).ok_or_else(refuse);
    }
    let index = number(value)?;
    if index > 0.0 {
        return Ok(Some(index));
    }
    Err(value.place.refuse(format!("'{name}' is {index}; an index of refraction above 0 is accepted")))
}

/// Rounds to single precision.
pub(super) fn single(value: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "colours and material parameters are single precision"
    )]
    let value = value as f32;
    value
}
