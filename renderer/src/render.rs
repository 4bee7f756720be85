//! Rank 9: a scene, an integrator and a sampler become an image, tile by tile on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::error::ParamError;
use crate::film::{PixelEstimate, PixelSum, Reconstruction};
use crate::integrator::{Batch, Integrator};
use crate::sampling::{
    Halton, Independent, MultiJitter, Pmj02, SampleId, Sampler, SamplerKind, Sobol, Stratified,
};
use crate::scene::Scene;

/// Side of a tile in pixels.
const TILE: u32 = 16;

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

/// Renders `scene`.
///
/// * `progress`: called with the share of the work that is done, from any thread.
///
/// # Errors
/// Samples or replicates of 0, or a number of threads that the system refuses.
pub fn render<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    settings: &RenderSettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Rendering, ParamError> {
    let [first, _] = integrator.decisions(scene);
    match settings.sampler {
        SamplerKind::Independent => {
            render_with(scene, integrator, &Independent::new(settings.seed), settings, progress)
        }
        SamplerKind::Stratified => {
            let sampler = Stratified::new(settings.seed, settings.samples);
            render_with(scene, integrator, &sampler, settings, progress)
        }
        SamplerKind::MultiJitter => {
            let sampler = MultiJitter::new(settings.seed, settings.samples);
            render_with(scene, integrator, &sampler, settings, progress)
        }
        SamplerKind::Halton => {
            let sampler = Halton::new(settings.seed, first, settings.samples);
            render_with(scene, integrator, &sampler, settings, progress)
        }
        SamplerKind::Pmj02 => render_with(scene, integrator, &Pmj02::new(settings.seed), settings, progress),
        SamplerKind::Sobol => {
            render_with(scene, integrator, &Sobol::new(settings.seed, first), settings, progress)
        }
    }
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
    for (name, value) in
        [("the number of samples", settings.samples), ("the number of replicates", settings.replicates)]
    {
        if value == 0 {
            return Err(ParamError::OutOfRange { name, value: 0.0, accepted: "a number of at least 1" });
        }
    }
    let tiles = tiles(scene.film.width, scene.film.height);
    let done = AtomicUsize::new(0);
    let work = || -> Vec<TileResult> {
        let tile = |tile: &Tile| {
            let result = render_tile(scene, integrator, sampler, settings, tile);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(done as f64 / tiles.len() as f64);
            result
        };
        tiles.par_iter().map(tile).collect()
    };
    let finished = if settings.threads == 0 { work() } else { pool(settings.threads)?.install(work) };
    Ok(assemble(scene, settings, &tiles, &finished))
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, ParamError> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|_| ParamError::OutOfRange {
        name: "the number of threads",
        value: threads as f64,
        accepted: "a number that the system can start",
    })
}

/// A rectangle of pixels: columns and rows from–to.
struct Tile {
    x: [u32; 2],
    y: [u32; 2],
}

impl Tile {
    fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y]))
    }
}

fn tiles(width: u32, height: u32) -> Vec<Tile> {
    let cuts = |size: u32| (0..size).step_by(TILE as usize).map(move |a| [a, (a + TILE).min(size)]);
    cuts(height).flat_map(|y| cuts(width).map(move |x| Tile { x, y })).collect()
}

struct TileResult {
    pixels: Vec<PixelEstimate>,
    largest: f64,
    dropped: u64,
}

fn render_tile<I: Integrator, S: Sampler>(
    scene: &Scene,
    integrator: &I,
    sampler: &S,
    settings: &RenderSettings,
    tile: &Tile,
) -> TileResult {
    let pixels: Vec<[u32; 2]> = tile.pixels().collect();
    let mut sums = vec![PixelSum::new(settings.replicates); pixels.len()];
    let of_pixel = |pixel: [u32; 2]| {
        (0..settings.replicates).flat_map(move |replicate| {
            (0..settings.samples).map(move |index| SampleId { pixel, replicate, index })
        })
    };
    let mut ids = pixels.iter().flat_map(|&pixel| of_pixel(pixel));
    let mut batch = Batch::default();
    let mut largest = 0.0f64;
    loop {
        batch.refill(ids.by_ref().take(BATCH));
        if batch.samples.is_empty() {
            break;
        }
        integrator.trace(scene, sampler, &mut batch);
        for sample in &batch.samples {
            let [x, y] = sample.id.pixel;
            let pixel = (y - tile.y[0]) * (tile.x[1] - tile.x[0]) + x - tile.x[0];
            let weighted = sample.radiance * sample.weight;
            sums[pixel as usize].push(sample.id.replicate, weighted, sample.weight);
            largest = largest.max(f64::from(weighted.mean().abs()));
        }
    }
    let by_weight = scene.film.reconstruction == Reconstruction::Weighted;
    TileResult {
        pixels: sums.iter().map(|s| s.estimate(by_weight)).collect(),
        largest,
        dropped: batch.dropped,
    }
}

fn assemble(scene: &Scene, settings: &RenderSettings, tiles: &[Tile], finished: &[TileResult]) -> Rendering {
    let (width, height) = (scene.film.width, scene.film.height);
    let empty = PixelEstimate { mean: [0.0; 3], standard_error: None, samples: 0 };
    let mut pixels = vec![empty; width as usize * height as usize];
    for (tile, result) in tiles.iter().zip(finished) {
        for ([x, y], estimate) in tile.pixels().zip(&result.pixels) {
            pixels[y as usize * width as usize + x as usize] = *estimate;
        }
    }
    let per_pixel = f64::from(settings.samples) * f64::from(settings.replicates);
    let sum: f64 = pixels.iter().map(|p| p.mean.iter().sum::<f64>() / 3.0).sum::<f64>() * per_pixel;
    let largest = finished.iter().map(|t| t.largest).fold(0.0, f64::max);
    Rendering {
        width,
        height,
        pixels,
        largest_share: if sum > 0.0 { largest / sum } else { 0.0 },
        dropped: finished.iter().map(|t| t.dropped).sum(),
    }
}
