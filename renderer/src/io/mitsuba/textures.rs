//! Textures: `checkerboard`, `bitmap`, and `srgb`, which is one colour.

use std::sync::Arc;

use glam::{Affine2, DAffine3, Vec2};

use super::color::{color, single, srgb};
use super::object::Object;
use super::{Context, transform};
use crate::Error;
use crate::io::png;
use crate::math::Rgb;
use crate::math::spectrum::Kind;
use crate::texture::{Bitmap, Checkerboard, Filter, Texture, Wrap};

/// The texture at `index` of the document.
pub(super) fn read(context: &Context, index: usize) -> Result<Texture, Error> {
    if let Some(known) = context.textures.borrow().get(&index) {
        return Ok(known.clone());
    }
    let object = Object::new(context, index)?;
    let texture = match object.plugin(&["bitmap", "checkerboard", "srgb"])? {
        "bitmap" => bitmap(&object)?,
        "srgb" => srgb(&object)?.into(),
        _ => checkerboard(&object)?,
    };
    object.finish()?;
    context.textures.borrow_mut().insert(index, texture.clone());
    Ok(texture)
}

fn checkerboard(object: &Object) -> Result<Texture, Error> {
    let side = |name, default| {
        Ok::<_, Error>(color(object, name, Kind::Reflectance)?.unwrap_or(Rgb::splat(default)))
    };
    let colors = [side("color0", 0.4)?, side("color1", 0.2)?];
    let board = Checkerboard::new(colors, to_uv(object)?).map_err(|reason| object.refuse(&reason))?;
    Ok(Texture::Checkerboard(board))
}

fn bitmap(object: &Object) -> Result<Texture, Error> {
    let filename = object.string("filename")?.ok_or_else(|| object.missing("filename"))?;
    let raw = object.boolean("raw", false)?;
    let filter = object.choice(
        "filter_type",
        &[("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)],
        Filter::Bilinear,
    )?;
    let wraps = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];
    let wrap = object.choice("wrap_mode", &wraps, Wrap::Repeat)?;
    let to_uv = to_uv(object)?;
    object.without_effect("accel", &["boolean"], "textures are looked up by the processor")?;
    object.without_effect("format", &["string"], "texels are f32")?;
    let (path, bytes) = object.context.file(filename)?;
    let image = png::decode(&path, &bytes, raw)?;
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let pixels = image.rgb.into_iter().map(Rgb::from).collect();
    let bitmap = Bitmap::new([side(image.width), side(image.height)], pixels, to_uv, filter, wrap);
    let refuse = |reason| filename.place.refuse(format!("bitmap '{}': {reason}", filename.value));
    Ok(Texture::Bitmap(Arc::new(bitmap.map_err(refuse)?)))
}

/// The part of `to_uv` that acts on the two surface coordinates.
fn to_uv(object: &Object) -> Result<Affine2, Error> {
    let DAffine3 { matrix3: m, translation: t } = transform::fixed(object, "to_uv")?;
    let vector = |x, y| Vec2::new(single(x), single(y));
    Ok(Affine2::from_cols(vector(m.x_axis.x, m.x_axis.y), vector(m.y_axis.x, m.y_axis.y), vector(t.x, t.y)))
}
