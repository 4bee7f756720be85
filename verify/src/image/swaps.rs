//! The level beyond which a pixel counts, calibrated by swapping seeds between the sides.
//!
//! If both sides show the same thing, a seed of one is as good as a seed of the other. So the differences between mixed sides show how
//! far single pixels stray by chance, whatever the distribution of their errors is.

use super::Image;
use super::comparison::{PIXEL_LEVEL, Pixels, rounding};
use crate::seeds::derive;
use crate::welch::{Difference, Sum};

/// Most divisions of the seeds that are looked at.
const MOST_SWAPS: usize = 20;

/// Counts pixels beyond the level that one of a hundred exceeds when seeds are swapped; `None` where a side has fewer than two files.
pub(super) fn pixels(a: &Image, b: &Image) -> Option<Pixels> {
    if a.files.len() < 2 || b.files.len() < 2 {
        return None;
    }
    let files: Vec<&[f64]> = a.files.iter().chain(&b.files).map(Vec::as_slice).collect();
    let own: Vec<usize> = (0..a.files.len()).collect();
    let divisions = divisions(&own, files.len());
    let scores = |side: &[usize]| scores(&files, side, a.channels, rounding(a, b));
    let swapped: Vec<Vec<f64>> = divisions.iter().map(|side| scores(side)).collect();
    let level = upper_quantile(swapped.iter().flatten().copied().collect(), PIXEL_LEVEL);
    let count = |scores: &[f64]| scores.iter().filter(|&&t| t > level).count() as u64;
    let counts: Vec<u64> = swapped.iter().map(|scores| count(scores)).collect();
    let true_scores = scores(&own);
    let beyond = count(&true_scores);
    let as_many = counts.iter().filter(|&&other| other >= beyond).count() as f64;
    Some(Pixels {
        count: true_scores.len(),
        beyond,
        expected: counts.iter().sum::<u64>() as f64 / counts.len() as f64,
        most_swapped: counts.iter().max().copied(),
        p_value: (1.0 + as_many) / (1.0 + counts.len() as f64),
    })
}

/// Different divisions of seeds into two sides, none of them the true one, nor that with the names of the sides exchanged.
fn divisions(own: &[usize], files: usize) -> Vec<Vec<usize>> {
    const TRIES: u64 = 200;
    let mirror: Vec<usize> = (own.len()..files).collect();
    let mut found: Vec<Vec<usize>> = Vec::new();
    for attempt in 0..TRIES {
        let mut order: Vec<usize> = (0..files).collect();
        order.sort_by_key(|&i| derive(attempt, files as u64, i as u64));
        order.truncate(own.len());
        order.sort_unstable();
        if found.len() < MOST_SWAPS && order != own && order != mirror && !found.contains(&order) {
            found.push(order);
        }
    }
    found
}

/// Largest |t| over the channels of each pixel, between the files of a side and the others.
fn scores(files: &[&[f64]], side: &[usize], channels: usize, rounding: f64) -> Vec<f64> {
    let side_of = |entry: usize, wanted: bool| {
        let values: Vec<f64> = files
            .iter()
            .enumerate()
            .filter(|(i, _)| side.contains(i) == wanted)
            .map(|(_, f)| f[entry])
            .collect();
        Sum::over_replicates(&values)
    };
    let score = |entry: usize| {
        let [a, b] = [true, false].map(|wanted| side_of(entry, wanted));
        Difference::of(a, b, rounding * a.mean.abs().max(b.mean.abs())).t.abs()
    };
    let pixel = |pixel: usize| (pixel * channels..(pixel + 1) * channels).map(score).fold(0.0, f64::max);
    (0..files[0].len() / channels).map(pixel).collect()
}

/// The value that a share of the values exceed.
fn upper_quantile(mut values: Vec<f64>, share: f64) -> f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a length is a place in the list"
    )]
    let place = ((1.0 - share) * values.len() as f64) as usize;
    let place = place.min(values.len() - 1);
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::compare;
    use crate::seeds::uniform;

    /// `count` files of 64 × 48 pixels with skewed noise (a square of a uniform number), alike in all channels; pixels from `wrong` on are
    /// brighter.
    fn coloured(channels: usize, first: u64, count: u64, wrong: usize) -> Image {
        let value = |seed: u64, i: usize| {
            let noise = uniform(seed, i as u64).powi(4);
            noise + if i >= wrong { 1.0 } else { 0.0 }
        };
        let file = |k: u64| (0..64 * 48 * channels).map(|i| value(first + k, i / channels)).collect();
        let files: Vec<Vec<f64>> = (0..count).map(file).collect();
        Image::from_seeds([64, 48], channels, &files).expect("files of one size")
    }

    /// The same in grey.
    fn side(first: u64, count: u64, wrong: usize) -> Image {
        coloured(1, first, count, wrong)
    }

    #[test]
    fn equal_images_have_one_pixel_of_a_hundred_beyond_the_level() {
        let found = pixels(&side(0, 4, usize::MAX), &side(10, 4, usize::MAX)).expect("several seeds");
        assert!((found.expected - 30.7).abs() < 1.0, "{found:?}"); // 1 % of 3,072; ties of the quantile add none
        // Three to four times the spread of a count of 31 among ten thousand skewed pixels.
        assert!(found.p_value > 0.05 || found.beyond < 60, "{found:?}");
        assert!(
            compare(&side(0, 4, usize::MAX), &side(10, 4, usize::MAX), 50.0)
                .unwrap()
                .evidence
                .doubts
                .is_empty()
        );
    }

    #[test]
    fn a_hundred_wrong_pixels_stand_out() {
        let found = pixels(&side(0, 4, 64 * 48 - 200), &side(10, 4, usize::MAX)).expect("several seeds");
        assert!(found.are_too_many() && found.p_value < 0.05, "{found:?}"); // 1/21: none of the swaps has as many
        let compared = compare(&side(0, 4, 64 * 48 - 200), &side(10, 4, usize::MAX), 50.0).unwrap();
        let [doubt] = compared.evidence.doubts.as_slice() else { panic!("{compared:?}") };
        assert!(doubt.starts_with(&format!("{} pixels differ beyond their errors", found.beyond)), "{doubt}");
    }

    #[test]
    fn a_pixel_counts_once_whatever_its_channels() {
        let found = |channels| {
            pixels(&coloured(channels, 0, 4, 64 * 48 - 200), &coloured(channels, 10, 4, usize::MAX))
        };
        assert_eq!(found(3), found(1));
    }

    #[test]
    fn one_file_a_side_has_nothing_to_swap() {
        assert_eq!(pixels(&side(0, 1, usize::MAX), &side(1, 4, usize::MAX)), None);
        assert_eq!(divisions(&[0, 1], 4).len(), 4); // of six, less the true one and its mirror
    }
}
