//! The 16×16 tiles of two images: tests that depend neither on the pooled mean nor on one another, so that all keep their level together.
//!
//! The tiles' normal scores z, weighted with the unit vector u of their standard errors, add up to the score of the pooled mean. A
//! reflection that makes u one of the axes leaves the others standard normal, independent of it and of one another (Householder 1958,
//! 10.1145/320941.320947): cⱼ = zⱼ − uⱼ(u·z + zₖ)/(1 + uₖ) for all tiles but k, the one whose u is the largest, which the mean sees best.
//! Of these contrasts the largest is one test, and the sum of the other squares, given that they are smaller, another.

use super::Image;
use super::comparison::{differences, rounding, smallest};
use crate::power::chi_square_sf;
use crate::tails::{any_of, normal_tail};
use crate::welch::Difference;
use statrs::function::gamma::{gamma_lr, gamma_ur};

/// Number of contrasts from which the worst tile is tested by itself: with fewer the sum of all squares sees it as well, and the
/// distribution of [`smaller_squares_sf`] is not good enough (a rate of 1e-2 is 4 % off with eight, and 18 % with four).
const FEWEST_CONTRASTS: usize = 8;

/// The tiles' sums.
#[derive(Debug, Clone, PartialEq)]
pub struct Tiles {
    /// Number of tiles.
    pub count: usize,
    /// Index of the tile with the smallest p in any channel, in rows.
    pub worst: usize,
    /// p of the largest contrast of tiles, over all of them and all channels; `None` for fewer than eight contrasts.
    pub worst_p_value: Option<f64>,
    /// Σ of the squared contrasts of tiles over all channels, without the largest where that is tested by itself.
    pub chi_square: f64,
    /// p of that sum; `None` for a single tile, which has no contrast.
    pub chi_square_p_value: Option<f64>,
    /// Normal score of each tile's difference over all channels, with its sign, in rows.
    pub scores: Vec<f64>,
}

/// The differences of all tiles, each as a list of its channels and their sum.
pub(super) struct Differences(Vec<Vec<Difference>>);

impl Differences {
    pub(super) fn of(a: &Image, b: &Image) -> Self {
        let rounding = rounding(a, b);
        Self(a.tiles().iter().zip(&b.tiles()).map(|(a, b)| differences(a, b, rounding)).collect())
    }

    /// Tests of one channel, or of the sum of all as the last.
    pub(super) fn tests(&self, channel: usize) -> TileTests {
        // A tile without any noise and without difference, such as a black one, says nothing.
        let counts = |d: &&Difference| d.error > 0.0 || d.t != 0.0;
        let tiles: Vec<&Difference> = self.0.iter().map(|tile| &tile[channel]).filter(counts).collect();
        let scores: Vec<f64> = tiles.iter().map(|d| score(d)).collect();
        TileTests::of(&contrasts(&scores, &tiles.iter().map(|d| d.error).collect::<Vec<_>>()))
    }

    /// What is told of the tiles, from the tests of each view: the last is the sum of all channels.
    pub(super) fn summary(&self, views: &[TileTests]) -> Tiles {
        let p_values: Vec<f64> = self.0.iter().map(|tile| smallest(tile)).collect();
        let worst = views.iter().filter_map(|tests| tests.worst).reduce(f64::min);
        let sum = views.last();
        Tiles {
            count: self.0.len(),
            worst: (0..p_values.len()).min_by(|&i, &j| p_values[i].total_cmp(&p_values[j])).unwrap_or(0),
            worst_p_value: worst.map(|p| (p * views.len() as f64).min(1.0)),
            chi_square: sum.map_or(0.0, |tests| tests.chi_square),
            chi_square_p_value: sum.and_then(|tests| tests.rest),
            scores: self.0.iter().filter_map(|tile| tile.last()).map(score).collect(),
        }
    }
}

fn score(difference: &Difference) -> f64 {
    difference.normal_score().copysign(difference.t)
}

/// Independent tests of a list of contrasts.
#[derive(Debug, Clone, Copy)]
pub(super) struct TileTests {
    /// p of the largest contrast.
    worst: Option<f64>,
    /// Σ of the other squares, or of all where the largest is not tested.
    chi_square: f64,
    /// Its p.
    rest: Option<f64>,
}

impl TileTests {
    fn of(contrasts: &[f64]) -> Self {
        let mut squares: Vec<f64> = contrasts.iter().map(|c| c * c).collect();
        squares.sort_by(f64::total_cmp);
        let count = squares.len() as f64;
        if squares.len() < FEWEST_CONTRASTS {
            let chi_square = squares.iter().sum();
            let rest = (count > 0.0).then(|| chi_square_sf(chi_square, count));
            return Self { worst: None, chi_square, rest };
        }
        let largest = squares.pop().unwrap_or(0.0);
        let chi_square = squares.iter().sum();
        Self {
            worst: Some(any_of(count, 2.0 * normal_tail(largest.sqrt()))),
            chi_square,
            rest: Some(smaller_squares_sf(chi_square, count - 1.0, largest)),
        }
    }

    pub(super) fn p_values(&self) -> impl Iterator<Item = f64> {
        [self.worst, self.rest].into_iter().flatten()
    }
}

/// Standard normal contrasts of standard normal scores, independent of one another and of their sum weighted with `errors`.
fn contrasts(scores: &[f64], errors: &[f64]) -> Vec<f64> {
    let length = errors.iter().map(|error| error * error).sum::<f64>().sqrt();
    if length == 0.0 {
        return scores.to_vec(); // nothing is random: no mean to be independent of
    }
    let unit: Vec<f64> = errors.iter().map(|error| error / length).collect();
    let pivot = (0..unit.len()).max_by(|&i, &j| unit[i].total_cmp(&unit[j])).unwrap_or(0);
    let mean: f64 = unit.iter().zip(scores).map(|(u, z)| u * z).sum();
    let turn = (mean + scores[pivot]) / (1.0 + unit[pivot]);
    (0..unit.len()).filter(|&j| j != pivot).map(|j| scores[j] - unit[j] * turn).collect()
}

/// P(Σ ≥ `sum`) of `count` squared standard normal numbers, each of which is known to be below `limit`.
///
/// A shifted gamma distribution with the mean, variance and skewness of that sum. Without the limit it is chi-square, exactly. The moments
/// of one square x: E[xᵏ] = 1·3⋯(2k − 1)·P(k + ½, limit/2)/P(½, limit/2) with the regularised gamma function P.
///
/// * `count`: at least 7; `limit`: the largest square, at least 0; without any spread of the squares, p is 1.
fn smaller_squares_sf(sum: f64, count: f64, limit: f64) -> f64 {
    if limit == 0.0 {
        return 1.0;
    }
    let below = |k: f64| gamma_lr(k + 0.5, 0.5 * limit);
    let [m1, m2, m3] = [1.0, 2.0, 3.0].map(|k| below(k) / below(0.0));
    let (m2, m3) = (3.0 * m2, 15.0 * m3);
    let (variance, third) = (m2 - m1 * m1, m3 - 3.0 * m1 * m2 + 2.0 * m1 * m1 * m1);
    // A gamma distribution of shape s has skewness 2/√s.
    let shape = count * 4.0 * variance * variance * variance / (third * third);
    let place = shape + (sum - count * m1) / (count * variance).sqrt() * shape.sqrt();
    if place > 0.0 { gamma_ur(shape, place) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goodness::kolmogorov_smirnov;
    use crate::seeds::uniform;
    use crate::tails::{any, normal_quantile};

    /// Independent standard normal scores, and errors from 1 to 3.
    fn drawn(seed: u64, tiles: usize) -> [Vec<f64>; 2] {
        let score = |i: usize| normal_quantile(1.0 - uniform(seed, i as u64));
        let error = |i: usize| 1.0 + 2.0 * i as f64 / tiles as f64;
        [(0..tiles).map(score).collect(), (0..tiles).map(error).collect()]
    }

    fn along(scores: &[f64], errors: &[f64]) -> f64 {
        let length = errors.iter().map(|e| e * e).sum::<f64>().sqrt();
        scores.iter().zip(errors).map(|(z, e)| z * e / length).sum()
    }

    #[test]
    fn contrasts_are_what_the_mean_leaves() {
        let [scores, errors] = drawn(1, 20);
        let found = contrasts(&scores, &errors);
        let squares = |list: &[f64]| list.iter().map(|z| z * z).sum::<f64>();
        let mean = along(&scores, &errors);
        // Sums of twenty squares of order 1 round by 1e-14.
        assert_eq!(found.len(), 19);
        assert!((squares(&found) - (squares(&scores) - mean * mean)).abs() < 1e-13);
        // A difference that all tiles share in proportion to their errors is the mean's alone.
        let shared: Vec<f64> = errors.iter().map(|error| 3.0 * error).collect();
        assert!(contrasts(&shared, &errors).iter().all(|c| c.abs() < 1e-13));
        assert_eq!(contrasts(&[2.0, 0.0], &[0.0, 0.0]), [2.0, 0.0]);
    }

    /// p of the mean and of the tiles together, from scores.
    fn joint(scores: &[f64], errors: &[f64], contrasts: &[f64]) -> f64 {
        let mean = 2.0 * normal_tail(along(scores, errors).abs());
        any(&TileTests::of(contrasts).p_values().chain([mean]).collect::<Vec<_>>())
    }

    /// With any number of tiles; the control forgets the reflection, so that the tests depend on one another.
    #[test]
    fn together_with_the_mean_p_values_are_uniform() {
        const RUNS: u64 = 4000;
        let fit = |tiles: usize, reflected: bool| {
            let one = |i: u64| {
                let [scores, errors] = drawn(RUNS * tiles as u64 + i, tiles);
                if reflected {
                    joint(&scores, &errors, &contrasts(&scores, &errors))
                } else {
                    joint(&scores, &errors, &scores)
                }
            };
            kolmogorov_smirnov(&(0..RUNS).map(one).collect::<Vec<_>>()).unwrap()
        };
        for tiles in [1, 2, 8, 9, 40, 300] {
            let found = fit(tiles, true);
            assert!(found.p_value > 1e-9, "{tiles} tiles: {found:?}"); // a distance of 0.053 would be noticed
        }
        assert!(fit(2, false).p_value < 1e-9);
    }

    #[test]
    fn the_worst_tile_and_the_others_see_different_errors() {
        let [mut scores, errors] = drawn(5, 256);
        let spread: Vec<f64> = scores.iter().map(|z| 1.7 * z).collect();
        let dense = TileTests::of(&contrasts(&spread, &errors));
        // Σ of 254 squares is 1.7² times as large: 734 instead of 254 ± 23. The largest of 255 scores is below 1.7·5 but once in 7,000.
        assert!(dense.rest.unwrap() < 1e-9 && dense.worst.unwrap() > 1e-14);
        scores[17] = 9.0;
        let sparse = TileTests::of(&contrasts(&scores, &errors));
        assert!(sparse.worst.unwrap() < 1e-9 && sparse.rest.unwrap() > 1e-6);
    }

    #[test]
    fn sums_of_smaller_squares_agree_with_their_convolution() {
        // By Fourier transform of 131,072 cells (SciPy 1.16); three moments leave 0.011 with seven squares, 0.004 with fifteen.
        for (count, limit, sum, expected, accuracy) in [
            (7.0, 3.24, 6.3, 0.232_6, 0.011),
            (7.0, 6.25, 4.5, 0.695_2, 0.011),
            (15.0, 4.84, 20.1, 0.039_1, 0.004),
            (15.0, 9.0, 10.2, 0.799_0, 0.004),
            (63.0, 7.84, 78.3, 0.043_1, 0.001),
            (255.0, 10.24, 326.4, 0.000_58, 0.000_02),
        ] {
            let found = smaller_squares_sf(sum, count, limit);
            assert!((found - expected).abs() < accuracy, "{count} below {limit}: {found}");
        }
        // Without a limit it is chi-square, to the accuracy of the gamma function.
        let free = smaller_squares_sf(30.0, 15.0, 1e3);
        assert!((free / chi_square_sf(30.0, 15.0) - 1.0).abs() < 1e-10);
        assert_eq!((smaller_squares_sf(0.0, 7.0, 0.0), smaller_squares_sf(0.0, 7.0, 1e3)), (1.0, 1.0));
    }
}
