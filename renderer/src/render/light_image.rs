//! What paths from lights bring to the pixels of an image.

use rayon::prelude::*;

use super::{Finish, Progress};
use crate::integrator::light_paths::{LightPaths, PER_SAMPLE, Splat};
use crate::integrator::{Batch, Integrator};
use crate::lights::Emission;
use crate::sampling::Sampler;

/// Paths that travel together.
const TOGETHER: u64 = 1024;

/// Batches whose results are kept until they are added, in their order.
const KEPT: u64 = 256;

/// Paths with numbers of one set.
const SET: u64 = 1 << 20;

/// Memory that a pixel takes for each replicate.
pub const BYTES: u64 = size_of::<[f64; 3]>() as u64;

/// The light that each pixel gets, replicate by replicate.
#[derive(Debug)]
pub(super) struct LightImage {
    width: usize,
    /// Mean radiance [W m⁻² sr⁻¹] of the pixels, row by row.
    replicates: Vec<Vec<[f64; 3]>>,
    /// Largest absolute value of a path's light, the mean of its channels, as that of a sample.
    pub(super) largest: f64,
    /// Paths left out because their light was not finite.
    pub(super) dropped: u64,
}

impl LightImage {
    /// What a pixel of the image gets.
    pub(super) fn at(&self, replicate: u32, [x, y]: [u32; 2]) -> [f64; 3] {
        self.replicates[replicate as usize][y as usize * self.width + x as usize]
    }
}

impl<I: Integrator> Finish<'_, I> {
    /// The light of paths from lights, in each replicate as many for each sample of a pixel of the whole film as [`PER_SAMPLE`] says.
    pub(super) fn light_image<S: Sampler>(&self, emission: &Emission, sampler: &S) -> LightImage {
        let film = &self.scene.film;
        let samples = film.whole.map(u64::from).iter().product::<u64>() * u64::from(self.settings.samples);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of paths")]
        let count = (samples as f64 * f64::from(PER_SAMPLE)).ceil() as u64;
        let mut image =
            LightImage { width: film.width as usize, replicates: Vec::new(), largest: 0.0, dropped: 0 };
        let paths = LightPaths { scene: self.scene, emission, sampler };
        let (replicates, batches) = (self.settings.replicates, count.div_ceil(TOGETHER));
        for replicate in 0..replicates {
            let mut sums = vec![[0.0; 3]; image.width * film.height as usize];
            for kept in (0..batches.div_ceil(KEPT)).map(|k| k * KEPT..batches.min((k + 1) * KEPT)) {
                let trace = |batch: &mut Batch, index: u64| {
                    let (start, end) = (index * TOGETHER, count.min((index + 1) * TOGETHER));
                    #[expect(
                        clippy::cast_possible_truncation,
                        reason = "places in a set, and fewer than 2³² sets"
                    )]
                    let [set, first, last] =
                        [start / SET, start % SET, start % SET + (end - start)].map(|n| n as u32);
                    batch.dropped = 0;
                    (paths.trace(replicate, set, first..last, batch), batch.dropped)
                };
                let followed = kept.end as f64 / batches as f64;
                let found: Vec<(Vec<Splat>, u64)> =
                    kept.into_par_iter().map_init(Batch::default, trace).collect();
                image.dropped += found.iter().map(|(_, dropped)| dropped).sum::<u64>();
                for splat in found.iter().flat_map(|(splats, _)| splats) {
                    let value = splat.value.to_array().map(|v| f64::from(v) / count as f64);
                    film.splat(splat.position, |[x, y], share| {
                        let sum = &mut sums[y as usize * image.width + x as usize];
                        sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += value * share);
                        let of_sample =
                            value.iter().sum::<f64>() / 3.0 * f64::from(self.settings.samples) * share;
                        image.largest = image.largest.max(of_sample.abs());
                    });
                }
                (self.watch)(Progress::LightPaths((f64::from(replicate) + followed) / f64::from(replicates)));
            }
            image.replicates.push(sums);
        }
        image
    }
}
