//! Shapes with their places, materials and emission.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::Context;
use super::color::emission_texture;
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

/// What the shape at `index` of the document puts into the scene: itself, nothing for a group, copies for an instance.
pub(super) fn read(context: &Context, index: usize) -> Result<Vec<ObjectSettings>, Error> {
    let object = Object::new(context, index)?;
    match object.plugin(&[&PLUGINS[..], &["shapegroup", "instance"]].concat())? {
        "shapegroup" => group(context, index).map(|_| Vec::new()),
        "instance" => instance(object),
        plugin => {
            if let Some(sensor) = object.only_nested("sensor")? {
                context.meters.borrow_mut().push((index, sensor));
            }
            Ok(vec![shape(object, plugin)?])
        }
    }
}

/// The shapes of the `shapegroup` at `index`, in the group's space; read once.
fn group(context: &Context, index: usize) -> Result<Arc<[ObjectSettings]>, Error> {
    if let Some(known) = context.groups.borrow().get(&index) {
        return Ok(known.clone());
    }
    let object = Object::new(context, index)?;
    object.plugin(&["shapegroup"])?;
    let mut shapes = Vec::new();
    for index in object.nested("shape")? {
        let part = Object::new(context, index)?;
        let (place, plugin) = (part.place(), part.plugin(&PLUGINS)?);
        if part.only_nested("sensor")?.is_some() {
            return Err(place.refuse("a sensor in a shapegroup; shapes without are accepted"));
        }
        let read = shape(part, plugin)?;
        if !read.radiance.is_black() {
            return Err(place.refuse("an emitter in a shapegroup; shapes without are accepted"));
        }
        shapes.push(read);
    }
    object.finish()?;
    let shapes: Arc<[ObjectSettings]> = shapes.into();
    context.groups.borrow_mut().insert(index, shapes.clone());
    Ok(shapes)
}

/// The shapes of a group where the instance puts them. Copies of a mesh share its vertices until they are placed.
fn instance(object: Object) -> Result<Vec<ObjectSettings>, Error> {
    let accepted = "one <shape> of type shapegroup is accepted";
    let Some(index) = object.only_nested("shape")? else {
        return Err(object.place().refuse(format!("an instance of nothing; {accepted}")));
    };
    let to_world = transform::motion(&object, "to_world")?;
    let is_reflected = to_world.at(0.0).matrix3.determinant() < 0.0;
    let placed = |part: &ObjectSettings| {
        let own = part.to_world.at(0.0);
        let to_world = match (part.to_world.is_static(), to_world.is_static()) {
            (_, true) => part.to_world.then(&to_world.at(0.0)).map_err(|reason| object.refuse(&reason))?,
            (true, false) if own == DAffine3::IDENTITY => to_world.clone(),
            // Turning keys, interpolated after a map of the shape's own, would leave the instance's path.
            _ => {
                let message = "a moving instance of shapes with a to_world of their own; a to_world on one of them is accepted";
                return Err(object.refuse_value("to_world", message));
            }
        };
        let name = format!("{}, {}", object.name(), part.name);
        // A shape's own reflection turns it over, that of an instance leaves the outside where it is.
        let flip_normals = part.flip_normals != (is_reflected && part.shape.turns_over());
        Ok(ObjectSettings { name, to_world, flip_normals, ..part.clone() })
    };
    let all = group(object.context, index)?.iter().map(placed).collect::<Result<_, _>>()?;
    object.finish()?;
    Ok(all)
}

/// A shape of one of [`PLUGINS`].
fn shape(object: Object, plugin: &str) -> Result<ObjectSettings, Error> {
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
        radiance: radiance.unwrap_or(Rgb::BLACK.into()),
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
fn radiance(object: &Object) -> Result<Option<Texture>, Error> {
    let Some(index) = object.only_nested("emitter")? else { return Ok(None) };
    let light = Object::new(object.context, index)?;
    light.plugin(&["area"])?;
    let radiance = emission_texture(&light, "radiance")?;
    light.finish()?;
    object.context.attached.borrow_mut().insert(index);
    Ok(Some(radiance))
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
