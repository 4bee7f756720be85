//! Images on surfaces.

use glam::{Affine2, Vec2};

use super::checkerboard::check_to_uv;
use super::range_of;
use crate::error::ParamError;
use crate::math::Rgb;

/// How values between the centres of texels are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// The value of the texel that the point lies in.
    Nearest,
    /// Linear in each direction between the four nearest centres.
    #[default]
    Bilinear,
}

/// What lies outside the unit square.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, every second copy mirrored.
    Mirror,
    /// The nearest texel of the border.
    Clamp,
}

/// An image of linear sRGB values over the unit square of surface coordinates.
///
/// Texel (i, j) of an image of w × h texels has its centre at ((i + ½)/w, (j + ½)/h); row 0 is the image's upper
/// row, so v grows downwards over the image.
///
/// # Precision, limits
/// Images of at most 2²⁴ texels in each direction, so that f32 holds every index.
///
/// # Source
/// The plugin `bitmap` of Mitsuba 3.9.1, measured at points inside, outside and on the border.
#[derive(Debug, Clone, PartialEq)]
pub struct Bitmap {
    size: [u32; 2],
    pixels: Vec<Rgb>,
    to_uv: Affine2,
    filter: Filter,
    wrap: Wrap,
}

impl Bitmap {
    /// The most texels in one direction.
    pub const MAX_SIZE: u32 = 1 << 24;

    /// The image of `size` texels (width, height), given row by row from the upper left corner; `to_uv` is
    /// applied to the surface coordinates first. Pixels are linear: whoever loads an image decodes it.
    ///
    /// # Errors
    /// [`ParamError::Empty`] without texels; [`ParamError::OutOfRange`] when a side is too long or the number of
    /// pixels is not width × height; [`ParamError::NotFinite`] for a pixel or a transform that is not finite.
    pub fn new(
        size: [u32; 2],
        pixels: Vec<Rgb>,
        to_uv: Affine2,
        filter: Filter,
        wrap: Wrap,
    ) -> Result<Self, ParamError> {
        check_to_uv(to_uv)?;
        if size.contains(&0) {
            return Err(ParamError::Empty { name: "bitmap", accepted: "at least one texel" });
        }
        if let Some(&side) = size.iter().find(|&&side| side > Self::MAX_SIZE) {
            let value = f64::from(side);
            return Err(ParamError::OutOfRange { name: "bitmap side", value, accepted: "1 to 16777216" });
        }
        if u64::try_from(pixels.len()) != Ok(u64::from(size[0]) * u64::from(size[1])) {
            let value = pixels.len() as f64;
            return Err(ParamError::OutOfRange {
                name: "number of pixels",
                value,
                accepted: "width × height",
            });
        }
        if let Some(bad) = pixels.iter().flat_map(|p| p.to_array()).find(|c| !c.is_finite()) {
            return Err(ParamError::NotFinite { name: "pixel", value: f64::from(bad) });
        }
        Ok(Self { size, pixels, to_uv, filter, wrap })
    }

    /// The value at the surface coordinates `uv`, whose transform must be finite.
    pub fn eval(&self, uv: [f32; 2]) -> Rgb {
        let p = self.to_uv.transform_point2(Vec2::from(uv));
        let x = brought_near(p.x, self.wrap) * self.size[0] as f32;
        let y = brought_near(p.y, self.wrap) * self.size[1] as f32;
        match self.filter {
            Filter::Nearest => self.texel(x.floor(), y.floor()),
            Filter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (x0, y0) = (x.floor(), y.floor());
                let (s, t) = (x - x0, y - y0);
                let upper = self.texel(x0, y0) * (1.0 - s) + self.texel(x0 + 1.0, y0) * s;
                let lower = self.texel(x0, y0 + 1.0) * (1.0 - s) + self.texel(x0 + 1.0, y0 + 1.0) * s;
                upper * (1.0 - t) + lower * t
            }
        }
    }

    /// The texel in whole-numbered column `x` and row `y`, wrapped into the image.
    fn texel(&self, x: f32, y: f32) -> Rgb {
        let column = wrapped(x, self.size[0], self.wrap);
        let row = wrapped(y, self.size[1], self.wrap);
        self.pixels[row * self.size[0] as usize + column]
    }

    pub(super) fn range(&self) -> [f32; 2] {
        range_of(self.pixels.iter().copied())
    }

    pub(super) fn mean(&self) -> f32 {
        let sum: f64 = self.pixels.iter().map(|p| f64::from(p.mean())).sum();
        #[expect(clippy::cast_possible_truncation, reason = "a mean of f32 values is in their range")]
        let mean = (sum / self.pixels.len() as f64) as f32;
        mean
    }
}

/// A coordinate in [−1, 2] that shows the same, so that no product with a size overflows.
fn brought_near(p: f32, wrap: Wrap) -> f32 {
    match wrap {
        Wrap::Repeat => p - p.floor(),
        Wrap::Mirror => p.rem_euclid(2.0),
        Wrap::Clamp => p.clamp(-1.0, 2.0),
    }
}

/// The index in 0..n that the whole number `i` stands for.
fn wrapped(i: f32, n: u32, wrap: Wrap) -> usize {
    let n = n as f32;
    let i = match wrap {
        Wrap::Clamp => i.clamp(0.0, n - 1.0),
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let j = i.rem_euclid(2.0 * n);
            j.min(2.0 * n - 1.0 - j)
        }
    };
    #[expect(clippy::cast_possible_truncation, reason = "0 <= i <= n − 1, a u32")]
    let index = i as usize;
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramps(filter: Filter, wrap: Wrap) -> Bitmap {
        let pixels = (0..3_u8).flat_map(|y| (0..4_u8).map(move |x| [x, y].map(f32::from)));
        let pixels = pixels.map(|[x, y]| Rgb::new(x / 8.0, y / 8.0, (x + 4.0 * y) / 16.0)).collect();
        Bitmap::new([4, 3], pixels, Affine2::IDENTITY, filter, wrap).unwrap()
    }

    /// Values that Mitsuba 3.9.1 (`scalar_rgb`) returned for the same 4 × 3 image.
    #[test]
    fn texels_are_those_of_mitsuba() {
        use {Filter::*, Wrap::*};
        let asked = [
            (Nearest, Repeat, [0.3, 0.2], [0.125, 0.0, 0.0625]),
            (Nearest, Repeat, [0.5, 0.5], [0.25, 0.125, 0.375]),
            (Nearest, Repeat, [-0.1, -0.3], [0.375, 0.25, 0.6875]),
            (Nearest, Repeat, [1.0, 1.0], [0.0, 0.0, 0.0]),
            (Nearest, Mirror, [1.1, 0.2], [0.375, 0.0, 0.1875]),
            (Nearest, Mirror, [2.3, -1.7], [0.125, 0.0, 0.0625]),
            (Nearest, Clamp, [2.3, -1.7], [0.375, 0.0, 0.1875]),
            (Bilinear, Repeat, [0.0, 0.0], [0.1875, 0.125, 0.34375]),
            (Bilinear, Repeat, [0.99, 0.01], [0.2025, 0.1175, 0.33625]),
            (Bilinear, Repeat, [-0.1, -0.3], [0.3375, 0.2, 0.56875]),
            (Bilinear, Mirror, [0.3, 0.2], [0.0875, 0.0125, 0.06875]),
            (Bilinear, Mirror, [-0.1, -0.3], [0.0, 0.05, 0.1]),
            (Bilinear, Mirror, [2.3, -1.7], [0.0875, 0.05, 0.14375]),
            (Bilinear, Clamp, [1.1, 0.2], [0.375, 0.0125, 0.2125]),
            (Bilinear, Clamp, [-0.1, -0.3], [0.0, 0.0, 0.0]),
        ];
        for (filter, wrap, uv, expected) in asked {
            let got = ramps(filter, wrap).eval(uv).to_array();
            for (g, e) in got.into_iter().zip(expected) {
                // Coordinates up to 10 texels from the origin carry 2⁻²⁰; slopes are at most ⅛ × 4 a texel.
                assert!((g - e).abs() < 1e-6, "{filter:?} {wrap:?} {uv:?}: {g} for {e}");
            }
        }
    }

    #[test]
    fn far_coordinates_stay_inside_the_image() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Nearest, Filter::Bilinear] {
                for far in [1e7, -1e7, 1e30, -1e30, -1e-30, f32::MAX, f32::MIN] {
                    assert!(ramps(filter, wrap).eval([far, far]).is_finite(), "{wrap:?} {filter:?} {far}");
                }
            }
        }
    }

    #[test]
    fn wrong_sizes_and_values_are_refused() {
        let new = |size, pixels| Bitmap::new(size, pixels, Affine2::IDENTITY, Filter::Nearest, Wrap::Repeat);
        assert!(matches!(new([0, 1], vec![]), Err(ParamError::Empty { .. })));
        assert!(matches!(new([2, 1], vec![Rgb::BLACK]), Err(ParamError::OutOfRange { .. })));
        assert!(matches!(new([1, 1], vec![Rgb::splat(f32::NAN)]), Err(ParamError::NotFinite { .. })));
        assert!(matches!(new([1 << 25, 1], vec![]), Err(ParamError::OutOfRange { .. })));
    }
}
