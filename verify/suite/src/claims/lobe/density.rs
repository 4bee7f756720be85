//! Densities of lobes: their closed forms at every pair of directions, and what they leave for dropped directions.

use glam::Vec3;
use renderer::materials::{Branch, Bsdf, Facets};
use verify::claim::{Claim, Evidence, Level, Picture, Run, claim};
use verify::error::InputError;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::super::jittered;
use super::super::pointwise::{EPSILON, curve, never_drawn, rejecting, single};
use super::{BLUR, BROAD, ETA, EXPONENT, PHONG, Region, SHARP};
use super::{
    anywhere, beckmann, blurred, brushed, closed_form, cones, diffuse, everywhere, ggx, ideal, integral,
    normals, phong, plain, roundings, towards, upper,
};
use crate::{bounds, setup};

/// The closed form of a density and its rounding; `None` where rounding decides between inside and outside.
type Exact = fn(Vec3, Vec3) -> Option<[f64; 2]>;

/// A wrong density, made from the renderer's own.
type Spoil = fn(Vec3, Vec3, f64) -> f64;

/// A lobe and what is said of its density.
#[derive(Clone, Copy)]
struct Subject {
    name: &'static str,
    formula: &'static str,
    bsdf: Bsdf<'static>,
    /// Whether the surface is seen from below, too.
    both_sides: bool,
    exact: Exact,
    /// The historical mistake.
    mistake: (&'static str, Spoil),
    /// Where its density is, seen from a direction.
    regions: fn(Vec3) -> Vec<Region>,
}

pub(super) fn claims() -> Vec<Claim> {
    let later = |claim: Claim| claim.from_level(Level::Standard);
    let others = microfacets().into_iter().flat_map(|subject| [pdf(subject), mass(subject)]).map(later);
    subjects().into_iter().flat_map(|subject| [pdf(subject), mass(subject)]).chain(others).collect()
}

fn subjects() -> [Subject; 6] {
    let one_sided = Subject {
        name: "diffuse",
        formula: "cos θ/π",
        bsdf: diffuse(),
        both_sides: false,
        exact: |_, wi| Some(rounded(closed_form::diffuse(wi.as_dvec3()), 3.0)),
        mistake: (
            "1/π without the cosine",
            |_, wi, pdf| if wi.z > 1e-3 { pdf / f64::from(wi.z) } else { pdf },
        ),
        regions: |_| upper(),
    };
    let metal = Subject {
        formula: "G₁·D/(4 cos θₒ)",
        mistake: ("without the Jacobian of mirroring", |wo, wi, pdf| {
            pdf * 4.0 * f64::from(wo.dot((wo + wi).normalize()))
        }),
        ..one_sided
    };
    let blur = Subject {
        name: "blur-reflection",
        formula: "1/(π f² cos³ γ)",
        bsdf: blurred(None),
        exact: |wo, wi| blur_exact(wo, wi, None),
        mistake: ("without cos³ γ", |wo, wi, pdf| flattened(wo, wi, pdf)),
        regions: |wo| cones(wo).into_iter().take(1).collect(),
        ..one_sided
    };
    [
        one_sided,
        Subject { name: "ggx-sharp", bsdf: ggx(SHARP), exact: |wo, wi| ggx_exact(wo, wi, SHARP), ..metal },
        Subject { name: "ggx-broad", bsdf: ggx(BROAD), exact: |wo, wi| ggx_exact(wo, wi, BROAD), ..metal },
        Subject {
            name: "phong",
            formula: "the mixture of (n + 1)/(2π)·cosⁿ α and cos θ/π",
            bsdf: phong(PHONG, f32::from(EXPONENT)),
            exact: phong_exact,
            mistake: ("normalised with the cosine, (n + 2)/(2π)", |_, _, pdf| pdf * 22.0 / 21.0),
            ..one_sided
        },
        blur,
        Subject {
            name: "blur-refraction",
            formula: "F or 1 − F times 1/(π f² cos³ γ)",
            bsdf: blurred(Some(ETA)),
            both_sides: true,
            exact: |wo, wi| blur_exact(wo, wi, Some(ETA)),
            regions: cones,
            ..blur
        },
    ]
}

/// Materials of microfacets other than round GGX.
fn microfacets() -> [Subject; 3] {
    let metal = Subject {
        name: "beckmann",
        formula: "G₁·D/(4 cos θₒ)",
        bsdf: plain(setup::mirror_of(beckmann(), 1.0)),
        both_sides: false,
        exact: |wo, wi| mirrored_exact(wo, wi, beckmann()),
        mistake: ("without the Jacobian of mirroring", |wo, wi, pdf| {
            pdf * 4.0 * f64::from(wo.dot((wo + wi).normalize()))
        }),
        regions: |_| upper(),
    };
    [
        metal,
        Subject {
            name: "ggx-brushed",
            bsdf: plain(setup::mirror_of(brushed(), 1.0)),
            exact: |wo, wi| mirrored_exact(wo, wi, brushed()),
            ..metal
        },
        Subject {
            name: "ground-glass",
            formula: "F or 1 − F times the density of visible facets' directions",
            bsdf: plain(setup::ground_glass(beckmann(), ETA)),
            both_sides: true,
            exact: |wo, wi| ground_exact(wo, wi, beckmann()),
            regions: |_| everywhere(),
            mistake: ("the Jacobian of refraction without η²", |wo, wi, pdf| {
                let eta = if wo.z > 0.0 { f64::from(ETA) } else { 1.0 / f64::from(ETA) };
                if wo.z * wi.z < 0.0 { pdf / (eta * eta) } else { pdf }
            }),
        },
    ]
}

/// The exponent −t of Beckmann has the relative error of the half vector's square.
fn mirrored_exact(wo: Vec3, wi: Vec3, facets: Facets) -> Option<[f64; 2]> {
    let (wo, wi, exact) = (wo.as_dvec3(), wi.as_dvec3(), normals(facets));
    let steepness = exact.steepness((wo + wi).normalize());
    // Beyond, the exponential of single precision has fewer and fewer digits.
    (steepness < 80.0 || wi.z <= 0.0).then(|| rounded(exact.mirrored(wo, wi), 40.0 + 16.0 * steepness))
}

/// As for mirrored directions; the facet that refracts comes from wo + η wi, of length ℓ, and has a relative error
/// larger by 1/ℓ; near the critical angle the share that passes is the root of a difference.
fn ground_exact(wo: Vec3, wi: Vec3, facets: Facets) -> Option<[f64; 2]> {
    let (wo, wi, exact) = (wo.as_dvec3(), wi.as_dvec3(), normals(facets));
    let eta = if wo.z > 0.0 { f64::from(ETA) } else { 1.0 / f64::from(ETA) };
    let sum = if wo.z * wi.z > 0.0 { wo + wi } else { wo + eta * wi };
    let (h, length) = (sum.normalize(), sum.length());
    let cos = wo.dot(h);
    let root = (cos * cos + eta * eta - 1.0).abs();
    // Rounding decides at the horizons of the facet whether light passes, and beyond 80 see above.
    let steepness = exact.steepness(h);
    let clear =
        root > 1e-2 && length > 1e-2 && cos.abs() > 1e-3 && wi.dot(h).abs() > 1e-3 && steepness < 80.0;
    let count = (64.0 + 16.0 * steepness) * (1.0 + 1.0 / length) * (1.0 + 1.0 / root);
    let count = count * (1.0 + 1.0 / h.z.abs()) * (1.0 + 1.0 / cos.abs() + 1.0 / wi.dot(h).abs());
    clear.then(|| rounded(exact.through(f64::from(ETA), wo, wi), count))
}

/// A value, and what so many roundings make of it.
fn rounded(value: f64, count: f64) -> [f64; 2] {
    [value, roundings(count) * value]
}

/// The half vector's components keep their relative precision, so D has about twice its own roundings twice over.
fn ggx_exact(wo: Vec3, wi: Vec3, alpha: f32) -> Option<[f64; 2]> {
    Some(rounded(closed_form::ggx(f64::from(alpha), wo.as_dvec3(), wi.as_dvec3()), 40.0))
}

/// cosⁿ α has n times the relative error of cos α, and that of 1 − cos α is a few roundings.
fn phong_exact(wo: Vec3, wi: Vec3) -> Option<[f64; 2]> {
    let (wo, wi) = (wo.as_dvec3(), wi.as_dvec3());
    let share = f64::from(PHONG[1] / (PHONG[0] + PHONG[1]));
    let highlight = share * closed_form::highlight(EXPONENT.into(), wo, wi);
    let diffuse = (1.0 - share) * closed_form::diffuse(wi);
    let cos = (highlight / 2.1).powf(1.0 / f64::from(EXPONENT)).max(EPSILON); // the highlight is 2.1·cosⁿ α
    let error = highlight * (8.0 + 4.0 * f64::from(EXPONENT) / cos) + 8.0 * diffuse;
    Some([highlight + diffuse, roundings(error)])
}

/// The branch of a pair of directions.
fn branch(wo: Vec3, wi: Vec3) -> Branch {
    if wo.z * wi.z > 0.0 { Branch::Reflect } else { Branch::Refract }
}

fn blur_exact(wo: Vec3, wi: Vec3, eta: Option<f32>) -> Option<[f64; 2]> {
    let which = branch(wo, wi);
    let share = match eta {
        Some(eta) => {
            let side = if wo.z > 0.0 { f64::from(eta) } else { 1.0 / f64::from(eta) };
            let reflected = closed_form::fresnel(f64::from(wo.z.abs()), side);
            if which == Branch::Reflect { reflected } else { 1.0 - reflected }
        }
        None => f64::from(u8::from(which == Branch::Reflect)),
    };
    if share == 0.0 {
        return Some([0.0, 0.0]);
    }
    let (f, r, w) = (f64::from(BLUR), ideal(wo, which), wi.as_dvec3());
    // The ideal direction comes from a cosine whose square has the error of sin², which the cosine divides.
    let slack = 1e-6 + roundings(8.0) / r.z.abs();
    let tan = r.cross(w).length() / r.dot(w);
    let at_the_rim = (tan / f - 1.0).abs() < 10.0 * slack || w.z.abs() < slack || r.z.abs() < 1e-3;
    let exact = share * closed_form::blur(f, r, w);
    (!at_the_rim).then(|| rounded(exact, 32.0 + 16.0 / r.z.abs()))
}

/// A blur disk's density times cos³ γ.
fn flattened(wo: Vec3, wi: Vec3, pdf: f64) -> f64 {
    pdf * ideal(wo, branch(wo, wi)).dot(wi.as_dvec3()).powi(3).abs()
}

fn pdf(subject: Subject) -> Claim {
    let says = format!(
        "the density of the lobe \"{}\" is {} at every pair of directions",
        subject.name, subject.formula
    );
    let builder = claim(format!("lobe/{}/pdf", subject.name), says);
    let builder = rejecting(builder, subject.mistake.0, move |u| misses(&subject, u, subject.mistake.1));
    // What rounding may do to ground glass, 2e-4 at most pairs, hides an error of 1e-4.
    let (name, larger): (_, Spoil) = match subject.name {
        "ground-glass" => ("2e-3 too large", |_, _, pdf| 1.002 * pdf),
        _ => ("1e-4 too large", |_, _, pdf| 1.0001 * pdf),
    };
    let builder = rejecting(builder, name, move |u| misses(&subject, u, larger));
    let misses = move |u| misses(&subject, u, |_, _, pdf| pdf);
    never_drawn(builder, "share of pairs with another density", misses, move || in_plane(&subject))
}

/// The density in the plane of incidence, seen at 26° from above.
fn in_plane(subject: &Subject) -> Picture {
    let wo = towards(0.9);
    curve(["angle from the normal, degrees", "density per steradian (3 σ: rounding)"], |u| {
        let degrees = 360.0 * u - 180.0;
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let wi = glam::DVec3::new(0.6 * sin, 0.8 * sin, cos).as_vec3();
        let [exact, error] = (subject.exact)(wo, wi)?;
        Some([degrees, exact, f64::from(subject.bsdf.pdf(wo, wi)), error])
    })
}

/// Whether the density misses at a sampled direction or at one from anywhere.
fn misses(subject: &Subject, [a, b, lobe, u, v]: [f64; 5], spoil: Spoil) -> bool {
    let mut wo = anywhere([a, b]);
    if !subject.both_sides {
        wo.z = wo.z.abs();
    }
    let sampled = subject.bsdf.sample(wo, single(lobe), [u, v].map(single)).map(|s| s.wi);
    sampled.into_iter().chain([anywhere([v, u])]).any(|wi| {
        let measured = spoil(wo, wi, f64::from(subject.bsdf.pdf(wo, wi)));
        (subject.exact)(wo, wi).is_some_and(|[exact, error]| (measured - exact).abs() > error)
    })
}

/// Samples of a replicate: 64 by 64.
const SIDE: u32 = 64;

fn mass(subject: Subject) -> Claim {
    let says = format!(
        "the density of the lobe \"{}\" integrates to 1 less the share of dropped directions, from above and at a grazing angle",
        subject.name
    );
    let views = views(&subject);
    claim(format!("lobe/{}/mass", subject.name), says)
        .rejects(subject.mistake.0, move |run| mass_of(&subject, views, run, subject.mistake.1))
        .rejects("1 % too large", move |run| mass_of(&subject, views, run, |_, _, pdf| 1.01 * pdf))
        .rejects("2.2 × resolution", move |run| {
            let means = masses(&subject, views, |_, _, pdf| pdf);
            joint_control(&means, run, |i, seed| dropped(&subject, views[i], seed))
        })
        .by(move |run| mass_of(&subject, views, run, |_, _, pdf| pdf))
}

/// From where the mass is integrated; glass is seen at a grazing angle from inside, just short of total reflection.
fn views(subject: &Subject) -> [Vec3; 2] {
    [towards(0.9), towards(if subject.both_sides { -0.7505 } else { 0.15 })]
}

fn masses(subject: &Subject, views: [Vec3; 2], spoil: Spoil) -> [MeanClaim; 2] {
    views.map(|wo| {
        let pdf = |wi| spoil(wo, wi, f64::from(subject.bsdf.pdf(wo, wi)));
        let [mass, error] = integral(&(subject.regions)(wo), pdf);
        MeanClaim { rounding: 1e-6 + error, ..MeanClaim::in_units_of(1.0, 1.0 - mass, bounds::MASS) }
    })
}

fn mass_of(subject: &Subject, views: [Vec3; 2], run: &Run, spoil: Spoil) -> Result<Evidence, InputError> {
    joint_evidence(&masses(subject, views, spoil), run, |i, seed| dropped(subject, views[i], seed))
}

/// The share of dropped directions in one replicate.
fn dropped(subject: &Subject, wo: Vec3, seed: u64) -> f64 {
    jittered::mean(seed, SIDE, |u, lobe| f64::from(u8::from(subject.bsdf.sample(wo, lobe, u).is_none())))
}
