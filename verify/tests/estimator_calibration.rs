//! The tests of estimators tested: uniform p-values under the truth, and a defect of the stated resolution found in 85–95 % of runs.

use std::cell::Cell;
use verify::claim::{Evidence, Run};
use verify::convergence::SlopeClaim;
use verify::estimate::Moments;
use verify::goodness::kolmogorov_smirnov;
use verify::image::{Comparison, Image, compare};
use verify::independence::{IndependenceClaim, Source};
use verify::mean::{MeanClaim, joint_evidence};
use verify::points::fill;
use verify::seeds::derive;

const RUNS: u64 = 2000;

/// Probability with which a right test fails here: each threshold below follows from it.
const FALSE_ALARM: f64 = 1e-6;

fn run(seed: u64) -> Run {
    Run { seed, effort: 1 }
}

/// A stream of independent numbers.
struct Stream {
    seed: u64,
    next: Cell<u64>,
}

impl Stream {
    fn of(seed: u64) -> Self {
        Self { seed, next: Cell::new(0) }
    }

    fn uniform(&self) -> f64 {
        let mut point = [0.0];
        fill(self.seed, self.next.replace(self.next.get() + 1), &mut point);
        point[0]
    }

    /// A standard normal number (Box and Muller).
    fn normal(&self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (2.0 * std::f64::consts::PI * self.uniform()).cos()
    }
}

fn assert_uniform(name: &str, p_values: &[f64]) {
    let fit = kolmogorov_smirnov(p_values).expect("p-values are in [0, 1]");
    assert!(fit.p_value > FALSE_ALARM, "{name}: D = {}, p = {:e}", fit.statistic, fit.p_value);
}

/// At most `level` of the p-values below it, up to 5 standard deviations of the count (P = 3e-7) and one for its discreteness.
fn assert_level(name: &str, p_values: &[f64], level: f64) {
    let below = p_values.iter().filter(|&&p| p < level).count() as f64;
    let expected = level * p_values.len() as f64;
    assert!(below <= expected + 5.0 * expected.sqrt() + 1.0, "{name}: {below} below {level}, not {expected}");
}

/// The mean resolution of 64 runs, and the share of 1,000 others that reject a defect of that size.
fn power(trial: impl Fn(u64, f64) -> Evidence) -> f64 {
    let pilots: Moments = (0..64).map(|i| trial(derive(1, 1, i), 0.0).resolution.value).collect();
    let rejected = |&i: &u64| trial(derive(2, 2, i), pilots.mean()).p_value < 1e-3;
    (0..1000).filter(rejected).count() as f64 / 1000.0
}

/// 0.9 ± 0.05: five standard deviations of a share of 1,000, √(0.9·0.1/1000) = 0.0095.
fn assert_power(name: &str, found: f64) {
    assert!((0.85..=0.95).contains(&found), "{name}: a defect of the stated resolution is found in {found}");
}

/// Configurations of which the first is the noisiest and has the defect.
fn mean_trial(configurations: usize, seed: u64, defect: f64) -> Evidence {
    let claims = vec![MeanClaim::relative(2.0, 0.1); configurations];
    let subject = |k: usize, seed: u64| {
        let noise = Stream::of(seed).normal();
        if k == 0 { 2.0 + 0.05 * noise + 2.0 * defect } else { 2.0 + 0.02 * noise }
    };
    joint_evidence(&claims, &run(seed), subject).expect("enough replicates")
}

#[test]
fn means_have_uniform_p_values_and_their_power() {
    let p_values: Vec<f64> = (0..RUNS).map(|seed| mean_trial(1, seed, 0.0).p_value).collect();
    assert_uniform("mean", &p_values);
    assert_power("mean", power(|seed, defect| mean_trial(1, seed, defect)));
    let joint: Vec<f64> = (0..RUNS).map(|seed| mean_trial(5, seed, 0.0).p_value).collect();
    assert_uniform("joint", &joint);
    assert_power("joint", power(|seed, defect| mean_trial(5, seed, defect)));
}

/// A right mean that is never called undecided: no doubt in any run, limits that cover the truth.
#[test]
fn intervals_of_means_cover_the_truth() {
    let runs: Vec<Evidence> = (0..RUNS).map(|seed| mean_trial(1, seed, 0.01)).collect();
    let missed = runs.iter().filter(|e| e.interval[0] > 0.01 || e.interval[1] < 0.01).count();
    // Expected at 1e-3 of 2,000: 2; P(more than 13) of a Poisson count is below 1e-6.
    assert!(missed <= 13, "{missed}");
    assert!(runs.iter().all(|e| e.doubts.is_empty()));
}

fn slope_trial(seed: u64, defect: f64) -> Evidence {
    let claim = SlopeClaim {
        name: String::from("normal errors"),
        exact: 0.0,
        counts: vec![16, 64, 256, 1024],
        replicates: 100,
        theory: -0.75 + defect,
        bound: 0.3,
    };
    claim.evidence(&run(seed), |n, seed| (n as f64).powf(-0.75) * Stream::of(seed).normal()).expect("runs")
}

#[test]
fn slopes_have_uniform_p_values_and_their_power() {
    let p_values: Vec<f64> = (0..RUNS).map(|seed| slope_trial(seed, 0.0).p_value).collect();
    assert_uniform("slope", &p_values);
    assert_level("slope", &p_values, 1e-3);
    assert_power("slope", power(slope_trial));
}

/// Two images of 32×16 pixels from four replicates a side; the noise of a pixel is as large as its value, B brighter by `defect` percent.
fn image_trial(seed: u64, defect: f64) -> Comparison {
    const PIXELS: usize = 32 * 16;
    let side = |stream: Stream, factor: f64| {
        let pixel = |i: usize| {
            let truth = factor * (0.1 + (i % 32) as f64 / 32.0);
            (0..4).map(|_| truth * (1.0 + stream.normal())).collect::<Moments>().estimate()
        };
        let pixels: Vec<_> = (0..PIXELS).map(pixel).collect();
        let errors: Vec<f64> = pixels.iter().map(|p| p.standard_error).collect();
        Image::with_errors([32, 16], 1, pixels.iter().map(|p| p.mean).collect(), &errors, 4).expect("finite")
    };
    let a = side(Stream::of(derive(seed, 0, 0)), 1.0 + 0.01 * defect);
    let b = side(Stream::of(derive(seed, 0, 1)), 1.0);
    compare(&a, &b, 1.0).expect("same size")
}

#[test]
fn images_have_uniform_pooled_p_values_and_their_power() {
    let found: Vec<Comparison> = (0..RUNS).map(|seed| image_trial(seed, 0.0)).collect();
    assert_uniform("pooled", &found.iter().map(|c| c.pooled.p_value).collect::<Vec<_>>());
    let joint: Vec<f64> = found.iter().map(|c| c.evidence.p_value).collect();
    assert_level("image", &joint, 1e-2);
    assert_level("image", &joint, 1e-3);
    let missed = found.iter().filter(|c| c.interval[0] > 0.0 || c.interval[1] < 0.0).count();
    assert!(missed <= 13, "{missed}"); // as for means
    assert_power("image", power(|seed, defect| image_trial(seed, defect).evidence));
}

/// Pairs with uniform margins and correlation `rho`: density 1 + 3ρ(2x − 1)(2y − 1) (Farlie, Gumbel, Morgenstern), by rejection.
fn dependence_trial(seed: u64, rho: f64) -> Evidence {
    let claim = IndependenceClaim { pairs: 1000, grid: 8, bound: 0.3, source: Source::Independent };
    let pair = |seed: u64, i: u64| {
        let stream = Stream::of(derive(seed, 3, i));
        loop {
            let [x, y] = [stream.uniform(), stream.uniform()];
            if stream.uniform() * (1.0 + 3.0 * rho) < 1.0 + 3.0 * rho * (2.0 * x - 1.0) * (2.0 * y - 1.0) {
                return [x, y];
            }
        }
    };
    claim.evidence(&run(seed), pair).expect("enough pairs")
}

#[test]
fn independence_has_its_level_and_its_power() {
    let p_values: Vec<f64> = (0..RUNS).map(|seed| dependence_trial(seed, 0.0).p_value).collect();
    for level in [0.3, 0.1, 1e-2, 1e-3] {
        assert_level("independence", &p_values, level);
    }
    // Each of the three tests alone rejects with a third of the level, so together they do at least that.
    let below = p_values.iter().filter(|&&p| p < 0.3).count() as f64;
    assert!(below >= 200.0 - 5.0 * 180.0_f64.sqrt(), "{below}"); // 2,000·0.1, standard deviation √(2000·0.1·0.9)
    assert_power("independence", power(dependence_trial));
}
