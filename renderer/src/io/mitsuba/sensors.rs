//! Sensors with their film, filter and sampler.

use super::Context;
use super::object::Object;
use super::transform;
use crate::Error;
use crate::camera::{Camera, CameraSettings, FovAxis, Opening, Projection, Shutter};
use crate::film::filter::{Filter, FilterSampler};
use crate::film::{Crop, FilmSettings, Reconstruction};
use crate::io::MAX_PIXELS;
use crate::sampling::SamplerKind;
use crate::scene::{ObjectSettings, SamplerSettings};
use glam::DVec3;

const PLUGINS: [&str; 3] = ["orthographic", "perspective", "thinlens"];
const NO_CLIPPING: &str = "nothing is cut off near or far";
/// Mitsuba's `far_clip`, where lenses focus unless they say so.
const FAR_CLIP: f64 = 1e4;
/// Mitsuba's focal length, mm.
const FOCAL_LENGTH: f64 = 50.0;
/// The diagonal of 35 mm film, 36 × 24 mm², squared, mm².
const FILM_DIAGONAL_SQUARED: f64 = 36.0 * 36.0 + 24.0 * 24.0;

/// What a sensor brings.
pub(super) struct Sensor {
    pub(super) camera: CameraSettings,
    pub(super) film: FilmSettings,
    pub(super) sampler: SamplerSettings,
}

/// The sensor at `index` of the document.
pub(super) fn read(context: &Context, index: usize) -> Result<Sensor, Error> {
    let object = Object::new(context, index)?;
    let plugin = object.plugin(&PLUGINS)?;
    let projection = match plugin {
        "orthographic" => Projection::Orthographic,
        _ => perspective(&object, plugin == "thinlens")?,
    };
    object.without_effect("near_clip", &["float", "integer"], NO_CLIPPING)?;
    if plugin != "thinlens" || object.has("focus_distance") {
        object.without_effect("far_clip", &["float", "integer"], NO_CLIPPING)?;
    }
    let to_world = transform::motion(&object, "to_world")?;
    let sensor = exposure(&object, CameraSettings { projection, to_world, shutter: Shutter::INSTANT })?;
    if plugin != "orthographic" {
        check_scale(&object, &sensor.camera)?;
    }
    object.finish()?;
    Ok(sensor)
}

/// The sensor at `index` of the document, which is in the shape that became `object`, the one of index `number`.
pub(super) fn read_meter(
    context: &Context,
    index: usize,
    number: usize,
    object: &ObjectSettings,
) -> Result<Sensor, Error> {
    let meter = Object::new(context, index)?;
    meter.plugin(&["irradiancemeter"])?;
    let projection = Projection::IrradianceMeter { object: number };
    let to_world = object.to_world.clone();
    let sensor = exposure(&meter, CameraSettings { projection, to_world, shutter: Shutter::INSTANT })?;
    if sensor.film.filter != Filter::PIXEL {
        let message =
            "an irradiancemeter behind a filter that reaches beyond a pixel; the rfilter 'box' is accepted";
        return Err(meter.place().refuse(message));
    }
    meter.finish()?;
    Ok(sensor)
}

/// What all sensors have: shutter, film and sampler.
fn exposure(object: &Object, camera: CameraSettings) -> Result<Sensor, Error> {
    let context = object.context;
    let opens = object.float("shutter_open")?.unwrap_or(0.0);
    let closes = object.float("shutter_close")?.unwrap_or(opens);
    let opening = object.choice("shutter_opening", &Opening::ALL, Opening::Box)?;
    let shutter = Shutter::new(opens, closes).map_err(|reason| object.refuse(&reason))?;
    let film = match object.only_nested("film")? {
        Some(index) => film(context, index)?,
        None => DEFAULT_FILM,
    };
    let sampler = match object.only_nested("sampler")? {
        Some(index) => sampler(context, index)?,
        None => DEFAULT_SAMPLER,
    };
    let camera = CameraSettings { shutter: shutter.with_opening(opening), ..camera };
    Camera::new(&camera, film.width, film.height, DVec3::ZERO).map_err(|reason| object.refuse(&reason))?;
    Ok(Sensor { camera, film, sampler })
}

fn perspective(object: &Object, lens: bool) -> Result<Projection, Error> {
    let (fov, axis) = field_of_view(object)?;
    for name in ["principal_point_offset_x", "principal_point_offset_y"] {
        if object.float(name)?.is_some_and(|offset| offset != 0.0) {
            return Err(object.refuse_value(name, format!("'{name}' other than 0; 0 is accepted")));
        }
    }
    if !lens {
        object.without_effect("focus_distance", &["float", "integer"], "a perspective sensor has no lens")?;
        return Ok(Projection::Perspective { fov, axis, lens_radius: 0.0, focus_distance: 1.0 });
    }
    let lens_radius = object.float("aperture_radius")?.ok_or_else(|| object.missing("aperture_radius"))?;
    let focus_distance = match object.float("focus_distance")? {
        Some(distance) => distance,
        None => {
            let distance = object.float("far_clip")?.unwrap_or(FAR_CLIP);
            object.context.note(format!(
                "{}: no 'focus_distance': the lens focuses at 'far_clip', {distance}, as in Mitsuba",
                object.place()
            ));
            distance
        }
    };
    Ok(Projection::Perspective { fov, axis, lens_radius, focus_distance })
}

/// The field of view, degrees, and its axis: by `fov`, or by the focal length for 35 mm film, whose diagonal is then the image's.
fn field_of_view(object: &Object) -> Result<(f64, FovAxis), Error> {
    let axes = [
        ("x", FovAxis::X),
        ("y", FovAxis::Y),
        ("diagonal", FovAxis::Diagonal),
        ("smaller", FovAxis::Smaller),
        ("larger", FovAxis::Larger),
    ];
    let focal_length = object.string("focal_length")?;
    if let Some(fov) = object.float("fov")? {
        let axis = object.choice("fov_axis", &axes, FovAxis::X)?;
        return match focal_length {
            Some(length) => Err(length.place.refuse("'focal_length' beside 'fov'; one of them is accepted")),
            None => Ok((fov, axis)),
        };
    }
    if object.has("fov_axis") {
        return Err(object.refuse_value("fov_axis", "'fov_axis' without 'fov'; beside 'fov' it is accepted"));
    }
    let length = match focal_length {
        None => FOCAL_LENGTH,
        Some(text) => {
            let number = text.value.strip_suffix("mm").unwrap_or(&text.value).trim().parse().ok();
            number.filter(|mm: &f64| *mm > 0.0 && mm.is_finite()).ok_or_else(|| {
                let message = "a positive number of millimetres, as '50mm', is accepted";
                text.place.refuse(format!("'focal_length' is '{}'; {message}", text.value))
            })?
        }
    };
    let fov = 2.0 * libm::atan(FILM_DIAGONAL_SQUARED.sqrt() / (2.0 * length));
    Ok((fov.to_degrees(), FovAxis::Diagonal))
}

/// Refuses scaled or sheared perspective sensors, as Mitsuba does.
fn check_scale(object: &Object, camera: &CameraSettings) -> Result<(), Error> {
    let m = camera.to_world.at(camera.shutter.open).matrix3;
    let error = (m.transpose() * m - glam::DMat3::IDENTITY)
        .to_cols_array()
        .into_iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    // Matrices in files carry about six digits.
    if error < 1e-4 {
        return Ok(());
    }
    Err(object.refuse_value(
        "to_world",
        "'to_world' scales or shears the sensor; rotation and translation are accepted",
    ))
}

const DEFAULT_FILM: FilmSettings = FilmSettings {
    width: 768,
    height: 576,
    crop: None,
    filter: DEFAULT_FILTER,
    reconstruction: Reconstruction::Importance,
};
const DEFAULT_FILTER: Filter = Filter::Gaussian { stddev: 0.5 };
const DEFAULT_SAMPLER: SamplerSettings = SamplerSettings { kind: SamplerKind::Independent, spp: 4, seed: 0 };

fn film(context: &Context, index: usize) -> Result<FilmSettings, Error> {
    let object = Object::new(context, index)?;
    object.plugin(&["hdrfilm"])?;
    let side = |name, default| object.count(name, [1, u32::MAX], default);
    let offset = |name, whole: u32| object.count(name, [0, whole.saturating_sub(1)], 0);
    let (width, height) = (side("width", DEFAULT_FILM.width)?, side("height", DEFAULT_FILM.height)?);
    let window = Crop {
        offset: [offset("crop_offset_x", width)?, offset("crop_offset_y", height)?],
        size: [side("crop_width", width)?, side("crop_height", height)?],
    };
    let crop = (window != Crop { offset: [0; 2], size: [width, height] }).then_some(window);
    let Crop { offset: [x, y], size: [columns, rows] } = window;
    if u64::from(columns) * u64::from(rows) > MAX_PIXELS {
        let message = format!("a film of {columns} × {rows} pixels; 1 to 2^28 pixels are accepted");
        return Err(object.refuse_value(if crop.is_some() { "crop_width" } else { "width" }, message));
    }
    for (name, start, count, whole) in [("crop_width", x, columns, width), ("crop_height", y, rows, height)] {
        if count > whole - start {
            let message = format!("'{name}' is {count} from {start} on; 1 to {} is accepted", whole - start);
            return Err(object.refuse_value(name, message));
        }
    }
    if object.choice("pixel_format", &[("rgb", false), ("rgba", true)], false)? {
        context.note(format!("{}: 'pixel_format' rgba has no effect: no alpha is written", object.place()));
    }
    if object.choice("component_format", &[("float32", false), ("float16", true)], false)? {
        context.note(format!(
            "{}: 'component_format' float16 has no effect: float32 is written",
            object.place()
        ));
    }
    object.choice("file_format", &[("openexr", ())], ())?;
    if object.boolean("compensate", false)? {
        return Err(object.refuse_value("compensate", "'compensate' is true; false is accepted"));
    }
    object.without_effect("sample_border", &["boolean"], "pixels own their samples; there is no border")?;
    let filter = match object.only_nested("rfilter")? {
        Some(index) => filter(context, index)?,
        None => DEFAULT_FILTER,
    };
    object.finish()?;
    Ok(FilmSettings { width, height, crop, filter, reconstruction: Reconstruction::Importance })
}

fn filter(context: &Context, index: usize) -> Result<Filter, Error> {
    let object = Object::new(context, index)?;
    let value = |name, default| Ok::<_, Error>(object.float(name)?.unwrap_or(default));
    let filter = match object.plugin(&["box", "catmullrom", "gaussian", "lanczos", "mitchell", "tent"])? {
        "box" => Filter::PIXEL,
        "catmullrom" => Filter::Mitchell { b: 0.0, c: 0.5 },
        "lanczos" => Filter::Lanczos { lobes: value("lobes", 3.0)? },
        "gaussian" => Filter::Gaussian { stddev: value("stddev", 0.5)? },
        "mitchell" => Filter::Mitchell { b: value("B", 1.0 / 3.0)?, c: value("C", 1.0 / 3.0)? },
        _ => Filter::Tent { radius: value("radius", 1.0)? },
    };
    FilterSampler::new(filter).map_err(|reason| object.refuse(&reason))?;
    object.finish()?;
    Ok(filter)
}

fn sampler(context: &Context, index: usize) -> Result<SamplerSettings, Error> {
    let object = Object::new(context, index)?;
    let known: Vec<&str> = SamplerKind::ALL.iter().map(|kind| kind.name()).chain(["ldsampler"]).collect();
    let plugin = object.plugin(&known)?;
    // Mitsuba's low-discrepancy sampler is a scrambled (0, 2)-sequence: Sobol' in two dimensions at a time
    let kind = SamplerKind::ALL.into_iter().find(|kind| kind.name() == plugin).unwrap_or_else(|| {
        context.note("the sampler 'ldsampler' is read as 'sobol', Owen-scrambled Sobol points".into());
        SamplerKind::Sobol
    });
    if plugin == "stratified" && !object.boolean("jitter", true)? {
        return Err(object.refuse_value("jitter", "'jitter' is false; true is accepted"));
    }
    let spp = object.count("sample_count", [1, u32::MAX], DEFAULT_SAMPLER.spp)?;
    let seed = u64::from(object.count("seed", [0, u32::MAX], 0)?);
    object.finish()?;
    Ok(SamplerSettings { kind, spp, seed })
}
