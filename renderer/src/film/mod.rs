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

/// The image to make.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSettings {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// The pixel filter.
    pub filter: Filter,
    /// How samples are weighed.
    pub reconstruction: Reconstruction,
}

/// A film ready for samples.
#[derive(Debug, Clone)]
pub struct Film {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
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
    /// No pixels, more than [`Self::MAX_PIXELS`], or a filter parameter out of its range.
    pub fn new(settings: &FilmSettings) -> Result<Self, ParamError> {
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        if pixels == 0 || pixels > Self::MAX_PIXELS {
            return Err(ParamError::OutOfRange {
                name: "the number of pixels",
                value: f64::from(settings.width) * f64::from(settings.height),
                accepted: "1 to 268435456",
            });
        }
        Ok(Self {
            width: settings.width,
            height: settings.height,
            filter: FilterSampler::new(settings.filter)?,
            reconstruction: settings.reconstruction,
        })
    }

    /// Where the point `u` of the pixel decision lands for `pixel`, and the weight of the sample there.
    ///
    /// Returns: the position in pixels from the upper left corner of the film, and w.
    pub fn place(&self, pixel: [u32; 2], u: [f32; 2]) -> ([f64; 2], f32) {
        let [(x, wx), (y, wy)] = match self.reconstruction {
            Reconstruction::Importance => u.map(|u| self.filter.sample(u)),
            Reconstruction::Weighted => u.map(|u| self.filter.uniform(u)),
        };
        let centre = pixel.map(|p| f64::from(p) + 0.5);
        ([centre[0] + f64::from(x), centre[1] + f64::from(y)], wx * wy)
    }

    /// A position in pixels as a point of the image, [−1, 1]², rightwards and downwards.
    pub fn to_image(&self, position: [f64; 2]) -> [f32; 2] {
        #[expect(clippy::cast_possible_truncation, reason = "points of the image are of order 1")]
        let to_unit = |x: f64, size: u32| (2.0 * x / f64::from(size) - 1.0) as f32;
        [to_unit(position[0], self.width), to_unit(position[1], self.height)]
    }
}
