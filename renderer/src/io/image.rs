//! An image as files hold it: means, their standard errors, and where they come from.

use std::collections::BTreeMap;

use crate::film::Film;

/// Most pixels of an image that is read or asked for.
pub const MAX_PIXELS: u64 = Film::MAX_PIXELS;

/// Linear sRGB radiance per pixel, rows from the top, with what is known about its error.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Mean radiance of each pixel [W m⁻² sr⁻¹], row by row.
    pub rgb: Vec<[f32; 3]>,
    /// Standard error of `rgb`; `None` where no error is known, as with one replicate.
    pub stderr: Option<Vec<[f32; 3]>>,
    /// Number of samples behind each pixel.
    pub samples: Option<Vec<f32>>,
    /// What the file says about itself.
    pub metadata: Metadata,
}

/// What an image file says about itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Metadata {
    /// How this program made it; `None` for other programs' files.
    pub provenance: Option<Provenance>,
    /// Further texts by name, written and read in the order of the names.
    pub texts: BTreeMap<String, String>,
}

/// Everything that is needed to make an image again, and the figure that tells whether its errors can be trusted.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Hash of the scene's files and overrides.
    pub scene_hash: String,
    /// Seed of the samples.
    pub seed: u64,
    /// Name of the sampler.
    pub sampler: String,
    /// Number of independent scramblings; with 1 there is no error.
    pub replicates: u32,
    /// First sample index of the range that was rendered, and the one past its last.
    pub sample_range: [u64; 2],
    /// Largest share of one sample in any pixel's sum, 0 to 1.
    pub largest_share: f64,
    /// Most pixels that have errors in common; 1 where each has its own.
    pub shared_by: u32,
    /// Version of the program.
    pub version: String,
}

impl Image {
    /// An image of means alone.
    ///
    /// # Panics
    /// If `rgb` has not `width` × `height` entries.
    pub fn new(width: usize, height: usize, rgb: Vec<[f32; 3]>) -> Self {
        assert_eq!(rgb.len(), width * height, "one triple per pixel");
        Self { width, height, rgb, ..Self::default() }
    }
}
