//! Fresnel's reflectance at every angle and index, and where its values are known.

use renderer::materials::fresnel::{Interface, dielectric};
use verify::claim::{Claim, Picture, claim};

use super::super::lobe::closed_form;
use super::super::pointwise::{self, EPSILON, never_drawn, rejecting, rejecting_subtle, single};
use crate::wrong;

/// What is looked at: an interface, from the cosine seen and the index.
type Solve = fn(f32, f32) -> Interface;

/// A wrong version that has 1e-5 too large an index, which moves reflectances by as much or more.
const DENSER: Solve = |cos, eta| dielectric(cos, 1.000_01 * eta);

/// Indices from 1.1 to 3.1.
fn index(u: f64) -> f32 {
    1.1 + 2.0 * single(u)
}

pub(super) fn claims() -> Vec<Claim> {
    vec![curve(), normal_incidence(), brewster(), critical(), energy()]
}

/// A claim that nothing misses, with the two wrong versions that it must see.
fn pointwise(
    (id, says): (&str, &str),
    misses: fn([f64; 2], Solve) -> bool,
    controls: [(&'static str, Solve); 2],
    picture: fn() -> Picture,
) -> Claim {
    let builder = controls
        .into_iter()
        .fold(claim(id, says), |builder, (name, solve)| rejecting(builder, name, move |u| misses(u, solve)));
    let quantity = "share of angles and indices with another reflectance";
    never_drawn(builder, quantity, move |u| misses(u, dielectric), picture)
}

/// The index of pictures over angles.
const GLASS: f32 = 1.5;

/// The reflectance over cosines from −1 (inside) to 1 (outside).
fn over_cosines(at: fn(f32, Interface) -> Option<[f64; 3]>) -> Picture {
    pointwise::curve(["cosine, negative inside glass of 1.5", "reflectance (3 σ: its rounding)"], |u| {
        #[expect(clippy::cast_possible_truncation, reason = "to round is the purpose")]
        let cos = (2.0 * u - 1.0) as f32;
        let [exact, found, error] = at(cos, dielectric(cos, GLASS))?;
        Some([f64::from(cos), exact, found, error])
    })
}

/// The reflectance over indices at the cosine that an index has.
fn over_indices(cos: fn(f64) -> f64, exact: fn(f64) -> f64, roundings: f64) -> Picture {
    pointwise::curve(["index", "reflectance (3 σ: its rounding)"], |u| {
        let eta = index(u);
        let right = exact(f64::from(eta));
        #[expect(clippy::cast_possible_truncation, reason = "the renderer's cosines are f32")]
        let found = dielectric(cos(f64::from(eta)) as f32, eta).reflectance;
        Some([f64::from(eta), right, f64::from(found), roundings * EPSILON * right])
    })
}

/// An interface of another reflectance.
fn with_reflectance(cos: f32, eta: f32, reflectance: f64) -> Interface {
    #[expect(clippy::cast_possible_truncation, reason = "to round is the purpose")]
    let reflectance = reflectance as f32;
    Interface { reflectance, ..dielectric(cos, eta) }
}

/// Whether two numbers differ by more than so many roundings, relative to the second.
fn differ(a: f32, b: f64, roundings: f64) -> bool {
    (f64::from(a) - b).abs() > roundings * EPSILON * b
}

fn curve() -> Claim {
    let misses = |[u, v]: [f64; 2], solve: Solve| {
        let (cos, eta) = (single(2.0f64.mul_add(u, -1.0).abs()) * if u < 0.5 { -1.0 } else { 1.0 }, index(v));
        if cos == 0.0 || cos.abs() > 0.999_999 {
            return false; // 0/0 in the closed form; these angles are those of other claims
        }
        let far = if cos > 0.0 { f64::from(eta) } else { 1.0 / f64::from(eta) };
        // One rounding to single precision; the sines and tangents of small angles lose 1e-16/1e-3.
        differ(solve(cos, eta).reflectance, closed_form::fresnel(f64::from(cos.abs()), far), 2.0)
    };
    pointwise(
        (
            "fresnel/dielectric/curve",
            "the reflectance is ½(sin²(i − t)/sin²(i + t) + tan²(i − t)/tan²(i + t)) at every angle",
        ),
        misses,
        [
            ("index 1e-5 too large", DENSER),
            ("Schlick's polynomial", |cos, eta| {
                with_reflectance(cos, eta, wrong::schlick(f64::from(cos.abs()), f64::from(eta)))
            }),
        ],
        || {
            over_cosines(|cos, found| {
                let far = if cos > 0.0 { f64::from(GLASS) } else { 1.0 / f64::from(GLASS) };
                let exact = closed_form::fresnel(f64::from(cos.abs()), far);
                let inside = cos != 0.0 && cos.abs() < 0.999_999;
                inside.then(|| [exact, f64::from(found.reflectance), 2.0 * EPSILON * exact])
            })
        },
    )
}

fn normal_incidence() -> Claim {
    let misses = |[u, side]: [f64; 2], solve: Solve| {
        let eta = index(u);
        let exact = ((f64::from(eta) - 1.0) / (f64::from(eta) + 1.0)).powi(2);
        differ(solve(if side < 0.5 { 1.0 } else { -1.0 }, eta).reflectance, exact, 2.0)
    };
    pointwise(
        (
            "fresnel/dielectric/normal-incidence",
            "from above the reflectance is ((η − 1)/(η + 1))² on both sides",
        ),
        misses,
        [
            ("index 1e-5 too large", DENSER),
            ("amplitude in the place of power", |cos, eta| {
                with_reflectance(cos, eta, f64::from(dielectric(cos, eta).reflectance).sqrt())
            }),
        ],
        || over_indices(|_| 1.0, |eta| ((eta - 1.0) / (eta + 1.0)).powi(2), 2.0),
    )
}

fn brewster() -> Claim {
    let misses = |[u, _]: [f64; 2], solve: Solve| {
        let eta = f64::from(index(u));
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let exact = 0.5 * ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
        #[expect(clippy::cast_possible_truncation, reason = "the renderer's cosines are f32")]
        let rounded = cos as f32;
        // The cosine's rounding of 2⁻²⁵ or less, times the slope |d ln R/d cos| = 4/q, q = η² cos θ ≥ 0.8; and that of R.
        differ(solve(rounded, index(u)).reflectance, exact, 4.0)
    };
    pointwise(
        (
            "fresnel/dielectric/brewster",
            "at tan θ = η only one polarisation is reflected: R = ½((η² − 1)/(η² + 1))²",
        ),
        misses,
        [
            ("index 1e-5 too large", DENSER),
            ("both polarisations alike", |cos, eta| {
                with_reflectance(cos, eta, 2.0 * f64::from(dielectric(cos, eta).reflectance))
            }),
        ],
        || {
            let half_squared = |eta: f64| 0.5 * ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
            over_indices(|eta| 1.0 / (1.0 + eta * eta).sqrt(), half_squared, 4.0)
        },
    )
}

fn critical() -> Claim {
    let misses = |[u, v]: [f64; 2], solve: Solve| {
        let eta = index(u);
        let sin = 1.0 / f64::from(eta);
        let cos = (1.0 - sin * sin).sqrt();
        // Relative distance from the critical cosine, 1e-6 (16 roundings) to 1e-2, on both sides.
        let away = 10f64.powf(-6.0 + 4.0 * (2.0 * v).fract());
        let total = v < 0.5;
        #[expect(clippy::cast_possible_truncation, reason = "the renderer's cosines are f32")]
        let seen = -(cos * if total { 1.0 - away } else { 1.0 + away }) as f32;
        let found = solve(seen, eta);
        let is_total = found.cos_t.is_none() && found.reflectance == 1.0 && found.transmittance == 0.0;
        is_total != total || !total && found.reflectance >= 1.0
    };
    let builder = claim(
        "fresnel/dielectric/critical",
        "from inside, all light is reflected beyond asin(1/η) and not before",
    );
    let builder = rejecting_subtle(builder, "index 1e-5 too large", move |u| misses(u, DENSER));
    let other_side: Solve = |cos, eta| dielectric(-cos, eta);
    let builder = rejecting(builder, "seen from the other side", move |u| misses(u, other_side));
    let quantity = "share of angles and indices with another verdict";
    never_drawn(
        builder,
        quantity,
        move |u| misses(u, dielectric),
        || {
            let sin = 1.0 / f64::from(GLASS);
            let critical = (1.0 - sin * sin).sqrt();
            pointwise::curve(
                ["cosine inside over the critical one", "reflectance (3 σ: its rounding)"],
                |u| {
                    #[expect(clippy::cast_possible_truncation, reason = "the renderer's cosines are f32")]
                    let cos = (critical * (0.99 + 0.02 * u)) as f32;
                    let exact = closed_form::fresnel(f64::from(cos), sin);
                    let found = f64::from(dielectric(-cos, GLASS).reflectance);
                    Some([f64::from(cos) / critical, exact, found, 2.0 * EPSILON * exact])
                },
            )
        },
    )
}

fn energy() -> Claim {
    let misses = |[u, v]: [f64; 2], solve: Solve| {
        let (cos, eta) = (single(u.max(0.01)), index(v));
        let there = solve(cos, eta);
        let (r, t) = (f64::from(there.reflectance), f64::from(there.transmittance));
        let Some(cos_t) = there.cos_t else { return true };
        let back = f64::from(dielectric(-cos_t, eta).reflectance);
        // Two roundings of numbers up to 1; and that of cos θₜ, 2⁻²⁵, by which R changes at a rate of up to 2(η + η³)/cos θ,
        // its limit at the critical angle; a tenth more for the curvature there, which matters when cos² θ is near 2⁻²⁴.
        let slack = (2.0 + 1.1 * f64::from(eta + eta.powi(3)) / f64::from(cos)) * EPSILON;
        (r + t - 1.0).abs() > 2.0 * EPSILON || (r - back).abs() > slack
    };
    pointwise(
        (
            "fresnel/dielectric/energy",
            "reflected and refracted shares add up to 1, and the way back reflects as much",
        ),
        misses,
        [
            ("index 1e-3 too large on one side", |cos, eta| dielectric(cos, 1.001 * eta)),
            ("what is refracted, divided by η²", |cos, eta| {
                let right = dielectric(cos, eta);
                Interface { transmittance: right.transmittance / (eta * eta), ..right }
            }),
        ],
        || {
            over_cosines(|_, found| {
                let sum = f64::from(found.reflectance) + f64::from(found.transmittance);
                Some([1.0, sum, 2.0 * EPSILON])
            })
        },
    )
}
