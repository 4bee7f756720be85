//! A render that isn't whole: some tiles, or some of the samples.

use std::sync::Arc;

use super::Reconstruction;
use super::allocation::Allocation;
use super::estimate::{PixelEstimate, PixelSum, levels};
use crate::error::ParamError;

/// Side of a tile in pixels.
const TILE: u32 = 16;

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// Columns, from the first to before the second.
    pub x: [u32; 2],
    /// Rows, likewise.
    pub y: [u32; 2],
}

impl Tile {
    /// The tiles of a film, row by row.
    pub fn all([width, height]: [u32; 2]) -> Vec<Self> {
        let cuts = |size: u32| (0..size).step_by(TILE as usize).map(move |a| [a, (a + TILE).min(size)]);
        cuts(height).flat_map(|y| cuts(width).map(move |x| Self { x, y })).collect()
    }

    /// Its pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y]))
    }

    /// The place of a pixel among its pixels.
    pub fn place(&self, [x, y]: [u32; 2]) -> usize {
        ((y - self.y[0]) * (self.x[1] - self.x[0]) + x - self.x[0]) as usize
    }
}

/// The samples of a tile.
#[derive(Debug, Clone, PartialEq)]
pub struct TileSums {
    /// For each pixel and replicate the sums of its nodes: Σw·R, Σw·G, Σw·B, Σw.
    pub sums: Vec<f64>,
    /// Largest absolute value of a weighted sample, the mean of its channels.
    pub largest: f64,
    /// Contributions left out because they were not finite.
    pub dropped: u64,
}

impl TileSums {
    /// Of the pixels of a tile.
    pub fn new(pixels: &[PixelSum], largest: f64, dropped: u64) -> Self {
        Self { sums: pixels.iter().flat_map(PixelSum::numbers).collect(), largest, dropped }
    }
}

/// What is there of a tile before its samples are taken.
#[derive(Debug, Clone)]
pub struct Begun {
    /// The sum of each pixel.
    pub sums: Vec<PixelSum>,
    /// The largest absolute value of each pixel's weighted samples, the mean of its channels.
    pub largest: Vec<f64>,
    /// Contributions left out because they were not finite.
    pub dropped: u64,
    /// Index of each pixel's next sample.
    pub next: u32,
}

/// Samples of an image: a range of each replicate's, for the tiles that are finished.
///
/// Parts over adjoining ranges join to the same bits as one over both.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Independent randomisations.
    pub replicates: u32,
    /// Indices of the samples of each replicate, from the first to before the second.
    pub range: [u32; 2],
    /// Samples of each pixel instead of the range.
    allocation: Option<Arc<Allocation>>,
    tiles: Vec<Option<TileSums>>,
    finished: usize,
}

impl Part {
    /// Nothing yet.
    pub fn new(size: [u32; 2], replicates: u32, range: [u32; 2]) -> Self {
        let tiles = vec![None; Tile::all(size).len()];
        Self { size, replicates, range, allocation: None, tiles, finished: 0 }
    }

    /// Nothing yet of the samples of `allocation`, whose mean is `samples`.
    ///
    /// # Errors
    /// A number of counts that isn't that of the pixels, and counts of 0.
    pub fn allocated(
        size: [u32; 2],
        replicates: u32,
        samples: u32,
        allocation: Allocation,
    ) -> Result<Self, ParamError> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let counts = &allocation.counts;
        if counts.len() as u64 != pixels || counts.contains(&0) {
            let accepted = "a number of samples above 0 for each pixel";
            return Err(ParamError::OutOfRange {
                name: "pixels with samples",
                value: pixels as f64,
                accepted,
            });
        }
        Ok(Self { allocation: Some(allocation.into()), ..Self::new(size, replicates, [0, samples]) })
    }

    /// The samples of each replicate of a pixel, row by row, where they are not the same for all.
    pub fn counts(&self) -> Option<&[u32]> {
        self.allocation.as_ref().map(|allocation| allocation.counts.as_slice())
    }

    /// The same samples, with no tile of them.
    #[must_use]
    pub fn emptied(&self) -> Self {
        Self { allocation: self.allocation.clone(), ..Self::new(self.size, self.replicates, self.range) }
    }

    /// Whether another part is of the same film, replicates and range of samples.
    pub fn is_of_ranges(&self, other: &Self) -> bool {
        (self.size, self.replicates, self.range) == (other.size, other.replicates, other.range)
    }

    /// The indices of the samples of each replicate of a pixel, from the first to before the second.
    pub fn range_of(&self, [x, y]: [u32; 2]) -> [u32; 2] {
        let place = y as usize * self.size[0] as usize + x as usize;
        self.counts().map_or(self.range, |counts| [0, counts[place]])
    }

    /// What there is of the tile of that index before it is rendered.
    pub fn begun(&self, index: usize, tile: &Tile) -> Begun {
        let pilot = self.allocation.as_ref().and_then(|allocation| allocation.pilot.as_ref());
        let first = pilot.and_then(|pilot| Some((pilot, pilot.part.tiles.get(index)?.as_ref()?)));
        match first {
            Some((pilot, sums)) => Begun {
                sums: pilot.part.pixels_of(tile, sums).collect(),
                largest: pilot.largest[index].clone(),
                dropped: sums.dropped,
                next: pilot.part.range[1],
            },
            None => {
                let pixels = tile.pixels().count();
                let nothing = PixelSum::starting_at(self.replicates, self.range[0]);
                let (sums, largest) = (vec![nothing; pixels], vec![0.0; pixels]);
                Begun { sums, largest, dropped: 0, next: self.range[0] }
            }
        }
    }

    /// How many numbers the sums of each tile are, in the order of [`Tile::all`].
    pub fn lengths(&self) -> Vec<usize> {
        let even = self.per_pixel(self.range);
        let of_tile = |tile: &Tile| match self.counts() {
            None => tile.pixels().count() * even,
            Some(_) => tile.pixels().map(|pixel| self.per_pixel(self.range_of(pixel))).sum(),
        };
        Tile::all(self.size).iter().map(of_tile).collect()
    }

    /// Memory that it takes once it is complete.
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size.map(u64::from);
        width * height * 8 * self.per_pixel(self.range) as u64
    }

    /// Numbers that a pixel with the samples of `range` has.
    fn per_pixel(&self, range: [u32; 2]) -> usize {
        4 * levels(range.map(u64::from)).len() * self.replicates as usize
    }

    /// Each tile's samples once it is finished, in the order of [`Tile::all`].
    pub fn tiles(&self) -> &[Option<TileSums>] {
        &self.tiles
    }

    /// Puts in the samples of a tile; a tile that is there stays as it is.
    pub fn finish(&mut self, tile: usize, sums: TileSums) {
        debug_assert_eq!(self.lengths()[tile], sums.sums.len());
        if self.tiles[tile].is_none() {
            self.finished += 1;
            self.tiles[tile] = Some(sums);
        }
    }

    /// The share of the tiles that are finished.
    pub fn share(&self) -> f64 {
        self.finished as f64 / self.tiles.len() as f64
    }

    /// Whether every tile is finished.
    pub fn is_complete(&self) -> bool {
        self.finished == self.tiles.len()
    }

    /// Largest absolute value of a weighted sample.
    pub fn largest(&self) -> f64 {
        self.tiles.iter().flatten().map(|t| t.largest).fold(0.0, f64::max)
    }

    /// Contributions left out because they were not finite.
    pub fn dropped(&self) -> u64 {
        self.tiles.iter().flatten().map(|t| t.dropped).sum()
    }

    /// Adds the samples that follow on these.
    ///
    /// # Errors
    /// Parts of other images, parts with tiles missing, numbers of samples by pixel, and ranges that don't adjoin.
    pub fn join(&self, next: &Self) -> Result<Self, ParamError> {
        let refused = |name, value, accepted| Err(ParamError::OutOfRange { name, value, accepted });
        if (self.size, self.replicates) != (next.size, next.replicates) {
            let pixels = f64::from(next.size[0]) * f64::from(next.size[1]);
            return refused("pixels of the next part", pixels, "the same film and number of replicates");
        }
        if self.allocation.is_some() || next.allocation.is_some() {
            return refused("numbers of samples of a pixel", 2.0, "one, the same for all pixels");
        }
        if next.range[0] != self.range[1] {
            let first = f64::from(next.range[0]);
            return refused("first sample of the next part", first, "the one after the last of this part");
        }
        if !(self.is_complete() && next.is_complete()) {
            return refused("share that is finished", self.share().min(next.share()), "1");
        }
        let pairs = self.tiles.iter().zip(&next.tiles);
        let tiles = Tile::all(self.size).into_iter().zip(pairs).map(|(tile, pair)| match pair {
            (Some(first), Some(second)) => Some(self.joined(&tile, first, second, next)),
            _ => None,
        });
        Ok(Self { range: [self.range[0], next.range[1]], tiles: tiles.collect(), ..self.clone() })
    }

    fn joined(&self, tile: &Tile, first: &TileSums, second: &TileSums, next: &Self) -> TileSums {
        let levels = levels(next.range.map(u64::from));
        let rest = second.sums.chunks_exact(next.per_pixel(next.range));
        let pixels: Vec<PixelSum> = self
            .pixels_of(tile, first)
            .zip(rest)
            .map(|(mut pixel, numbers)| {
                pixel.append(&levels, numbers);
                pixel
            })
            .collect();
        TileSums::new(&pixels, first.largest.max(second.largest), first.dropped + second.dropped)
    }

    fn pixels_of<'a>(&'a self, tile: &Tile, sums: &'a TileSums) -> impl Iterator<Item = PixelSum> + use<'a> {
        let mut rest = sums.sums.as_slice();
        tile.pixels().map(move |pixel| {
            let range = self.range_of(pixel);
            let levels = levels(range.map(u64::from));
            let (numbers, others) = rest.split_at(4 * levels.len() * self.replicates as usize);
            rest = others;
            let mut pixel = PixelSum::starting_at(self.replicates, range[0]);
            pixel.append(&levels, numbers);
            pixel
        })
    }

    /// Every pixel's estimate, row by row from the top; pixels of tiles that are missing have no samples.
    pub fn estimates(&self, reconstruction: Reconstruction) -> Vec<PixelEstimate> {
        let [width, height] = self.size;
        let empty = PixelEstimate { mean: [0.0; 3], standard_error: None, samples: 0 };
        let mut image = vec![empty; width as usize * height as usize];
        for (tile, sums) in Tile::all(self.size).iter().zip(&self.tiles) {
            let Some(sums) = sums else { continue };
            for ([x, y], pixel) in tile.pixels().zip(self.pixels_of(tile, sums)) {
                image[y as usize * width as usize + x as usize] = pixel.estimate(reconstruction);
            }
        }
        image
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    fn part(range: [u32; 2]) -> Part {
        let mut part = Part::new([20, 17], 2, range);
        for (index, tile) in Tile::all(part.size).iter().enumerate() {
            let pixel = |[x, y]: [u32; 2]| {
                let mut sum = PixelSum::starting_at(2, range[0]);
                for (replicate, index) in (0..2).flat_map(|r| (range[0]..range[1]).map(move |i| (r, i))) {
                    sum.push(
                        replicate,
                        Rgb::splat(1.0 / (x + 3 * y + 7 * index + replicate + 1) as f32),
                        1.0,
                    );
                }
                sum
            };
            let pixels: Vec<PixelSum> = tile.pixels().map(pixel).collect();
            part.finish(index, TileSums::new(&pixels, f64::from(range[0]), 1));
        }
        part
    }

    #[test]
    fn parts_join_to_the_whole_bit_for_bit() {
        let whole = part([0, 13]);
        for cut in [1, 8, 12] {
            let joined = part([0, cut]).join(&part([cut, 13])).unwrap();
            assert_eq!(
                joined.estimates(Reconstruction::Importance),
                whole.estimates(Reconstruction::Importance),
                "cut at {cut}"
            );
            assert_eq!(
                joined.lengths(),
                joined.tiles.iter().flatten().map(|t| t.sums.len()).collect::<Vec<_>>()
            );
        }
        assert!(whole.estimates(Reconstruction::Importance).iter().all(|p| p.samples == 26));
    }

    #[test]
    fn pixels_can_have_numbers_of_samples_of_their_own() {
        let counts: Vec<u32> = (0..20 * 17).map(|i| 1 + i % 5).collect();
        let allocation = Allocation { counts: counts.clone(), pilot: None };
        let mut part = Part::allocated([20, 17], 2, 3, allocation).unwrap();
        for (index, tile) in Tile::all(part.size).iter().enumerate() {
            let pixel = |pixel: [u32; 2]| {
                let mut sum = PixelSum::new(2);
                let all = (0..2).flat_map(|r| (0..part.range_of(pixel)[1]).map(move |i| (r, i)));
                all.for_each(|(r, i)| sum.push(r, Rgb::splat((i + pixel[0]) as f32), 1.0));
                sum
            };
            let pixels: Vec<PixelSum> = tile.pixels().map(pixel).collect();
            part.finish(index, TileSums::new(&pixels, 0.0, 0));
        }
        let found = part.estimates(Reconstruction::Importance);
        for ((place, count), pixel) in (0..).zip(&counts).zip(found) {
            // The mean of the column and 0 to count − 1 on top of it.
            let mean = f64::from(place % 20) + 0.5 * f64::from(count - 1);
            assert_eq!((pixel.mean[0], pixel.samples), (mean, u64::from(2 * count)));
        }
        let short = Allocation { counts: vec![1; 339], pilot: None };
        assert!(part.join(&part).is_err() && Part::allocated([20, 17], 2, 3, short).is_err());
    }

    #[test]
    fn parts_that_do_not_belong_together_are_refused() {
        assert!(part([0, 4]).join(&part([5, 8])).is_err());
        assert!(part([0, 4]).join(&Part::new([20, 17], 2, [4, 8])).is_err());
        assert!(part([0, 4]).join(&Part { replicates: 3, ..part([4, 8]) }).is_err());
    }
}
