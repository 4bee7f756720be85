//! Which pixels get how many of an image's samples.

use rayon::prelude::*;

use super::part::Part;

/// Share of the samples that pixels get alike, whatever the pilot says of them.
const EVEN: f64 = 0.05;

/// Power of a pixel's error that its number of samples follows: 1 where the variance falls as 1/n, 0.8 where it falls as
/// n to the 3/2, as scrambled points make it at edges.
const EXPONENT: f64 = 0.9;

/// How far to each side a pixel's error is looked for, in pixels.
const REACH: isize = 4;

/// Most samples of a pixel, in units of the mean.
const MOST: f64 = 64.0;

/// Halvings of the interval in which the common factor lies: more digits than a film has pixels.
const HALVINGS: u32 = 32;

/// How many samples each replicate of a pixel has, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Allocation {
    /// The numbers, at least 1 each.
    pub counts: Vec<u32>,
    /// The first samples of every pixel, if they are taken already.
    pub pilot: Option<Pilot>,
}

/// The first samples of every pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilot {
    /// Their sums, of all tiles.
    pub part: Part,
    /// For each tile and pixel of it, the largest absolute value of a weighted sample, the mean of its channels.
    pub largest: Vec<Vec<f64>>,
}

/// The numbers of samples, powers of two from `least` on whose mean is at most `samples`, for an image in which the
/// squared error is in proportion to `variances`, row by row, and falls with the number of a pixel's samples.
///
/// The sum Σ σᵢ² / nᵢᵖ over pixels is least for nᵢ in proportion to σᵢ to the power 2 / (p + 1). Here σᵢ is a mean over
/// pixels at an odd number of steps, and the factor is found for one colour of a chessboard at a time: what a black pixel
/// gets depends on white pixels' variances only, and the other way round. So numbers of samples are independent of the
/// samples that a pixel's own variance was found from, and these may be used: its mean is right whatever the number is.
///
/// # Source
/// Neyman 1934, "On the two different aspects of the representative method", section III (doi:10.2307/2342192), for
/// p = 1. The chessboard is ours.
///
/// # Verified by
/// claim `relation/allocation/same-mean`
pub fn by_error([width, height]: [u32; 2], variances: &[f64], least: u32, samples: u32) -> Vec<u32> {
    let size = [width as usize, height as usize];
    let errors: Vec<f64> = variances.iter().map(|variance| variance.sqrt()).collect();
    let taps = taps();
    let mut counts = vec![samples; variances.len()];
    for colour in 0..2 {
        let of_colour = |&place: &usize| (place % size[0] + place / size[0]) % 2 == colour;
        let places: Vec<usize> = (0..counts.len()).filter(of_colour).collect();
        let around: Vec<f64> =
            places.par_iter().map(|&place| error_around(size, &errors, &taps, place)).collect();
        for (place, count) in places.into_iter().zip(in_proportion(&around, least, samples)) {
            counts[place] = count;
        }
    }
    counts
}

/// A pixel of the other colour nearby.
struct Tap {
    /// Columns and rows to it.
    step: [isize; 2],
    weight: f64,
}

/// Pixels around one, at the distance r with the weight (1 + r²)^(−3/2).
fn taps() -> Vec<Tap> {
    let tap = |[x, y]: [isize; 2]| {
        let squared = 1.0 + (x * x + y * y) as f64;
        Tap { step: [x, y], weight: 1.0 / (squared * squared.sqrt()) }
    };
    let steps = (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| [x, y]));
    steps.filter(|[x, y]| (x + y) % 2 != 0).map(tap).collect()
}

/// The weighted mean of the errors of a pixel's neighbours within the image.
fn error_around([width, height]: [usize; 2], errors: &[f64], taps: &[Tap], place: usize) -> f64 {
    let (x, y) = (place % width, place / width);
    let (mut sum, mut weights) = (0.0, 0.0);
    for Tap { step: [across, down], weight } in taps {
        // A step beyond the left or upper side wraps to a number beyond the other one.
        let (column, row) = (x.wrapping_add_signed(*across), y.wrapping_add_signed(*down));
        if column < width && row < height {
            sum += weight * errors[row * width + column];
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// Powers of two from `least` on, nearly in proportion to powers of `errors`; their mean is at most `samples`.
fn in_proportion(errors: &[f64], least: u32, samples: u32) -> Vec<u32> {
    let needs: Vec<f64> = errors.par_iter().map(|error| libm::pow(*error, EXPONENT)).collect();
    let mean = needs.iter().sum::<f64>() / needs.len() as f64;
    let share = |need: &f64| if mean > 0.0 { EVEN + (1.0 - EVEN) * need / mean } else { 1.0 };
    // The logarithm of a pixel's share, so that powers of two near it are a rounding away.
    let logs: Vec<f64> = needs.par_iter().map(|need| libm::log2(share(need).min(MOST))).collect();
    let budget = u64::from(samples) * logs.len() as u64;
    let count = |log: f64| power(log).max(least);
    let fits = |factor: f64| logs.par_iter().map(|log| u64::from(count(log + factor))).sum::<u64>() <= budget;
    // Between one sample for those with most, and more than the mean for those with least.
    let [mut low, mut high] = [-libm::log2(MOST) - 1.0, libm::log2(f64::from(samples) / EVEN) + 1.0];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if fits(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    logs.iter().map(|log| count(log + low)).collect()
}

/// The power of two nearest in ratio to 2 to the `log`, at least 1.
fn power(log: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rounded into 0 to 31")]
    let exponent = (log + 0.5).clamp(0.0, 31.0) as u32;
    1 << exponent
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_get_powers_of_two_by_their_error_and_no_more_than_there_are() {
        // A half of the image has ten times the error of the other, from the column 32 on.
        let variances: Vec<f64> = (0..64 * 8).map(|i| if i % 64 < 32 { 0.01 } else { 1.0 }).collect();
        for samples in [16, 64, 100] {
            let counts = by_error([64, 8], &variances, 1, samples);
            let total: u64 = counts.iter().map(|n| u64::from(*n)).sum();
            assert!(total <= u64::from(samples) * 512, "{total}");
            assert!(2 * total > u64::from(samples) * 512, "{total}: a factor of two more would be too many");
            assert!(counts.iter().all(|n| n.is_power_of_two()));
            // The ratio of errors to the power 0.9 is 7.9; both numbers are rounded by a factor of √2.
            let ratio = counts[64 * 3 + 60] / counts[64 * 3 + 3];
            assert!((4..=16).contains(&ratio), "{samples}: {ratio}");
            assert!(by_error([64, 8], &variances, 8, samples).iter().all(|n| *n >= 8));
        }
    }

    #[test]
    fn what_a_pixel_gets_does_not_depend_on_its_own_colour() {
        // Variances fall to the right, by powers of two; those of one colour are made to rise.
        let variances: Vec<f64> = (0..13 * 9).map(|i| f64::from(2.0_f32.powi(-(i % 13)))).collect();
        let counts = by_error([13, 9], &variances, 4, 64);
        for colour in 0..2 {
            let of_colour = |place: usize| (place % 13 + place / 13) % 2 == colour;
            let changed: Vec<f64> =
                variances.iter().enumerate().map(|(i, v)| if of_colour(i) { 1.0 / v } else { *v }).collect();
            let others = by_error([13, 9], &changed, 4, 64);
            assert!((0..counts.len()).filter(|i| of_colour(*i)).all(|i| counts[i] == others[i]));
            assert_ne!(counts, others);
        }
    }

    #[test]
    fn pixels_without_error_keep_their_even_share() {
        let errors: Vec<f64> = (0..64).map(|i| f64::from(i % 2)).collect();
        let counts = in_proportion(&errors, 1, 1024);
        // 0.05 against 0.05 + 0.95·2 = 1.95; both numbers are rounded by a factor of √2.
        let ratio = f64::from(counts[1]) / f64::from(counts[0]);
        assert!((19.5..=78.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn an_image_without_errors_is_sampled_evenly() {
        assert_eq!(by_error([3, 2], &[0.0; 6], 16, 64), [64; 6]);
        assert_eq!(by_error([3, 2], &[2.0; 6], 16, 64), [64; 6]);
        assert_eq!(by_error([1, 1], &[2.0], 16, 64), [64]);
    }
}
