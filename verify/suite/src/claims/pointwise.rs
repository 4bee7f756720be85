//! Claims that something is so at every point: a density is its closed form, an inverse undoes its map.

use std::sync::Arc;

use verify::claim::{Claim, ClaimBuilder, Evidence, Picture, Run};
use verify::error::InputError;
use verify::{points, share};

use crate::bounds;

/// Half a unit in the last place of single precision, 2⁻²⁴: the relative error of one rounding.
pub(super) const EPSILON: f64 = 1.0 / 16_777_216.0;

/// Completes a claim by trying uniform numbers, for none of which `misses` may be true.
pub(super) fn never<const N: usize>(
    builder: ClaimBuilder,
    quantity: &'static str,
    misses: impl Fn([f64; N]) -> bool + Send + Sync + 'static,
) -> Claim {
    builder.by(move |run| evidence(run, quantity, &misses, 1))
}

/// The same with a picture of it.
pub(super) fn never_drawn<const N: usize>(
    builder: ClaimBuilder,
    quantity: &'static str,
    misses: impl Fn([f64; N]) -> bool + Send + Sync + 'static,
    picture: impl Fn() -> Picture + Send + Sync + 'static,
) -> Claim {
    builder.by(move |run| Ok(Evidence { pictures: vec![picture()], ..evidence(run, quantity, &misses, 1)? }))
}

/// Intervals of a curve's abscissa between the places that are drawn.
const PLACES: u32 = 96;

/// A curve over the places of [0, 1].
///
/// * `at`: gives the abscissa, the exact value, the measured one, and what rounding may make of it, which is drawn as three standard errors;
///   `None` leaves a place out.
pub(super) fn curve(axes: [&'static str; 2], at: impl Fn(f64) -> Option<[f64; 4]>) -> Picture {
    let places = (0..=PLACES).filter_map(|i| at(f64::from(i) / f64::from(PLACES)));
    let (exact, measured) = places.map(|[x, exact, y, error]| ([x, exact], [x, y, error / 3.0])).unzip();
    Picture::Curve { axes, exact, measured }
}

/// How many points the rare form of a control is wrong at.
///
/// A share that is caught with 90 % power means ln 10 = 2.3 points; these are 17 times as many. A wrong version that misses at 40 % of its points
/// escapes all of them with probability 0.6⁴⁰ = 1e-9.
const RARE: u64 = 40;

/// Adds two controls to a claim that [`never`] completes: a wrong version, which misses, and a part that is that version at [`RARE`] points only.
pub(super) fn rejecting<const N: usize>(
    builder: ClaimBuilder,
    name: &'static str,
    misses: impl Fn([f64; N]) -> bool + Send + Sync + 'static,
) -> ClaimBuilder {
    let misses = Arc::new(misses);
    let rarely = misses.clone();
    rejecting_subtle(builder, name, move |u| misses(u))
        .rejects(format!("{name}, at {RARE} points"), move |run| {
            evidence(run, "share of points", &*rarely, trials(run)? / RARE)
        })
}

/// Adds a control that misses at few points by itself.
pub(super) fn rejecting_subtle<const N: usize>(
    builder: ClaimBuilder,
    name: &'static str,
    misses: impl Fn([f64; N]) -> bool + Send + Sync + 'static,
) -> ClaimBuilder {
    builder.rejects(name, move |run| evidence(run, "share of points", &misses, 1))
}

fn trials(run: &Run) -> Result<u64, InputError> {
    Ok(share::trials_for(bounds::MISSES)? * run.effort)
}

/// Tries every point whose index is a multiple of `every`; the others count as hits.
fn evidence<const N: usize>(
    run: &Run,
    quantity: &'static str,
    misses: impl Fn([f64; N]) -> bool,
    every: u64,
) -> Result<Evidence, InputError> {
    let trials = trials(run)?;
    let missed = |&index: &u64| {
        let mut u = [0.0; N];
        points::fill(run.seed, index, &mut u);
        misses(u)
    };
    let count = (0..trials).step_by(usize::try_from(every).unwrap_or(usize::MAX)).filter(missed).count();
    share::judge(quantity, u64::try_from(count).unwrap_or(u64::MAX), trials, bounds::MISSES)
}

/// A uniform number as the renderer's generators make it: a multiple of 2⁻²⁴ in [0, 1).
pub(super) fn single(u: f64) -> f32 {
    const STEPS: f64 = 16_777_216.0;
    #[expect(clippy::cast_possible_truncation, reason = "exact: 24 bits")]
    let rounded = ((u * STEPS).floor() / STEPS) as f32;
    rounded
}

/// Whether two pairs of numbers agree, each on the circle of circumference 1 (an angle of a full turn is one of 0).
pub(super) fn same_on_circle(a: [f32; 2], b: [f32; 2], tolerance: f32) -> bool {
    a.iter().zip(b).all(|(a, b)| {
        let distance = (a - b).abs();
        distance.min(1.0 - distance) <= tolerance
    })
}

/// Whether a density is its closed form, relative to it.
pub(super) fn same_density(measured: f32, closed_form: f64, tolerance: f64) -> bool {
    (f64::from(measured) - closed_form).abs() <= tolerance * closed_form
}
