//! Numbers in [0, 1) from all 2³² words, at the exhaustive level; from a sample of them below it.

use verify::claim::{Evidence, Level, Run, claim};
use verify::error::InputError;
use verify::mean::CONTROL_FACTOR;

use super::Entry;
use super::arithmetic::{NAIVE, OURS, steps_off};
use super::routine::{ROUNDING, Routine, worst_case};
use super::tables;

/// The routine as its row of the table shows it, over drawn words.
const DRAWN: Routine<1, 1> = Routine {
    id: "unit-f32/every-bits",
    says: "",
    unit: "steps of 2⁻²⁴",
    bound: 0.5, // The value is exact: any other multiple is a whole step away.
    one: |_, _| [ROUNDING],
    table: tables::NONE,
    corners: &[[0.0], [4_294_967_295.0]],
    draw: |n| [(4_294_967_296.0 * n.unit()).floor()],
    draws: 4096,
    exact: |[word]| [(word / 256.0).floor() * ROUNDING],
    ours: |x| [f64::from(OURS(word(x)))],
    naive: ("all 32 bits over 2³²", |x| [f64::from(NAIVE(word(x)))]),
};

fn word([x]: &[f64; 1]) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a word")]
    let word = *x as u32;
    word
}

/// The claim, and the routine's row.
pub(super) fn entry() -> Entry {
    let perturbed: fn(u32) -> f32 =
        |bits| OURS(bits) + super::routine::single(CONTROL_FACTOR * 0.5 * ROUNDING);
    let says = "32 random bits become the multiple of 2⁻²⁴ at or below bits/2³², and never 1";
    let claim = claim(format!("stable/{}", DRAWN.id), says)
        .rejects("2.2 × bound", move |run| evidence(run, perturbed))
        .rejects(DRAWN.naive.0, |run| evidence(run, NAIVE))
        .by(|run| evidence(run, OURS));
    Entry { claim, row: Box::new(|| DRAWN.row()) }
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
