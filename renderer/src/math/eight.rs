//! Eight vectors side by side, so that a formula is evaluated for eight rays at once; each lane gets the bits of the formula alone.

use std::ops::{Add, Mul, Sub};

use glam::DVec3;
use wide::{f32x8, f64x8};

/// Eight vectors of f64, coordinate by coordinate.
#[derive(Debug, Clone, Copy)]
pub struct DVec3x8(pub [f64x8; 3]);

impl DVec3x8 {
    /// The same vector eight times.
    #[inline]
    pub fn splat(v: DVec3) -> Self {
        Self([f64x8::splat(v.x), f64x8::splat(v.y), f64x8::splat(v.z)])
    }

    /// The vectors whose coordinates `v` are.
    #[inline]
    pub fn new(v: [[f32; 8]; 3]) -> Self {
        let [x, y, z] = v;
        Self([widened(x), widened(y), widened(z)])
    }

    /// The dot products, summed in the order of `DVec3::dot`.
    #[inline]
    pub fn dot(self, other: Self) -> f64x8 {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        x * ox + y * oy + z * oz
    }
}

impl Add for DVec3x8 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        Self([x + ox, y + oy, z + oz])
    }
}

impl Sub for DVec3x8 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        let ([x, y, z], [ox, oy, oz]) = (self.0, other.0);
        Self([x - ox, y - oy, z - oz])
    }
}

impl Mul<f64x8> for DVec3x8 {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64x8) -> Self {
        let [x, y, z] = self.0;
        Self([x * factor, y * factor, z * factor])
    }
}

/// Eight numbers as f64.
#[inline]
fn widened(x: [f32; 8]) -> f64x8 {
    let mut wide = [0.0; 8];
    for (wide, x) in wide.iter_mut().zip(x) {
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
