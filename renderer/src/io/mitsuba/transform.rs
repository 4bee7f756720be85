//! Transforms, composed in f64: each step comes after those above it.

use glam::{DAffine3, DMat3, DVec3};

use super::document::{Element, accepted};
use super::object::{Object, number, numbers, triple};
use crate::Error;
use crate::math::transform::Motion;

/// Axes of rotations may deviate this much from length 1, as those written with four digits do.
const AXIS_TOLERANCE: f64 = 1e-3;

/// The motion called `name`: a `transform`, an `animation` of keyed ones, or rest where there is none.
pub(super) fn motion(object: &Object, name: &str) -> Result<Motion, Error> {
    let Some(index) = object.part(name, &["transform", "animation"])? else {
        return Motion::fixed(DAffine3::IDENTITY).map_err(|reason| object.refuse(&reason));
    };
    let element = &object.context.document.elements[index];
    let keys = if element.tag == "transform" {
        element.only(&["name"])?;
        vec![(0.0, transform(object, element)?)]
    } else {
        keys(object, element)?
    };
    Motion::keyed(keys).map_err(|reason| element.place.refuse(format!("{name}: {reason}")))
}

/// The transform called `name` that cannot move.
pub(super) fn fixed(object: &Object, name: &str) -> Result<DAffine3, Error> {
    let Some(index) = object.part(name, &["transform"])? else { return Ok(DAffine3::IDENTITY) };
    let element = &object.context.document.elements[index];
    element.only(&["name"])?;
    transform(object, element)
}

fn keys(object: &Object, element: &Element) -> Result<Vec<(f64, DAffine3)>, Error> {
    element.only(&["name"])?;
    let mut keys = Vec::new();
    for &child in &element.children {
        let key = &object.context.document.elements[child];
        if key.tag != "transform" {
            return Err(key
                .place
                .refuse(format!("<{}> in an animation; <transform time> is accepted", key.tag)));
        }
        key.only(&["time"])?;
        keys.push((number(key.required("time")?)?, transform(object, key)?));
    }
    Ok(keys)
}

fn transform(object: &Object, element: &Element) -> Result<DAffine3, Error> {
    let mut whole = DAffine3::IDENTITY;
    for &child in &element.children {
        let part = &object.context.document.elements[child];
        if let Some(&inside) = part.children.first() {
            let inside = &object.context.document.elements[inside];
            return Err(inside
                .place
                .refuse(format!("<{}> in <{}>; nothing is accepted", inside.tag, part.tag)));
        }
        whole = step(part)? * whole;
    }
    Ok(whole)
}

fn step(part: &Element) -> Result<DAffine3, Error> {
    match part.tag.as_str() {
        "translate" => Ok(DAffine3::from_translation(axes(part, 0.0, &[])?)),
        "scale" => Ok(DAffine3::from_scale(axes(part, 1.0, &[])?)),
        "rotate" => rotate(part),
        "lookat" => look_at(part),
        "matrix" => matrix(part),
        tag => {
            let known = accepted(&["translate", "scale", "rotate", "lookat", "matrix"]);
            Err(part.place.refuse(format!("<{tag}> in a transform; {known}")))
        }
    }
}

/// `x`, `y`, `z`, each `default` where it is not given, or `value`.
fn axes(part: &Element, default: f64, also: &[&str]) -> Result<DVec3, Error> {
    part.only(&[&["x", "y", "z", "value"], also].concat())?;
    let given = |axis| part.attribute(axis).map(number).transpose();
    let [x, y, z] = ["x", "y", "z"].map(given);
    let (x, y, z) = (x?, y?, z?);
    if part.attribute("value").is_some() {
        if x.or(y).or(z).is_some() {
            return Err(part.place.refuse("'value' beside x, y or z; one or the other is accepted"));
        }
        return triple(part, "value");
    }
    Ok(DVec3::new(x.unwrap_or(default), y.unwrap_or(default), z.unwrap_or(default)))
}

fn rotate(part: &Element) -> Result<DAffine3, Error> {
    let axis = axes(part, 0.0, &["angle"])?;
    let angle = number(part.required("angle")?)?;
    if (axis.length() - 1.0).abs() > AXIS_TOLERANCE {
        // Mitsuba 3.9.1 takes such an axis for a unit vector and shears.
        return Err(part
            .place
            .refuse(format!("rotation axis of length {}; length 1 is accepted", axis.length())));
    }
    Ok(DAffine3::from_mat3(DMat3::from_axis_angle(axis.normalize(), angle.to_radians())))
}

/// Camera space at `origin` with +z towards `target`, +y as near to `up` as can be, +x to the left.
fn look_at(part: &Element) -> Result<DAffine3, Error> {
    part.only(&["origin", "target", "up"])?;
    let (origin, target, up) = (triple(part, "origin")?, triple(part, "target")?, triple(part, "up")?);
    let forward = (target - origin).try_normalize();
    let left = forward.and_then(|forward| up.cross(forward).try_normalize());
    let (Some(forward), Some(left)) = (forward, left) else {
        let accepted = "a target away from the origin and an up that does not point to it are accepted";
        return Err(part.place.refuse(format!("lookat without a direction; {accepted}")));
    };
    let rotation = DMat3::from_cols(left, forward.cross(left), forward);
    Ok(DAffine3::from_mat3_translation(rotation, origin))
}

/// Nine numbers of a linear map or sixteen of an affine one, row by row.
fn matrix(part: &Element) -> Result<DAffine3, Error> {
    part.only(&["value"])?;
    let a = part.required("value")?;
    let values = numbers(a)?;
    let (side, rows): (usize, Vec<&[f64]>) = match values.len() {
        9 => (3, values.chunks(3).collect()),
        16 => (4, values.chunks(4).collect()),
        n => return Err(a.place.refuse(format!("a matrix of {n} numbers; 9 or 16 are accepted"))),
    };
    if side == 4 && rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err(a.place.refuse("a last row other than 0 0 0 1; an affine matrix is accepted"));
    }
    let column = |c: usize| DVec3::new(rows[0][c], rows[1][c], rows[2][c]);
    let translation = if side == 4 { column(3) } else { DVec3::ZERO };
    Ok(DAffine3::from_mat3_translation(DMat3::from_cols(column(0), column(1), column(2)), translation))
}
