//! What filters do to waves: the amplitude that one keeps, and a zone plate, whose rings are finer and finer.

use glam::{Affine2, DAffine3, DVec3, Vec2};
use renderer::film::Filter;
use renderer::materials::Material;
use renderer::math::Rgb;
use renderer::scene::{IntegratorSettings, LightSettings, ObjectSettings, SceneDescription};
use renderer::shapes::ShapeSettings;
use renderer::texture::{Bitmap, Filter as TexelFilter, Texture, Wrap};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use verify::claim::{Claim, Level};
use verify::coverage::circle_in_rectangle;
use verify::filter::Kernel;

use super::super::film::{Exact, Films};
use super::kernel;
use crate::bounds;
use crate::setup::{diffuse, flat, lamp, pixel_middles, rectangle_at, thing};

/// Texels of one period: linear interpolation keeps the share sinc²(1/256) = 1 − 5e-5 of the wave, and its harmonics are
/// 1.5e-5 and less.
const TEXELS: u32 = 256;

/// Waves a pixel.
const FREQUENCIES: [f64; 3] = [0.1, 0.4, 0.8];

/// Direction in which the waves run.
const ANGLE: f64 = 0.3;

/// Half the side of the square that carries the waves.
const HALF: f64 = 16.0;

/// Pixels of a row.
const ROW: [u32; 2] = [8, 1];

/// A square of waves ½ + ½cos(2πf·s), s along its side from its middle less `HALF`, times the number of waves that `wider` says.
fn waves(filter: Filter, frequency: f64) -> SceneDescription {
    let texel = |i: u32| {
        let phase = TAU * (f64::from(i) + 0.5) / f64::from(TEXELS);
        #[expect(clippy::cast_possible_truncation, reason = "reflectances are f32")]
        let value = (0.5 + 0.5 * phase.cos()) as f32;
        Rgb::splat(value)
    };
    #[expect(clippy::cast_possible_truncation, reason = "texture coordinates are f32")]
    let periods = (2.0 * HALF * frequency) as f32;
    let scale = Affine2::from_scale(Vec2::new(periods, 1.0));
    let pixels = (0..TEXELS).map(texel).collect();
    let bitmap = Bitmap::new([TEXELS, 1], pixels, scale, TexelFilter::Bilinear, Wrap::Repeat);
    let texture = Texture::Bitmap(Arc::new(bitmap.expect("finite texels, as many as its size says")));
    let material = Arc::new(Material::new_diffuse(texture).expect("reflectances in [0, 1]"));
    let (along, up) = (DVec3::new(ANGLE.cos(), ANGLE.sin(), 0.0), DVec3::new(-ANGLE.sin(), ANGLE.cos(), 0.0));
    let square = rectangle_at(DVec3::ZERO, HALF * along, HALF * up);
    let mut description = flat(ROW, vec![thing(ShapeSettings::Rectangle, square, material)]);
    description.film.filter = filter;
    description.integrator = IntegratorSettings::DIRECT;
    // Light of irradiance π: the radiance is the reflectance.
    #[expect(clippy::cast_possible_truncation, reason = "radiances are f32")]
    let irradiance = Rgb::splat(PI as f32);
    description.lights = vec![LightSettings::Directional { direction: -DVec3::Z, irradiance }];
    description
}

/// A row of each frequency, the waves' number multiplied by a factor.
fn rows((filter, factor): (Filter, f64)) -> Vec<SceneDescription> {
    FREQUENCIES.map(|f| waves(filter, factor * f)).into()
}

fn exact(kernel: &Kernel) -> Vec<Exact> {
    let row = |frequency: f64| {
        let [fx, fy] = [frequency * ANGLE.cos(), frequency * ANGLE.sin()];
        let interpolated = Kernel::Box { radius: 0.5 }.response(1.0 / f64::from(TEXELS)).powi(2);
        let amplitude = 0.5 * interpolated * kernel.response(fx) * kernel.response(fy);
        let positions: Vec<f64> = pixel_middles(ROW).iter().map(|p| p[0]).collect();
        let value = |x: f64| 0.5 + amplitude * (TAU * (fx * x + frequency * HALF)).cos();
        Exact::on_curve(["pixel, from the middle", "radiance"], &positions, value)
    };
    FREQUENCIES.map(row).into()
}

pub(super) fn response(name: &'static str, filter: Filter) -> Claim {
    let other = if name == "tent" { Filter::PIXEL } else { Filter::Tent { radius: 1.0 } };
    Films {
        id: format!("filter/{name}/response"),
        says: format!(
            "waves of 0.1 to 0.8 a pixel keep the amplitude that the {name} filter's transform says"
        ),
        level: Level::Standard,
        samples: match filter {
            // Large negative lobes leave signed weights four times the noise.
            Filter::Lanczos { .. } => 8192,
            Filter::Mitchell { .. } => 4096,
            _ => 1024,
        },
        unit: 1.0,
        bound: bounds::PIXEL,
        right: (filter, 1.0),
        wrong: vec![("another filter", (other, 1.0)), ("waves 1 % shorter", (filter, 1.01))],
    }
    .claim(rows, move || exact(&kernel(filter)))
}

/// Side of the zone plate's film, whose lower left corner is its middle.
const PLATE: u32 = 4;

/// Square of the innermost ring's radius: rings are 2 pixels wide there and 0.36 in the far corner.
const INNERMOST: f64 = 4.0;

/// Number of rings, the outermost bright and beyond the far corner.
const RINGS: u32 = 9;

fn ring(n: u32) -> f64 {
    (INNERMOST * f64::from(n)).sqrt()
}

/// Disks about the film's lower left corner, bright and dark in turn, the smaller before the larger.
fn plate((scale, shift): (f64, f64)) -> Vec<SceneDescription> {
    let corner = -0.5 * f64::from(PLATE);
    let disk = |n: u32| -> ObjectSettings {
        let to_world = DAffine3::from_translation(DVec3::new(corner + shift, corner, -0.01 * f64::from(n)))
            * DAffine3::from_scale(DVec3::new(scale * ring(n), scale * ring(n), 1.0));
        if n % 2 == 1 {
            lamp(ShapeSettings::Disk, to_world)
        } else {
            thing(ShapeSettings::Disk, to_world, diffuse(0.0))
        }
    };
    vec![flat([PLATE; 2], (1..=RINGS).map(disk).collect())]
}

fn plate_exact() -> Exact {
    let corner = 0.5 * f64::from(PLATE);
    let pixel = |[x, y]: [f64; 2]| {
        let (x, y) = (x + corner, y + corner);
        let square = [[x - 0.5, x + 0.5], [y - 0.5, y + 0.5]];
        let sign = |n: u32| if n % 2 == 1 { 1.0 } else { -1.0 };
        let value: f64 = (1..=RINGS).map(|n| sign(n) * circle_in_rectangle(ring(n), square)).sum();
        [x.hypot(y), value]
    };
    let mut pixels: Vec<[f64; 2]> = pixel_middles([PLATE; 2]).into_iter().map(pixel).collect();
    let axes = ["distance from the plate's middle, pixels", "radiance"];
    let mut exact = Exact::pixels(axes, std::mem::take(&mut pixels));
    exact.curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    exact
}

pub(super) fn zone_plate() -> Claim {
    Films {
        id: String::from("filter/box/zone-plate"),
        says: String::from("pixels of a zone plate are the areas of its rings in them, also where rings are finer than pixels"),
        level: Level::Standard,
        samples: 4096,
        unit: 1.0,
        bound: bounds::PIXEL,
        right: (1.0, 0.0),
        wrong: vec![("rings 1 % wider", (1.01, 0.0)), ("half a pixel to the right", (1.0, 0.5))],
    }
    .claim(plate, || vec![plate_exact()])
}
