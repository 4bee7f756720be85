use super::tiles::{Differences, TileTests, Tiles};
use super::{Image, swaps};
use crate::claim::{Evidence, REJECTION_LEVEL, Resolution, SINGLE_RUN_LEVEL, Verdict};
use crate::error::InputError;
use crate::estimate::LARGEST_SHARE;
use crate::tails::{any, positive, shared_level, t_noncentrality};
use crate::welch::{Difference, Sum};
use statrs::distribution::{Binomial, DiscreteCDF};

/// How many times the expected number of pixels may be beyond the level before it raises a doubt: samples of a path tracer are skewed,
/// and their errors rest on few replicates. A right image of the Cornell box at 64 samples a pixel has 2.1 times the number with 8
/// replicates, and 2.8 times with 16.
const SKEWED: f64 = 4.0;

/// Level beyond which a pixel counts.
pub(super) const PIXEL_LEVEL: f64 = 0.01;

/// What a comparison of two images found.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// `Fails` where "the same" is rejected at 1e-9, `Holds` where the bias is below the bound with 99.9 % confidence.
    pub verdict: Verdict,
    /// 100·(mean A − mean B)/mean B, over all pixels and channels; with its sign.
    pub bias_percent: f64,
    /// 99.9 % confidence limits of `bias_percent`; NaN where errors are unknown.
    pub interval: [f64; 2],
    /// Bound on |bias|, percent.
    pub bound: f64,
    /// The means of the whole images.
    pub pooled: Pooled,
    /// The 16×16 tiles.
    pub tiles: Tiles,
    /// The pixels, as a count.
    pub pixels: Pixels,
    /// Whether both sides know their errors; without, there is no verdict.
    pub error_known: bool,
    /// The same as evidence, whose defect is |bias| in percent.
    pub evidence: Evidence,
}

/// Means of the whole images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pooled {
    /// Mean of A over pixels and channels.
    pub mean_a: f64,
    /// Mean of B.
    pub mean_b: f64,
    /// Standard error of mean A − mean B.
    pub standard_error: f64,
    /// Welch's t of that difference.
    pub t: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// Two-sided p of that difference.
    pub p_value: f64,
    /// Smallest p of the single channels' differences, uncorrected.
    pub channel_p_value: f64,
    /// Smallest bias, percent, that the whole comparison finds at 1e-3 with power 0.9.
    pub resolution_percent: f64,
}

/// Pixels whose difference is beyond their errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixels {
    /// Number of pixels.
    pub count: usize,
    /// How many are beyond the level in any channel.
    pub beyond: u64,
    /// How many equal images have on average.
    pub expected: f64,
    /// Where the level comes from swapped seeds, the most that a swap has beyond it.
    pub most_swapped: Option<u64>,
    /// Probability of so many: of the true sides among the swapped ones; where no seed can be swapped, if pixels' errors were exactly
    /// normal.
    pub p_value: f64,
}

impl Pixels {
    /// Whether equal images do not have so many.
    ///
    /// Swapped seeds show how far the number spreads, so twice the most of them is too many; without them skewed errors and errors from
    /// few replicates move the level itself, and it takes four times the expected number.
    pub(super) fn are_too_many(&self) -> bool {
        match self.most_swapped {
            Some(most) => self.beyond > 2 * most,
            None => self.p_value < SINGLE_RUN_LEVEL && self.beyond as f64 > SKEWED * self.expected,
        }
    }
}

/// Compares two images of the same size.
///
/// Error model: a sum over pixels has the sum of their variances and Satterthwaite's degrees of freedom; where seeds are known, the
/// variance is that of the sum between seeds. Differences are Welch's. The pooled mean, the worst tile and the other tiles are independent
/// tests (`image/tiles.rs`), so p = 1 − (1 − min p)³ (Šidák) for images of one channel; of few tiles fewer tests are left. Several channels
/// and their sum, whose dependence nobody states, each have such a p, and the whole has at most the smallest times their number. There is no floor under a
/// variance: where both are zero, equal means pass and others fail.
///
/// * `bound_percent`: bound on |mean A − mean B|/mean B.
///
/// # Errors
/// [`InputError::Parameter`] for a mean of B that is not above 0 or a bound that is not; [`InputError::Subject`] for different sizes.
pub fn compare(a: &Image, b: &Image, bound_percent: f64) -> Result<Comparison, InputError> {
    positive("bound", bound_percent)?;
    if (a.size, a.channels) != (b.size, b.channels) {
        let size = |i: &Image| format!("{}×{} pixels of {} channels", i.size[0], i.size[1], i.channels);
        return Err(InputError::Subject(format!("A has {}, B has {}", size(a), size(b))));
    }
    let error_known = a.error_known() && b.error_known();
    let (whole_a, whole_b) = (a.whole(), b.whole());
    let (sum_a, sum_b) = (whole_a[a.channels], whole_b[b.channels]);
    positive("mean of B", sum_b.mean)?;
    let rounding = rounding(a, b);
    let differences = differences(&whole_a, &whole_b, rounding);
    let total = differences[a.channels];
    // The quotient's variance, to first order in the error of B.
    let ratio = sum_a.mean / sum_b.mean;
    let quotient = Difference { error: (sum_a.variance + ratio * ratio * sum_b.variance).sqrt(), ..total };
    let percent = 100.0 / sum_b.mean;
    let (bias_percent, half) = (percent * total.value, percent * quotient.half_width(REJECTION_LEVEL));
    let tile_differences = Differences::of(a, b);
    // The sum of one channel is that channel.
    let views = if a.channels == 1 { &differences[1..] } else { &differences[..] };
    let tests: Vec<TileTests> =
        (differences.len() - views.len()..=a.channels).map(|view| tile_differences.tests(view)).collect();
    let [p_value, level] = joint(views, &tests);
    let shift = t_noncentrality(level, 0.9, total.dof);
    let entries = a.mean.len() as f64;
    let pooled = Pooled {
        mean_a: sum_a.mean / entries,
        mean_b: sum_b.mean / entries,
        standard_error: total.error / entries,
        t: total.t,
        dof: total.dof,
        p_value: total.p_value(),
        channel_p_value: smallest(&differences[..a.channels]),
        resolution_percent: 100.0 * rounding + percent * shift * total.error,
    };
    let tiles = tile_differences.summary(&tests);
    let pixels = pixels(a, b);
    let interval = [bias_percent - half, bias_percent + half];
    let evidence =
        evidence(&pooled, &tiles, p_value, [bias_percent, half, bound_percent], doubts(a, b, &pixels));
    let verdict = evidence.verdict_of_single_run();
    Ok(Comparison {
        verdict,
        bias_percent,
        interval,
        bound: bound_percent,
        pooled,
        tiles,
        pixels,
        error_known,
        evidence,
    })
}

/// What rounding may make of the difference of two images that show the same, relative to the larger.
pub(super) fn rounding(a: &Image, b: &Image) -> f64 {
    a.rounding.max(b.rounding)
}

/// * `rounding`: relative.
pub(super) fn differences(a: &[Sum], b: &[Sum], rounding: f64) -> Vec<Difference> {
    let one = |(a, b): (&Sum, &Sum)| Difference::of(*a, *b, rounding * a.mean.abs().max(b.mean.abs()));
    a.iter().zip(b).map(one).collect()
}

/// The p-value of all views together, and the level that a test of the last has where all together have 1e-3.
fn joint(whole: &[Difference], tiles: &[TileTests]) -> [f64; 2] {
    let views = whole.len() as f64;
    let tests = |of: &TileTests| 1.0 + of.p_values().count() as f64;
    let one = |(whole, tiles): (&Difference, &TileTests)| {
        any(&tiles.p_values().chain([whole.p_value()]).collect::<Vec<_>>())
    };
    let smallest = whole.iter().zip(tiles).map(one).fold(1.0, f64::min);
    let level = shared_level(tiles.last().map_or(1.0, tests), REJECTION_LEVEL / views);
    [(views * smallest).min(1.0), level]
}

/// The smallest of the differences' p-values.
pub(super) fn smallest(differences: &[Difference]) -> f64 {
    differences.iter().map(Difference::p_value).fold(1.0, f64::min)
}

fn pixels(a: &Image, b: &Image) -> Pixels {
    if let Some(swapped) = swaps::pixels(a, b) {
        return swapped;
    }
    let count = a.mean.len() / a.channels;
    let one = |image: &Image, entry: usize| {
        let [mean, variance] = image.pixel(entry);
        Sum { mean, variance, dof: image.replicates.saturating_sub(1) as f64 }
    };
    let level = PIXEL_LEVEL / a.channels as f64;
    let is_beyond = |pixel: &usize| {
        let entries = pixel * a.channels..(pixel + 1) * a.channels;
        entries
            .into_iter()
            .any(|i| smallest(&differences(&[one(a, i)], &[one(b, i)], rounding(a, b))) < level)
    };
    let beyond = (0..count).filter(is_beyond).count() as u64;
    let tail = Binomial::new(PIXEL_LEVEL, count as u64).map_or(f64::NAN, |binomial| match beyond {
        0 => 1.0,
        more => binomial.sf(more - 1),
    });
    Pixels { count, beyond, expected: PIXEL_LEVEL * count as f64, most_swapped: None, p_value: tail }
}

fn doubts(a: &Image, b: &Image, pixels: &Pixels) -> Vec<String> {
    let mut doubts = Vec::new();
    if !(a.error_known() && b.error_known()) {
        doubts.push(String::from("an image does not know its errors: one replicate, one file"));
    } else if pixels.are_too_many() {
        let (beyond, expected) = (pixels.beyond, pixels.expected);
        doubts
            .push(format!("{beyond} pixels differ beyond their errors where {expected:.0} would by chance"));
    }
    let share = a.largest_share.max(b.largest_share);
    if share > LARGEST_SHARE {
        doubts.push(format!(
            "normal theory is not trusted: one sample makes up {:.1} % of an image",
            100.0 * share
        ));
    }
    doubts
}

fn evidence(
    pooled: &Pooled,
    tiles: &Tiles,
    p_value: f64,
    [bias, half, bound]: [f64; 3],
    doubts: Vec<String>,
) -> Evidence {
    let interval = [(bias.abs() - half).max(0.0), bias.abs() + half];
    let (quantity, value) = ("bias of the image's mean, %", pooled.resolution_percent);
    Evidence {
        method: format!("image comparison, Welch's t over the image and {} tiles", tiles.count),
        n: tiles.count as u64,
        statistic: pooled.t,
        dof: Some(pooled.dof),
        p_value: if half.is_nan() { 1.0 } else { p_value },
        estimate: bias.abs(),
        interval: if half.is_nan() { [0.0, f64::INFINITY] } else { interval },
        bound,
        resolution: Resolution { quantity, value, power: 0.9 },
        doubts,
        pictures: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeds::uniform;

    const SIZE: [usize; 2] = [64, 48];

    /// A scene with edges and gradients, in three channels.
    fn truth(entry: usize) -> f64 {
        let (pixel, channel) = (entry / 3, entry % 3);
        let (x, y) = (pixel % SIZE[0], pixel / SIZE[0]);
        let square = if (20..40).contains(&x) && (10..30).contains(&y) { 1.5 } else { 0.2 };
        square + 0.01 * x as f64 + 0.1 * channel as f64
    }

    /// One file from four replicates with relative noise of up to ±`noise`, the same for the channels of a pixel.
    fn file(seed: u64, noise: f64, scene: impl Fn(usize) -> f64) -> Image {
        let entries = SIZE[0] * SIZE[1] * 3;
        let value =
            |k: u64, i: usize| scene(i) * (1.0 + noise * (2.0 * uniform(4 * seed + k, i as u64 / 3) - 1.0));
        let of = |i: usize| (0..4).map(|k| value(k, i)).collect::<crate::estimate::Moments>().estimate();
        let estimates: Vec<_> = (0..entries).map(of).collect();
        let errors: Vec<f64> = estimates.iter().map(|e| e.standard_error).collect();
        Image::with_errors(SIZE, 3, estimates.iter().map(|e| e.mean).collect(), &errors, 4).unwrap()
    }

    #[test]
    fn two_noisy_renderings_of_one_truth_hold() {
        let found = compare(&file(1, 0.1, truth), &file(2, 0.1, truth), 0.5).unwrap();
        assert_eq!(found.verdict, Verdict::Holds, "{found:?}");
        assert!(found.interval[0] < found.bias_percent && found.bias_percent < found.interval[1]);
        let half = 0.5 * (found.interval[1] - found.interval[0]);
        // Three roundings of numbers below 1.
        assert!((found.evidence.interval[1] - found.bias_percent.abs() - half).abs() < 1e-15);
        assert!(found.pooled.resolution_percent < 0.5);
    }

    #[test]
    fn rounding_of_pixels_without_noise_is_no_difference() {
        // The upper half is a sky, the same in every seed, that one side has rounded by 3e-6.
        let image = |seed: u64, sky: f64| {
            let value = |k: u64, i: usize| {
                if i < SIZE[0] * SIZE[1] / 2 { sky } else { 1.0 + 0.1 * uniform(4 * seed + k, i as u64) }
            };
            let files: Vec<Vec<f64>> =
                (0..4).map(|k| (0..SIZE[0] * SIZE[1]).map(|i| value(k, i)).collect()).collect();
            Image::from_seeds(SIZE, 1, &files).unwrap()
        };
        let (a, b) = (image(1, 0.7), image(2, 0.7 * (1.0 + 3e-6)));
        let strict = compare(&a, &b, 0.5).unwrap();
        assert_eq!(strict.verdict, Verdict::Fails, "{strict:?}");
        let allowed = compare(&a, &b.clone().with_rounding(4e-6), 0.5).unwrap();
        assert_eq!(allowed.verdict, Verdict::Holds, "{allowed:?}");
        assert!(allowed.pixels.beyond < strict.pixels.beyond);
        let beyond = compare(&a, &b.clone().with_rounding(2e-6), 0.5).unwrap();
        assert_eq!(beyond.verdict, Verdict::Fails, "{beyond:?}");
        let more = compare(&a, &b.with_rounding(5e-6), 0.5).unwrap();
        let resolutions = more.pooled.resolution_percent - allowed.pooled.resolution_percent;
        assert!((resolutions - 1e-4).abs() < 1e-12, "{resolutions}"); // 100·(5e-6 − 4e-6), but for roundings of f64
    }

    /// Of 200 pairs of equal images in which eight neighbours have the same error, how many are rejected at 1e-2.
    fn rejected(shared_by: u64) -> u64 {
        let one = |seed: u64| {
            let value = |k: u64, i: usize| 1.0 + uniform(4 * seed + k, i as u64 / 8);
            let of = |i: usize| (0..4).map(|k| value(k, i)).collect::<crate::estimate::Moments>().estimate();
            let estimates: Vec<_> = (0..SIZE[0] * SIZE[1]).map(of).collect();
            let errors: Vec<f64> = estimates.iter().map(|e| e.standard_error).collect();
            let means = estimates.iter().map(|e| e.mean).collect();
            Image::with_errors(SIZE, 1, means, &errors, 4).unwrap().with_errors_shared_by(shared_by)
        };
        let p = |pair: u64| compare(&one(2 * pair), &one(2 * pair + 1), 0.5).unwrap().evidence.p_value;
        (0..200).filter(|&pair| p(pair) < 0.01).count() as u64
    }

    #[test]
    fn errors_in_common_are_counted_where_an_image_says_so() {
        let tail = |n: u64| Binomial::new(0.01, 200).unwrap().sf(n);
        let [apart, together] = [1, 8].map(rejected);
        assert!(tail(apart) < 1e-9, "{apart}: independent pixels are another thing");
        assert!(tail(together) > 1e-9, "{together}: as many as chance rejects, or fewer");
    }

    #[test]
    fn one_percent_of_brightness_fails() {
        let brighter = |i: usize| 1.01 * truth(i);
        let found = compare(&file(1, 0.1, truth), &file(2, 0.1, brighter), 0.5).unwrap();
        assert_eq!(found.verdict, Verdict::Fails, "{found:?}");
        assert!((found.bias_percent + 1.0).abs() < 0.5); // 1/1.01 − 1 = −0.99 %, error below 0.1 %
    }

    #[test]
    fn a_tint_that_keeps_the_mean_fails() {
        let weight = [1.02, 1.0, 0.983];
        let found = compare(&file(1, 0.1, truth), &file(2, 0.1, |i| weight[i % 3] * truth(i)), 0.5).unwrap();
        assert_eq!(found.verdict, Verdict::Fails, "{found:?}");
    }

    /// Channels of whose dependence nothing is known share the level: three equal ones and their sum have four times the p of one.
    #[test]
    fn equal_channels_share_the_level() {
        let grey = |seed| {
            let of = |i: usize| truth(3 * (i / 3)) * (0.9 + 0.2 * uniform(seed, i as u64 / 3));
            (0..SIZE[0] * SIZE[1] * 3).map(of).collect::<Vec<f64>>()
        };
        let files = |first: u64| (first..first + 6).map(grey).collect::<Vec<_>>();
        let colour = |first| Image::from_seeds(SIZE, 3, &files(first)).unwrap();
        let single = |first| {
            let one = |file: &Vec<f64>| file.iter().copied().step_by(3).collect::<Vec<_>>();
            Image::from_seeds(SIZE, 1, &files(first).iter().map(one).collect::<Vec<_>>()).unwrap()
        };
        let p = |a: &Image, b: &Image| compare(a, b, 0.5).unwrap().evidence.p_value;
        let (one, three) = (p(&single(0), &single(6)), p(&colour(0), &colour(6)));
        assert!((three - (4.0 * one).min(1.0)).abs() < 1e-9, "{one} {three}"); // rounding of sums of 3,072 pixels
        let shares = [&single(0), &colour(0)].map(|image| compare(image, image, 0.5).unwrap().pooled);
        assert!(shares[1].resolution_percent > 1.1 * shares[0].resolution_percent);
    }

    #[test]
    fn a_shift_by_one_pixel_is_seen_by_tiles_and_pixels() {
        let shifted = |i: usize| truth(if i >= 3 { i - 3 } else { i });
        let found = compare(&file(1, 0.1, truth), &file(2, 0.1, shifted), 5.0).unwrap();
        assert_eq!(found.verdict, Verdict::Fails);
        assert!(found.tiles.worst_p_value.unwrap() < 1e-9 && found.pixels.beyond > 2 * 31);
    }

    #[test]
    fn without_errors_there_is_no_verdict() {
        let bare = Image::with_errors([1, 1], 1, vec![2.0], &[], 1).unwrap();
        let sure = Image::with_errors([1, 1], 1, vec![1.0], &[0.0], 4).unwrap();
        let found = compare(&bare, &sure, 0.5).unwrap();
        assert_eq!(
            (found.verdict, found.error_known, found.bias_percent),
            (Verdict::Undecided, false, 100.0)
        );
        assert_eq!(found.evidence.doubts, ["an image does not know its errors: one replicate, one file"]);
        let rare = compare(&sure.clone().with_largest_share(0.25), &sure, 0.5).unwrap();
        let doubts = ["normal theory is not trusted: one sample makes up 25.0 % of an image"];
        assert_eq!(
            (rare.error_known, rare.evidence.doubts.as_slice()),
            (true, doubts.map(String::from).as_slice())
        );
    }

    #[test]
    fn zero_variance_is_equal_or_different() {
        let exact = |value| Image::with_errors([2, 1], 1, vec![value, 1.0], &[0.0; 2], 4).unwrap();
        assert_eq!(compare(&exact(1.0), &exact(1.0 + 1e-7), 0.5).unwrap().verdict, Verdict::Holds);
        assert_eq!(compare(&exact(1.0), &exact(1.0 + 1e-4), 0.5).unwrap().verdict, Verdict::Fails);
        let one = Image::with_errors([1, 1], 1, vec![1.0], &[0.0], 4).unwrap();
        assert!(compare(&one, &exact(1.0), 0.5).is_err());
        assert!(compare(&exact(1.0), &exact(-1.0), 0.5).is_err());
    }
}
