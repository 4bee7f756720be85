//! The fourth idea: every number is an estimate.

use crate::math::Rgb;

/// Sums in f64 along a fixed binary tree over the order in which values come.
///
/// Two sums over aligned power-of-two blocks join to the same bits as one sum over both. The rounding error grows
/// with the logarithm of the count, not with the count.
#[derive(Debug, Clone, Default)]
struct TreeSum {
    /// Sums of complete subtrees, largest first; bit k of `count` says whether there is one of 2ᵏ values.
    levels: Vec<[f64; 4]>,
    count: u64,
}

impl TreeSum {
    fn push(&mut self, value: [f64; 4]) {
        let mut sum = value;
        for _ in 0..self.count.trailing_ones() {
            let left = self.levels.pop().expect("one subtree for each bit set in the count");
            sum = add(left, sum);
        }
        self.levels.push(sum);
        self.count += 1;
    }

    fn total(&self) -> [f64; 4] {
        self.levels.iter().rev().fold([0.0; 4], |sum, &level| add(level, sum))
    }
}

fn add(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// The samples of one pixel, replicate by replicate.
#[derive(Debug, Clone)]
pub struct PixelSum {
    replicates: Vec<TreeSum>,
}

impl PixelSum {
    /// No samples yet, for `replicates` independent randomisations.
    pub fn new(replicates: u32) -> Self {
        Self { replicates: vec![TreeSum::default(); replicates as usize] }
    }

    /// Adds a sample of `replicate`: its radiance already multiplied by `weight`.
    pub fn push(&mut self, replicate: u32, weighted: Rgb, weight: f32) {
        let [r, g, b] = weighted.to_array().map(f64::from);
        self.replicates[replicate as usize].push([r, g, b, f64::from(weight)]);
    }

    /// The pixel's value: each replicate's Σ(w·L) / n, or Σ(w·L) / Σw if `by_weight`, and their mean.
    pub fn estimate(&self, by_weight: bool) -> PixelEstimate {
        let values: Vec<[f64; 3]> = self
            .replicates
            .iter()
            .map(|sum| {
                let [r, g, b, w] = sum.total();
                let divisor = if by_weight { w } else { sum.count as f64 };
                if divisor == 0.0 { [0.0; 3] } else { [r / divisor, g / divisor, b / divisor] }
            })
            .collect();
        let n = values.len() as f64;
        let mean: [f64; 3] = std::array::from_fn(|c| values.iter().map(|v| v[c]).sum::<f64>() / n);
        let standard_error = (values.len() > 1).then(|| {
            std::array::from_fn(|c| {
                let squares: f64 = values.iter().map(|v| (v[c] - mean[c]).powi(2)).sum();
                (squares / (n * (n - 1.0))).sqrt()
            })
        });
        PixelEstimate { mean, standard_error, samples: self.replicates.iter().map(|s| s.count).sum() }
    }
}

/// A pixel's radiance with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelEstimate {
    /// Mean radiance, linear sRGB.
    pub mean: [f64; 3],
    /// Standard error of the mean, from the spread of the replicates; `None` with fewer than two.
    pub standard_error: Option<[f64; 3]>,
    /// Samples taken, over all replicates.
    pub samples: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_join_to_the_same_bits() {
        let values: Vec<[f64; 4]> =
            (1..=24).map(|i| [1.0 / f64::from(i), 0.1 * f64::from(i), 1e-9, 1.0]).collect();
        let sum = |values: &[[f64; 4]]| {
            let mut tree = TreeSum::default();
            values.iter().for_each(|&v| tree.push(v));
            tree
        };
        let blocks = add(sum(&values[..16]).total(), sum(&values[16..]).total());
        assert_eq!(sum(&values).total(), blocks);
    }

    #[test]
    fn a_long_sum_of_equal_values_is_exact_to_a_few_roundings() {
        let mut tree = TreeSum::default();
        (0..1 << 20).for_each(|_| tree.push([0.1, 0.0, 0.0, 1.0]));
        assert_eq!(tree.total()[0], 0.1 * f64::from(1 << 20)); // a power of two times 0.1: the tree doubles exactly
        assert_eq!(tree.total()[3], f64::from(1 << 20));
    }

    #[test]
    fn the_error_is_that_of_the_replicates() {
        let mut pixel = PixelSum::new(2);
        pixel.push(0, Rgb::splat(1.0), 1.0);
        pixel.push(1, Rgb::splat(3.0), 1.0);
        let estimate = pixel.estimate(false);
        assert_eq!(estimate.mean, [2.0; 3]);
        assert_eq!(estimate.standard_error, Some([1.0; 3])); // s = √2, s/√2 = 1
        assert_eq!(PixelSum::new(1).estimate(false).standard_error, None);
    }

    #[test]
    fn a_weighted_average_of_a_constant_is_that_constant() {
        let mut pixel = PixelSum::new(1);
        for w in [0.3, 0.9, 0.25] {
            pixel.push(0, Rgb::splat(2.0) * w, w);
        }
        let mean = pixel.estimate(true).mean[0];
        assert!((mean - 2.0).abs() < 3.0 * 2.0 * f64::from(f32::EPSILON)); // one f32 product a sample
    }
}
