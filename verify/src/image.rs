//! Two images with their errors: are they noisy renderings of the same thing?
//!
//! Pixels are taken as independent, channels of a pixel are not. The mean over all pixels sees a bias of brightness, the tiles see a
//! local one, and single pixels only count: their errors, from a few replicates, have tails that no verdict should rest on. Where the
//! files of several seeds are known, the level beyond which a pixel counts comes from swapping seeds between the sides.

mod comparison;
mod swaps;
mod tiles;

pub use comparison::{Comparison, Pixels, Pooled, compare};
pub use tiles::Tiles;

use crate::error::InputError;
use crate::estimate::Moments;
use crate::welch::Sum;

/// Relative rounding of pixels stored as f32: two conversions and a few operations, 2^-24 each.
const ROUNDING: f64 = 1e-6;

/// Side of a tile, pixels.
pub const TILE: usize = 16;

/// An image of means, with what is known of their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Columns and rows.
    size: [usize; 2],
    channels: usize,
    /// Row by row, channels together.
    mean: Vec<f64>,
    /// Variance of each entry of `mean`; empty where unknown.
    variance: Vec<f64>,
    /// Number of independent replicates behind each entry.
    replicates: u64,
    /// Sums over tiles, one list a seed; empty where only pixels are known.
    seeds: Vec<Vec<f64>>,
    /// All entries of each seed; empty where only means are known.
    files: Vec<Vec<f64>>,
    largest_share: f64,
    /// Most pixels that have errors in common.
    shared_by: u64,
    /// Largest relative error by rounding.
    rounding: f64,
}

impl Image {
    /// An image from one file: mean and standard error of each pixel and channel, from `replicates` independent replicates.
    ///
    /// With one replicate the errors are unknown and not looked at.
    ///
    /// * `size`: columns and rows; `mean`, `standard_error`: row by row, channels together.
    ///
    /// # Errors
    /// [`InputError::TooFew`] where a list is too short, [`InputError::Subject`] for a value that is not finite or an error below 0.
    pub fn with_errors(
        size: [usize; 2],
        channels: usize,
        mean: Vec<f64>,
        standard_error: &[f64],
        replicates: u64,
    ) -> Result<Self, InputError> {
        finite(size, channels, &mean)?;
        let mut variance = Vec::new();
        if replicates > 1 {
            finite(size, channels, standard_error)?;
            if let Some(i) = standard_error.iter().position(|&s| s < 0.0) {
                return Err(InputError::Subject(format!("{} is negative", place(size, channels, i))));
            }
            variance = standard_error.iter().map(|s| s * s).collect();
        }
        let (seeds, files) = (Vec::new(), Vec::new());
        Ok(Self {
            size,
            channels,
            mean,
            variance,
            replicates,
            seeds,
            files,
            largest_share: 0.0,
            shared_by: 1,
            rounding: ROUNDING,
        })
    }

    /// An image from several files of the same thing with different seeds: the errors come from the files themselves.
    ///
    /// # Errors
    /// As [`Self::with_errors`]; also without any file.
    pub fn from_seeds(size: [usize; 2], channels: usize, files: &[Vec<f64>]) -> Result<Self, InputError> {
        if files.is_empty() {
            return Err(InputError::TooFew { what: "images", given: 0, needed: 1 });
        }
        files.iter().try_for_each(|file| finite(size, channels, file))?;
        let count = files.len() as f64;
        let of = |i: usize| files.iter().map(|file| file[i]).collect::<Moments>();
        let moments: Vec<Moments> = (0..files[0].len()).map(of).collect();
        let known = files.len() > 1;
        let variance = moments.iter().filter(|_| known).map(|m| m.variance() / count).collect();
        let mean = moments.iter().map(Moments::mean).collect();
        let mut image = Self {
            size,
            channels,
            mean,
            variance,
            replicates: files.len() as u64,
            seeds: Vec::new(),
            files: files.to_vec(),
            largest_share: 0.0,
            shared_by: 1,
            rounding: ROUNDING,
        };
        image.seeds = files.iter().map(|file| image.tile_sums(file)).collect();
        Ok(image)
    }

    /// Adds sums over 16×16 tiles of each seed that the means rest on, from which the errors of tiles and of the whole are then taken.
    ///
    /// * `sums`: one list a seed, tile by tile in rows, channels together; tiles at the right and lower border are cut off.
    ///
    /// # Errors
    /// As [`Self::with_errors`].
    pub fn with_seed_tiles(mut self, sums: Vec<Vec<f64>>) -> Result<Self, InputError> {
        let tiles = [self.size[0].div_ceil(TILE), self.size[1].div_ceil(TILE)];
        sums.iter().try_for_each(|seed| finite(tiles, self.channels, seed))?;
        self.seeds = sums;
        Ok(self)
    }

    /// Adds the largest share that a single sample has in the image's sum, as far as the file says it; above 5 % it raises a doubt.
    #[must_use]
    pub fn with_largest_share(self, largest_share: f64) -> Self {
        Self { largest_share, ..self }
    }

    /// Says that up to `pixels` pixels have errors in common, as where a renderer shares samples among neighbours.
    ///
    /// The variance of a sum of k numbers is at most k times the sum of their variances, whatever they have in common (Cauchy–Schwarz), and
    /// k equal ones are known no better than one of them. So errors of sums over pixels become larger than they need to be, never too
    /// small. Sums over seeds have the right errors without.
    #[must_use]
    pub fn with_errors_shared_by(self, pixels: u64) -> Self {
        Self { shared_by: pixels.max(1), ..self }
    }

    /// Says that rounding may have changed each pixel by `relative` of itself, the same way in every seed, instead of by 1e-6; differences up to
    /// that count as none, and the resolution says so.
    ///
    /// A sum of n equal f32 numbers, one after the other, is off by up to n/2·2^-24: each addition rounds by up to 2^-24 of what is there so far.
    #[must_use]
    pub fn with_rounding(self, relative: f64) -> Self {
        Self { rounding: relative, ..self }
    }

    /// Whether errors can be had.
    #[must_use]
    pub fn error_known(&self) -> bool {
        self.seeds.len() > 1 || !self.variance.is_empty()
    }

    fn tile_of(&self, entry: usize) -> usize {
        let pixel = entry / self.channels;
        let (x, y) = (pixel % self.size[0], pixel / self.size[0]);
        y / TILE * self.size[0].div_ceil(TILE) + x / TILE
    }

    fn tile_count(&self) -> usize {
        self.size[0].div_ceil(TILE) * self.size[1].div_ceil(TILE)
    }

    fn tile_sums(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.tile_count() * self.channels];
        for (i, value) in values.iter().enumerate() {
            sums[self.tile_of(i) * self.channels + i % self.channels] += value;
        }
        sums
    }

    /// Sums over each tile: one entry a channel, and a last one over all channels.
    fn tiles(&self) -> Vec<Vec<Sum>> {
        if self.seeds.len() > 1 {
            let tile =
                |t: usize| self.over_seeds(&(t * self.channels..(t + 1) * self.channels).collect::<Vec<_>>());
            return (0..self.tile_count()).map(tile).collect();
        }
        let mut entries = vec![Vec::new(); self.tile_count()];
        (0..self.mean.len()).for_each(|i| entries[self.tile_of(i)].push(i));
        entries.iter().map(|inside| self.over_pixels(inside)).collect()
    }

    /// Sums over the whole image, as [`Self::tiles`].
    fn whole(&self) -> Vec<Sum> {
        if self.seeds.len() > 1 {
            return self.over_seeds(&(0..self.tile_count() * self.channels).collect::<Vec<_>>());
        }
        self.over_pixels(&(0..self.mean.len()).collect::<Vec<_>>())
    }

    fn over_seeds(&self, entries: &[usize]) -> Vec<Sum> {
        let sum = |channel: Option<usize>| {
            let wanted = |&&i: &&usize| channel.is_none_or(|c| i % self.channels == c);
            let one = |seed: &Vec<f64>| entries.iter().filter(wanted).map(|&i| seed[i]).sum::<f64>();
            Sum::over_replicates(&self.seeds.iter().map(one).collect::<Vec<_>>())
        };
        (0..self.channels).map(Some).chain([None]).map(sum).collect()
    }

    fn over_pixels(&self, entries: &[usize]) -> Vec<Sum> {
        let mut sums = vec![Sum::default(); self.channels];
        let shared_by = self.shared_by as f64;
        for &i in entries {
            let [mean, variance] = self.pixel(i);
            sums[i % self.channels].add([mean, shared_by * variance]);
        }
        sums.iter_mut().for_each(|sum| sum.finish(self.replicates.saturating_sub(1) as f64 / shared_by));
        sums.push(Sum::of_dependent(&sums));
        sums
    }

    fn pixel(&self, entry: usize) -> [f64; 2] {
        [self.mean[entry], self.variance.get(entry).copied().unwrap_or(f64::NAN)]
    }
}

fn finite([width, height]: [usize; 2], channels: usize, values: &[f64]) -> Result<(), InputError> {
    let needed = width.saturating_mul(height).saturating_mul(channels);
    if values.len() != needed || needed == 0 {
        let (given, needed) = (values.len() as u64, needed.max(1) as u64);
        return Err(InputError::TooFew { what: "values of an image", given, needed });
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(i) => {
            Err(InputError::Subject(format!("{} is {}", place([width, height], channels, i), values[i])))
        }
        None => Ok(()),
    }
}

fn place([width, _]: [usize; 2], channels: usize, entry: usize) -> String {
    let pixel = entry / channels;
    format!("pixel ({}, {}), channel {}", pixel % width, pixel / width, entry % channels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_and_seeds_give_the_same_sums() {
        let files: Vec<Vec<f64>> =
            (0..5).map(|k| (0..20 * 18 * 2).map(|i| f64::from((i * 7 + k * k) % 11)).collect()).collect();
        let image = Image::from_seeds([20, 18], 2, &files).unwrap();
        assert_eq!((image.tile_count(), image.tiles().len()), (4, 4));
        let whole = image.whole();
        let sum: f64 = files.iter().flatten().sum::<f64>() / 5.0;
        assert_eq!(whole.len(), 3);
        assert!((whole[2].mean - sum).abs() < 1e-9); // sums of 720 whole numbers: exact up to the division
        assert_eq!(whole[2].dof, 4.0);
    }

    #[test]
    fn malformed_input_is_refused_with_its_place() {
        assert!(Image::with_errors([2, 1], 1, vec![1.0], &[1.0], 4).is_err());
        let refused = Image::with_errors([2, 1], 3, vec![0.0, 0.0, 0.0, 0.0, f64::NAN, 0.0], &[0.0; 6], 4);
        assert_eq!(refused, Err(InputError::Subject("pixel (1, 0), channel 1 is NaN".into())));
        assert!(Image::with_errors([1, 1], 1, vec![1.0], &[-1.0], 4).is_err());
        assert!(!Image::with_errors([1, 1], 1, vec![1.0], &[], 1).unwrap().error_known());
    }
}
