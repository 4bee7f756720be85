//! Materials.

use std::sync::Arc;

use super::Context;
use super::color::{color, index, single, texture};
use super::document::MAX_DEPTH;
use super::object::Object;
use crate::materials::{Material, Metal};
use crate::math::Rgb;
use crate::math::spectrum::Kind;
use crate::{Error, ParamError};

const PLUGINS: [&str; 7] =
    ["blurdisc", "conductor", "dielectric", "diffuse", "phong", "roughconductor", "twosided"];

/// Mitsuba's defaults of `int_ior` (bk7) and `ext_ior` (air).
const GLASS: f64 = 1.5046;
const AIR: f64 = 1.000_277;

/// Mitsuba's linear sRGB of its named conductors; a copy of `references/spectra/metals_rgb.csv`, whose README tells how it
/// was made.
const METALS: &str = include_str!("metals.csv");

/// The material at `at` in the document.
pub(super) fn read(context: &Context, at: usize) -> Result<Arc<Material>, Error> {
    if let Some(known) = context.materials.borrow().get(&at) {
        return Ok(known.clone());
    }
    let object = Object::new(context, at)?;
    if context.building.borrow().contains(&at) {
        return Err(object
            .place()
            .refuse("a bsdf inside itself; a bsdf without a reference to itself is accepted"));
    }
    if context.building.borrow().len() >= MAX_DEPTH {
        return Err(object.place().refuse(format!("bsdfs nested too deep; {MAX_DEPTH} levels are accepted")));
    }
    context.building.borrow_mut().push(at);
    let built = match object.plugin(&PLUGINS)? {
        "blurdisc" => blur_disk(&object)?,
        "conductor" => conductor(&object)?,
        "dielectric" => dielectric(&object)?,
        "diffuse" => Material::new_diffuse(texture(&object, "reflectance", 0.5)?),
        "phong" => phong(&object)?,
        "roughconductor" => rough_conductor(&object)?,
        _ => two_sided(&object)?,
    };
    let material = Arc::new(built.map_err(|reason| object.refuse(&reason))?);
    object.finish()?;
    context.building.borrow_mut().pop();
    context.materials.borrow_mut().insert(at, material.clone());
    Ok(material)
}

/// What a constructor of materials says; the outer result is the reader's.
type Built = Result<Result<Material, ParamError>, Error>;

fn eta(object: &Object, default: [f64; 2]) -> Result<f32, Error> {
    let inside = index(object, "int_ior")?.unwrap_or(default[0]);
    let outside = index(object, "ext_ior")?.unwrap_or(default[1]);
    Ok(single(inside / outside))
}

fn dielectric(object: &Object) -> Built {
    let eta = eta(object, [GLASS, AIR])?;
    let (reflected, transmitted) =
        (texture(object, "specular_reflectance", 1.0)?, texture(object, "specular_transmittance", 1.0)?);
    Ok(Material::new_dielectric(eta, reflected, transmitted))
}

fn blur_disk(object: &Object) -> Built {
    let blur = object.float("blur")?.ok_or_else(|| object.missing("blur"))?;
    let refracts = object.has("int_ior") || object.has("ext_ior");
    let eta = eta(object, [GLASS, AIR])?;
    let (reflected, transmitted) =
        (texture(object, "specular_reflectance", 1.0)?, texture(object, "specular_transmittance", 1.0)?);
    if !refracts && object.has("specular_transmittance") {
        let message =
            "'specular_transmittance' without 'int_ior' or 'ext_ior'; one of them beside it is accepted";
        return Err(object.refuse_value("specular_transmittance", message));
    }
    Ok(Material::new_blur_disk(single(blur), refracts.then_some(eta), reflected, transmitted))
}

fn phong(object: &Object) -> Built {
    let diffuse = texture(object, "diffuse_reflectance", 0.5)?;
    let specular = texture(object, "specular_reflectance", 0.2)?;
    Ok(Material::new_phong(diffuse, specular, single(object.float("exponent")?.unwrap_or(30.0))))
}

fn two_sided(object: &Object) -> Built {
    let inner = object.only_nested("bsdf")?;
    let inner =
        inner.ok_or_else(|| object.place().refuse("bsdf twosided without a <bsdf>; one is accepted"))?;
    Ok(Material::new_two_sided(Material::clone(&*read(object.context, inner)?)))
}

fn conductor(object: &Object) -> Built {
    let metal = metal(object)?;
    let reflectance = texture(object, "specular_reflectance", 1.0)?;
    Ok(match metal {
        Some(metal) => Material::new_conductor(metal, reflectance),
        None => Material::new_mirror(reflectance),
    })
}

fn rough_conductor(object: &Object) -> Built {
    let ggx = object.string("distribution")?;
    if ggx.is_none_or(|d| d.value != "ggx") {
        let place = ggx.map_or(object.place(), |d| &d.place);
        let name = ggx.map_or("beckmann (Mitsuba's default)", |d| &d.value);
        return Err(place.unsupported(format!("distribution {name}"), "ggx is accepted"));
    }
    if !object.boolean("sample_visible", true)? {
        let why = "visible normals are always sampled; the image's mean is the same";
        object.context.note(format!("{}: 'sample_visible' has no effect: {why}", object.place()));
    }
    let alpha = object.float("alpha")?;
    let [along, across] = [object.float("alpha_u")?, object.float("alpha_v")?];
    let alpha = match (alpha, along, across) {
        (None, None, None) => [0.1; 2],
        (Some(alpha), None, None) => [alpha; 2],
        (None, Some(u), Some(v)) => [u, v],
        _ => {
            return Err(
                object.refuse_value("alpha", "alpha_u and alpha_v; alpha alone or both of them are accepted")
            );
        }
    };
    // eta 0, k 1 reflects everything: Mitsuba's `none`
    let none = || Metal::new(Rgb::BLACK, Rgb::WHITE).map_err(|reason| object.refuse(&reason));
    let metal = metal(object)?.map_or_else(none, Ok)?;
    Ok(Material::new_rough_conductor(alpha.map(single), metal, texture(object, "specular_reflectance", 1.0)?))
}

/// The metal by `material` or by `eta` and `k`; `None` for a mirror.
fn metal(object: &Object) -> Result<Option<Metal>, Error> {
    let material = object.string("material")?;
    let (eta, k) = (color(object, "eta", Kind::Index)?, color(object, "k", Kind::Index)?);
    let (eta, k) = match (material, eta, k) {
        (None, None, None) => return Ok(None),
        (None, Some(eta), Some(k)) => (eta, k),
        (Some(name), None, None) if name.value == "none" => return Ok(None),
        (Some(name), None, None) => named_metal(&name.value).ok_or_else(|| {
            let names: Vec<&str> = METALS.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
            let list = names.join(", ");
            name.place.refuse(format!("'material' is '{}'; none, {list} are accepted", name.value))
        })?,
        _ => {
            return Err(object
                .place()
                .refuse("eta, k and material; both eta and k, or material alone, are accepted"));
        }
    };
    Metal::new(eta, k).map(Some).map_err(|reason| object.refuse(&reason))
}

fn named_metal(name: &str) -> Option<(Rgb, Rgb)> {
    let mut cells = METALS.lines().skip(1).map(|line| line.split(',')).find_map(|mut cells| {
        let found = cells.next() == Some(name);
        found.then_some(cells)
    })?;
    let mut next = || cells.next().and_then(|cell| cell.parse().ok());
    let eta = Rgb::new(next()?, next()?, next()?);
    Some((eta, Rgb::new(next()?, next()?, next()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_metals_is_the_references_table_and_all_can_be_used() {
        assert_eq!(METALS, include_str!("../../../../references/spectra/metals_rgb.csv"));
        for name in METALS.lines().skip(1).filter_map(|line| line.split(',').next()) {
            let (eta, k) = named_metal(name).unwrap();
            assert!(eta.is_finite() && k.is_finite(), "{name}");
        }
        assert_eq!(named_metal("Au").unwrap().0.g, 0.375_307_08);
    }
}
