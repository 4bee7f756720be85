//! The parts of variance that `lightproof effects` prints, on an integrand whose parts are known.

use renderer::integrator::{Batch, Integrator};
use renderer::math::Rgb;
use renderer::sampling::{Decision, DecisionSet, Sampler, Vertex};
use renderer::scene::Scene;
use verify::claim::{Claim, Level, claim};
use verify::mean::{MeanClaim, joint_control, joint_evidence};

use super::scene;
use crate::bounds;
use crate::setup::built;
use crate::shares::total_effects;

/// Factors 1 + c·√12·(u − ½), of mean 1 and variance c², for each number of these decisions.
const FACTORS: [(Decision, [f64; 2]); 4] = [
    (Decision::Pixel, [0.2, 0.3]),
    (Decision::Time, [0.4, 0.0]),
    (Decision::LightPoint, [0.3, 0.2]),
    (Decision::Lobe, [0.3, 0.0]),
];

/// Sets of decisions to draw anew.
const SETS: [&[Decision]; 6] = [
    &[Decision::Pixel],
    &[Decision::Time],
    &[Decision::LightPoint],
    &[Decision::Lobe],
    &[Decision::Time, Decision::Lobe],
    &[Decision::Pixel, Decision::Time, Decision::LightPoint, Decision::Lobe],
];

/// Samples in a replicate: half squared differences spread by about twice their mean, and 256 · 1024 of them leave 0.4 %.
const SAMPLES: u32 = 1024;

/// The product of the factors, for light.
struct Product;

impl Integrator for Product {
    fn decisions(&self, _: &Scene) -> [DecisionSet; 2] {
        [DecisionSet::FULL, DecisionSet::EMPTY]
    }

    fn trace<S: Sampler>(&self, _: &Scene, sampler: &S, batch: &mut Batch) {
        for sample in &mut batch.samples {
            let numbers = |decision: Decision| match decision.dimensions() {
                1 => [sampler.draw_1d(sample.id, Vertex::default(), decision), 0.5],
                _ => sampler.draw_2d(sample.id, Vertex::default(), decision),
            };
            let factor = |c: f64, u: f32| 1.0 + c * 12.0_f64.sqrt() * (f64::from(u) - 0.5);
            let of = |&(decision, [a, b]): &(Decision, [f64; 2])| {
                let [u, v] = numbers(decision);
                factor(a, u) * factor(b, v)
            };
            #[expect(clippy::cast_possible_truncation, reason = "light is f32")]
            let value = FACTORS.iter().map(of).product::<f64>() as f32;
            sample.radiance = Rgb::splat(value);
        }
    }
}

/// Variance in which the decisions of `set` take part: (∏ₛ (1 + c²) − 1) · ∏ over the others of (1 + c²).
fn exact(set: &[Decision]) -> f64 {
    let power = |inside: bool| -> f64 {
        let chosen = FACTORS.iter().filter(|(decision, _)| set.contains(decision) == inside);
        chosen.flat_map(|(_, c)| c).map(|c| 1.0 + c * c).product()
    };
    (power(true) - 1.0) * power(false)
}

/// The claim.
pub(super) fn total_effect() -> Claim {
    let claims = SETS.map(|set| MeanClaim::relative(exact(set), bounds::TOTAL_EFFECT));
    claim(
        "effect/variance/total-effect",
        "half the mean squared change when decisions are drawn anew is the variance they take part in, of a product",
    )
    .bound(bounds::TOTAL_EFFECT)
    .rejects("2.2 × resolution", move |run| joint_control(&claims, run, part()))
    .rejects("the squared change not halved", move |run| {
        let part = part();
        joint_evidence(&claims, run, |k, seed| 2.0 * part(k, seed))
    })
    .by(move |run| joint_evidence(&claims, run, part()))
    .from_level(Level::Standard)
}

/// What one replicate finds for a set.
fn part() -> impl Fn(usize, u64) -> f64 {
    let scene = built(&scene());
    move |k, seed| {
        let redrawn = SETS[k].iter().fold(DecisionSet::EMPTY, |set, &d| set.with(d));
        total_effects(&scene, &Product, &[[redrawn; 2]], SAMPLES, seed)[0]
    }
}
