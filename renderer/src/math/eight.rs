//! Eight vectors side by side, so that a formula is evaluated for eight lanes at once; each gets the bits of the formula alone.

use std::ops::{Add, Div, Mul, Sub};

use bytemuck::cast;
use glam::{DVec3, Vec3};
use wide::{f32x8, f64x8, i32x8, u32x8};

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

/// The numbers in those lanes that the three lowest bits of `lanes` tell, with every bit, so that they may stand for integers.
#[inline]
pub fn permuted(of: f32x8, lanes: u32x8) -> f32x8 {
    #[cfg(target_feature = "avx2")]
    return cast(safe_arch::shuffle_av_f32_all_m256(cast(of), cast(lanes)));
    #[cfg(not(target_feature = "avx2"))]
    f32x8::new(lanes.to_array().map(|lane| of.as_array()[lane as usize % 8]))
}

/// Eight integers in descending order, without a branch: a bitonic network of six steps, in each of which every lane meets another and
/// keeps the greater or the smaller of both.
#[inline]
pub fn sorted(of: i32x8) -> i32x8 {
    #[cfg(target_feature = "avx2")]
    {
        use safe_arch::{blend_imm_i32_m256i as blend, m256i, max_i32_m256i as max, min_i32_m256i as min};
        use safe_arch::{permute2z_m256i as halves, shuffle_ai_i32_half_m256i as shuffle};
        let a: m256i = cast(of);
        let b = shuffle::<0b10_11_00_01>(a);
        let a = blend::<0b1010_1010>(max(a, b), min(a, b));
        let b = shuffle::<0b00_01_10_11>(a);
        let a = blend::<0b1100_1100>(max(a, b), min(a, b));
        let b = shuffle::<0b10_11_00_01>(a);
        let a = blend::<0b1010_1010>(max(a, b), min(a, b));
        let b = halves::<0x01>(a, a);
        let b = shuffle::<0b00_01_10_11>(b);
        let a = blend::<0b1111_0000>(max(a, b), min(a, b));
        let b = shuffle::<0b01_00_11_10>(a);
        let a = blend::<0b1100_1100>(max(a, b), min(a, b));
        let b = shuffle::<0b10_11_00_01>(a);
        cast(blend::<0b1010_1010>(max(a, b), min(a, b)))
    }
    #[cfg(not(target_feature = "avx2"))]
    {
        let mut list = of.to_array();
        list.sort_unstable_by(|a, b| b.cmp(a));
        i32x8::new(list)
    }
}

/// The lanes of a mask, given as bits below 256, one after the other from the highest lane on, in the three lowest bits. What follows them
/// is of no meaning.
#[inline]
pub fn packed(mask: u32) -> u32x8 {
    u32x8::splat(PACKED[mask as usize % 256]) >> u32x8::new([0, 4, 8, 12, 16, 20, 24, 28])
}

/// The lanes of each mask, in four bits each.
static PACKED: [u32; 256] = {
    let mut table = [0; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut count) = (8, 0);
        while lane > 0 {
            lane -= 1;
            if mask >> lane & 1 == 1 {
                table[mask] |= lane << (4 * count);
                count += 1;
            }
        }
        mask += 1;
    }
    table
};

/// Eight numbers by their lower and upper halves.
#[inline]
pub fn interleaved(lower: i32x8, upper: i32x8) -> [u64; 8] {
    #[cfg(target_feature = "avx2")]
    {
        use safe_arch::{m256i, permute2z_m256i as halves, unpack_high_i32_m256i, unpack_low_i32_m256i};
        let (a, b): (m256i, m256i) = (cast(lower), cast(upper));
        let (even, odd) = (unpack_low_i32_m256i(a, b), unpack_high_i32_m256i(a, b));
        cast([halves::<0x20>(even, odd), halves::<0x31>(even, odd)])
    }
    #[cfg(not(target_feature = "avx2"))]
    std::array::from_fn(|lane| {
        let [lower, upper] = [lower, upper].map(|half| u64::from(half.as_array()[lane].cast_unsigned()));
        upper << 32 | lower
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight numbers from −16 to 15.
    fn scattered(n: u32) -> [i32; 8] {
        std::array::from_fn(|lane| (n.wrapping_mul(2_654_435_761) >> (3 * lane) & 31) as i32 - 16)
    }

    #[test]
    fn eight_integers_are_sorted_and_permuted() {
        // A network that sorts all zeros and ones sorts everything (Knuth, The Art of Computer Programming 3, 5.3.4).
        let bits = (0..256).map(|n| std::array::from_fn(|lane| n >> lane & 1));
        for list in bits.chain((0..10_000).map(scattered)) {
            let mut expected = list;
            expected.sort_unstable_by(|a, b| b.cmp(a));
            assert_eq!(sorted(i32x8::new(list)).to_array(), expected);
        }
        for n in 0..1000 {
            let (list, lanes) = (scattered(n), scattered(n + 7));
            let expected = lanes.map(|lane| list[(lane & 7) as usize]);
            let by: u32x8 = cast(i32x8::new(lanes));
            let integers: i32x8 = cast(permuted(cast(i32x8::new(list)), by));
            assert_eq!(integers.to_array(), expected);
            let floats = f32x8::new(list.map(|x| x as f32));
            assert_eq!(permuted(floats, by).to_array(), expected.map(|x| x as f32));
            let halves = interleaved(i32x8::new(list), i32x8::new(lanes));
            for ((whole, lower), upper) in halves.iter().zip(list).zip(lanes) {
                assert_eq!(*whole, u64::from(upper.cast_unsigned()) << 32 | u64::from(lower.cast_unsigned()));
            }
        }
    }

    #[test]
    fn lanes_of_a_mask_are_packed() {
        for mask in 0..256 {
            let lanes: Vec<u32> = (0..8).rev().filter(|lane| mask >> lane & 1 == 1).collect();
            let packed = packed(mask).to_array().map(|lane| lane & 7);
            assert_eq!(packed[..lanes.len()], lanes, "{mask:b}");
        }
    }

    #[test]
    fn eight_numbers_step_as_one() {
        let numbers = [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, -1e-45, 1e30, -1e-30];
        assert_eq!(next_up(f32x8::new(numbers)).to_array(), numbers.map(f32::next_up));
    }
}
