//! From a rendering to the image that files hold.

use super::image::{Image, Metadata, Provenance};
use crate::film::PixelEstimate;
use crate::render::{RenderSettings, Rendering};

/// The image of `rendering` with `provenance`.
///
/// Files hold f32: means and standard errors beyond its range become infinite, so that they show.
pub fn image(rendering: &Rendering, provenance: Provenance) -> Image {
    #[expect(clippy::cast_possible_truncation, reason = "files hold f32")]
    let single = |v: [f64; 3]| v.map(|c| c as f32);
    let errors = |p: &PixelEstimate| p.standard_error.map(single);
    Image {
        width: rendering.width as usize,
        height: rendering.height as usize,
        rgb: rendering.pixels.iter().map(|p| single(p.mean)).collect(),
        stderr: rendering.pixels.iter().map(errors).collect(),
        samples: Some(rendering.pixels.iter().map(|p| p.samples as f32).collect()),
        metadata: Metadata { provenance: Some(provenance), ..Metadata::default() },
    }
}

impl Provenance {
    /// Of `rendering`, made with `settings` from the scene of that hash.
    pub fn of(scene_hash: u64, settings: &RenderSettings, rendering: &Rendering) -> Self {
        Self {
            scene_hash: format!("{scene_hash:016x}"),
            seed: settings.seed,
            sampler: settings.sampler.name().into(),
            replicates: settings.replicates,
            sample_range: [0, u64::from(settings.samples) * u64::from(settings.replicates)],
            largest_share: rendering.largest_share,
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }
}
