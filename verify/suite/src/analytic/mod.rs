//! Scenes whose images mathematics knows, as files for any renderer: plain Mitsuba XML and exact pixels.

use std::collections::BTreeMap;

use renderer::io::{Image, Metadata};

use crate::setup::pixel_middles;

mod readme;
mod scenes;
mod xml;

pub use readme::readme;
pub use scenes::all;

/// A scene with its exact image.
pub struct Analytic {
    /// Name of its files.
    pub name: &'static str,
    /// What is to be seen, in one sentence.
    pub says: &'static str,
    /// The scene as Mitsuba XML.
    pub xml: String,
    /// Columns and rows.
    pub size: [u32; 2],
    /// The radiance of a pixel, from its middle: to the right and upwards, in pixels from the film's middle.
    pub exact: Box<dyn Fn([f64; 2]) -> f64 + Send + Sync>,
    /// The radiance that an error is measured by: the brightest that the scene can show.
    pub scale: f64,
    /// Whether Mitsuba 3.9.1 renders it; it has no moving shapes.
    pub mitsuba: bool,
}

impl Analytic {
    /// Its exact pixels, row by row from the top.
    pub fn values(&self) -> Vec<f64> {
        pixel_middles(self.size).into_iter().map(&self.exact).collect()
    }

    /// Its exact image, with standard errors of 0.
    pub fn image(&self) -> Image {
        #[expect(clippy::cast_possible_truncation, reason = "image files hold f32")]
        let rgb: Vec<[f32; 3]> = self.values().into_iter().map(|value| [value as f32; 3]).collect();
        let texts = [("lightproof.replicates", "exact"), ("lightproof.analytic", self.name)];
        let texts: BTreeMap<String, String> =
            texts.into_iter().map(|(name, text)| (String::from(name), String::from(text))).collect();
        let stderr = Some(vec![[0.0; 3]; rgb.len()]);
        let metadata = Metadata { provenance: None, texts };
        let [width, height] = self.size.map(|side| side as usize);
        Image { stderr, metadata, ..Image::new(width, height, rgb) }
    }
}
