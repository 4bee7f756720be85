//! The fourth idea: every number is an estimate.

use smallvec::SmallVec;

use super::Reconstruction;
use crate::math::Rgb;

/// Sums in f64 along a fixed binary tree over the indices of the values.
///
/// The tree's nodes are the blocks [k·2ˡ, (k + 1)·2ˡ). The sum of a range holds the largest nodes inside it, so that
/// two sums of adjoining ranges join to the same bits as one sum over both. The rounding error grows with the
/// logarithm of the count, not with the count.
#[derive(Debug, Clone)]
struct TreeSum {
    start: u64,
    end: u64,
    /// Levels and sums of complete nodes, in the order of their indices.
    nodes: SmallVec<[(u32, [f64; 4]); 4]>,
}

impl TreeSum {
    /// Nothing yet, before the value of index `start`.
    fn new(start: u64) -> Self {
        Self { start, end: start, nodes: SmallVec::new() }
    }

    /// Adds a node of 2^`level` values that follow on those here, and joins what makes up larger nodes.
    fn append(&mut self, mut level: u32, mut sum: [f64; 4]) {
        self.end += 1 << level;
        while let Some(&(left_level, left)) = self.nodes.last()
            && left_level == level
            && self.end.trailing_zeros() > level
        {
            self.nodes.pop();
            sum = add(left, sum);
            level += 1;
        }
        self.nodes.push((level, sum));
    }

    /// Adds values that follow on those here, whole nodes of eight at once.
    fn extend(&mut self, mut values: &[[f64; 4]]) {
        while let Some((&value, rest)) = values.split_first() {
            match values.split_first_chunk() {
                Some((&[a, b, c, d, e, f, g, h], rest)) if self.end.is_multiple_of(8) => {
                    let [left, right] = [add(add(a, b), add(c, d)), add(add(e, f), add(g, h))];
                    self.append(3, add(left, right));
                    values = rest;
                }
                _ => {
                    self.append(0, value);
                    values = rest;
                }
            }
        }
    }

    fn count(&self) -> u64 {
        self.end - self.start
    }

    /// What the sum is divided by: n, or Σw.
    fn divisor(&self, reconstruction: Reconstruction) -> f64 {
        match reconstruction {
            Reconstruction::Importance => self.count() as f64,
            Reconstruction::Weighted => self.total()[3],
        }
    }

    fn total(&self) -> [f64; 4] {
        self.nodes.iter().rev().fold([0.0; 4], |sum, &(_, node)| add(node, sum))
    }
}

/// The levels of the nodes of a sum over the indices `start` to `end` − 1.
pub(super) fn levels([start, end]: [u64; 2]) -> Vec<u32> {
    let (mut at, mut levels) = (start, Vec::new());
    while at < end {
        let level = (end - at).ilog2().min(at.trailing_zeros());
        levels.push(level);
        at += 1 << level;
    }
    levels
}

fn add(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// What is summed of a sample: its radiance already multiplied by `weight`, and `weight`.
pub fn values(weighted: Rgb, weight: f32) -> [f64; 4] {
    [weighted.r, weighted.g, weighted.b, weight].map(f64::from)
}

/// The samples of one pixel, replicate by replicate.
#[derive(Debug, Clone)]
pub struct PixelSum {
    replicates: Vec<TreeSum>,
}

impl PixelSum {
    /// No samples yet, for `replicates` independent randomisations.
    pub fn new(replicates: u32) -> Self {
        Self::starting_at(replicates, 0)
    }

    /// No samples yet; the first of each replicate has index `start`.
    pub fn starting_at(replicates: u32, start: u32) -> Self {
        Self { replicates: vec![TreeSum::new(u64::from(start)); replicates as usize] }
    }

    /// Its sums as numbers: replicate by replicate, four for each node in the order of [`levels`].
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.replicates.iter().flat_map(|sum| sum.nodes.iter().flat_map(|(_, node)| *node))
    }

    /// Adds sums over the samples that follow, given as [`Self::numbers`] gives them.
    pub(super) fn append(&mut self, levels: &[u32], numbers: &[f64]) {
        let mut nodes = numbers.as_chunks().0.iter();
        for sum in &mut self.replicates {
            levels.iter().zip(nodes.by_ref()).for_each(|(&level, &node)| sum.append(level, node));
        }
    }

    /// Adds a sample of `replicate`: its radiance already multiplied by `weight`.
    pub fn push(&mut self, replicate: u32, weighted: Rgb, weight: f32) {
        self.extend(replicate, &[values(weighted, weight)]);
    }

    /// Adds samples of `replicate`, each as [`values`] gives it.
    pub fn extend(&mut self, replicate: u32, samples: &[[f64; 4]]) {
        self.replicates[replicate as usize].extend(samples);
    }

    /// Adds `by` to the value that a replicate's samples, all of them here, give.
    pub fn raise(&mut self, replicate: u32, by: [f64; 3], reconstruction: Reconstruction) {
        let sum = &mut self.replicates[replicate as usize];
        let divisor = sum.divisor(reconstruction);
        if let Some((_, node)) = sum.nodes.last_mut() {
            node.iter_mut().zip(by).for_each(|(sum, by)| *sum += by * divisor);
        }
    }

    /// The pixel's value: each replicate's Σ(w·L) / n, or Σ(w·L) / Σw if weighted, and their mean.
    pub fn estimate(&self, reconstruction: Reconstruction) -> PixelEstimate {
        let values: Vec<[f64; 3]> = self
            .replicates
            .iter()
            .map(|sum| {
                let [r, g, b, _] = sum.total();
                let divisor = sum.divisor(reconstruction);
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
        PixelEstimate { mean, standard_error, samples: self.replicates.iter().map(TreeSum::count).sum() }
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

    fn sum_of(values: &[[f64; 4]], start: u64) -> TreeSum {
        let mut tree = TreeSum::new(start);
        values.iter().for_each(|&v| tree.append(0, v));
        tree
    }

    #[test]
    fn adjoining_ranges_join_to_the_same_bits_wherever_they_are_cut() {
        let values: Vec<[f64; 4]> =
            (1..=77).map(|i| [1.0 / f64::from(i), 0.1 * f64::from(i), 1e-9, 1.0]).collect();
        let whole = sum_of(&values, 0);
        for cut in 0..=77 {
            let mut at_once = TreeSum::new(0);
            at_once.extend(&values[..cut]);
            at_once.extend(&values[cut..]);
            assert_eq!(
                (at_once.total(), at_once.nodes.len()),
                (whole.total(), whole.nodes.len()),
                "cut at {cut}"
            );
            let mut joined = sum_of(&values[..cut], 0);
            let second = sum_of(&values[cut..], cut as u64);
            let found: Vec<u32> = second.nodes.iter().map(|(level, _)| *level).collect();
            assert_eq!(found, levels([cut as u64, 77]), "cut at {cut}");
            second.nodes.iter().for_each(|&(level, sum)| joined.append(level, sum));
            assert_eq!((joined.total(), joined.count()), (whole.total(), 77), "cut at {cut}");
        }
    }

    #[test]
    fn a_long_sum_of_equal_values_is_exact_to_a_few_roundings() {
        let total = sum_of(&vec![[0.1, 0.0, 0.0, 1.0]; 1 << 20], 0).total();
        assert_eq!(total[0], 0.1 * f64::from(1 << 20)); // a power of two times 0.1: the tree doubles exactly
        assert_eq!(total[3], f64::from(1 << 20));
    }

    #[test]
    fn the_error_is_that_of_the_replicates() {
        let mut pixel = PixelSum::new(2);
        pixel.push(0, Rgb::splat(1.0), 1.0);
        pixel.push(1, Rgb::splat(3.0), 1.0);
        let estimate = pixel.estimate(Reconstruction::Importance);
        assert_eq!(estimate.mean, [2.0; 3]);
        assert_eq!(estimate.standard_error, Some([1.0; 3])); // s = √2, s/√2 = 1
        assert_eq!(PixelSum::new(1).estimate(Reconstruction::Importance).standard_error, None);
    }

    #[test]
    fn a_weighted_average_of_a_constant_is_that_constant() {
        let mut pixel = PixelSum::new(1);
        for w in [0.3, 0.9, 0.25] {
            pixel.push(0, Rgb::splat(2.0) * w, w);
        }
        let mean = pixel.estimate(Reconstruction::Weighted).mean[0];
        assert!((mean - 2.0).abs() < 3.0 * 2.0 * f64::from(f32::EPSILON)); // one f32 product a sample
    }
}
