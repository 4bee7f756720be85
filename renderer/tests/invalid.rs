//! Input that means nothing is refused: each message has the parameter's name, its value, and what is accepted.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use renderer::ParamError;
use renderer::camera::{Camera, CameraSettings, FovAxis, Projection, Shutter};
use renderer::film::{Crop, Film, FilmSettings, Filter, FilterSampler, Reconstruction};
use renderer::lights::{Environment, Spot};
use renderer::materials::{Beckmann, Ggx, Material, Metal};
use renderer::math::Rgb;
use renderer::math::transform::Motion;
use renderer::render::RenderSettings;
use renderer::sampling::{Discrete, Piecewise2d};
use renderer::shapes::{MeshData, Shape, ShapeSettings};
use renderer::texture::Texture;

/// Asserts that the message has each of the words, and is one line.
fn says<T>(result: Result<T, ParamError>, words: &[&str]) {
    let message = match result {
        Ok(_) => panic!("accepted; {words:?} expected"),
        Err(error) => error.to_string(),
    };
    for word in words {
        assert!(message.contains(word), "{word:?} is missing in: {message}");
    }
    assert!(!message.contains('\n'), "{message}");
}

fn placed(shape: &ShapeSettings, to: DAffine3) -> Result<Shape, ParamError> {
    Shape::new(shape, &to, false)
}

fn sphere(radius: f64) -> ShapeSettings {
    ShapeSettings::Sphere { center: DVec3::ZERO, radius }
}

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> ShapeSettings {
    ShapeSettings::Mesh(Arc::new(MeshData {
        positions: positions.into(),
        triangles: triangles.into(),
        ..MeshData::default()
    }))
}

#[test]
fn shapes() {
    let id = DAffine3::IDENTITY;
    for (radius, value) in [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        says(placed(&sphere(radius), id), &["radius", value, "accepted"]);
        let rod = ShapeSettings::Cylinder { p0: DVec3::ZERO, p1: DVec3::Z, radius };
        says(placed(&rod, id), &["radius", value, "accepted"]);
    }
    let nowhere = ShapeSettings::Sphere { center: DVec3::new(0.0, f64::NAN, 0.0), radius: 1.0 };
    says(placed(&nowhere, id), &["center", "NaN", "finite"]);
    let short = ShapeSettings::Cylinder { p0: DVec3::ONE, p1: DVec3::ONE, radius: 1.0 };
    says(placed(&short, id), &["length of a cylinder", "0", "p0 ≠ p1"]);
    says(placed(&sphere(1e20), id), &["coordinate", "100000000000000000000", "below 1e18"]);
    says(
        placed(&sphere(1.0), DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0))),
        &["scale of a sphere", "uniform"],
    );
}

#[test]
fn transforms() {
    for shape in [ShapeSettings::Rectangle, ShapeSettings::Disk, ShapeSettings::Cube, sphere(1.0)] {
        let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
        says(placed(&shape, flat), &["to_world", "singular", "determinant", "invertible"]);
        says(placed(&shape, DAffine3::from_mat3(DMat3::ZERO)), &["to_world", "singular"]);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let far = DAffine3::from_translation(DVec3::new(value, 0.0, 0.0));
            says(placed(&shape, far), &["to_world", "finite"]);
        }
    }
    let (id, mirrored) = (DAffine3::IDENTITY, DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    says(Motion::keyed(vec![]), &["motion", "at least one"]);
    says(Motion::keyed(vec![(0.5, id), (0.25, id)]), &["key time", "0.25", "after"]);
    says(Motion::keyed(vec![(f64::NAN, id)]), &["key time", "NaN", "finite"]);
    says(Motion::keyed(vec![(0.0, id), (1.0, mirrored)]), &["determinants", "-1", "reflection"]);
}

#[test]
fn meshes() {
    let id = DAffine3::IDENTITY;
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    says(placed(&mesh(&corners, &[]), id), &["mesh", "at least one triangle"]);
    says(placed(&mesh(&[], &[[0, 1, 2]]), id), &["vertex index", "0"]);
    says(placed(&mesh(&corners, &[[0, 1, 3]]), id), &["vertex index", "3", "0 to 2"]);
    says(placed(&mesh(&corners, &[[0, 1, u32::MAX]]), id), &["vertex index", "4294967295"]);
    for value in [f32::NAN, f32::INFINITY] {
        let broken = [[value, 0.0, 0.0], corners[1], corners[2]];
        says(placed(&mesh(&broken, &[[0, 1, 2]]), id), &["vertex position", "finite"]);
    }
    // A mesh whose triangles have no area; one of many without area is let through and is never met.
    says(placed(&mesh(&corners, &[[0, 1, 1], [2, 2, 2]]), id), &["shape", "area"]);
    assert!(placed(&mesh(&corners, &[[0, 1, 1], [0, 1, 2]]), id).is_ok());
}

#[test]
fn materials() {
    let white = || Texture::Constant(Rgb::WHITE);
    for (eta, value) in [(0.0, "0"), (-1.5, "-1.5"), (f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        says(Material::new_dielectric(eta, white(), white()), &["eta", value, "accepted"]);
        says(Material::new_blur_disk(0.5, Some(eta), white(), white()), &["eta", value, "accepted"]);
    }
    let metal = || Metal::new(Rgb::WHITE, Rgb::WHITE).unwrap();
    for (alpha, value) in [(-0.1, "-0.1"), (f32::NAN, "NaN")] {
        says(
            Material::new_rough_conductor(Ggx { alpha: [alpha, 0.1] }, metal(), white()),
            &["alpha", value, "accepted"],
        );
        says(Material::new_blur_disk(alpha, None, white(), white()), &["blur", value, "accepted"]);
        says(
            Material::new_phong(white(), Texture::Constant(Rgb::BLACK), alpha),
            &["exponent", value, "accepted"],
        );
    }
    says(Metal::new(Rgb::splat(-1.0), Rgb::WHITE), &["eta", "-1", "accepted"]);
    says(Metal::new(Rgb::WHITE, Rgb::splat(f32::NAN)), &["k", "NaN", "accepted"]);
    for value in [-0.5, 1.5, f32::NAN] {
        says(Material::new_diffuse(Texture::Constant(Rgb::splat(value))), &["reflectance", "accepted"]);
    }
}

#[test]
fn boundaries() {
    let (white, black) = (|| Texture::Constant(Rgb::WHITE), || Texture::Constant(Rgb::BLACK));
    for (eta, value) in [(0.0, "0"), (-1.5, "-1.5"), (f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        let facets = || Beckmann { alpha: [0.1; 2] };
        says(Material::new_rough_dielectric(facets(), eta, white(), white()), &["eta", value, "accepted"]);
        says(Material::new_thin_dielectric(eta, white(), white()), &["eta", value, "accepted"]);
        says(Material::new_plastic(eta, true, black(), white()), &["eta", value, "accepted"]);
        says(Material::new_rough_plastic(facets(), eta, true, black(), white()), &["eta", value, "accepted"]);
    }
    for (alpha, value) in [(-0.1, "-0.1"), (f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        let facets = || Beckmann { alpha: [0.1, alpha] };
        says(Material::new_rough_dielectric(facets(), 1.5, white(), white()), &["alpha", value, "accepted"]);
        says(
            Material::new_rough_plastic(facets(), 1.5, true, black(), white()),
            &["alpha", value, "accepted"],
        );
    }
    for value in [-0.5, 1.5, f32::NAN] {
        let share = || Texture::Constant(Rgb::splat(value));
        let matt = || Material::new_diffuse(black()).unwrap();
        says(Material::new_mask(share(), matt()), &["opacity", "accepted"]);
        says(Material::new_blend(share(), [matt(), matt()]), &["weight", "accepted"]);
    }
}

#[test]
fn lights() {
    let spot = |beam, cutoff| Spot::new(Vec3::ZERO, Vec3::Z, Rgb::WHITE, [beam, cutoff]);
    for (cutoff, value) in [(0.0, "0"), (-1.0, "-1"), (181.0, "181"), (f32::NAN, "NaN")] {
        says(spot(0.0, cutoff), &["cutoff_angle", value, "(0, 180]"]);
    }
    for (beam, value) in [(-1.0, "-1"), (30.5, "30.5"), (f32::NAN, "NaN")] {
        says(spot(beam, 30.0), &["beam_width", value, "from 0 to cutoff_angle"]);
    }
    let sky = |size, value, to_world| Environment::new(size, vec![Rgb::splat(value); 4], to_world);
    let id = DMat3::IDENTITY;
    says(sky([0, 2], 1.0, id), &["environment map", "one column and two rows"]);
    says(sky([3, 2], 1.0, id), &["pixels", "4", "width × height"]);
    for (value, written) in [(-1.0, "-1"), (f32::NAN, "NaN"), (f32::INFINITY, "inf")] {
        says(sky([2, 2], value, id), &["pixel", written, "accepted"]);
    }
    says(sky([2, 2], 1.0, 2.0 * id), &["to_world", "3", "rotation"]);
    says(sky([2, 2], 1.0, f64::NAN * id), &["to_world", "NaN", "rotation"]);
}

fn camera(projection: Projection) -> Result<Camera, ParamError> {
    let to_world = Motion::fixed(DAffine3::IDENTITY).unwrap();
    Camera::new(&CameraSettings { projection, to_world, shutter: Shutter::INSTANT }, 4, 4, DVec3::ZERO)
}

#[test]
fn cameras() {
    let perspective = |fov, lens_radius, focus_distance| {
        camera(Projection::Perspective { fov, axis: FovAxis::X, lens_radius, focus_distance })
    };
    for (fov, value) in [(0.0, "0"), (180.0, "180"), (-3.0, "-3"), (f64::NAN, "NaN")] {
        says(perspective(fov, 0.0, 1.0), &["fov", value, "(0, 180)"]);
    }
    for (radius, value) in [(-0.1, "-0.1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        says(perspective(40.0, radius, 1.0), &["aperture_radius", value, "at least 0"]);
    }
    for (focus, value) in [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        says(perspective(40.0, 0.1, focus), &["focus_distance", value, "above 0"]);
    }
    says(Shutter::new(1.0, 0.5), &["shutter_close", "0.5", "not before shutter_open"]);
    says(Shutter::new(f64::NAN, 0.5), &["shutter_open", "NaN", "finite"]);
    says(Shutter::new(0.0, f64::INFINITY), &["shutter_close", "inf", "finite"]);
}

#[test]
fn films_and_distributions() {
    let settings = |width, height, filter| FilmSettings {
        width,
        height,
        crop: None,
        filter,
        reconstruction: Reconstruction::Importance,
    };
    let film = |width, height, filter| Film::new(&settings(width, height, filter));
    says(film(0, 4, Filter::PIXEL), &["pixels", "0", "1 to 268435456"]);
    says(film(1 << 20, 1 << 20, Filter::PIXEL), &["pixels", "1099511627776", "1 to 268435456"]);
    let cropped = |offset, size| {
        Film::new(&FilmSettings { crop: Some(Crop { offset, size }), ..settings(8, 4, Filter::PIXEL) })
    };
    says(cropped([0, 0], [0, 2]), &["pixels", "0", "1 to 268435456"]);
    says(cropped([0, 3], [8, 2]), &["the end of the crop", "5", "a rectangle of the film's pixels"]);
    says(cropped([u32::MAX, 0], [2, 2]), &["the end of the crop", "4294967297"]);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        says(FilterSampler::new(Filter::Box { radius: value }), &["radius", "above 0"]);
        says(FilterSampler::new(Filter::Tent { radius: value }), &["radius", "above 0"]);
        says(FilterSampler::new(Filter::Gaussian { stddev: value }), &["stddev", "above 0"]);
    }
    says(FilterSampler::new(Filter::Mitchell { b: f64::NAN, c: 0.5 }), &["B", "NaN", "[0, 1]"]);
    says(Discrete::new(&[]), &["weights", "above 0"]);
    says(Discrete::new(&[0.0, -1.0]), &["weight", "-1", "0 or more"]);
    says(Discrete::new(&[f64::INFINITY]), &["weight", "inf", "finite"]);
    says(Piecewise2d::new(&[1.0; 6], 4), &["columns", "4", "divisor"]);
    assert_eq!(RenderSettings::split(0, 0), [1, 1], "no samples at all become one");
}
