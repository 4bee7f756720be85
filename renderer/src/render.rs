//! Rank 9: a scene, an integrator and a sampler become an image, tile by tile on all cores.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::error::ParamError;
use crate::film::estimate::values;
use crate::film::{Begun, Part, PixelEstimate, PixelSum, Reconstruction, Tile, TileSums};
use crate::integrator::batch::Sample;
use crate::integrator::{Batch, Integrator, PathTracer, reuse};
use crate::sampling::{
    Halton, Independent, MultiJitter, Pmj02, SampleId, Sampler, SamplerKind, Sobol, Stratified,
};
use crate::scene::Scene;
use light_image::LightImage;

pub mod light_image;
pub mod pilot;

/// Samples that travel together: few enough for the lists of all stages to stay in a core's own cache.
const BATCH: u32 = 512;

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

    /// Does `work` on the threads that are asked for.
    fn on_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, ParamError> {
        if self.threads == 0 {
            return Ok(work());
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build();
        let refused = ParamError::OutOfRange {
            name: "the number of threads",
            value: self.threads as f64,
            accepted: "a number that the system can start",
        };
        Ok(pool.map_err(|_| refused)?.install(work))
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

/// How far a render is; it goes through these in their order.
#[derive(Debug, Clone, Copy)]
pub enum Progress<'a> {
    /// The share of the first samples that are taken, where they decide how many each pixel gets.
    Pilot(f64),
    /// The share of the paths from lights that are followed.
    LightPaths(f64),
    /// All that is finished of the image, after each tile.
    Image(&'a Part),
}

impl Progress<'_> {
    /// Tells the share of the image that is finished.
    fn tell_share(self, progress: &(dyn Fn(f64) + Sync)) {
        if let Progress::Image(part) = self {
            progress(part.share());
        }
    }
}

/// Renders `scene`.
///
/// * `progress`: called with the share of the image that is finished, from any thread.
///
/// # Errors
/// Samples or replicates of 0, or a number of threads that the system refuses.
pub fn render(
    scene: &Scene,
    integrator: &PathTracer,
    settings: &RenderSettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Rendering, ParamError> {
    let watch = |found: Progress| found.tell_share(progress);
    let part = go_on(scene, integrator, settings, settings.whole(scene), &watch)?;
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
    let with = Finish { scene, integrator, settings, watch: &|found| found.tell_share(progress) };
    let part = with.sampler(sampler, settings.whole(scene))?;
    Ok(Rendering::of(&part, scene.film.reconstruction))
}

/// Renders the tiles that `part` misses, each for the part's range of samples.
///
/// * `watch`: called from any thread; nothing else is entered meanwhile.
///
/// # Errors
/// As [`render`]; a part of another film, other replicates, or samples beyond the settings'; one with numbers of
/// samples by pixel where the sampler must know one for all; and with paths from lights such a sampler or a part of the samples.
pub fn go_on(
    scene: &Scene,
    integrator: &PathTracer,
    settings: &RenderSettings,
    part: Part,
    watch: &(dyn Fn(Progress) + Sync),
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
    if scene.emission.is_some() && !(part.range == [0, settings.samples] && pilot::serves(settings.sampler)) {
        return Err(ParamError::OutOfRange {
            name: "the number of samples beside paths from lights",
            value: f64::from(part.range[1] - part.range[0]),
            accepted: "that of the whole render, of the samplers independent, sobol and pmj02,",
        });
    }
    if part.counts().is_some() && !pilot::serves(settings.sampler) {
        return Err(pilot::refused(0));
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
        SamplerKind::Sobol => with.sampler(&with.sobol(), part),
    }
}

/// The indices of a pixel's samples, from the first to before the second.
#[derive(Debug, Clone, Copy)]
struct Indices {
    pixel: [u32; 2],
    range: [u32; 2],
}

/// Samples of a group of pixels whose indices lie in a range.
struct Unit<'a> {
    group: &'a [Indices],
    replicate: u32,
    indices: [u32; 2],
}

impl Unit<'_> {
    /// Their sets, of those with the same index, numbered from `first` on, and their names; pixel by pixel.
    fn ids(&self, first: u32) -> impl Iterator<Item = (u32, SampleId)> {
        let name = |pixel, index| SampleId { pixel, replicate: self.replicate, index };
        let of_pixel = move |of: &Indices| {
            let pixel = of.pixel;
            self.of(of).map(move |index| (first + index - self.indices[0], name(pixel, index)))
        };
        self.group.iter().flat_map(of_pixel)
    }

    /// How many sets these are.
    fn sets(&self) -> u32 {
        self.indices[1] - self.indices[0]
    }

    /// The indices that are there of a pixel.
    fn of(&self, of: &Indices) -> Range<u32> {
        let ([a, b], [start, end]) = (self.indices, of.range);
        a.max(start)..b.min(end)
    }

    /// How many samples these are.
    fn len(&self) -> usize {
        self.group.iter().map(|of| self.of(of).len()).sum()
    }
}

/// How the tiles that a part misses are rendered.
struct Finish<'a, I> {
    scene: &'a Scene,
    integrator: &'a I,
    settings: &'a RenderSettings,
    watch: &'a (dyn Fn(Progress) + Sync),
}

impl<I: Integrator> Finish<'_, I> {
    /// The Sobol points of all of the render, and of its pilot, whose samples are its first.
    fn sobol(&self) -> Sobol {
        let [first, later] = self.integrator.decisions(self.scene);
        Sobol::new(self.settings.seed, first).with_second_hit(later)
    }

    /// The part with its missing tiles, with numbers from `sampler`.
    fn sampler<S: Sampler>(&self, sampler: &S, part: Part) -> Result<Part, ParamError> {
        let empty = part.emptied();
        let missing: Vec<(usize, Tile)> = Tile::all(part.size)
            .into_iter()
            .enumerate()
            .filter(|(index, _)| part.tiles()[*index].is_none())
            .collect();
        let part = Mutex::new(part);
        let work = || {
            let emission = self.scene.emission.as_ref().filter(|_| !missing.is_empty());
            let light = emission.map(|emission| self.light_image(emission, sampler));
            // Each tile can be taken by another thread: the last ones are shared, too.
            missing.par_iter().with_max_len(1).for_each(|(index, tile)| {
                let mut begun = empty.begun(*index, tile);
                let next = begun.next;
                let range_of = |pixel| [next, empty.range_of(pixel)[1]];
                self.tile(sampler, tile, range_of, &mut begun, |_| ());
                if let Some(light) = &light {
                    self.brighten(tile, &mut begun.sums, light);
                }
                let mut sums = self.finished(&empty, tile, &begun);
                if let (0, Some(light)) = (index, &light) {
                    // The first tile tells of all of these paths.
                    sums.dropped += light.dropped;
                    sums.largest = sums.largest.max(light.largest);
                }
                let mut part = part.lock().unwrap_or_else(PoisonError::into_inner);
                part.finish(*index, sums);
                (self.watch)(Progress::Image(&part));
            });
        };
        self.settings.on_threads(work)?;
        Ok(part.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// A tile's sums as a part holds them; a sample counts in inverse proportion to its pixel's number of samples.
    fn finished(&self, part: &Part, tile: &Tile, begun: &Begun) -> TileSums {
        let mean = f64::from(self.settings.samples);
        let share = |pixel| part.counts().map_or(1.0, |_| mean / f64::from(part.range_of(pixel)[1]));
        let shares = tile.pixels().zip(&begun.largest).map(|(pixel, largest)| largest * share(pixel));
        TileSums::new(&begun.sums, shares.fold(0.0, f64::max), begun.dropped)
    }

    /// Adds what paths from lights bring to the pixels of a tile whose samples are all there.
    fn brighten(&self, tile: &Tile, pixels: &mut [PixelSum], light: &LightImage) {
        for (sum, pixel) in pixels.iter_mut().zip(tile.pixels()) {
            for replicate in 0..self.settings.replicates {
                sum.raise(replicate, light.at(replicate, pixel), self.scene.film.reconstruction);
            }
        }
    }

    /// The samples of pixels that share, or of one, in units that travel together.
    fn units<'a>(&self, group: &'a [Indices]) -> impl Iterator<Item = Unit<'a>> + use<'a, I> {
        let start = group.iter().map(|of| of.range[0]).min().unwrap_or(0);
        let end = group.iter().map(|of| of.range[1]).max().unwrap_or(0);
        let length = if group.len() == 1 { BATCH } else { BATCH / reuse::MATES };
        let cut = move |replicate| {
            let starts = (start..end).step_by(length as usize);
            starts.map(move |a| Unit { group, replicate, indices: [a, end.min(a.saturating_add(length))] })
        };
        (0..self.settings.replicates).flat_map(cut)
    }

    /// Adds the samples of each pixel and replicate of a tile, from the first to before the second that `range_of` says.
    ///
    /// * `seen`: called with samples of one pixel and replicate.
    fn tile<S: Sampler>(
        &self,
        sampler: &S,
        tile: &Tile,
        range_of: impl Fn([u32; 2]) -> [u32; 2],
        begun: &mut Begun,
        mut seen: impl FnMut(&[Sample]),
    ) {
        let film = &self.scene.film;
        let reuses = self.integrator.reuses(self.scene);
        let indices = |pixel| Indices { pixel: film.pixel(pixel), range: range_of(pixel) };
        let mut pixels: Vec<Indices> = tile.pixels().map(indices).collect();
        if reuses {
            pixels.sort_by_key(|of| reuse::group(of.pixel));
        }
        let share = |a: &Indices, b: &Indices| reuses && reuse::group(a.pixel) == reuse::group(b.pixel);
        let mut units = pixels.chunk_by(share).flat_map(|group| self.units(group)).peekable();
        let mut batch = Batch::default();
        let mut summed = Vec::new();
        while let Some(unit) = units.next() {
            batch.clear();
            batch.extend(unit.ids(0));
            let mut sets = unit.sets();
            while let Some(unit) = units.next_if(|unit| batch.samples.len() + unit.len() <= BATCH as usize) {
                batch.extend(unit.ids(sets));
                sets += unit.sets();
            }
            self.integrator.trace(self.scene, sampler, &mut batch);
            batch.drop_infinite();
            let of_one_sum =
                |a: &Sample, b: &Sample| (a.id.pixel, a.id.replicate) == (b.id.pixel, b.id.replicate);
            for run in batch.samples.chunk_by(of_one_sum) {
                let id = run[0].id;
                let place = tile.place(film.in_image(id.pixel));
                summed.clear();
                summed.extend(run.iter().map(|sample| values(sample.weighted(), sample.weight)));
                begun.sums[place].extend(id.replicate, &summed);
                // Their mean; the sum of all three may be more than f32 holds.
                let mean = |sample: &Sample| (sample.weighted() / 3.0).to_array().iter().sum::<f32>().abs();
                let largest = run.iter().map(mean).fold(0.0, f32::max);
                begun.largest[place] = begun.largest[place].max(f64::from(largest));
                seen(run);
            }
        }
        begun.dropped += batch.dropped;
    }
}
