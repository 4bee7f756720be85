//! Eight vectors side by side, so that a formula is evaluated for eight lanes at once; each gets the bits of the formula alone.

use std::ops::{Add, Div, Mul, Sub};

use bytemuck::cast;
use glam::{DVec3, Vec3};
use wide::{f32x8, f64x8, i32x8};

/// Eight vectors, coordinate by coordinate.
#[derive(Debug, Clone, Copy, Default)]
pub struct Eight<T>(pub [T; 3]);

/// Eight vectors of f32.
pub type Vec3x8 = Eight<f32x8>;

/// Eight vectors of f64.
pub type DVec3x8 = Eight<f64x8>;

impl<T> Eight<T> {
    /// `f` of each coordinate.
    #[inline]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Eight<U> {
        let [x, y, z] = self.0;
        Eight([f(x), f(y), f(z)])
    }
}

impl<T: Copy + Add<Output = T> + Mul<Output = T>> Eight<T> {
    /// The dot products, summed in the order of `Vec3::dot`.
    #[inline]
    pub fn dot(self, other: Self) -> T {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        x * ox + y * oy + z * oz
    }
}

impl<T: Copy + Sub<Output = T> + Mul<Output = T>> Eight<T> {
    /// The cross products, in the order of `Vec3::cross`.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        Self([y * oz - oy * z, z * ox - oz * x, x * oy - ox * y])
    }
}

impl<T: Add<Output = T>> Add for Eight<T> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        Self([x + ox, y + oy, z + oz])
    }
}

impl<T: Sub<Output = T>> Sub for Eight<T> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        Self([x - ox, y - oy, z - oz])
    }
}

impl<T: Copy + Mul<Output = T>> Mul<T> for Eight<T> {
    type Output = Self;

    #[inline]
    fn mul(self, factor: T) -> Self {
        self.map(|c| c * factor)
    }
}

impl<T: Copy + Div<Output = T>> Div<T> for Eight<T> {
    type Output = Self;

    #[inline]
    fn div(self, divisor: T) -> Self {
        self.map(|c| c / divisor)
    }
}

impl DVec3x8 {
    /// The same vector eight times.
    #[inline]
    pub fn splat(v: DVec3) -> Self {
        Self([f64x8::splat(v.x), f64x8::splat(v.y), f64x8::splat(v.z)])
    }

    /// The same vectors but for those of `other` in the lanes of `mask`.
    #[inline]
    pub fn replaced(self, mask: f64x8, other: Self) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        Self([mask.select(ox, x), mask.select(oy, y), mask.select(oz, z)])
    }

    /// The vectors rounded to f32.
    #[inline]
    pub fn rounded(self) -> Vec3x8 {
        self.map(rounded)
    }
}

impl Vec3x8 {
    /// Zero eight times.
    pub const ZERO: Self = Self([f32x8::ZERO; 3]);

    /// The same vector eight times.
    #[inline]
    pub fn splat(v: Vec3) -> Self {
        Self([f32x8::splat(v.x), f32x8::splat(v.y), f32x8::splat(v.z)])
    }

    /// The vectors in f64.
    #[inline]
    pub fn widened(self) -> DVec3x8 {
        self.map(widened)
    }

    /// The vector in a lane below 8.
    #[inline]
    pub fn get(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(x.as_array()[lane], y.as_array()[lane], z.as_array()[lane])
    }

    /// Puts a vector into a lane below 8.
    #[inline]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        let [x, y, z] = &mut self.0;
        (x.as_mut_array()[lane], y.as_mut_array()[lane], z.as_mut_array()[lane]) = (v.x, v.y, v.z);
    }
}

/// Up to eight points of the unit square, coordinate by coordinate.
#[inline]
pub fn pairs(points: &[[f32; 2]]) -> [f32x8; 2] {
    let [mut u, mut v] = [f32x8::ZERO; 2];
    for (lane, point) in points.iter().enumerate().take(8) {
        [u.as_mut_array()[lane], v.as_mut_array()[lane]] = *point;
    }
    [u, v]
}

/// Eight numbers as f64.
#[inline]
pub fn widened(x: f32x8) -> f64x8 {
    let mut wide = [0.0; 8];
    for (wide, x) in wide.iter_mut().zip(x.to_array()) {
        *wide = f64::from(x);
    }
    f64x8::new(wide)
}

/// Eight numbers rounded to the nearest f32.
#[inline]
pub fn rounded(x: f64x8) -> f32x8 {
    let mut rounded = [0.0; 8];
    for (rounded, x) in rounded.iter_mut().zip(x.to_array()) {
        *rounded = super::float::round_f32(x);
    }
    f32x8::new(rounded)
}

/// `f32::next_up` of eight finite numbers.
#[inline]
pub fn next_up(x: f32x8) -> f32x8 {
    // −0 becomes 0; below it the bits count down.
    let bits: i32x8 = cast(x + f32x8::ZERO);
    cast(bits + (bits >> 31_u32 | i32x8::ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_numbers_step_as_one() {
        let numbers = [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, -1e-45, 1e30, -1e-30];
        assert_eq!(next_up(f32x8::new(numbers)).to_array(), numbers.map(f32::next_up));
    }
}
