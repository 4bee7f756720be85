//! Materials.

use std::sync::Arc;

use super::Context;
use super::color::{index, single, texture};
use super::document::MAX_DEPTH;
use super::metals;
use super::object::Object;
use crate::materials::{Beckmann, Facets, Ggx, Material, Metal};
use crate::math::Rgb;
use crate::texture::Texture;
use crate::{Error, ParamError};

const PLUGINS: [&str; 13] = [
    "blendbsdf",
    "blurdisc",
    "conductor",
    "dielectric",
    "diffuse",
    "mask",
    "phong",
    "plastic",
    "roughconductor",
    "roughdielectric",
    "roughplastic",
    "thindielectric",
    "twosided",
];

/// Mitsuba's defaults of `int_ior` (bk7, of plastics polypropylene) and `ext_ior` (air).
const GLASS: f64 = 1.5046;
const PLASTIC: f64 = 1.49;
const AIR: f64 = 1.000_277;

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
        "blendbsdf" => blend(&object)?,
        "blurdisc" => blur_disk(&object)?,
        "conductor" => conductor(&object)?,
        "dielectric" => dielectric(&object)?,
        "diffuse" => Material::new_diffuse(texture(&object, "reflectance", 0.5)?),
        "mask" => mask(&object)?,
        "phong" => phong(&object)?,
        "plastic" => plastic(&object, false)?,
        "roughconductor" => rough_conductor(&object)?,
        "roughdielectric" => rough_dielectric(&object)?,
        "roughplastic" => plastic(&object, true)?,
        "thindielectric" => thin_dielectric(&object)?,
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

/// `specular_reflectance` and `specular_transmittance`.
fn factors(object: &Object) -> Result<[Texture; 2], Error> {
    Ok([texture(object, "specular_reflectance", 1.0)?, texture(object, "specular_transmittance", 1.0)?])
}

fn dielectric(object: &Object) -> Built {
    let eta = eta(object, [GLASS, AIR])?;
    let [reflected, transmitted] = factors(object)?;
    Ok(Material::new_dielectric(eta, reflected, transmitted))
}

fn thin_dielectric(object: &Object) -> Built {
    let eta = eta(object, [GLASS, AIR])?;
    let [reflected, transmitted] = factors(object)?;
    Ok(Material::new_thin_dielectric(eta, reflected, transmitted))
}

fn blur_disk(object: &Object) -> Built {
    let blur = object.float("blur")?.ok_or_else(|| object.missing("blur"))?;
    let refracts = object.has("int_ior") || object.has("ext_ior");
    let eta = eta(object, [GLASS, AIR])?;
    let [reflected, transmitted] = factors(object)?;
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
    let side = |index| read(object.context, index).map(|material| Material::clone(&material));
    match object.nested("bsdf")?[..] {
        [both] => Ok(Material::new_two_sided(side(both)?)),
        [upper, lower] => Ok(Material::new_faces([side(upper)?, side(lower)?])),
        _ => {
            Err(object.place().refuse("bsdf twosided with other than one or two <bsdf>; those are accepted"))
        }
    }
}

fn conductor(object: &Object) -> Built {
    let metal = metals::metal(object)?;
    let reflectance = texture(object, "specular_reflectance", 1.0)?;
    Ok(match metal {
        Some(metal) => Material::new_conductor(metal, reflectance),
        None => Material::new_mirror(reflectance),
    })
}

fn rough_conductor(object: &Object) -> Built {
    let facets = facets(object, true)?;
    // eta 0, k 1 reflects everything: Mitsuba's `none`
    let none = || Metal::new(Rgb::BLACK, Rgb::WHITE).map_err(|reason| object.refuse(&reason));
    let metal = metals::metal(object)?.map_or_else(none, Ok)?;
    Ok(Material::new_rough_conductor(facets, metal, texture(object, "specular_reflectance", 1.0)?))
}

fn rough_dielectric(object: &Object) -> Built {
    let facets = facets(object, true)?;
    let eta = eta(object, [GLASS, AIR])?;
    let [reflected, transmitted] = factors(object)?;
    Ok(Material::new_rough_dielectric(facets, eta, reflected, transmitted))
}

fn plastic(object: &Object, rough: bool) -> Built {
    let facets = if rough { Some(facets(object, false)?) } else { None };
    let eta = eta(object, [PLASTIC, AIR])?;
    let nonlinear = object.boolean("nonlinear", false)?;
    let diffuse = texture(object, "diffuse_reflectance", 0.5)?;
    let specular = texture(object, "specular_reflectance", 1.0)?;
    Ok(match facets {
        Some(facets) => Material::new_rough_plastic(facets, eta, nonlinear, diffuse, specular),
        None => Material::new_plastic(eta, nonlinear, diffuse, specular),
    })
}

/// Microfacets of a distribution by their roughness.
type OfAlpha = fn([f32; 2]) -> Facets;

/// The microfacets by `distribution` and `alpha`, or `alpha_u` and `alpha_v` where the plugin has them.
fn facets(object: &Object, anisotropic: bool) -> Result<Facets, Error> {
    let (beckmann, ggx): (OfAlpha, OfAlpha) =
        (|alpha| Beckmann { alpha }.into(), |alpha| Ggx { alpha }.into());
    let of_alpha = object.choice("distribution", &[("beckmann", beckmann), ("ggx", ggx)], beckmann)?;
    if !object.boolean("sample_visible", true)? {
        let why = "visible normals are always sampled; the image's mean is the same";
        object.context.note(format!("{}: 'sample_visible' has no effect: {why}", object.place()));
    }
    let alpha = object.float("alpha")?;
    if !anisotropic {
        return Ok(of_alpha([single(alpha.unwrap_or(0.1)); 2]));
    }
    let [along, across] = [object.float("alpha_u")?, object.float("alpha_v")?];
    let alpha = match (alpha, along, across) {
        (None, None, None) => [0.1; 2],
        (Some(alpha), None, None) => [alpha; 2],
        (None, Some(u), Some(v)) => [u, v],
        _ => {
            let message = "alpha_u and alpha_v; alpha alone or both of them are accepted";
            return Err(object.refuse_value("alpha", message));
        }
    };
    Ok(of_alpha(alpha.map(single)))
}

/// A texture that is read as one number.
///
/// Mitsuba 3.9.1 exchanges the two colours of a checkerboard there (`eval_1` against `eval`), and so what a scene shows.
fn share(object: &Object, name: &str) -> Result<Texture, Error> {
    Ok(match texture(object, name, 0.5)? {
        Texture::Checkerboard(board) => {
            let why = "as in Mitsuba 3.9.1, where one number is asked for";
            object
                .context
                .note(format!("{}: '{name}': color0 and color1 are exchanged, {why}", object.place()));
            Texture::Checkerboard(board.exchanged())
        }
        other => other,
    })
}

fn mask(object: &Object) -> Built {
    let opacity = share(object, "opacity")?;
    let inner = object.only_nested("bsdf")?;
    let inner = inner.ok_or_else(|| object.place().refuse("bsdf mask without a <bsdf>; one is accepted"))?;
    Ok(Material::new_mask(opacity, Material::clone(&*read(object.context, inner)?)))
}

fn blend(object: &Object) -> Built {
    if !object.has("weight") {
        return Err(object.missing("weight"));
    }
    let weight = share(object, "weight")?;
    let [first, second] = object.nested("bsdf")?[..] else {
        let message = "bsdf blendbsdf with other than two <bsdf>; two are accepted";
        return Err(object.place().refuse(message));
    };
    let part = |index| read(object.context, index).map(|material| Material::clone(&material));
    Ok(Material::new_blend(weight, [part(first)?, part(second)?]))
}
