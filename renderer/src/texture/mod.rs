//! Rank 2: values that vary over a surface, looked up at its (u, v) coordinates.

pub mod bitmap;
pub mod checkerboard;

use std::sync::Arc;

pub use bitmap::{Bitmap, Filter, Wrap};
pub use checkerboard::Checkerboard;

use crate::error::ParamError;
use crate::math::Rgb;

/// A linear sRGB value for every point of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Texture {
    /// The same value everywhere.
    Constant(Rgb),
    /// Two values in turn.
    Checkerboard(Checkerboard),
    /// The pixels of an image.
    Bitmap(Arc<Bitmap>),
}

impl Texture {
    /// The value at the surface coordinates `uv`, which may be any finite numbers.
    pub fn eval(&self, uv: [f32; 2]) -> Rgb {
        match self {
            Self::Constant(value) => *value,
            Self::Checkerboard(board) => board.eval(uv),
            Self::Bitmap(bitmap) => bitmap.eval(uv),
        }
    }

    /// The value as one number: the mean of a constant's channels and of a checkerboard's, the luminance of an image's
    /// pixels, as in Mitsuba 3.9.1.
    pub fn eval_scalar(&self, uv: [f32; 2]) -> f32 {
        let value = self.eval(uv);
        match self {
            Self::Constant(_) | Self::Checkerboard(_) => value.mean(),
            Self::Bitmap(_) => value.luminance(),
        }
    }

    /// The smallest and the largest channel found anywhere on the texture.
    pub fn range(&self) -> [f32; 2] {
        match self {
            Self::Constant(value) => range_of([*value]),
            Self::Checkerboard(board) => board.range(),
            Self::Bitmap(bitmap) => bitmap.range(),
        }
    }

    /// Whether it looks at surface coordinates.
    pub fn varies(&self) -> bool {
        !matches!(self, Self::Constant(_))
    }

    /// Whether it is 0 everywhere.
    pub fn is_black(&self) -> bool {
        self.range() == [0.0; 2]
    }

    /// The largest channel found anywhere on the texture.
    pub fn max(&self) -> f32 {
        self.range()[1]
    }

    /// The mean over one period of the texture and the three channels; wrapping and `to_uv` are not looked at.
    pub fn mean(&self) -> f32 {
        match self {
            Self::Constant(value) => value.mean(),
            Self::Checkerboard(board) => board.mean(),
            Self::Bitmap(bitmap) => bitmap.mean(),
        }
    }

    /// Checks that the texture can be a reflectance or a transmittance.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] and [`ParamError::OutOfRange`] when a channel is not in [0, 1].
    pub fn check_reflectance(&self, name: &'static str) -> Result<(), ParamError> {
        for value in self.range() {
            if !value.is_finite() {
                return Err(ParamError::NotFinite { name, value: f64::from(value) });
            }
            if !(0.0..=1.0).contains(&value) {
                return Err(ParamError::OutOfRange { name, value: f64::from(value), accepted: "0 to 1" });
            }
        }
        Ok(())
    }
}

impl From<Rgb> for Texture {
    fn from(value: Rgb) -> Self {
        Self::Constant(value)
    }
}

/// The smallest and the largest channel of `values`; NaN twice when any channel is NaN.
fn range_of(values: impl IntoIterator<Item = Rgb>) -> [f32; 2] {
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    for channel in values.into_iter().flat_map(Rgb::to_array) {
        if channel.is_nan() {
            return [channel; 2];
        }
        range = [range[0].min(channel), range[1].max(channel)];
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectances_are_checked_channel_by_channel() {
        assert!(Texture::from(Rgb::new(0.0, 1.0, 0.5)).check_reflectance("reflectance").is_ok());
        for bad in [-0.001, 1.001, f32::NAN, f32::INFINITY] {
            for rgb in [Rgb::new(bad, 0.5, 0.5), Rgb::new(0.5, bad, 0.5), Rgb::new(0.5, 0.5, bad)] {
                assert!(Texture::from(rgb).check_reflectance("reflectance").is_err(), "{rgb:?}");
            }
        }
    }
}
