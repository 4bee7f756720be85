//! Maps onto sphere, hemisphere, cone and Phong's lobe.

use std::f64::consts::TAU;

use glam::Vec3;
use renderer::sampling::warp;
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, claim};
use verify::domain::Directions;

use super::super::pointwise::{never, rejecting, same_density, single};
use super::inverse;
use crate::{bounds, wrong};

/// Half angle of the wide cone, in radians.
const WIDE: f64 = 0.7;

/// Half angle of the narrow cone: the sun's is 4.7e-3.
const NARROW: f64 = 1e-3;

/// Phong's exponent.
const EXPONENT: f64 = 20.0;

/// Relative error that rounding leaves in densities of few operations: four roundings of 2⁻²⁴.
const FEW: f64 = 2.4e-7;

pub(super) fn claims() -> Vec<Claim> {
    let mut list = sphere();
    list.extend(hemisphere());
    list.extend(cosine_hemisphere());
    list.extend(cone());
    list.extend(phong());
    list
}

/// A direction in double precision.
fn double(w: Vec3) -> Option<[f64; 3]> {
    Some(w.to_array().map(f64::from))
}

/// A claim on a density: its closed form on the map's own directions, zero on their opposites where these are outside.
fn pdf(
    (id, says): (&str, &str),
    map: fn([f32; 2]) -> Vec3,
    closed_form: (impl Fn(Vec3) -> f64 + Copy + Send + Sync + 'static, f64),
    pdf: (impl Fn(Vec3) -> f32 + Send + Sync + 'static, bool),
    (mistake, wrong): (&'static str, impl Fn(Vec3) -> f32 + Send + Sync + 'static),
) -> Claim {
    let (closed_form, tolerance) = closed_form;
    let (pdf, zero_below) = pdf;
    let misses = move |u: [f64; 2], pdf: &dyn Fn(Vec3) -> f32| {
        let w = map(u.map(single));
        let below = w.z > 0.0 && pdf(-w) != 0.0;
        !same_density(pdf(w), closed_form(w), tolerance) || zero_below && below
    };
    let builder = rejecting(claim(id, says), mistake, move |u| misses(u, &wrong));
    never(builder, "share of directions with another density", move |u| misses(u, &pdf))
}

fn sphere() -> Vec<Claim> {
    let density = 0.5 / TAU;
    let uniform = ChiSquare::on(Directions::sphere())
        .density(move |_| density)
        .samples(|u: [f64; 2]| double(warp::square_to_sphere(u.map(single))))
        .bound(bounds::SHAPES)
        .rejects("uniform angles", |u: [f64; 2]| Some(wrong::sphere_by_angles(u)))
        .rejects("a cube's points normalised", |u: [f64; 3]| Some(wrong::sphere_from_cube(u)));
    vec![
        uniform.claim("warp/sphere/uniform", "directions are uniform on the sphere"),
        pdf(
            ("warp/sphere/pdf", "the sphere's density is 1/(4π)"),
            warp::square_to_sphere,
            (move |_| density, FEW),
            (|_| warp::sphere_pdf(), false),
            ("the hemisphere's", warp::hemisphere_pdf),
        ),
        inverse(
            "warp/sphere/inverse",
            "the sphere's inverse gives its numbers back",
            |u| warp::sphere_to_square(warp::square_to_sphere(u)),
            ("height upside down", |u| {
                let [height, turn] = warp::sphere_to_square(warp::square_to_sphere(u));
                [1.0 - height, turn]
            }),
        ),
    ]
}

fn hemisphere() -> Vec<Claim> {
    let density = 1.0 / TAU;
    let uniform = ChiSquare::on(Directions::hemisphere())
        .density(move |_| density)
        .samples(|u: [f64; 2]| double(warp::square_to_hemisphere(u.map(single))))
        .bound(bounds::SHAPES)
        .rejects("uniform angles", |u: [f64; 2]| Some(wrong::hemisphere_by_angles(u)))
        .rejects("in proportion to the cosine", |u: [f64; 2]| Some(wrong::hemisphere_cosine(u)));
    vec![
        uniform.claim("warp/hemisphere/uniform", "directions are uniform on the hemisphere"),
        pdf(
            ("warp/hemisphere/pdf", "the hemisphere's density is 1/(2π) above and 0 below"),
            warp::square_to_hemisphere,
            (move |_| density, FEW),
            (warp::hemisphere_pdf, true),
            ("the same below", |_| warp::hemisphere_pdf(Vec3::Z)),
        ),
        inverse(
            "warp/hemisphere/inverse",
            "the hemisphere's inverse gives its numbers back",
            |u| warp::hemisphere_to_square(warp::square_to_hemisphere(u)),
            ("inverse of the cosine's map", |u| {
                warp::cosine_hemisphere_to_square(warp::square_to_hemisphere(u))
            }),
        ),
    ]
}

fn cosine_hemisphere() -> Vec<Claim> {
    let density = |w: [f64; 3]| 2.0 * w[2].max(0.0) / TAU;
    let cosine = ChiSquare::on(Directions::hemisphere())
        .density(density)
        .samples(|u: [f64; 2]| double(warp::square_to_cosine_hemisphere(u.map(single))))
        .bound(bounds::SHAPES)
        .rejects("uniform directions", |u: [f64; 2]| Some(wrong::hemisphere_uniform(u)));
    vec![
        cosine.claim("warp/cosine-hemisphere/distribution", "directions follow cos θ/π"),
        pdf(
            ("warp/cosine-hemisphere/pdf", "the density is cos θ/π above and 0 below"),
            warp::square_to_cosine_hemisphere,
            (move |w: Vec3| density(w.to_array().map(f64::from)), FEW),
            (warp::cosine_hemisphere_pdf, true),
            ("the absolute cosine", |w| warp::cosine_hemisphere_pdf(w.abs())),
        ),
        inverse(
            "warp/cosine-hemisphere/inverse",
            "the inverse gives the numbers back",
            |u| warp::cosine_hemisphere_to_square(warp::square_to_cosine_hemisphere(u)),
            ("inverse of the uniform map", |u| {
                warp::hemisphere_to_square(warp::square_to_cosine_hemisphere(u))
            }),
        ),
    ]
}

/// 1 − cos of an angle.
fn depth(half_angle: f64) -> f64 {
    2.0 * (0.5 * half_angle).sin().powi(2)
}

fn cone() -> Vec<Claim> {
    let test = |half_angle: f64| {
        let depth = depth(half_angle);
        ChiSquare::on(Directions::cone(half_angle))
            .density(move |_| 1.0 / (TAU * depth))
            .samples(move |u: [f64; 2]| double(warp::square_to_cone(u.map(single), nearest(depth))))
            .bound(bounds::SHAPES)
            .rejects("uniform angle from the axis", move |u: [f64; 2]| {
                Some(wrong::cone_by_angle(u, half_angle))
            })
    };
    let wide =
        test(WIDE).rejects("uniform disk normalised", |u: [f64; 2]| Some(wrong::cone_as_disk(u, WIDE)));
    let narrow = test(NARROW).rejects("1 − cos θ in single precision", |u: [f64; 2]| {
        double(wrong::cone_without_digits(u.map(single), NARROW))
    });
    let wide_depth = nearest(depth(WIDE));
    vec![
        wide.claim("warp/cone/uniform", "directions are uniform in a cone of 0.7 rad"),
        narrow.claim(
            "warp/cone/narrow",
            "directions are uniform in a cone of 1e-3 rad, where cosines have few digits left",
        ),
        pdf(
            ("warp/cone/pdf", "the cone's density is one over its solid angle, and 0 outside"),
            |u| warp::square_to_cone(u, nearest(depth(WIDE))),
            (move |_| 1.0 / (TAU * depth(WIDE)), FEW),
            (move |w| warp::cone_pdf(w, wide_depth), true),
            ("the hemisphere's", warp::hemisphere_pdf),
        ),
        inverse(
            "warp/cone/inverse",
            "the cone's inverse gives its numbers back",
            move |u| warp::cone_to_square(warp::square_to_cone(u, wide_depth), wide_depth),
            ("inverse of the hemisphere's map", move |u| {
                warp::hemisphere_to_square(warp::square_to_cone(u, wide_depth))
            }),
        ),
    ]
}

/// Nearest single.
fn nearest(x: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "to round is the purpose")]
    let rounded = x as f32;
    rounded
}

fn phong() -> Vec<Claim> {
    let exponent = nearest(EXPONENT);
    let density = |w: [f64; 3]| (EXPONENT + 1.0) / TAU * w[2].max(0.0).powf(EXPONENT);
    let lobe = ChiSquare::on(Directions::hemisphere())
        .density(density)
        .samples(move |u: [f64; 2]| double(warp::square_to_phong(u.map(single), exponent)))
        .bound(bounds::SHAPES)
        .rejects("exponent e in the place of e + 1", |u: [f64; 2]| {
            Some(wrong::phong_with_exponent(u, EXPONENT))
        })
        // most of the lobe lies in one row of cells, which sees nothing of u0
        .defect_in(1);
    // The map keeps cos θ above 2^(−24/21) = 0.45, so e·ln cos θ is at most 16 and its roundings, four of 2⁻²⁴, give 4e-6; the rounding of w
    // itself, e·2⁻²⁴·tan θ with tan θ at most 2, gives 3e-6.
    let tolerance = 7e-6;
    vec![
        lobe.claim("warp/phong/distribution", "directions follow (e + 1)/(2π)·cosᵉ θ"),
        pdf(
            ("warp/phong/pdf", "the density is (e + 1)/(2π)·cosᵉ θ above and 0 below"),
            |u| warp::square_to_phong(u, nearest(EXPONENT)),
            (move |w: Vec3| density(w.to_array().map(f64::from)), tolerance),
            (move |w| warp::phong_pdf(w, exponent), true),
            ("normalised with the cosine, (e + 2)/(2π)", move |w| {
                warp::phong_pdf(w, exponent) * (exponent + 2.0) / (exponent + 1.0)
            }),
        ),
        inverse(
            "warp/phong/inverse",
            "the lobe's inverse gives its numbers back",
            move |u| warp::phong_to_square(warp::square_to_phong(u, exponent), exponent),
            ("inverse for the exponent e − 1", move |u| {
                warp::phong_to_square(warp::square_to_phong(u, exponent), exponent - 1.0)
            }),
        ),
    ]
}
