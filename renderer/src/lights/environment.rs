//! Light from far away on all sides, by an image.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3, Vec3};

use crate::ParamError;
use crate::math::Rgb;
use crate::math::float::round_f32;
use crate::math::spherical::turn;
use crate::sampling::piecewise::Piecewise2d;

/// Radiance by latitude and longitude, linear between pixels.
///
/// In the map's own space +y is up. Columns are longitudes: column i of w is in the middle of the i-th part of the full
/// turn from −z over +x, and the last one is beside the first. Rows are latitudes: the first row is at +y and the last
/// at −y.
///
/// # Source
/// The plugin `envmap` of Mitsuba 3.9.1, measured in eight directions (test `values_are_those_of_mitsuba`).
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    size: [usize; 2],
    pixels: Vec<Rgb>,
    /// The map's own space to the render frame: a rotation, or a reflected one.
    to_frame: DMat3,
    /// Over the unit square of longitude and latitude, in proportion to the mean radiance of a cell between rows and
    /// its share of the sphere.
    density: Piecewise2d,
    mean: Rgb,
}

/// By how much a rotation's columns may differ from orthonormal ones: matrices in files carry about six digits.
const ROTATION: f64 = 1e-4;

impl Environment {
    /// The map of `size` pixels (columns, rows), given row by row from +y, turned by `to_world`.
    ///
    /// # Errors
    /// `Empty` without columns, with fewer than two rows, or where all is black; `OutOfRange` for another number of
    /// pixels, a negative one, and a transform that scales or shears; `NotFinite`.
    pub fn new(size: [usize; 2], pixels: Vec<Rgb>, to_world: DMat3) -> Result<Self, ParamError> {
        let [columns, rows] = size;
        if columns == 0 || rows < 2 {
            return Err(ParamError::Empty { name: "environment map", accepted: "one column and two rows" });
        }
        if pixels.len() != columns * rows {
            let value = pixels.len() as f64;
            return Err(ParamError::OutOfRange {
                name: "number of pixels",
                value,
                accepted: "width × height",
            });
        }
        for value in pixels.iter().flat_map(|p| p.to_array()).map(f64::from) {
            if !value.is_finite() {
                return Err(ParamError::NotFinite { name: "pixel", value });
            }
            if value < 0.0 {
                return Err(ParamError::OutOfRange { name: "pixel", value, accepted: "0 or more" });
            }
        }
        let gram = to_world.transpose() * to_world - DMat3::IDENTITY;
        // NaN counts as the largest; `max` would leave it out.
        let larger = |a: f64, x: f64| if a.is_nan() || x <= a { a } else { x };
        let value = gram.to_cols_array().into_iter().map(f64::abs).fold(0.0, larger);
        if value.is_nan() || value > ROTATION {
            let (name, accepted) = ("distortion by to_world", "a rotation or reflection");
            return Err(ParamError::OutOfRange { name, value, accepted });
        }
        let masses = masses(size, &pixels);
        let mean = masses.iter().fold([0.0; 3], |sum, m| [0, 1, 2].map(|c| sum[c] + m[c] / (2.0 * TAU)));
        let weights: Vec<f64> = masses.iter().map(|m| m.iter().sum()).collect();
        let density = Piecewise2d::new(&weights, columns)?;
        Ok(Self { size, pixels, to_frame: to_world, density, mean: Rgb::from(mean.map(round_f32)) })
    }

    /// The mean radiance over all directions.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// The radiance \[W m⁻² sr⁻¹\] from the unit vector `direction`.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        let [columns, rows] = self.size;
        let [u, v] = self.coordinates(direction).map(f64::from);
        let (i, across) = split((u + 1.0) * columns as f64 - 0.5);
        let (j, down) = split(v * (rows - 1) as f64);
        let row = |j: usize| {
            let at = |i: usize| self.pixels[j.min(rows - 1) * columns + i % columns];
            at(i) * (1.0 - across) + at(i + 1) * across
        };
        row(j) * (1.0 - down) + row(j + 1) * down
    }

    /// A direction for `u` in [0, 1)², with its density; `None` at a pole.
    ///
    /// # Measure
    /// Per steradian: the square's density over 2π² sin θ.
    pub fn sample(&self, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let ([longitude, latitude], pdf) = self.density.sample(u);
        let (sin, cos) = libm::sincos(PI * f64::from(latitude));
        let (sin_phi, cos_phi) = libm::sincos(TAU * f64::from(longitude));
        let direction = self.to_frame * DVec3::new(sin_phi * sin, cos, -cos_phi * sin);
        (sin > 0.0).then(|| (direction.normalize().as_vec3(), round_f32(f64::from(pdf) / (TAU * PI * sin))))
    }

    /// The density with which [`Self::sample`] draws `direction`; 0 at a pole.
    ///
    /// # Measure
    /// Per steradian.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let local = self.local(direction);
        let sin = f64::from(local.x).hypot(f64::from(local.z));
        if sin == 0.0 {
            return 0.0;
        }
        let pdf = self.density.pdf(self.coordinates(direction));
        round_f32(f64::from(pdf) / (TAU * PI * sin))
    }

    fn local(&self, direction: Vec3) -> Vec3 {
        (self.to_frame.transpose() * direction.as_dvec3()).as_vec3()
    }

    /// Longitude and latitude as shares of the full turn and of the half turn.
    fn coordinates(&self, direction: Vec3) -> [f32; 2] {
        let w = self.local(direction);
        let theta = libm::atan2(f64::from(w.x).hypot(f64::from(w.z)), f64::from(w.y));
        [turn(-w.z, w.x), round_f32(theta / PI).min(1.0f32.next_down())]
    }
}

/// ∫ L dω of each channel over the cells of the grid: columns of the image, and what lies between two rows, where the
/// mean of the linear interpolation stands for it.
fn masses([columns, rows]: [usize; 2], pixels: &[Rgb]) -> Vec<[f64; 3]> {
    let mut masses = Vec::with_capacity(columns * (rows - 1));
    let cos = |row: usize| (PI * row as f64 / (rows - 1) as f64).cos();
    for j in 0..rows - 1 {
        let solid_angle = TAU / columns as f64 * (cos(j) - cos(j + 1));
        for i in 0..columns {
            let at = |di: usize, dj: usize| pixels[(j + dj) * columns + (i + di) % columns];
            // Linear between the middles of columns: ⅛ from either side.
            let [left, right] = [columns - 1, 1];
            let row = |dj: usize| at(left, dj) * 0.125 + at(0, dj) * 0.75 + at(right, dj) * 0.125;
            let mean = (row(0) + row(1)) * 0.5;
            masses.push(mean.to_array().map(|c| f64::from(c) * solid_angle));
        }
    }
    masses
}

/// The whole number below `x`, which is not negative, and the rest.
fn split(x: f64) -> (usize, f32) {
    let whole = x.floor();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a pixel's index")]
    let index = whole as usize;
    (index, round_f32(x - whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of 8 × 4 pixels with the value (37 k mod 101)/100 in the k-th.
    fn map() -> Environment {
        let pixels = (0..32_u8).map(|k| Rgb::splat(f32::from(u16::from(k) * 37 % 101) / 100.0)).collect();
        Environment::new([8, 4], pixels, DMat3::IDENTITY).unwrap()
    }

    #[test]
    fn values_are_those_of_mitsuba() {
        let theirs = [
            ([0.0, 1.0, 0.0], 0.285),
            ([0.0, 0.0, -1.0], 0.685_000_06),
            ([0.0, 0.0, 1.0], 0.432_500_03),
            ([1.0, 0.0, 0.0], 0.450_000_02),
            ([-1.0, 0.0, 0.0], 0.414_999_96),
            ([0.48, 0.6, 0.64], 0.242_386_52),
            ([0.48, -0.6, -0.64], 0.657_613_6),
            ([-0.48, -0.64, 0.6], 0.451_445_46),
        ];
        for (direction, expected) in theirs {
            let got = map().radiance(Vec3::from(direction)).g;
            // Coordinates are rounded by 2⁻²⁴ of 8 columns, the values' slopes are below 1 a column; Mitsuba as much.
            assert!((got - expected).abs() < 2e-6, "{direction:?}: {got}");
        }
    }

    #[test]
    fn the_density_integrates_to_one_and_is_that_of_samples() {
        let map = map();
        let [columns, rows] = [16_u8, 9];
        let mut integral = 0.0;
        for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
            let (sin_phi, cos_phi) = (TAU * (f64::from(i) + 0.5) / f64::from(columns)).sin_cos();
            let (sin, cos) = (PI * (f64::from(j) + 0.5) / f64::from(rows)).sin_cos();
            let direction = DVec3::new(sin * sin_phi, cos, -sin * cos_phi).as_vec3();
            integral += f64::from(map.pdf(direction)) * TAU * PI * sin;
        }
        integral /= f64::from(columns) * f64::from(rows);
        // The density times sin θ is constant between points: two roundings of 2⁻²⁴ in sin θ, two in the density.
        assert!((integral - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "{integral}");
        for k in 1..1000_u16 {
            let u = [0.754_88, 0.569_84].map(|step: f32| (f32::from(k) * step).fract());
            let (direction, pdf) = map.sample(u).unwrap();
            let again = map.pdf(direction);
            // sin θ is at least 1e-3 here and rounded by 2⁻²⁴; so are longitude and latitude, over cells' borders at times.
            let near = (pdf / again - 1.0).abs() < 1e-3;
            let at_border = map.coordinates(direction).iter().zip([8.0, 3.0]).any(|(x, n)| {
                let cell = x * n;
                (cell - cell.round()).abs() < 1e-4
            });
            assert!(near || at_border, "{u:?}: {pdf} {again}");
        }
    }

    #[test]
    fn bad_maps_are_refused() {
        let new = |size, n: usize, value, m| Environment::new(size, vec![Rgb::splat(value); n], m);
        assert!(matches!(new([1, 1], 1, 1.0, DMat3::IDENTITY), Err(ParamError::Empty { .. })));
        assert!(matches!(new([2, 2], 3, 1.0, DMat3::IDENTITY), Err(ParamError::OutOfRange { .. })));
        assert!(matches!(new([2, 2], 4, -1.0, DMat3::IDENTITY), Err(ParamError::OutOfRange { .. })));
        assert!(matches!(new([2, 2], 4, f32::NAN, DMat3::IDENTITY), Err(ParamError::NotFinite { .. })));
        assert!(matches!(new([2, 2], 4, 0.0, DMat3::IDENTITY), Err(ParamError::Empty { .. })));
        let twice = DMat3::from_diagonal(DVec3::splat(2.0));
        assert!(matches!(new([2, 2], 4, 1.0, twice), Err(ParamError::OutOfRange { .. })));
    }
}
