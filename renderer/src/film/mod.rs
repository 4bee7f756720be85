//! Rank 4: from samples to an image in which every number is an estimate with its error.

use crate::error::ParamError;

pub mod allocation;
pub mod estimate;
pub mod filter;
pub mod part;

pub use allocation::{Allocation, Pilot};
pub use estimate::{PixelEstimate, PixelSum};
pub use filter::{Filter, FilterSampler};
pub use part::{Begun, Part, Tile, TileSums};

/// How the samples of a pixel become its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reconstruction {
    /// The mean of w·L over samples drawn from |f|, with the signed weight w = f / pdf: unbiased.
    #[default]
    Importance,
    /// The lecture's weighted average Σf·L / Σf over samples uniform in the filter's support: its bias is O(1/n).
    Weighted,
}

impl Reconstruction {
    /// All ways.
    pub const ALL: [Self; 2] = [Self::Importance, Self::Weighted];

    /// The name in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Importance => "importance",
            Self::Weighted => "weighted",
        }
    }

    /// The way of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| way.name() == name)
    }
}

/// A rectangle of the pixels of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// Its first column and row.
    pub offset: [u32; 2],
    /// Columns and rows, at least 1.
    pub size: [u32; 2],
}

/// The image to make.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSettings {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// The part of these columns and rows that is made; `None` for all.
    pub crop: Option<Crop>,
    /// The pixel filter.
    pub filter: Filter,
    /// How samples are weighed.
    pub reconstruction: Reconstruction,
}

impl FilmSettings {
    /// Columns and rows of the image: those of the crop, where there is one.
    pub fn size(&self) -> [u32; 2] {
        self.crop.map_or([self.width, self.height], |crop| crop.size)
    }
}

/// A film ready for samples.
#[derive(Debug, Clone)]
pub struct Film {
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// The image's first column and row on the whole film.
    pub offset: [u32; 2],
    /// Columns and rows of the whole film.
    pub whole: [u32; 2],
    /// The filter with its tables.
    pub filter: FilterSampler,
    /// How samples are weighed.
    pub reconstruction: Reconstruction,
}

impl Film {
    /// Most pixels a film may have: 2²⁸, 4 GiB of results.
    pub const MAX_PIXELS: u64 = 1 << 28;

    /// The film of `settings`.
    ///
    /// # Errors
    /// A film or crop without pixels or with more than [`Self::MAX_PIXELS`], a crop that reaches beyond the film, or a filter
    /// parameter out of its range.
    pub fn new(settings: &FilmSettings) -> Result<Self, ParamError> {
        let (whole, size) = ([settings.width, settings.height], settings.size());
        let offset = settings.crop.map_or([0; 2], |crop| crop.offset);
        let [pixels, all] = [size, whole].map(|[width, height]| u64::from(width) * u64::from(height));
        if pixels == 0 || pixels > Self::MAX_PIXELS || all == 0 {
            return Err(ParamError::OutOfRange {
                name: "the number of pixels",
                value: pixels.min(all) as f64,
                accepted: "1 to 268435456",
            });
        }
        for axis in [0, 1] {
            let end = u64::from(offset[axis]) + u64::from(size[axis]);
            if end > u64::from(whole[axis]) {
                let (name, accepted) = ("the end of the crop", "a rectangle of the film's pixels");
                return Err(ParamError::OutOfRange { name, value: end as f64, accepted });
            }
        }
        Ok(Self {
            width: size[0],
            height: size[1],
            offset,
            whole,
            filter: FilterSampler::new(settings.filter)?,
            reconstruction: settings.reconstruction,
        })
    }

    /// The pixel of the whole film that is the image's at column `x` and row `y`: a crop's samples are those of the whole film.
    pub fn pixel(&self, [x, y]: [u32; 2]) -> [u32; 2] {
        [x + self.offset[0], y + self.offset[1]]
    }

    /// The column and row of the image that a pixel of the whole film has.
    pub fn in_image(&self, [x, y]: [u32; 2]) -> [u32; 2] {
        [x - self.offset[0], y - self.offset[1]]
    }

    /// Where the point `u` of the pixel decision lands for `pixel` of the whole film, and the weight of the sample there.
    ///
    /// Returns: the position in pixels from the upper left corner of the whole film, and w.
    #[inline]
    pub fn place(&self, pixel: [u32; 2], u: [f32; 2]) -> ([f64; 2], f32) {
        let [(x, wx), (y, wy)] = match self.reconstruction {
            Reconstruction::Importance => u.map(|u| self.filter.sample(u)),
            Reconstruction::Weighted => u.map(|u| self.filter.uniform(u)),
        };
        let centre = pixel.map(|p| f64::from(p) + 0.5);
        ([centre[0] + f64::from(x), centre[1] + f64::from(y)], wx * wy)
    }

    /// The pixels of the image whose filters hold a position in pixels of the whole film.
    ///
    /// * `add`: called with each one's column and row of the image, and its filter's value there per pixel, whose integral is 1.
    pub fn splat(&self, position: [f64; 2], mut add: impl FnMut([u32; 2], f64)) {
        let radius = self.filter.radius();
        // Columns or rows, and how far the position is from their middles.
        let near = |axis: usize| {
            let at = position[axis] - f64::from(self.offset[axis]) - 0.5;
            let last = f64::from([self.width, self.height][axis] - 1);
            let first = (at - radius).floor() + 1.0;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the image")]
            let range = first.max(0.0) as u32..((at + radius).floor().min(last) + 1.0) as u32;
            range.map(move |place| (place, at - f64::from(place)))
        };
        for (y, down) in near(1) {
            for (x, right) in near(0) {
                add([x, y], self.filter.value(right) * self.filter.value(down));
            }
        }
    }

    /// The position in pixels of a point of the whole film: the inverse of [`Self::to_image`].
    pub fn to_pixels(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| 0.5 * (place[axis] + 1.0) * f64::from(self.whole[axis]))
    }

    /// A position in pixels as a point of the whole film, [−1, 1]², rightwards and downwards.
    #[inline]
    pub fn to_image(&self, position: [f64; 2]) -> [f32; 2] {
        #[expect(clippy::cast_possible_truncation, reason = "points of the film are of order 1")]
        let to_unit = |x: f64, size: u32| (2.0 * x / f64::from(size) - 1.0) as f32;
        [to_unit(position[0], self.whole[0]), to_unit(position[1], self.whole[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(filter: Filter) -> Film {
        let crop = Some(Crop { offset: [2, 1], size: [5, 4] });
        let reconstruction = Reconstruction::Importance;
        Film::new(&FilmSettings { width: 9, height: 7, crop, filter, reconstruction }).unwrap()
    }

    fn splats(film: &Film, position: [f64; 2]) -> Vec<([u32; 2], f64)> {
        let mut all = Vec::new();
        film.splat(position, |pixel, share| all.push((pixel, share)));
        all
    }

    #[test]
    fn a_position_falls_on_the_pixels_whose_filters_hold_it() {
        let film = film(Filter::PIXEL);
        assert_eq!(splats(&film, [3.75, 4.5]), [([1, 3], 1.0)]);
        assert_eq!(splats(&film, [3.0, 1.0]), [([1, 0], 1.0)]);
        for beyond in [[1.99, 2.0], [7.01, 2.0], [3.0, 0.99], [3.0, 5.01], [-1e300, 1e300]] {
            assert_eq!(splats(&film, beyond), []);
        }
        let place = film.to_image([3.75, 4.5]).map(f64::from);
        for (there, back) in [3.75, 4.5].into_iter().zip(film.to_pixels(place)) {
            assert!((there - back).abs() < 9.0 * 2.0_f64.powi(-24)); // half of 9 pixels, a rounding below 1
        }
    }

    #[test]
    fn shares_are_the_filters_values() {
        let film = film(Filter::Tent { radius: 1.0 });
        let found = splats(&film, [4.75, 3.25]);
        assert_eq!(found, [([2, 1], 0.1875), ([3, 1], 0.0625), ([2, 2], 0.5625), ([3, 2], 0.1875)]);
        assert_eq!(film.filter.pixels(), 4);
        // Half of a tent is beyond the image's edge.
        assert_eq!(splats(&film, [2.0, 3.25]), [([0, 1], 0.125), ([0, 2], 0.375)]);
    }
}
