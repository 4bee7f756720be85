//! From a rendering to the image that files hold.

use super::image::{Image, Metadata, Provenance};
use crate::film::PixelEstimate;
use crate::render::Rendering;

/// The image of `rendering`, and what is known of how it came about.
///
/// Files hold f32: means and standard errors beyond its range become infinite, so that they show.
pub fn image(rendering: &Rendering, provenance: Option<Provenance>) -> Image {
    #[expect(clippy::cast_possible_truncation, reason = "files hold f32")]
    let single = |v: [f64; 3]| v.map(|c| c as f32);
    let errors = |p: &PixelEstimate| p.standard_error.map(single);
    Image {
        width: rendering.width as usize,
        height: rendering.height as usize,
        rgb: rendering.pixels.iter().map(|p| single(p.mean)).collect(),
        stderr: rendering.pixels.iter().map(errors).collect(),
        samples: Some(rendering.pixels.iter().map(|p| p.samples as f32).collect()),
        metadata: Metadata { provenance, ..Metadata::default() },
    }
}
