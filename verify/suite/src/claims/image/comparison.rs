//! The comparison itself, on images of known difference and known errors.

use verify::claim::{Claim, claim};
use verify::error::InputError;
use verify::image::{Image, compare};
use verify::mean::{MeanClaim, joint_control, joint_evidence};
use verify::points::fill;
use verify::seeds::derive;

use crate::bounds;

/// Columns and rows: two tiles of 16 pixels, the second one narrow.
const SIZE: [usize; 2] = [20, 8];

/// What is different between the images: by what share which channel of the columns from which on is brighter.
const CHANGES: [(f64, usize, usize); 2] = [(0.03, 1, 0), (-0.05, 2, 10)];

/// Relative standard deviation of an entry.
const NOISE: f64 = 0.001;

/// The value of an entry, of pixels row by row and three channels.
fn truth(entry: usize) -> f64 {
    let (pixel, channel) = (entry / 3, entry % 3);
    0.2 + 0.05 * (pixel % SIZE[0]) as f64 + 0.3 * channel as f64
}

/// The same where channel and column are changed.
fn changed(entry: usize, (share, channel, from): (f64, usize, usize)) -> f64 {
    let column = entry / 3 % SIZE[0];
    truth(entry) * if entry % 3 == channel && column >= from { 1.0 + share } else { 1.0 }
}

const ENTRIES: usize = 3 * SIZE[0] * SIZE[1];

/// An image with independent errors of known size.
fn noisy(seed: u64, value: impl Fn(usize) -> f64) -> Result<Image, InputError> {
    let mut u = vec![0.0; ENTRIES];
    fill(seed, 0, &mut u);
    // Uniform on ±√3 σ.
    let noise = |i: usize| 3f64.sqrt() * NOISE * (2.0 * u[i] - 1.0);
    let means = (0..ENTRIES).map(|i| value(i) * (1.0 + noise(i))).collect();
    let errors: Vec<f64> = (0..ENTRIES).map(|i| NOISE * value(i)).collect();
    Image::with_errors(SIZE, 3, means, &errors, 8)
}

/// The bias in percent that the comparison of the changed image with the other finds; not a number if there is none.
fn compared(seed: u64, change: (f64, usize, usize)) -> f64 {
    let a = noisy(derive(seed, 0, 0), |i| changed(i, change));
    let b = noisy(derive(seed, 1, 0), truth);
    let found = a.and_then(|a| compare(&a, &b?, bounds::IMAGE_PERCENT));
    found.map_or(f64::NAN, |found| found.bias_percent)
}

/// The exact bias in percent.
fn bias(change: (f64, usize, usize)) -> f64 {
    let total: f64 = (0..ENTRIES).map(truth).sum();
    100.0 * ((0..ENTRIES).map(|i| changed(i, change)).sum::<f64>() / total - 1.0)
}

pub(super) fn biases() -> Claim {
    let measured = |k: usize, seed| compared(seed, CHANGES[k]);
    let claims = CHANGES.map(|change| MeanClaim::relative(bias(change), bounds::COMPARED_BIAS));
    claim("image/comparison/bias", "a comparison finds the bias that part of one channel gives an image")
        .rejects("2.2 × resolution", move |run| joint_control(&claims, run, measured))
        .rejects("a change 3 % smaller", move |run| {
            let smaller = |(share, channel, from)| (0.97 * share, channel, from);
            let measured = |k: usize, seed| compared(seed, smaller(CHANGES[k]));
            joint_evidence(&claims, run, measured)
        })
        .by(move |run| joint_evidence(&claims, run, measured))
}
