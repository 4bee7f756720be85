//! What random decisions do to the variance of an image: redraw one, keep the rest.

use rayon::prelude::*;
use renderer::film::Film;
use renderer::integrator::{Batch, Integrator};
use renderer::math::Rgb;
use renderer::sampling::{Decision, DecisionSet, Independent, Redrawn, SampleId, Sampler, Vertex};
use renderer::scene::Scene;
use verify::seeds::derive;

/// Independent replicates, from whose spread the limits come.
pub const REPLICATES: u64 = 32;

/// Student's t for 31 degrees of freedom at 95 %.
const T: f64 = 2.0395;

/// Samples that travel together.
const BATCH: u32 = 512;

/// Every decision at every bounce.
const ALL: [DecisionSet; 2] = [DecisionSet::FULL; 2];

/// A share with its 95 % limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// The share.
    pub value: f64,
    /// The limits.
    pub interval: [f64; 2],
}

/// Half the mean squared change of single samples' values when each set of decisions is drawn anew: the variance that
/// these decisions take part in, alone and together with others, averaged over the image's pixels and channels.
///
/// A sample of each of `samples` pixels chosen at random; all numbers are independent.
///
/// * `redraws`: which decisions, at bounce 0 and at later ones.
///
/// # Source
/// Jansen 1999, "Analysis of variance designs for model output", doi 10.1016/S0010-4655(98)00154-4.
///
/// # Verified by
/// Claim `effect/variance/total-effect`
pub fn total_effects<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    redraws: &[[DecisionSet; 2]],
    samples: u32,
    seed: u64,
) -> Vec<f64> {
    let (kept, fresh) = (Independent::new(derive(seed, 0, 0)), Independent::new(derive(seed, 0, 1)));
    let mut batch = Batch::default();
    let mut sums = vec![0.0; redraws.len()];
    for start in (0..samples).step_by(BATCH as usize) {
        let ids: Vec<SampleId> =
            (start..samples.min(start + BATCH)).map(|i| place(&kept, &scene.film, i)).collect();
        let before = values(scene, integrator, &kept, &ids, &mut batch);
        for (sum, &decisions) in sums.iter_mut().zip(redraws) {
            let redrawn = Redrawn::new(kept, fresh, decisions);
            let after = values(scene, integrator, &redrawn, &ids, &mut batch);
            *sum += before.iter().zip(&after).map(|(a, b)| half_square(*a, *b)).sum::<f64>();
        }
    }
    sums.into_iter().map(|sum| sum / f64::from(samples)).collect()
}

/// Sample `index`, in a pixel chosen by numbers of a vertex that no path has.
fn place(sampler: &Independent, film: &Film, index: u32) -> SampleId {
    let nowhere = Vertex { bounce: u16::MAX, split: u16::MAX, branch: u32::MAX };
    let id = SampleId { pixel: [0, 0], replicate: 0, index };
    let [u, v] = sampler.draw_2d(id, nowhere, Decision::Pixel);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "u·n lies in [0, n)")]
    let at = |u: f32, n: u32| ((f64::from(u) * f64::from(n)) as u32).min(n - 1);
    SampleId { pixel: film.pixel([at(u, film.width), at(v, film.height)]), ..id }
}

fn values<I: Integrator, S: Sampler>(
    scene: &Scene,
    integrator: &I,
    sampler: &S,
    ids: &[SampleId],
    batch: &mut Batch,
) -> Vec<Rgb> {
    batch.clear();
    batch.extend((0..).zip(ids.iter().copied()));
    integrator.trace(scene, sampler, batch);
    batch.samples.iter().map(|s| s.radiance * s.weight).collect()
}

/// Half the squared difference, averaged over channels.
fn half_square(a: Rgb, b: Rgb) -> f64 {
    let square = |(a, b): (f32, f32)| (f64::from(a) - f64::from(b)).powi(2);
    a.to_array().into_iter().zip(b.to_array()).map(square).sum::<f64>() / 6.0
}

/// The shares of the variance that sets of decisions take part in.
///
/// Shares of decisions that act together count for each, so that all of them may add up to more than 1.
///
/// * `samples`: of each of [`REPLICATES`] replicates.
///
/// Returns: `None` for an image without variance.
pub fn variance_shares<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    redraws: &[[DecisionSet; 2]],
    samples: u32,
    seed: u64,
) -> Option<Vec<Share>> {
    let all: Vec<[DecisionSet; 2]> = redraws.iter().copied().chain([ALL]).collect();
    let replicate = |r: u64| total_effects(scene, integrator, &all, samples, derive(seed, 1, r));
    let replicates: Vec<Vec<f64>> = (0..REPLICATES).into_par_iter().map(replicate).collect();
    let whole: Vec<f64> = replicates.iter().map(|r| r[redraws.len()]).collect();
    let part = |k: usize| replicates.iter().map(|r| r[k]).collect::<Vec<f64>>();
    (whole.iter().sum::<f64>() > 0.0).then(|| (0..redraws.len()).map(|k| ratio(&part(k), &whole)).collect())
}

/// The ratio of two means with its limits: to first order the ratio's error is that of the mean of part − ratio · whole.
fn ratio(part: &[f64], whole: &[f64]) -> Share {
    let n = part.len() as f64;
    let total: f64 = whole.iter().sum();
    let value = part.iter().sum::<f64>() / total;
    let squares: f64 = part.iter().zip(whole).map(|(p, w)| (p - value * w).powi(2)).sum();
    let half_width = T * (squares * n / (n - 1.0)).sqrt() / total;
    Share { value, interval: [value - half_width, value + half_width] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_and_its_limits() {
        let whole = [2.0; 32];
        let part: Vec<f64> = (0..32).map(|i| if i % 2 == 0 { 0.8 } else { 1.2 }).collect();
        let share = ratio(&part, &whole);
        assert!((share.value - 0.5).abs() < 1e-15); // roundings of numbers near 1
        // The standard error of ±0.2 over 32 is 0.2/√31, and the whole is 2.
        let half_width = T * 0.2 / 31.0_f64.sqrt() / 2.0;
        assert!((share.interval[1] - share.value - half_width).abs() < 1e-15);
    }
}
