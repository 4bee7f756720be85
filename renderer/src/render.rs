//! Rank 9: a scene, an integrator and a sampler become an image, tile by tile on all cores.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::error::ParamError;
use crate::film::estimate::values;
use crate::film::{Part, PixelEstimate, PixelSum, Reconstruction, Tile, TileSums};
use crate::integrator::batch::Sample;
use crate::integrator::{Batch, Integrator, PathTracer};
use crate::math::Rgb;
use crate::sampling::{
    Halton, Independent, MultiJitter, Pmj02, SampleId, Sampler, SamplerKind, Sobol, Stratified,
};
use crate::scene::Scene;

/// Samples that travel together: few enough for the lists of all stages to stay in a core's own cache.
const BATCH: usize = 512;

/// How much work is done, and from which seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RenderSettings {
    /// Where numbers come from.
    pub sampler: SamplerKind,
    /// Samples per pixel and replicate, at least 1.
    pub samples: u32,
    /// Independent randomisations, at least 1; with fewer than 2 the image has no error.
    pub replicates: u32,
    /// Seed of every number.
    pub seed: u64,
    /// Threads of its own; 0 to work in the pool that it is called from, by default one thread a core. The result
    /// is the same for any.
    pub threads: usize,
}

impl RenderSettings {
    /// `spp` samples a pixel in `replicates` equal parts: as many parts as fit, each of ⌈spp / parts⌉ samples.
    pub fn split(spp: u32, replicates: u32) -> [u32; 2] {
        let replicates = replicates.clamp(1, spp.max(1));
        [spp.max(1).div_ceil(replicates), replicates]
    }

    /// An empty part of all the samples of `scene`'s film.
    pub fn whole(&self, scene: &Scene) -> Part {
        Part::new([scene.film.width, scene.film.height], self.replicates, [0, self.samples])
    }

    fn check(&self) -> Result<(), ParamError> {
        for (name, value) in
            [("the number of samples", self.samples), ("the number of replicates", self.replicates)]
        {
            if value == 0 {
                return Err(ParamError::OutOfRange { name, value: 0.0, accepted: "a number of at least 1" });
            }
        }
        Ok(())
    }
}

/// An image with its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendering {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pixels, row by row from the top.
    pub pixels: Vec<PixelEstimate>,
    /// Largest share that one sample has in the sum of the whole image.
    pub largest_share: f64,
    /// Contributions left out because they were not finite.
    pub dropped: u64,
}

impl Rendering {
    /// The image of `part`; tiles that are missing are black.
    pub fn of(part: &Part, reconstruction: Reconstruction) -> Self {
        let pixels = part.estimates(reconstruction);
        let per_pixel = f64::from(part.range[1] - part.range[0]) * f64::from(part.replicates);
        let sum: f64 = pixels.iter().map(|p| p.mean.iter().sum::<f64>() / 3.0).sum::<f64>() * per_pixel;
        let largest_share = if sum > 0.0 { part.largest() / sum } else { 0.0 };
        let [width, height] = part.size;
        Self { width, height, pixels, largest_share, dropped: part.dropped() }
    }
}

/// Renders `scene`.
///
/// * `progress`: called with the share of the work that is done, from any thread.
///
/// # Errors
/// Samples or replicates of 0, or a number of threads that the system refuses.
pub fn render(
    scene: &Scene,
    integrator: &PathTracer,
    settings: &RenderSettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Rendering, ParamError> {
    let part = go_on(scene, integrator, settings, settings.whole(scene), &|part| progress(part.share()))?;
    Ok(Rendering::of(&part, scene.film.reconstruction))
}

/// Renders `scene` with numbers from any `sampler`; the settings' own kind and seed are not looked at.
///
/// # Errors
/// As [`render`].
pub fn render_with<I: Integrator, S: Sampler>(
    scene: &Scene,
    integrator: &I,
    sampler: &S,
    settings: &RenderSettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Rendering, ParamError> {
    settings.check()?;
    let with = Finish { scene, integrator, settings, watch: &|part| progress(part.share()) };
    let part = with.sampler(sampler, settings.whole(scene))?;
    Ok(Rendering::of(&part, scene.film.reconstruction))
}

/// Renders the tiles that `part` misses, each for the part's range of samples.
///
/// * `watch`: called with all that is finished after each tile, from any thread; nothing else is entered meanwhile.
///
/// # Errors
/// As [`render`]; and a part of another film, other replicates, or samples beyond the settings'.
pub fn go_on(
    scene: &Scene,
    integrator: &PathTracer,
    settings: &RenderSettings,
    part: Part,
    watch: &(dyn Fn(&Part) + Sync),
) -> Result<Part, ParamError> {
    settings.check()?;
    let film = [scene.film.width, scene.film.height];
    if part.size != film || part.replicates != settings.replicates || part.range[1] > settings.samples {
        return Err(ParamError::OutOfRange {
            name: "the last sample of the part",
            value: f64::from(part.range[1]),
            accepted: "a part of the same film, with as many replicates, of samples that the settings have",
        });
    }
    let [first, _] = integrator.decisions(scene);
    let (seed, samples) = (settings.seed, settings.samples);
    let with = Finish { scene, integrator, settings, watch };
    match settings.sampler {
        SamplerKind::Independent => with.sampler(&Independent::new(seed), part),
        SamplerKind::Stratified => with.sampler(&Stratified::new(seed, samples), part),
        SamplerKind::MultiJitter => with.sampler(&MultiJitter::new(seed, samples), part),
        SamplerKind::Halton => with.sampler(&Halton::new(seed, first, samples), part),
        SamplerKind::Pmj02 => with.sampler(&Pmj02::new(seed), part),
        SamplerKind::Sobol => with.sampler(&Sobol::new(seed, first), part),
    }
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, ParamError> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|_| ParamError::OutOfRange {
        name: "the number of threads",
        value: threads as f64,
        accepted: "a number that the system can start",
    })
}

/// How the tiles that a part misses are rendered.
struct Finish<'a, I> {
    scene: &'a Scene,
    integrator: &'a I,
    settings: &'a RenderSettings,
    watch: &'a (dyn Fn(&Part) + Sync),
}

impl<I: Integrator> Finish<'_, I> {
    /// The part with its missing tiles, with numbers from `sampler`.
    fn sampler<S: Sampler>(&self, sampler: &S, part: Part) -> Result<Part, ParamError> {
        let range = part.range;
        let missing: Vec<(usize, Tile)> = Tile::all(part.size)
            .into_iter()
            .enumerate()
            .filter(|(index, _)| part.tiles()[*index].is_none())
            .collect();
        let part = Mutex::new(part);
        let work = || {
            missing.par_iter().for_each(|(index, tile)| {
                let sums = self.tile(sampler, tile, range);
                let mut part = part.lock().unwrap_or_else(PoisonError::into_inner);
                part.finish(*index, sums);
                (self.watch)(&part);
            });
        };
        if self.settings.threads == 0 {
            work();
        } else {
            pool(self.settings.threads)?.install(work);
        }
        Ok(part.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// The samples `start` to `end` − 1 of each pixel and replicate of a tile.
    fn tile<S: Sampler>(&self, sampler: &S, tile: &Tile, [start, end]: [u32; 2]) -> TileSums {
        let replicates = self.settings.replicates;
        let mut sums = vec![PixelSum::starting_at(replicates, start); tile.pixels().count()];
        let of_pixel = |pixel: [u32; 2]| {
            (0..replicates).flat_map(move |replicate| {
                (start..end).map(move |index| SampleId { pixel, replicate, index })
            })
        };
        let mut ids = tile.pixels().flat_map(of_pixel);
        let mut batch = Batch::default();
        let mut summed = Vec::new();
        let mut largest = 0.0f32;
        loop {
            batch.refill(ids.by_ref().take(BATCH));
            if batch.samples.is_empty() {
                break;
            }
            self.integrator.trace(self.scene, sampler, &mut batch);
            let of_one_sum =
                |a: &Sample, b: &Sample| (a.id.pixel, a.id.replicate) == (b.id.pixel, b.id.replicate);
            for run in batch.samples.chunk_by(of_one_sum) {
                summed.clear();
                for sample in run {
                    let mut weighted = sample.radiance * sample.weight;
                    if !weighted.is_finite() {
                        batch.dropped += 1;
                        weighted = Rgb::BLACK;
                    }
                    summed.push(values(weighted, sample.weight));
                    // Their mean; the sum of all three may be more than f32 holds.
                    largest = largest.max((weighted / 3.0).to_array().iter().sum::<f32>().abs());
                }
                let id = run[0].id;
                sums[tile.place(id.pixel)].extend(id.replicate, &summed);
            }
        }
        TileSums::new(&sums, f64::from(largest), batch.dropped)
    }
}
