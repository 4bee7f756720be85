//! Triples of linear sRGB values.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

use glam::Vec3;

/// A linear sRGB triple: a reflectance (dimensionless), a radiance [W m⁻² sr⁻¹] or a path's throughput.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rgb {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

impl Rgb {
    /// All zero.
    pub const BLACK: Self = Self::splat(0.0);
    /// All one.
    pub const WHITE: Self = Self::splat(1.0);

    /// The triple of `r`, `g` and `b`.
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// The triple with the same value in each channel.
    pub const fn splat(value: f32) -> Self {
        Self { r: value, g: value, b: value }
    }

    /// The channels in the order red, green, blue.
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }

    /// The value of `f` on each channel.
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// The largest channel.
    pub fn max_component(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// The arithmetic mean of the channels.
    pub fn mean(self) -> f32 {
        (self.r + self.g + self.b) / 3.0
    }

    /// The CIE 1931 luminance of a linear sRGB value.
    ///
    /// # Source
    /// Rec. ITU-R BT.709, with the digits of Mitsuba 3.9.1.
    pub fn luminance(self) -> f32 {
        0.212_671 * self.r + 0.715_16 * self.g + 0.072_169 * self.b
    }

    /// Whether every channel is exactly zero.
    pub fn is_black(self) -> bool {
        self == Self::BLACK
    }

    /// Whether every channel is finite.
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }
}

impl From<[f32; 3]> for Rgb {
    fn from([r, g, b]: [f32; 3]) -> Self {
        Self::new(r, g, b)
    }
}

impl From<Vec3> for Rgb {
    fn from(Vec3 { x, y, z }: Vec3) -> Self {
        Self::new(x, y, z)
    }
}

impl Add for Rgb {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.r + o.r, self.g + o.g, self.b + o.b)
    }
}

impl AddAssign for Rgb {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Rgb {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.r - o.r, self.g - o.g, self.b - o.b)
    }
}

impl Mul for Rgb {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(self.r * o.r, self.g * o.g, self.b * o.b)
    }
}

impl MulAssign for Rgb {
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    fn mul(self, s: f32) -> Self {
        self.map(|c| c * s)
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    fn div(self, s: f32) -> Self {
        self.map(|c| c / s)
    }
}
