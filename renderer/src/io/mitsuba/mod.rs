//! Scene files in Mitsuba 3's XML format: a documented subset, read strictly. A generic layer (`document`, `object`,
//! `transform`, `color`) knows elements, places and values; one short function per plugin asks for its parameters, and
//! what none has asked for is refused with the list of what would have been accepted.
//!
//! Accepted plugins, with Mitsuba's parameters unless a refusal says otherwise:
//! - integrators `path`, `direct`, and our `distribution`;
//! - sensors `perspective`, `thinlens`, `orthographic`, `irradiancemeter` in a shape; film `hdrfilm`, whole or cropped; filters `box`, `tent`, `gaussian`, `mitchell`,
//!   `catmullrom`, `lanczos`;
//! - shapes `rectangle`, `disk`, `sphere`, `cylinder`, `cube`, `obj`, `ply`, `serialized`, `shapegroup`,
//!   `instance`;
//! - bsdfs `diffuse`, `conductor`, `roughconductor`, `dielectric`, `roughdielectric`, `thindielectric`, `plastic`,
//!   `roughplastic`, `phong`, `mask`, `blendbsdf`, `twosided`, and our `blurdisc`;
//! - emitters `area`, `constant`, `envmap`, `point`, `directional`, `spot`; textures `bitmap`, `checkerboard`.
//!
//! Mitsuba 3.9.1's habits are followed where they decide what a scene shows: a checkerboard read as one number has its
//! colours exchanged; `roughplastic` has its tables. Fits are not: the internal reflectance of `plastic` and the shadowing
//! of Beckmann's microfacets are exact (0.1 % of the body, at most 0.35 % of a highlight).
//!
//! `filename`s are relative to the folder of the scene that is read, also in files that it includes, as in Mitsuba.

mod bsdfs;
mod color;
mod document;
mod emitters;
mod files;
mod integrators;
mod metals;
mod object;
mod sensors;
mod shapes;
mod textures;
mod transform;

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use document::{Attribute, Document};
use files::Files;
use object::Object;

use crate::Error;
use crate::materials::Material;
use crate::scene::{ObjectSettings, SceneDescription};
use crate::texture::Texture;

/// What is known while a document becomes a scene.
struct Context {
    document: Document,
    files: RefCell<Files>,
    notes: RefCell<Vec<String>>,
    materials: RefCell<HashMap<usize, Arc<Material>>>,
    textures: RefCell<HashMap<usize, Texture>>,
    /// Shapes of shapegroups.
    groups: RefCell<HashMap<usize, Arc<[ObjectSettings]>>>,
    /// Materials that are being read, to find one inside itself.
    building: RefCell<Vec<usize>>,
    /// Area emitters that a shape has.
    attached: RefCell<HashSet<usize>>,
    /// Shapes with a sensor in them, each with the sensor.
    meters: RefCell<Vec<(usize, usize)>>,
}

impl Context {
    fn note(&self, note: String) {
        self.notes.borrow_mut().push(note);
    }

    /// Path and content of the file that a parameter names.
    fn file(&self, filename: &Attribute) -> Result<(PathBuf, Vec<u8>), Error> {
        let mut files = self.files.borrow_mut();
        let path = files.resolve(&filename.value);
        let refuse = |error| filename.place.refuse(format!("filename '{}': {error}", filename.value));
        let bytes = files.read(&path).map_err(refuse)?;
        Ok((path, bytes))
    }
}

/// Reads the scene file `path` with everything it includes.
///
/// * `overrides`: names and values that win over the file's `default`s; the last one of a name counts.
///
/// Returns: the scene, and one note for each valid parameter that changes nothing.
///
/// # Errors
/// `Error::Io` if `path` cannot be read; else `Error::Format` or `Error::Unsupported` with file, line and column, the name of
/// what is wrong, and what is accepted.
pub fn read_scene(
    path: &Path,
    overrides: &[(String, String)],
) -> Result<(SceneDescription, Vec<String>), Error> {
    let mut files = Files::beside(path);
    for (name, value) in overrides {
        files.add(name.as_bytes());
        files.add(value.as_bytes());
    }
    let document = document::load(&mut files, path, overrides)?;
    let context = Context {
        document,
        files: RefCell::new(files),
        notes: RefCell::default(),
        materials: RefCell::default(),
        textures: RefCell::default(),
        groups: RefCell::default(),
        building: RefCell::default(),
        attached: RefCell::default(),
        meters: RefCell::default(),
    };
    let mut scene = scene(&context)?;
    scene.hash = context.files.borrow().hash();
    Ok((scene, context.notes.into_inner()))
}

fn scene(context: &Context) -> Result<SceneDescription, Error> {
    let root = Object::new(context, 0)?;
    if root.element.tag != "scene" {
        return Err(root.place().refuse(format!("<{}> as the root; <scene> is accepted", root.element.tag)));
    }
    let version = root.element.required("version")?;
    if !(version.value.starts_with("3.") || version.value.starts_with("2.")) {
        let feature = format!("format version '{}'", version.value);
        return Err(version.place.unsupported(feature, "2.x.y and 3.x.y are accepted"));
    }
    let camera = root.only_nested("sensor")?.map(|index| sensors::read(context, index)).transpose()?;
    let integrator = integrators::read(context, root.only_nested("integrator")?)?;
    for index in root.nested("bsdf")? {
        bsdfs::read(context, index)?;
    }
    for index in root.nested("texture")? {
        textures::read(context, index)?;
    }
    let (mut objects, mut meter) = (Vec::new(), None);
    for index in root.nested("shape")? {
        let object = objects.len();
        objects.extend(shapes::read(context, index)?);
        if let Some(&(_, sensor)) = context.meters.borrow().iter().find(|(shape, _)| *shape == index) {
            let second = camera.is_some() || meter.is_some();
            meter = Some((sensor, object));
            if second {
                return Err(context.document.elements[sensor]
                    .place
                    .refuse("a second <sensor>; one is accepted"));
            }
        }
    }
    let meter = meter.map(|(sensor, object)| sensors::read_meter(context, sensor, object, &objects[object]));
    let sensor = camera.or(meter.transpose()?);
    let sensor = sensor.ok_or_else(|| root.place().refuse("a scene without a <sensor>; one is accepted"))?;
    let lights = emitters::read(context, &root.nested("emitter")?)?;
    root.finish()?;
    let sensors::Sensor { camera, film, sampler } = sensor;
    Ok(SceneDescription { camera, film, sampler, integrator, objects, lights, hash: 0 })
}
