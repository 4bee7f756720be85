//! Tests of means: Student's, Welch's, slopes, images.

use verify::claim::{Evidence, Run};
use verify::convergence::SlopeClaim;
use verify::estimate::Moments;
use verify::image::{Comparison, Image, compare};
use verify::mean::{MeanClaim, joint_evidence};
use verify::seeds::derive;
use verify::welch::EqualMeans;

use crate::{Kind, Null, Stream, check, stated};

fn run(seed: u64) -> Run {
    Run { seed, effort: 1 }
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

const MEAN: Kind = Kind {
    name: "mean",
    says: "32 normal replicates against a known mean; defect: another mean",
    null: Null::Uniform,
    trial: |seed, defect| mean_trial(1, seed, defect),
    resolution: stated,
};

const MEANS: Kind = Kind {
    name: "several means",
    says: "five configurations of 32 normal replicates; defect: another mean of the noisiest",
    null: Null::Uniform,
    trial: |seed, defect| mean_trial(5, seed, defect),
    resolution: stated,
};

const WELCH: Kind = Kind {
    name: "two means",
    says: "32 normal replicates a side, one three times noisier; defect: different means",
    null: Null::Uniform,
    trial: |seed, defect| {
        let claim = EqualMeans { unit: 2.0, replicates: 32, bound: 0.5 };
        let side = |noise: f64, shift: f64| move |seed| 2.0 + shift + noise * Stream::of(seed).normal();
        claim.evidence(&run(seed), side(0.3, 2.0 * defect), side(0.1, 0.0)).expect("enough replicates")
    },
    resolution: stated,
};

const SLOPE: Kind = Kind {
    name: "slope",
    says: "normal errors at four sample counts, 200 replicates each; defect: another slope",
    null: Null::Uniform,
    trial: |seed, defect| {
        let claim = SlopeClaim {
            name: String::from("normal errors"),
            exact: 0.0,
            counts: vec![16, 64, 256, 1024],
            replicates: 200,
            theory: -0.75 + defect,
            bound: 0.3,
        };
        claim
            .evidence(&run(seed), |n, seed| (n as f64).powf(-0.75) * Stream::of(seed).normal())
            .expect("runs")
    },
    resolution: stated,
};

/// Two images of sixteen tiles from four replicates a side; the noise of a pixel is a fifth of its value, so that
/// a brighter image is hardly noisier, and A is brighter by `defect` percent.
fn image_trial(seed: u64, defect: f64) -> Comparison {
    const SIZE: [usize; 2] = [256, 4];
    let side = |stream: Stream, factor: f64| {
        let pixel = |i: usize| {
            let truth = factor * (0.1 + (i % SIZE[0]) as f64 / SIZE[0] as f64);
            (0..4).map(|_| truth * (1.0 + 0.2 * stream.normal())).collect::<Moments>().estimate()
        };
        let pixels: Vec<_> = (0..SIZE[0] * SIZE[1]).map(pixel).collect();
        let errors: Vec<f64> = pixels.iter().map(|p| p.standard_error).collect();
        Image::with_errors(SIZE, 1, pixels.iter().map(|p| p.mean).collect(), &errors, 4).expect("finite")
    };
    let a = side(Stream::of(derive(seed, 0, 0)), 1.0 + 0.01 * defect);
    let b = side(Stream::of(derive(seed, 0, 1)), 1.0);
    compare(&a, &b, 1.0).expect("same size")
}

const IMAGE: Kind = Kind {
    name: "image",
    says: "two noisy images of sixteen tiles, pooled mean and tiles together; defect: a brighter one",
    null: Null::Uniform,
    trial: |seed, defect| image_trial(seed, defect).evidence,
    resolution: stated,
};

/// The pooled mean alone, against the bias that it finds by itself.
const POOLED: Kind = Kind {
    name: "pooled mean of an image",
    says: "two noisy images, by their means alone; defect: a brighter one",
    null: Null::Uniform,
    trial: |seed, defect| {
        let Comparison { pooled, evidence, .. } = image_trial(seed, defect);
        Evidence { p_value: pooled.p_value, ..evidence }
    },
    resolution: |evidence| {
        // Normal quantiles of 1e-3 and power 0.9, instead of a third of 1e-3: 4.572 instead of 4.869 standard errors.
        evidence.resolution.value * (3.290_527 + 1.281_552) / (3.587_828 + 1.281_552)
    },
};

macro_rules! tests {
    ($($name:ident: $kind:ident,)*) => { $(#[test] fn $name() { check(&$kind); })* };
}

tests! {
    mean: MEAN,
    several_means: MEANS,
    two_means: WELCH,
    slope: SLOPE,
    image: IMAGE,
    pooled_mean_of_an_image: POOLED,
}

/// Limits of a right mean cover the truth but once in a thousand runs, and no run has a doubt.
#[test]
fn intervals_of_means_cover_the_truth() {
    let runs: Vec<Evidence> = (0..2000).map(|seed| mean_trial(1, seed, 0.01)).collect();
    let missed = runs.iter().filter(|e| e.interval[0] > 0.01 || e.interval[1] < 0.01).count();
    // Expected at 1e-3 of 2,000: 2; P(more than 13) of a Poisson count is below 1e-6.
    assert!(missed <= 13, "{missed}");
    assert!(runs.iter().all(|e| e.doubts.is_empty()));
}
