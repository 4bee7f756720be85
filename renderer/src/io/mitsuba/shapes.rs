//! Shapes with their places, materials and emission.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::Context;
use super::color::emission;
use super::object::Object;
use super::{bsdfs, transform};
use crate::Error;
use crate::io::mesh::{self, MeshFormat};
use crate::materials::Material;
use crate::math::Rgb;
use crate::math::transform::Motion;
use crate::scene::ObjectSettings;
use crate::shapes::{Shape, ShapeSettings};
use crate::texture::Texture;

const PLUGINS: [&str; 8] = ["cube", "cylinder", "disk", "obj", "ply", "rectangle", "serialized", "sphere"];

/// The shape at `index` of the document.
pub(super) fn read(context: &Context, index: usize) -> Result<ObjectSettings, Error> {
    let object = Object::new(context, index)?;
    let plugin = object.plugin(&PLUGINS)?;
    let to_world = transform::motion(&object, "to_world")?;
    let flip_normals = object.boolean("flip_normals", false)?;
    let shape = match plugin {
        "cube" => ShapeSettings::Cube,
        "cylinder" => ShapeSettings::Cylinder {
            p0: object.point("p0")?.unwrap_or(DVec3::ZERO),
            p1: object.point("p1")?.unwrap_or(DVec3::Z),
            radius: radius(&object)?,
        },
        "disk" => ShapeSettings::Disk,
        "rectangle" => ShapeSettings::Rectangle,
        "sphere" => ShapeSettings::Sphere {
            center: object.point("center")?.unwrap_or(DVec3::ZERO),
            radius: radius(&object)?,
        },
        "obj" => mesh(&object, MeshFormat::Obj, &to_world)?,
        "serialized" => {
            let shape = object.count("shape_index", [0, u32::MAX], 0)?;
            mesh(&object, MeshFormat::Serialized { shape }, &to_world)?
        }
        _ => mesh(&object, MeshFormat::Ply, &to_world)?,
    };
    if !matches!(shape, ShapeSettings::Mesh(_)) {
        Shape::new(&shape, &to_world.at(0.0), flip_normals).map_err(|reason| object.refuse(&reason))?;
    }
    let radiance = radiance(&object)?;
    let material = material(&object, radiance.is_some())?;
    let name = object.name();
    object.finish()?;
    Ok(ObjectSettings {
        name,
        shape,
        to_world,
        flip_normals,
        material,
        radiance: radiance.unwrap_or(Rgb::BLACK),
    })
}

fn radius(object: &Object) -> Result<f64, Error> {
    let radius = object.float("radius")?.unwrap_or(1.0);
    if radius > 0.0 {
        return Ok(radius);
    }
    Err(object.refuse_value("radius", format!("'radius' is {radius}; a radius above 0 is accepted")))
}

fn mesh(object: &Object, format: MeshFormat, to_world: &Motion) -> Result<ShapeSettings, Error> {
    let filename = object.string("filename")?.ok_or_else(|| object.missing("filename"))?;
    let face_normals = object.boolean("face_normals", false)?;
    // texture coordinates of OBJ files count v upwards
    let has_flip = !matches!(format, MeshFormat::Serialized { .. });
    let flip_uvs = has_flip && object.boolean("flip_tex_coords", format == MeshFormat::Obj)?;
    let (path, bytes) = object.context.file(filename)?;
    let mut data = mesh::parse(&path, &bytes, format)?;
    // a serialized mesh may say so itself
    data.face_normals |= face_normals;
    let face_normals = data.face_normals;
    if let (Some(uvs), true) = (&mut data.uvs, flip_uvs) {
        uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
    }
    if data.normals.is_none() && !face_normals {
        let DAffine3 { matrix3, .. } = to_world.at(0.0);
        data.normals = Some(mesh::vertex_normals(&data, matrix3));
    }
    Ok(ShapeSettings::Mesh(Arc::new(data)))
}

/// The radiance of the area light that the shape is, if it is one.
fn radiance(object: &Object) -> Result<Option<Rgb>, Error> {
    let Some(index) = object.only_nested("emitter")? else { return Ok(None) };
    let light = Object::new(object.context, index)?;
    light.plugin(&["area"])?;
    let radiance = area_radiance(&light)?;
    light.finish()?;
    object.context.attached.borrow_mut().insert(index);
    Ok(Some(radiance))
}

/// The radiance of the `area` emitter `light`.
pub(super) fn area_radiance(light: &Object) -> Result<Rgb, Error> {
    if let Some(index) = light.part("radiance", &["rgb", "spectrum", "float", "integer", "texture"])? {
        let element = &light.context.document.elements[index];
        if element.tag == "texture" {
            return Err(element
                .place
                .unsupported("a texture as radiance", "rgb, spectrum, float are accepted"));
        }
    }
    emission(light, "radiance")
}

/// The shape's material; without one, grey of 0.5, or black for a light, as in Mitsuba.
fn material(object: &Object, shines: bool) -> Result<Arc<Material>, Error> {
    if let Some(index) = object.only_nested("bsdf")? {
        return bsdfs::read(object.context, index);
    }
    let reflectance = if shines { 0.0 } else { 0.5 };
    let diffuse = Material::new_diffuse(Texture::from(Rgb::splat(reflectance)));
    diffuse.map(Arc::new).map_err(|reason| object.refuse(&reason))
}
