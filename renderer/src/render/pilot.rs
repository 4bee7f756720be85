//! The first samples of each pixel decide how many its neighbours get.

use std::sync::Mutex;

use rayon::prelude::*;

use super::{Finish, Progress, RenderSettings};
use crate::error::ParamError;
use crate::film::{Allocation, Part, Pilot, Tile, allocation};
use crate::integrator::batch::Sample;
use crate::integrator::{Integrator, PathTracer};
use crate::sampling::{Independent, Pmj02, Sampler, SamplerKind};
use crate::scene::Scene;

/// One sample in this many is the pilot's, at least.
const SHARE: u32 = 4;

/// Parts of a pixel's first samples whose means show by their spread how well such points do there.
const GROUPS: usize = 4;

/// Least number of samples of a replicate, so that each group has one.
const FEWEST: u32 = 16;

/// Whether samples of that kind can be of any number, so that pixels can have different ones.
pub(super) fn serves(sampler: SamplerKind) -> bool {
    matches!(sampler, SamplerKind::Independent | SamplerKind::Sobol | SamplerKind::Pmj02)
}

pub(super) fn refused(samples: u32) -> ParamError {
    let accepted = "16 and more, of the samplers independent, sobol and pmj02,";
    let value = f64::from(samples);
    ParamError::OutOfRange { name: "samples of a pixel to be allocated by its error", value, accepted }
}

/// A part in which pixels have samples in proportion to the error that their neighbours' first samples show, and these first
/// samples, up to a quarter of all; for [`super::go_on`].
///
/// * `watch`: as there.
///
/// # Errors
/// As [`super::render`]; samplers that must know the number of samples, and fewer than 16 of them.
///
/// # Verified by
/// claim `relation/allocation/same-mean`
pub fn allocated(
    scene: &Scene,
    integrator: &PathTracer,
    settings: &RenderSettings,
    watch: &(dyn Fn(Progress) + Sync),
) -> Result<Part, ParamError> {
    settings.check()?;
    if settings.samples < FEWEST {
        return Err(refused(settings.samples));
    }
    let with = Finish { scene, integrator, settings, watch };
    match settings.sampler {
        SamplerKind::Independent => with.pilot(&Independent::new(settings.seed)),
        SamplerKind::Pmj02 => with.pilot(&Pmj02::new(settings.seed)),
        SamplerKind::Sobol => with.pilot(&with.sobol()),
        SamplerKind::Stratified | SamplerKind::MultiJitter | SamplerKind::Halton => {
            Err(refused(settings.samples))
        }
    }
}

/// What the pilot finds of a tile, pixel by pixel.
#[derive(Clone, Default)]
struct Found {
    largest: Vec<f64>,
    variances: Vec<f64>,
}

impl<I: Integrator> Finish<'_, I> {
    fn pilot<S: Sampler>(&self, sampler: &S) -> Result<Part, ParamError> {
        let (film, replicates) = ([self.scene.film.width, self.scene.film.height], self.settings.replicates);
        let count = 1 << (self.settings.samples / SHARE).ilog2();
        let part = Part::new(film, replicates, [0, count]);
        let (empty, tiles) = (part.emptied(), Tile::all(film));
        let part = Mutex::new(part);
        let work = || {
            // As in the render itself, each tile can be taken by another thread.
            let each = tiles.par_iter().with_max_len(1).enumerate();
            each.map(|(index, tile)| self.pilot_tile(sampler, &empty, (index, tile), &part))
                .collect::<Vec<_>>()
        };
        let found = self.settings.on_threads(work)?;
        let mut variances = vec![0.0; film[0] as usize * film[1] as usize];
        for (tile, found) in tiles.iter().zip(&found) {
            for ([x, y], variance) in tile.pixels().zip(&found.variances) {
                variances[y as usize * film[0] as usize + x as usize] = *variance;
            }
        }
        let samples = self.settings.samples;
        let counts = self.settings.on_threads(|| allocation::by_error(film, &variances, count, samples))?;
        let part = part.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        let pilot = Pilot { part, largest: found.into_iter().map(|tile| tile.largest).collect() };
        Part::allocated(film, replicates, samples, Allocation { counts, pilot: Some(pilot) })
    }

    /// Puts a tile of the pilot into `part`.
    fn pilot_tile<S: Sampler>(
        &self,
        sampler: &S,
        empty: &Part,
        (index, tile): (usize, &Tile),
        part: &Mutex<Part>,
    ) -> Found {
        let mut begun = empty.begun(index, tile);
        let size = empty.range[1] as usize / GROUPS;
        let group = |sample: &Sample| (sample.id.replicate as usize, sample.id.index as usize / size);
        let mut groups = vec![vec![[[0.0; 3]; GROUPS]; self.settings.replicates as usize]; begun.sums.len()];
        self.tile(
            sampler,
            tile,
            |_| empty.range,
            &mut begun,
            |run| {
                let groups = &mut groups[tile.place(self.scene.film.in_image(run[0].id.pixel))];
                for sample in run {
                    let (replicate, group) = group(sample);
                    let value = sample.weighted().to_array().map(f64::from);
                    groups[replicate][group].iter_mut().zip(value).for_each(|(sum, value)| *sum += value);
                }
            },
        );
        let sums = self.finished(empty, tile, &begun);
        let variances = groups.iter().map(|pixel| pixel.iter().map(spread).sum()).collect();
        let mut part = part.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        part.finish(index, sums);
        (self.watch)(Progress::Pilot(part.share()));
        Found { largest: begun.largest, variances }
    }
}

/// The squared deviations of groups from their mean, summed over channels.
fn spread(groups: &[[f64; 3]; GROUPS]) -> f64 {
    let of_channel = |channel: usize| {
        let mean = groups.iter().map(|group| group[channel]).sum::<f64>() / GROUPS as f64;
        groups.iter().map(|group| (group[channel] - mean).powi(2)).sum::<f64>()
    };
    (0..3).map(of_channel).sum()
}
