//! Single numbers fill the interval.

use std::sync::Arc;

use renderer::sampling::Generator;
use verify::chi_square::{ChiSquare, Target};
use verify::claim::{Claim, Evidence, Run, claim};
use verify::domain::Interval;
use verify::error::InputError;
use verify::mean::CONTROL_FACTOR;

use super::{Named, Start};
use crate::{bounds, wrong};

/// The claims that each generator's numbers are uniform on [0, 1).
pub(super) fn claims(all: [Named; 4]) -> Vec<Claim> {
    let lcg = all[0].1;
    all.map(|(name, start)| uniform(name, start, lcg)).into()
}

fn uniform(name: &str, start: Start, lcg: Start) -> Claim {
    let target = Arc::new(ChiSquare::on(Interval::unit()).density(|_| 1.0));
    let (control, gross) = (target.clone(), target.clone());
    let single = |generator: &mut Generator| f64::from(generator.next_f32());
    claim(format!("generator/{name}/uniform"), "numbers are uniform on [0, 1)")
        .rejects("lowest 8 bits of the linear congruential generator", move |run| {
            counted(&gross, run, lcg, |generator| wrong::lowest_8_bits(generator.next_u32()))
        })
        .rejects("u^(1+δ), 2.2 × resolution", move |run| {
            let resolution = control.resolution(control.sample_count(bounds::GENERATOR)? * run.effort)?;
            // the density of u^(1+δ) is off by δ·(−1 − ln u) to first order, RMS δ
            let exponent = 1.0 + CONTROL_FACTOR * resolution;
            counted(&control, run, start, |generator| single(generator).powf(exponent))
        })
        .by(move |run| counted(&target, run, start, single))
}

fn counted(
    target: &Target<Interval>,
    run: &Run,
    start: Start,
    draw: impl Fn(&mut Generator) -> f64,
) -> Result<Evidence, InputError> {
    let mut generator = start(run.seed);
    let mut histogram = target.histogram();
    for _ in 0..target.sample_count(bounds::GENERATOR)? * run.effort {
        target.add(&mut histogram, draw(&mut generator));
    }
    target.judge(&histogram, bounds::GENERATOR)
}
