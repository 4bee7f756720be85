//! Generators: successive numbers and streams of neighbouring seeds fill the unit square, and 1 never comes out.

use std::sync::Arc;

mod complexity;
mod interval;

use renderer::math::float::unit_f32;
use renderer::sampling::generators::Generator;
use verify::chi_square::{ChiSquare, Target};
use verify::claim::{Claim, Run, claim};
use verify::domain::Parallelogram;

use super::pointwise::{never, rejecting};
use crate::{bounds, wrong};

/// Pairs of numbers in a run: what settles [`bounds::DISTRIBUTION`] on the unit square's 196 cells, 2.09e6, and a little more.
const PAIRS: u64 = 2_200_000;

/// Pairs of streams in a run: what settles [`bounds::RECORDED`], 5.3e5, and a little more.
const STREAMS: u64 = 550_000;

/// Exponent of the control: u^1.02 has an RMS relative error of 2 % (the density's relative error is −δ(1 + ln u), whose variance is δ²), which
/// is 2.8 times the resolution of [`PAIRS`].
const EXPONENT: f64 = 1.02;

/// Starts a generator from a run's seed.
type Start = fn(u64) -> Generator;

/// A generator's name and its start.
type Named = (&'static str, Start);

/// The claims of the group.
pub(super) fn claims() -> Vec<Claim> {
    let all: [Named; 4] = [
        ("lcg", |seed| Generator::lcg(low_word(seed))),
        ("mersenne-twister", |seed| Generator::mersenne_twister(low_word(seed))),
        ("pcg", Generator::pcg),
        ("xoshiro", Generator::xoshiro),
    ];
    let mut list = vec![below_one()];
    list.extend(all.iter().map(|&(name, start)| pairs(name, start)));
    // The Mersenne Twister's 624 words of state make a million streams too dear.
    list.extend(all[2..].iter().map(|&(name, start)| streams(name, start)));
    list.extend(interval::claims(all));
    list.extend(complexity::claims(all));
    list
}

fn low_word(seed: u64) -> u32 {
    #[expect(clippy::cast_possible_truncation, reason = "the lower half of a seed is a seed")]
    let word = seed as u32;
    word
}

fn square() -> Arc<Target<Parallelogram<2>>> {
    Arc::new(ChiSquare::on(Parallelogram::unit_square()))
}

/// Counts pairs of numbers and tests them for uniformity.
fn uniform(
    target: &Target<Parallelogram<2>>,
    pairs: impl Iterator<Item = [f64; 2]>,
    bound: f64,
) -> Result<verify::claim::Evidence, verify::error::InputError> {
    let mut histogram = target.histogram();
    pairs.for_each(|pair| target.add(&mut histogram, pair));
    target.judge(&histogram, bound)
}

fn pairs(name: &str, start: Start) -> Claim {
    let target = square();
    let test = move |run: &Run, next: &dyn Fn(&mut Generator) -> f64| {
        let mut generator = start(run.seed);
        let pairs = (0..PAIRS * run.effort).map(|_| [next(&mut generator), next(&mut generator)]);
        uniform(&target, pairs, bounds::DISTRIBUTION)
    };
    let [powers, subject] = [test.clone(), test];
    let low_bits = {
        let target = square();
        move |run: &Run| {
            let mut generator = Generator::lcg(low_word(run.seed));
            let mut next = || wrong::lowest_16_bits(generator.next_u32());
            uniform(&target, (0..PAIRS * run.effort).map(|_| [next(), next()]), bounds::DISTRIBUTION)
        }
    };
    claim(format!("generator/{name}/pairs"), "pairs of successive numbers are uniform on the unit square")
        .rejects("lowest 16 bits of the linear congruential generator", low_bits)
        .rejects("u^1.02", move |run| powers(run, &|g| f64::from(g.next_f32()).powf(EXPONENT)))
        .by(move |run| subject(run, &|g| f64::from(g.next_f32())))
}

fn streams(name: &str, start: Start) -> Claim {
    let test = |run: &Run, start: Start, target: &Target<Parallelogram<2>>| {
        let first = |seed: u64| f64::from(start(seed).next_f32());
        let pair = |k: u64| [first(run.seed.wrapping_add(2 * k)), first(run.seed.wrapping_add(2 * k + 1))];
        uniform(target, (0..STREAMS * run.effort).map(pair), bounds::RECORDED)
    };
    let (target, control) = (square(), square());
    claim(
        format!("generator/{name}/seeds"),
        "first numbers of streams with neighbouring seeds are independent and uniform",
    )
    .rejects("streams of the linear congruential generator", move |run| {
        test(run, |seed| Generator::lcg(low_word(seed)), &control)
    })
    .by(move |run| test(run, start, &target))
}

/// Words near the largest one as well as any: the former are those that rounding could take to 1.
fn below_one() -> Claim {
    let is_outside = |[near, any]: [f64; 2], unit: fn(u32) -> f32| {
        let word = |u: f64, count: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "u is below 1")]
            let word = (u * count) as u32;
            word
        };
        let inside = |x: f32| (0.0..1.0).contains(&x);
        !inside(unit(u32::MAX - word(near, 1024.0))) || !inside(unit(word(any, 4_294_967_296.0)))
    };
    let builder = claim("generator/unit/below-one", "words map to numbers in [0, 1); 1 never comes out");
    let builder =
        rejecting(builder, "word / 2³² rounded to nearest", move |u| is_outside(u, wrong::unit_rounded));
    never(builder, "share of words outside [0, 1)", move |u| is_outside(u, unit_f32))
}
