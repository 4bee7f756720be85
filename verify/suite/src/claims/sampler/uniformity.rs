//! Each point alone is uniform over seeds, pixels and replicates; so means have no bias.

use std::sync::Arc;

use renderer::sampling::{Decision, DecisionSet, SampleId, SamplerKind, Vertex};
use verify::chi_square::{ChiSquare, Target};
use verify::claim::{Claim, Evidence, Run, claim};
use verify::domain::Parallelogram;
use verify::error::InputError;
use verify::integrands::Integrand;
use verify::mean::{CONTROL_FACTOR, MeanClaim, joint_control, joint_evidence};
use verify::seeds::derive;

use super::level;
use crate::bounds;
use crate::setup::sampler;
use crate::wrong::samplers::{in_order, on_the_diagonal};

/// Samples of each pixel: neither a square nor a power of two, so that no set is complete.
const SAMPLES: u32 = 13;

/// The sample that is looked at.
const INDEX: u32 = 6;

/// Randomisations of one seed: pixels and replicates.
const OF_A_SEED: u64 = 4096;

/// Where points are looked at: name, decision, bounce.
const PLACES: [(&str, Decision, u16); 3] =
    [("pixel", Decision::Pixel, 0), ("lens", Decision::Lens, 0), ("direction", Decision::Direction, 2)];

pub(super) fn claims() -> Vec<Claim> {
    let of_kind = |kind: SamplerKind| {
        let marginals = PLACES
            .map(|(name, decision, bounce)| marginal(kind, name, Place { decision, vertex: at(bounce) }));
        let all = marginals.into_iter().chain([mean(kind)]);
        all.map(|claim| claim.from_level(level(kind))).collect::<Vec<_>>()
    };
    SamplerKind::ALL.into_iter().flat_map(of_kind).collect()
}

fn at(bounce: u16) -> Vertex {
    Vertex { bounce, ..Vertex::default() }
}

#[derive(Clone, Copy)]
struct Place {
    decision: Decision,
    vertex: Vertex,
}

/// What a mistake makes of a point.
type Change = fn([f64; 2]) -> [f64; 2];

/// The claim that one sample's point at `place` is uniform on the square over seeds, pixels and replicates.
fn marginal(kind: SamplerKind, name: &str, place: Place) -> Claim {
    let target = Arc::new(ChiSquare::on(Parallelogram::unit_square()).density(|_| 1.0));
    let (control, gross) = (target.clone(), target.clone());
    let (mistake, wrong): (_, Change) = match kind {
        SamplerKind::Stratified => ("grid filled in order", |u| in_order(u, INDEX % 3, 3)),
        _ => ("both numbers of the same bits", on_the_diagonal),
    };
    let id = format!("sampler/{}/marginal-{name}", kind.name());
    let says = format!(
        "one {} sample's {name} point is uniform on the square over seeds, pixels and replicates",
        kind.name()
    );
    claim(id, says)
        .rejects(mistake, move |run| over_randomisations(&gross, run, kind, place, wrong))
        .rejects("u0^(1+δ), 2.2 × resolution", move |run| {
            let resolution = control.resolution(control.sample_count(bounds::MARGINAL)? * run.effort)?;
            // the density of u^(1+δ) is off by δ·(−1 − ln u) to first order, RMS δ
            let exponent = 1.0 + CONTROL_FACTOR * resolution;
            over_randomisations(&control, run, kind, place, |[x, y]| [x.powf(exponent), y])
        })
        .by(move |run| over_randomisations(&target, run, kind, place, |u| u))
}

fn over_randomisations(
    target: &Target<Parallelogram<2>>,
    run: &Run,
    kind: SamplerKind,
    place: Place,
    change: impl Fn([f64; 2]) -> [f64; 2],
) -> Result<Evidence, InputError> {
    let planned = DecisionSet::EMPTY.with(Decision::Pixel).with(Decision::Lens);
    let seeds = (target.sample_count(bounds::MARGINAL)? * run.effort).div_ceil(OF_A_SEED);
    let mut histogram = target.histogram();
    for seed in 0..seeds {
        let sampler = sampler(kind, derive(run.seed, 0, seed), planned, SAMPLES);
        for (replicate, y, x) in
            (0..16).flat_map(|r| (0..16).flat_map(move |y| (0..16).map(move |x| (r, y, x))))
        {
            let sample = SampleId { pixel: [x, y], replicate, index: INDEX };
            let point = sampler.draw_2d(sample, place.vertex, place.decision).map(f64::from);
            target.add(&mut histogram, change(point));
        }
    }
    target.judge(&histogram, bounds::MARGINAL)
}

/// What means are taken of: an integrand over one decision's points at one bounce.
const MEANS: [(&str, Decision, u16); 6] = [
    ("quarterdisk", Decision::Pixel, 0),
    ("triangle", Decision::Lens, 0),
    ("bilinear", Decision::LightPoint, 0),
    ("quartergaussian", Decision::Direction, 1),
    ("quarterdisk", Decision::LightPoint, 3),
    ("bilinear", Decision::Direction, 2),
];

/// Samples of a mean: not a power of two and not a square.
const OF_A_MEAN: u32 = 3000;

/// Replicates of a mean over points that are more even than independent ones, and over those.
const REPLICATES: [u64; 2] = [128, 192];

/// The claim that means over the sampler's points are the integrals.
fn mean(kind: SamplerKind) -> Claim {
    let (bound, replicates) = match kind {
        SamplerKind::Independent => (bounds::MEAN_INDEPENDENT, REPLICATES[1]),
        _ => (bounds::MEAN, REPLICATES[0]),
    };
    let tests = move || {
        MEANS.map(|(name, ..)| MeanClaim {
            replicates,
            ..MeanClaim::relative(integrand(name).integral(), bound)
        })
    };
    let right = move |i: usize, seed: u64| estimate(kind, MEANS[i], seed);
    let says = format!(
        "means over {} points are the integrals, for six integrands at several decisions and bounces",
        kind.name()
    );
    claim(format!("sampler/{}/mean", kind.name()), says)
        .rejects("2.2 × resolution", move |run| joint_control(&tests(), run, right))
        .rejects("one seed for all replicates", move |run| {
            let one = MEANS.map(|mean| estimate(kind, mean, run.seed));
            joint_evidence(&tests(), run, |i, _| one[i])
        })
        .by(move |run| joint_evidence(&tests(), run, right))
}

fn integrand(name: &str) -> Integrand {
    Integrand::named(name).expect("the integrands of this file are in the list")
}

/// One replicate's mean.
fn estimate(kind: SamplerKind, (name, decision, bounce): (&str, Decision, u16), seed: u64) -> f64 {
    let integrand = integrand(name);
    let planned = [Decision::Pixel, Decision::Lens, Decision::LightPoint];
    let planned = planned.into_iter().fold(DecisionSet::EMPTY, DecisionSet::with);
    let sampler = sampler(kind, seed, planned, OF_A_MEAN);
    let value = |index| {
        let sample = SampleId { pixel: [5, 9], replicate: 0, index };
        integrand.eval(sampler.draw_2d(sample, at(bounce), decision).map(f64::from))
    };
    (0..OF_A_MEAN).map(value).sum::<f64>() / f64::from(OF_A_MEAN)
}
