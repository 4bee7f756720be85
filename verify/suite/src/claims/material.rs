//! Materials agree with themselves: what `sample`, `pdf` and `eval` say of one another, in both directions, and of the energy.

use glam::Vec3;
use renderer::materials::{Bsdf, BsdfSample, Lobe, Metal};
use renderer::math::Rgb;
use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::jittered;
use super::lobe::{
    Region, anywhere, beckmann, blurred, brushed, closed_form, cones, diffuse, everywhere, ggx, integral,
    phong, plain, towards, upper,
};
use super::pointwise::{EPSILON, never, rejecting, single};
use crate::{bounds, setup};

/// What a wrong `sample` gives, from the right one's, the direction it is for and the number that chose the lobe.
type Spoil = fn(&Bsdf, Vec3, f32, BsdfSample) -> BsdfSample;

/// A material and what it is seen from.
#[derive(Clone, Copy)]
struct Subject {
    name: &'static str,
    bsdf: Bsdf<'static>,
    both_sides: bool,
    /// The share of light that goes in single directions, seen at a cosine.
    single: fn(f64) -> f64,
    /// Index below the surface over that above it, where light passes.
    eta: f64,
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
    for other in others() {
        list.push(agreement(other).from_level(Level::Standard));
        list.push(reciprocity(other).from_level(Level::Standard));
        list.push(energy(other).from_level(Level::Standard));
    }
    list.extend([smooth_metal(), two_sided()]);
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
        single: |_| 0.0,
        eta: 1.0,
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

/// The index of claims' glass and plastic.
const ETA: f32 = 1.5;

/// The opacity of the mask.
const OPACITY: f32 = 0.625;

/// What Fresnel's equations say of a smooth coat.
fn coat(cos: f64) -> f64 {
    closed_form::fresnel(cos, ETA.into())
}

/// Materials of microfacets other than round GGX, and materials made of layers and others.
fn others() -> [Subject; 8] {
    let [one_sided, ..] = subjects();
    let of = |name, material| Subject { name, bsdf: plain(material), ..one_sided };
    let glass = setup::ground_glass(beckmann(), ETA);
    let matt = setup::diffuse(0.8);
    let through = Subject { both_sides: true, regions: |_| everywhere(), ..one_sided };
    [
        of("beckmann", setup::mirror_of(beckmann(), 1.0)),
        of("ggx-brushed", setup::mirror_of(brushed(), 1.0)),
        Subject { single: coat, ..of("plastic", setup::plastic([0.6, 1.0], None)) },
        of("rough-plastic", setup::plastic([0.6, 1.0], Some(brushed()))),
        Subject { name: "ground-glass", bsdf: plain(glass.clone()), eta: ETA.into(), ..through },
        Subject {
            name: "mask",
            bsdf: plain(setup::masked(OPACITY, &matt)),
            single: |_| 1.0 - f64::from(OPACITY),
            ..through
        },
        Subject {
            name: "blend",
            bsdf: plain(setup::blended(0.375, [&matt, &glass])),
            eta: ETA.into(),
            ..through
        },
        Subject {
            name: "faces",
            bsdf: plain(setup::faces([&matt, &setup::mirror_of(beckmann(), 1.0)])),
            ..through
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
    let fine: [(&'static str, Spoil); 2] = [
        ("density 1e-5 too large", |_, _, _, s| BsdfSample { pdf: 1.000_01 * s.pdf, ..s }),
        ("weight 1e-5 too large", |_, _, _, s| BsdfSample { weight: s.weight * 1.000_01, ..s }),
    ];
    // What a facet's normal loses that comes from two directions hides a finer defect.
    let coarse: [(&'static str, Spoil); 2] = [
        ("density 1 % too large", |_, _, _, s| BsdfSample { pdf: 1.01 * s.pdf, ..s }),
        ("weight 1 % too large", |_, _, _, s| BsdfSample { weight: s.weight * 1.01, ..s }),
    ];
    let factors = if subject.eta == 1.0 { fine } else { coarse };
    let builder = factors.into_iter().chain([subject.mistake]).fold(builder, |builder, (name, spoil)| {
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
    if sample.lobe == Lobe::Delta {
        return false; // what single directions carry is part of `energy`
    }
    let sample = spoil(&subject.bsdf, wo, lobe, sample);
    let pdf = f64::from(subject.bsdf.pdf(wo, sample.wi));
    let reflected = f64::from(subject.bsdf.eval(wo, sample.wi).g * sample.wi.z.abs());
    let slack = if subject.eta == 1.0 { 1.0 } else { facet_slack(subject, wo, sample.wi) };
    let far = |a: f64, b: f64| (a - b).abs() > AGREEMENT * slack * b;
    far(f64::from(sample.pdf), pdf) || far(f64::from(sample.weight.g) * pdf, reflected)
}

/// By how much the error of a facet's normal, which comes from the two directions, exceeds that of a sum of their size.
///
/// The normal's relative error is that of wo + η wi, over its length; Beckmann's exponent of up to −17 at roughness
/// ½ turns by 16·tan θ/cos² θ of it; near the critical angle the share that passes is the root of a difference.
fn facet_slack(subject: &Subject, wo: Vec3, wi: Vec3) -> f64 {
    let (wo, wi) = (wo.as_dvec3(), wi.as_dvec3());
    let eta = if wo.z > 0.0 { subject.eta } else { 1.0 / subject.eta };
    let sum = if wo.z * wi.z > 0.0 { wo + wi } else { wo + eta * wi };
    let h = sum.normalize();
    let [near, far] = [wo.dot(h), wi.dot(h)].map(f64::abs);
    if near.min(far) < 1e-3 || h.z.abs() < 1e-2 {
        return f64::INFINITY; // rounding decides whether the facet lets light pass
    }
    let root = (near * near + eta * eta - 1.0).abs();
    (1.0 + 1.0 / sum.length())
        * (1.0 + 1.0 / root)
        * (1.0 + 4.0 / h.z.abs().powi(3))
        * (1.0 + 1.0 / near + 1.0 / far)
}

fn reciprocity(subject: Subject) -> Claim {
    let says = if subject.eta == 1.0 {
        format!("\"{}\" reflects as much from wi to wo as from wo to wi", subject.name)
    } else {
        format!(
            "\"{}\" scatters as much from wi to wo as from wo to wi, times η² of where the light comes from",
            subject.name
        )
    };
    let misses = move |[a, b, u, v]: [f64; 4], spoil: fn(f64, Vec3) -> f64| {
        let (wo, wi) = (eye(&subject, [a, b]), eye(&subject, [u, v]));
        // Radiance over the square of the index is what is the same both ways.
        let squeezed = |w: Vec3| if w.z < 0.0 { subject.eta * subject.eta } else { 1.0 };
        let there = squeezed(wi) * spoil(f64::from(subject.bsdf.eval(wo, wi).g), wi);
        let back = squeezed(wo) * spoil(f64::from(subject.bsdf.eval(wi, wo).g), wo);
        // The same operations in another order: at most 16 roundings between them, as what cancels does so in f64. Below the
        // smallest normal number a value and its share in a blend are rounded by half a step each, both ways: 2·η² steps.
        let steps = 2.0 * subject.eta * subject.eta * f64::from(f32::from_bits(1));
        (there - back).abs() > 16.0 * EPSILON * back + steps
    };
    let builder = claim(format!("material/{}/reciprocity", subject.name), says);
    let builder = rejecting(builder, "times the cosine", move |u| misses(u, |f, w| f * f64::from(w.z)));
    let builder = rejecting(builder, "up to 1e-4 more along the normal", move |u| {
        misses(u, |f, w| f * (1.0 + 1e-4 * f64::from(w.z)))
    });
    never(builder, "share of pairs that differ", move |u| misses(u, |f, _| f))
}

/// Samples of a replicate: 64 by 64.
const SIDE: u32 = 64;

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
        let [spread, error] = integral(&(subject.regions)(wo), reflected);
        let albedo = spread + (subject.single)(f64::from(wo.z));
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

/// Gold's index, channel by channel.
const GOLD: [[f32; 3]; 2] = [[0.143, 0.375, 1.442], [3.983, 2.386, 1.603]];

fn smooth_metal() -> Claim {
    let [eta, k] = GOLD.map(Rgb::from);
    let bsdf = plain(setup::smooth_metal(Metal::new(eta, k).expect("gold")));
    let misses = move |u: [f64; 2], spoil: fn(f64) -> f64| {
        let wo = anywhere(u);
        let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        let Some(sample) = bsdf.sample(wo, 0.0, [0.0; 2]) else { return wo.z > 0.0 };
        let mirrored = sample.wi == Vec3::new(-wo.x, -wo.y, wo.z) && sample.lobe == Lobe::Delta;
        let right = |channel: usize| {
            let index = [GOLD[0][channel], GOLD[1][channel]].map(f64::from);
            let exact = spoil(closed_form::metal(f64::from(wo.z), index));
            // Some ten roundings in quotients of numbers of one size, the result at most 1.
            (f64::from(sample.weight.to_array()[channel]) - exact).abs() <= 32.0 * EPSILON
        };
        !(mirrored && sample.pdf == 1.0 && (0..3).all(right))
    };
    let says = "a smooth metal mirrors, with the weight that complex arithmetic gives Fresnel's reflectance";
    let builder = claim("material/smooth-metal/weight", says);
    let builder = rejecting(builder, "1e-5 too much", move |u| misses(u, |f| 1.000_01 * f));
    let builder = rejecting(builder, "as much at every angle", move |u| misses(u, |_| 0.9));
    never(builder, "share of angles with another weight", move |u| misses(u, |f| f))
}

/// A side of a material as its other side would see it.
fn turned(sample: BsdfSample) -> BsdfSample {
    BsdfSample { wi: -sample.wi, ..sample }
}

fn two_sided() -> Claim {
    let inner = setup::phong([0.3, 0.5], 20.0);
    let (one, two) = (plain(inner.clone()), plain(setup::two_sided(&inner)));
    let misses = move |[a, b, lobe, u, v]: [f64; 5], below: Bsdf<'static>| {
        let (wo, wi) = (anywhere([a, b]), anywhere([u, v]));
        let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        let (lobe, square) = (single(lobe), [u, v].map(single));
        let same = |lower: Bsdf, [o, i]: [Vec3; 2]| {
            lower.eval(o, i) == one.eval(wo, wi) && lower.pdf(o, i) == one.pdf(wo, wi)
        };
        let sampled = below.sample(-wo, lobe, square).map(turned) == one.sample(wo, lobe, square);
        !(same(two, [wo, wi]) && same(below, [-wo, -wi]) && sampled)
    };
    let says = "the lower side of a two-sided material is its upper side, upside down";
    let builder = claim("material/two-sided/symmetry", says);
    let builder = rejecting(builder, "one side only", move |u| misses(u, one));
    let other = plain(setup::two_sided(&setup::phong([0.3, 0.5], 20.01)));
    let builder = rejecting(builder, "an exponent of 20.01 below", move |u| misses(u, other));
    never(builder, "share of directions that differ", move |u| misses(u, two))
}
