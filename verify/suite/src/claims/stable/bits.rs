//! Numbers in [0, 1) from all 2³² words, at the exhaustive level; from a sample of them below it.

use verify::claim::{Claim, Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::mean::CONTROL_FACTOR;

use super::arithmetic::{NAIVE, OURS, steps_off};
use super::routine::{ROUNDING, worst_case};

pub(super) fn claims() -> Vec<Claim> {
    let perturbed: fn(u32) -> f32 =
        |bits| OURS(bits) + super::routine::single(CONTROL_FACTOR * 0.5 * ROUNDING);
    vec![
        claim(
            "stable/unit-f32/every-bits",
            "32 random bits become the multiple of 2⁻²⁴ at or below bits/2³², and never 1",
        )
        .rejects("2.2 × bound", move |run| evidence(run, perturbed))
        .rejects("all 32 bits over 2³²", |run| evidence(run, NAIVE))
        .by(|run| evidence(run, OURS)),
    ]
}

/// Every word where the effort allows it, else 2²⁰ of them, evenly, with the largest 1,000.
fn evidence(run: &Run, subject: fn(u32) -> f32) -> Result<Evidence, InputError> {
    let stride = if run.effort >= Level::Exhaustive.effort() { 1 } else { 4093 };
    let words = (0..=u32::MAX).step_by(stride).chain(u32::MAX - 1000..=u32::MAX);
    let (worst, count) =
        words.fold((0.0f64, 0u64), |(worst, count), bits| (worst.max(steps_off(bits, subject)), count + 1));
    // Half a step: every other multiple is a whole one away.
    Ok(worst_case("steps of 2⁻²⁴", worst, count, 0.5, None))
}
