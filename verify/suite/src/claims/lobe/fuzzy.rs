//! Fuzzy mirrors: the mirrored direction r plus f times a point ξ of the unit sphere, or of the ball.

use glam::DVec3;
use renderer::sampling::warp::square_to_sphere;
use std::f64::consts::PI;
use verify::chi_square::ChiSquare;
use verify::claim::{Claim, Level};
use verify::domain::Directions;

use super::super::pointwise::single;
use crate::{bounds, wrong};

/// f, below 1: the directions fill a cone of the sine f.
const FUZZ: f64 = 0.6;

/// The cone of the claims ends at this share of that sine: at the rim the density of the sphere has no bound. Points beyond it
/// are left out, and counted.
const RIM: f64 = 0.98;

pub(super) fn claims() -> Vec<Claim> {
    [sphere(), ball()].map(|claim| claim.from_level(Level::Standard)).into()
}

/// cos 2γ and the root of f² − sin² γ, for a direction at the cosine z to r.
fn parts(z: f64) -> [f64; 2] {
    [2.0 * z * z - 1.0, (FUZZ * FUZZ + z * z - 1.0).sqrt()]
}

/// The direction of r + fξ, where r is the third axis, within the rim.
fn direction(xi: DVec3, fuzz: f64) -> Option<[f64; 3]> {
    let w = (DVec3::Z + fuzz * xi).normalize();
    (w.truncate().length() < RIM * FUZZ).then(|| w.to_array())
}

/// ξ on the sphere.
fn on_sphere(u: [f64; 2]) -> DVec3 {
    square_to_sphere(u.map(single)).as_dvec3()
}

/// ξ in the ball.
fn in_ball([radius, u, v]: [f64; 3]) -> DVec3 {
    radius.cbrt() * on_sphere([u, v])
}

fn test<const N: usize>(
    density: fn(f64) -> f64,
    sample: impl Fn([f64; N]) -> Option<[f64; 3]> + Send + Sync + 'static,
) -> ChiSquare<Directions> {
    ChiSquare::on(Directions::cone((RIM * FUZZ).asin()))
        .density(move |w: [f64; 3]| density(w[2]))
        .samples(sample)
        .bound(bounds::LOBE)
        .rejects("uniform directions of the cone", |u: [f64; 2]| {
            Some(wrong::cone_uniform(u, (RIM * FUZZ).asin()))
        })
}

/// Both points of the sphere that a direction passes count, at the distances cos γ ± s from the eye of r.
fn sphere() -> Claim {
    let density = |z: f64| {
        let [cos_2, s] = parts(z);
        (cos_2 + FUZZ * FUZZ) / (2.0 * PI * FUZZ * s)
    };
    test(density, |u: [f64; 2]| direction(on_sphere(u), FUZZ))
        .rejects("points of the ball", |u: [f64; 3]| direction(in_ball(u), FUZZ))
        .rejects("f 2 % too large", |u: [f64; 2]| direction(on_sphere(u), 1.02 * FUZZ))
        .claim(
            "lobe/fuzzy/sphere",
            "directions r + fξ, ξ on the sphere, have the density (cos 2γ + f²)/(2πf√(f² − sin² γ))",
        )
}

fn ball() -> Claim {
    let density = |z: f64| {
        let s = parts(z)[1];
        (3.0 * z * z * s + s.powi(3)) / (2.0 * PI * FUZZ.powi(3))
    };
    test(density, |u: [f64; 3]| direction(in_ball(u), FUZZ))
        .rejects("points of the sphere", |[_, u, v]: [f64; 3]| direction(on_sphere([u, v]), FUZZ))
        .rejects("radius ξ in the place of its cube root", |[radius, u, v]: [f64; 3]| {
            direction(radius * on_sphere([u, v]), FUZZ)
        })
        .defect_in(2) // of the azimuth or height of ξ; the first number is its distance from the middle
        .claim(
            "lobe/fuzzy/ball",
            "directions r + fξ, ξ in the ball, have the density (3 cos² γ s + s³)/(2πf³), s² = f² − sin² γ",
        )
}
