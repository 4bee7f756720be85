//! Wavelength spectra as linear sRGB, by the rule of Mitsuba's rgb variants, so that one scene file means the same to both.

use std::sync::LazyLock;

use crate::ParamError;
use crate::math::Rgb;

/// What a spectrum measures: it decides the light that it is seen under, and its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A share of light, seen under D65, at most 1.
    Reflectance,
    /// A refractive index or an extinction coefficient, seen under D65, without limit.
    Index,
    /// Emitted light, as it is, without limit.
    Emission,
}

/// Wavelength in nm and value: the knots of a piecewise linear spectrum that is zero outside them.
pub type Knot = (f64, f64);

const FIRST_NM: f64 = 360.0;
const LAST_NM: f64 = 830.0;
const POINTS: u32 = 1000;
/// The integral of the observer's y over the wavelengths: a spectrum of constant 1 has the luminance 1.
const Y_INTEGRAL: f64 = 106.750_259_399_414_06;
/// The mean of D65 under the observer's y, in the table's unit: seen under D65, a constant 1 has the luminance 1.
const D65_MEAN: f64 = 98.997_417_518_762_55;
/// Linear sRGB from XYZ (IEC 61966-2-1, with the digits that Mitsuba has).
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.240_479, -1.537_150, -0.498_535],
    [-0.969_256, 1.875_991, 0.041_556],
    [0.055_648, -0.204_043, 1.057_311],
];

/// Rows of x, y, z of the CIE 1931 2° observer and of D65 (100 at 560 nm), 360 to 830 nm in steps of 5.
///
/// # Source
/// CIE 15, as held by Mitsuba 3.9.1; the file is a copy of `references/spectra/cie1931_d65.csv`, whose README tells how it was made.
static OBSERVER: LazyLock<Vec<[f64; 4]>> =
    LazyLock::new(|| include_str!("spectrum/cie1931_d65.csv").lines().skip(1).map(observer_row).collect());
const STEP_NM: f64 = 5.0;

fn observer_row(line: &str) -> [f64; 4] {
    let mut row = [0.0; 4];
    for (cell, text) in row.iter_mut().zip(line.split(',').skip(1)) {
        *cell = text.parse().expect("the table beside this file holds numbers");
    }
    row
}

/// The linear sRGB triple of a spectrum given by `knots`.
///
/// XYZ = Σ c(λ)·v(λ)·d(λ) · (470/1000) / ∫y over 1,000 points from 360 to 830 nm, both included; d is D65 for `Reflectance` and
/// `Index`, else 1. Negative components of sRGB become 0, a reflectance's above 1 become 1.
///
/// * `knots`: at least two, of strictly increasing wavelength.
///
/// # Precision, limits
/// f64 sums; 1e-5 relative of Mitsuba's own single-precision values.
///
/// # Errors
/// `Empty` for fewer than two knots, `NotFinite`, `OutOfRange` for a wavelength not above the one before it.
///
/// # Source
/// Mitsuba 3.9.1's conversion, observed; written down with its oracle in `references/spectra/README.md`. The factor is
/// 470/1000 although the points are 470/999 apart.
///
/// # Verified by
/// `math::spectrum::tests::mitsubas_own_values_are_met`
pub fn rgb_of_knots(knots: &[Knot], kind: Kind) -> Result<Rgb, ParamError> {
    check(knots)?;
    let mut xyz = [0.0; 3];
    for i in 0..POINTS {
        let wavelength = FIRST_NM + (LAST_NM - FIRST_NM) * f64::from(i) / f64::from(POINTS - 1);
        let [x, y, z, d65] = observer(wavelength);
        let light = if kind == Kind::Emission { 1.0 } else { d65 / D65_MEAN };
        let weight = value(knots, wavelength) * light * (LAST_NM - FIRST_NM) / f64::from(POINTS) / Y_INTEGRAL;
        xyz = [xyz[0] + x * weight, xyz[1] + y * weight, xyz[2] + z * weight];
    }
    let limit = if kind == Kind::Reflectance { 1.0 } else { f64::INFINITY };
    Ok(rgb_of_xyz(xyz, limit))
}

/// The linear sRGB triple of an emission that is `value` at every wavelength: the equal-energy white times `value`.
///
/// # Source
/// `references/spectra/README.md`, last paragraph of the rule.
pub fn rgb_of_constant_emission(value: f64) -> Rgb {
    rgb_of_xyz([value; 3], f64::INFINITY)
}

fn rgb_of_xyz(xyz: [f64; 3], limit: f64) -> Rgb {
    let component = |row: [f64; 3]| {
        let sum = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
        #[expect(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
        let single = sum.clamp(0.0, limit) as f32;
        single
    };
    XYZ_TO_RGB.map(component).into()
}

fn check(knots: &[Knot]) -> Result<(), ParamError> {
    if knots.len() < 2 {
        return Err(ParamError::Empty { name: "spectrum", accepted: "a list of at least two wavelengths" });
    }
    for &(wavelength, value) in knots {
        for (name, number) in [("wavelength", wavelength), ("value", value)] {
            if !number.is_finite() {
                return Err(ParamError::NotFinite { name, value: number });
            }
        }
    }
    match knots.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
        Some(pair) => Err(ParamError::OutOfRange {
            name: "wavelength",
            value: pair[1].0,
            accepted: "a wavelength above the one before it",
        }),
        None => Ok(()),
    }
}

fn observer(wavelength: f64) -> [f64; 4] {
    let place = (wavelength - FIRST_NM) / STEP_NM;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 94 by construction")]
    let index = (place as usize).min(OBSERVER.len() - 2);
    let t = place - index as f64;
    std::array::from_fn(|k| OBSERVER[index][k] * (1.0 - t) + OBSERVER[index + 1][k] * t)
}

fn value(knots: &[Knot], wavelength: f64) -> f64 {
    let above = knots.partition_point(|knot| knot.0 <= wavelength);
    match (above.checked_sub(1).map(|i| knots[i]), knots.get(above)) {
        (Some((w0, v0)), Some(&(w1, v1))) => v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0),
        (Some((w0, v0)), None) if w0 == wavelength => v0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORACLE: &str = include_str!("../../../references/spectra/cbox_rgb.csv");

    fn parse_row(line: &str) -> (Kind, [f32; 3], Vec<Knot>) {
        let cells: Vec<&str> = line.split(',').collect();
        let kind = match cells[1] {
            "reflectance" => Kind::Reflectance,
            "index" => Kind::Index,
            "emission" => Kind::Emission,
            other => panic!("unknown kind {other}"),
        };
        let knot = |pair: &str| {
            let (w, v) = pair.split_once(':').unwrap();
            (w.parse().unwrap(), v.parse().unwrap())
        };
        let rgb = [2, 3, 4].map(|i| cells[i].parse().unwrap());
        (kind, rgb, cells[5].split(' ').map(knot).collect())
    }

    #[test]
    fn mitsubas_own_values_are_met() {
        let rows: Vec<_> = ORACLE.lines().skip(1).map(parse_row).collect();
        assert!(rows.len() >= 6);
        for (kind, expected, knots) in rows {
            let ours = rgb_of_knots(&knots, kind).unwrap().to_array();
            for (a, b) in ours.into_iter().zip(expected) {
                assert!((a - b).abs() <= 1e-6 * b, "{a} against {b}"); // Mitsuba sums in single precision: 8 units of 1.2e-7
            }
        }
    }

    #[test]
    fn the_factor_of_999_intervals_would_be_seen() {
        let (kind, expected, knots) = parse_row(ORACLE.lines().nth(1).unwrap());
        let ours = rgb_of_knots(&knots, kind).unwrap().g * 1000.0 / 999.0;
        assert!((ours - expected[1]).abs() > 1e-5 * expected[1]);
    }

    #[test]
    fn the_table_is_the_references_table() {
        let original = include_str!("../../../references/spectra/cie1931_d65.csv");
        assert_eq!(include_str!("spectrum/cie1931_d65.csv"), original);
        assert_eq!(OBSERVER.len(), 95); // (830 − 360)/5 + 1
    }

    #[test]
    fn a_spectrum_ends_at_its_ends() {
        let knots = [(400.0, 2.0), (500.0, 4.0)];
        let seen = [399.9, 400.0, 450.0, 500.0, 500.1].map(|w| value(&knots, w));
        assert_eq!(seen, [0.0, 2.0, 3.0, 4.0, 0.0]);
    }

    #[test]
    fn unusable_lists_are_refused() {
        let refused = |knots: &[Knot]| rgb_of_knots(knots, Kind::Reflectance).unwrap_err();
        assert!(matches!(refused(&[(400.0, 1.0)]), ParamError::Empty { .. }));
        assert!(matches!(refused(&[(400.0, 1.0), (400.0, 1.0)]), ParamError::OutOfRange { .. }));
        assert!(matches!(refused(&[(400.0, f64::NAN), (500.0, 1.0)]), ParamError::NotFinite { .. }));
    }

    #[test]
    fn a_constant_emission_is_the_equal_energy_white() {
        let rgb = rgb_of_constant_emission(0.5).to_array();
        let expected = [0.602_397, 0.474_145_5, 0.454_458]; // 0.5 times the rows' sums
        for (a, b) in rgb.into_iter().zip(expected) {
            assert!((a - b).abs() <= f32::EPSILON * b, "{a} against {b}"); // rounding to single precision
        }
    }
}
