//! Materials agree with themselves: what `sample`, `pdf` and `eval` say of one another, in both directions, and of the energy.

use glam::Vec3;
use renderer::materials::{Bsdf, BsdfSample};
use verify::claim::{Claim, Evidence, Run, claim};
use verify::error::InputError;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::jittered;
use super::lobe::{Region, anywhere, blurred, cones, diffuse, ggx, integral, phong, towards, upper};
use super::pointwise::{EPSILON, never, rejecting, single};
use crate::bounds;

/// What a wrong `sample` gives, from the right one's, the direction it is for and the number that chose the lobe.
type Spoil = fn(&Bsdf, Vec3, f32, BsdfSample) -> BsdfSample;

/// A material and what it is seen from.
#[derive(Clone, Copy)]
struct Subject {
    name: &'static str,
    bsdf: Bsdf,
    both_sides: bool,
    /// A mistake of sampled densities.
    mistake: (&'static str, Spoil),
    /// Where it reflects to, seen from a direction.
    regions: fn(Vec3) -> Vec<Region>,
}

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let [diffuse, metal, plastic, mirror, glass] = subjects();
    let mut list: Vec<Claim> = [diffuse, metal, plastic, mirror, glass].into_iter().map(agreement).collect();
    list.extend([diffuse, metal, plastic].map(reciprocity));
    list.extend([diffuse, metal, plastic, mirror].map(energy));
    list
}

/// Share of Phong's highlight among its samples.
const HIGHLIGHT: f32 = 0.625;

fn subjects() -> [Subject; 5] {
    let without_cosine: Spoil = |_, _, _, s| BsdfSample { pdf: s.pdf / s.wi.z.abs(), ..s };
    let one_sided = Subject {
        name: "diffuse",
        bsdf: diffuse(),
        both_sides: false,
        mistake: ("density without the cosine", without_cosine),
        regions: |_| upper(),
    };
    let mirror = Subject {
        name: "blur-reflection",
        bsdf: blurred(None),
        regions: |wo| cones(wo).into_iter().take(1).collect(),
        ..one_sided
    };
    [
        one_sided,
        Subject { name: "ggx", bsdf: ggx(0.5), ..one_sided },
        Subject {
            name: "phong",
            bsdf: phong([0.3, 0.5], 20.0),
            mistake: ("the chosen lobe's density in the place of the mixture's", chosen_lobe),
            ..one_sided
        },
        mirror,
        Subject {
            name: "blur-refraction",
            bsdf: blurred(Some(1.5)),
            both_sides: true,
            regions: cones,
            ..mirror
        },
    ]
}

/// Phong's sample with the density and the weight of the lobe that was chosen, as if it were the only one.
fn chosen_lobe(_: &Bsdf, wo: Vec3, lobe: f32, s: BsdfSample) -> BsdfSample {
    let only = if lobe < HIGHLIGHT { phong([0.0, 0.5], 20.0) } else { phong([0.3, 0.0], 20.0) };
    let pdf = only.pdf(wo, s.wi);
    BsdfSample { pdf, weight: only.eval(wo, s.wi) * (s.wi.z / pdf.max(f32::MIN_POSITIVE)), ..s }
}

/// A direction that the material is seen from.
fn eye(subject: &Subject, u: [f64; 2]) -> Vec3 {
    let wo = anywhere(u);
    if subject.both_sides { wo } else { Vec3::new(wo.x, wo.y, wo.z.abs()) }
}

fn agreement(subject: Subject) -> Claim {
    let says = format!(
        "the density of a sample of \"{}\" is that of its direction, and its weight is f·|cos θ| over it",
        subject.name
    );
    let builder = claim(format!("material/{}/agreement", subject.name), says);
    let controls: [(&'static str, Spoil); 3] = [
        subject.mistake,
        ("density 1e-5 too large", |_, _, _, s| BsdfSample { pdf: 1.000_01 * s.pdf, ..s }),
        ("weight 1e-5 too large", |_, _, _, s| BsdfSample { weight: s.weight * 1.000_01, ..s }),
    ];
    let builder = controls.into_iter().fold(builder, |builder, (name, spoil)| {
        rejecting(builder, name, move |u| disagrees(&subject, u, spoil))
    });
    never(builder, "share of samples that disagree", move |u| disagrees(&subject, u, |_, _, _, s| s))
}

/// Relative difference that some 64 roundings can make: two ways to the same density, each of at most 30 operations.
const AGREEMENT: f64 = 64.0 * EPSILON;

/// Share of the unit square at a blur disk's rim where rounding decides whether a direction is inside.
const RIM: f64 = 1e-4;

fn disagrees(subject: &Subject, [a, b, lobe, u, v]: [f64; 5], spoil: Spoil) -> bool {
    let wo = eye(subject, [a, b]);
    let lobe = single(lobe);
    let Some(sample) = subject.bsdf.sample(wo, lobe, [(1.0 - RIM) * u, v].map(single)) else { return false };
    let sample = spoil(&subject.bsdf, wo, lobe, sample);
    let pdf = f64::from(subject.bsdf.pdf(wo, sample.wi));
    let reflected = f64::from(subject.bsdf.eval(wo, sample.wi).g * sample.wi.z.abs());
    let far = |a: f64, b: f64| (a - b).abs() > AGREEMENT * b;
    far(f64::from(sample.pdf), pdf) || far(f64::from(sample.weight.g) * pdf, reflected)
}

fn reciprocity(subject: Subject) -> Claim {
    let says = format!("\"{}\" reflects as much from wi to wo as from wo to wi", subject.name);
    let misses = move |[a, b, u, v]: [f64; 4], spoil: fn(f64, Vec3) -> f64| {
        let (wo, wi) = (eye(&subject, [a, b]), eye(&subject, [u, v]));
        let there = spoil(f64::from(subject.bsdf.eval(wo, wi).g), wi);
        let back = spoil(f64::from(subject.bsdf.eval(wi, wo).g), wo);
        // The same operations in another order: at most 16 roundings between them.
        (there - back).abs() > 16.0 * EPSILON * back
    };
    let builder = claim(format!("material/{}/reciprocity", subject.name), says);
    let builder = rejecting(builder, "times the cosine", move |u| misses(u, |f, w| f * f64::from(w.z)));
    let builder = rejecting(builder, "up to 1e-4 more along the normal", move |u| {
        misses(u, |f, w| f * (1.0 + 1e-4 * f64::from(w.z)))
    });
    never(builder, "share of pairs that differ", move |u| misses(u, |f, _| f))
}

/// Samples of a replicate: 32 by 32.
const SIDE: u32 = 32;

/// From where the energy is measured: above, and at a grazing angle.
fn views() -> [Vec3; 2] {
    [towards(0.9), towards(0.15)]
}

fn energy(subject: Subject) -> Claim {
    let says = format!(
        "weights of \"{}\" average to the integral of f·cos θ, which is at most 1, from above and at a grazing angle",
        subject.name
    );
    let mut builder = claim(format!("material/{}/energy", subject.name), says);
    if subject.name == "phong" {
        builder = builder.rejects("the chosen lobe's weight as if it were the only one", move |run| {
            energy_of(&subject, run, chosen_lobe)
        });
    }
    builder
        .rejects("weights without the cosine", move |run| {
            energy_of(&subject, run, |_, _, _, s| BsdfSample { weight: s.weight / s.wi.z.abs(), ..s })
        })
        .rejects("weights 1 % too large", move |run| {
            energy_of(&subject, run, |_, _, _, s| BsdfSample { weight: s.weight * 1.01, ..s })
        })
        .rejects("2.2 × resolution", move |run| {
            joint_control(&albedos(&subject)?, run, |i, seed| {
                weights(&subject, views()[i], seed, |_, _, _, s| s)
            })
        })
        .by(move |run| energy_of(&subject, run, |_, _, _, s| s))
}

/// Claims that mean weights are the albedos.
fn albedos(subject: &Subject) -> Result<[MeanClaim; 2], InputError> {
    let means = views().map(|wo| {
        let reflected = |wi: Vec3| f64::from(subject.bsdf.eval(wo, wi).g * wi.z.abs());
        let [albedo, error] = integral(&(subject.regions)(wo), reflected);
        MeanClaim { rounding: 1e-6 + error / albedo, ..MeanClaim::relative(albedo, bounds::ALBEDO) }
    });
    match means.iter().find(|mean| mean.exact > 1.0 + mean.rounding) {
        Some(mean) => {
            Err(InputError::Subject(format!("{} reflects {} of the light", subject.name, mean.exact)))
        }
        None => Ok(means),
    }
}

fn energy_of(subject: &Subject, run: &Run, spoil: Spoil) -> Result<Evidence, InputError> {
    joint_evidence(&albedos(subject)?, run, |i, seed| weights(subject, views()[i], seed, spoil))
}

/// The mean weight of a replicate's samples; dropped ones weigh nothing.
fn weights(subject: &Subject, wo: Vec3, seed: u64, spoil: Spoil) -> f64 {
    jittered::mean(seed, SIDE, |u, lobe| {
        let sample = subject.bsdf.sample(wo, lobe, u);
        sample.map_or(0.0, |s| f64::from(spoil(&subject.bsdf, wo, lobe, s).weight.g))
    })
}
