//! Calibration: the tests reject what is right as often as they say, and find what is wrong as often as they
//! say.

use verify::chi_square::ChiSquare;
use verify::claim::{Run, Seed};
use verify::domain::Parallelogram;
use verify::power::chi_square_sf;

/// Runs of a right sampler. The bound makes 5,280 samples of each: about 27 in a coarse cell, 0.27 in a fine
/// one, so that pooling is tested too.
const RUNS: u64 = 2000;
const SMALL: f64 = 0.2;

fn right([u, v]: [f64; 2]) -> Option<[f64; 2]> {
    Some([u, v])
}

/// P-values of right runs: of the coarse grid alone, and joined with that of the fine one.
fn right_p_values(density: fn([f64; 2]) -> f64, sampler: fn([f64; 2]) -> Option<[f64; 2]>) -> [Vec<f64>; 2] {
    let test = ChiSquare::on(Parallelogram::unit_square()).density(density).samples(sampler).bound(SMALL);
    let master = Seed::from_env();
    let p_values = |index| {
        let run = Run { seed: Seed::derive(master, "calibration of right samplers", index), effort: 1 };
        let evidence = test.evidence(&run).expect("a uniform density has cells");
        (
            chi_square_sf(evidence.statistic, evidence.dof.expect("chi-square has degrees of freedom")),
            evidence.p_value,
        )
    };
    let (coarse, joined) = (0..RUNS).map(p_values).unzip();
    [coarse, joined]
}

/// Largest distance between the empirical distribution and the uniform one.
fn distance_from_uniform(p_values: &[f64]) -> f64 {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let gap = |(i, p): (usize, &f64)| (p - i as f64 / n).max((i + 1) as f64 / n - p);
    sorted.iter().enumerate().map(gap).fold(0.0, f64::max)
}

/// Probability that a right set of p-values fails one of its checks.
const FALSE_ALARM: f64 = 1e-4;

/// Dvoretzky, Kiefer, Wolfowitz, Massart: P(D > d) ≤ 2 exp(−2nd²).
fn largest_distance(n: f64) -> f64 {
    ((2.0 / FALSE_ALARM).ln() / (2.0 * n)).sqrt()
}

/// Bernstein, for a binomial count X of a given mean: P(|X − mean| > t) ≤ 2 exp(−t²/2/(mean + t/3)), solved
/// for t.
fn slack(mean: f64) -> f64 {
    let l = (2.0 / FALSE_ALARM).ln();
    l / 3.0 + (l * l / 9.0 + 2.0 * l * mean).sqrt()
}

fn assert_calibrated(name: &str, p_values: &[f64]) {
    let n = p_values.len() as f64;
    let (distance, limit) = (distance_from_uniform(p_values), largest_distance(n));
    assert!(distance < limit, "{name}: p-values are {distance:.4} from uniform, more than {limit:.4}");
    let mut report = format!("{name}: distance {distance:.4} of {limit:.4};");
    for level in [0.1, 0.01, 0.001] {
        let (rejected, mean) = (p_values.iter().filter(|p| **p < level).count() as f64, n * level);
        assert!((rejected - mean).abs() < slack(mean), "{name}: {rejected} of {n} rejected at {level}");
        report += &format!(" {rejected} rejected at {level};");
    }
    eprintln!("{report}");
}

#[test]
fn p_values_of_right_samplers_are_uniform() {
    let [coarse, joined] = right_p_values(|_| 1.0, right);
    assert_calibrated("coarse", &coarse);
    assert_calibrated("joined", &joined);
    // The control: a test that reports half its p-values, as one does that forgets its second side.
    let halved: Vec<f64> = coarse.iter().map(|p| 0.5 * p).collect();
    let (n, mean) = (halved.len() as f64, halved.len() as f64 * 0.1);
    assert!(distance_from_uniform(&halved) > largest_distance(n));
    assert!(halved.iter().filter(|p| **p < 0.1).count() as f64 > mean + slack(mean));
}

#[test]
fn p_values_of_a_right_peaked_sampler_are_uniform() {
    let [coarse, joined] = right_p_values(|[x, _]| 4.0 * x * x * x, |[u, v]| Some([u.powf(0.25), v]));
    assert_calibrated("coarse, peaked", &coarse);
    assert_calibrated("joined, peaked", &joined);
}

#[test]
fn a_defect_of_the_stated_resolution_is_found_with_the_stated_power() {
    const RUNS: u64 = 1000;
    let right = ChiSquare::on(Parallelogram::unit_square()).samples(right).bound(0.1);
    let size = right.resolution(&Run { seed: 0, effort: 1 }).expect("a uniform density has cells");
    // A checkerboard over the 14 × 14 cells, relative error ±size: no contrast has more than a thousandth of it.
    let odd = |x: f64| (14.0 * x) as u32 % 2 == 1;
    let checker = move |[u, v, w]: [f64; 3]| {
        let moved = odd(u) != odd(v) && w < size;
        Some([if moved { (u + 1.0 / 14.0).fract() } else { u }, v])
    };
    let wrong = ChiSquare::on(Parallelogram::unit_square()).samples(checker).bound(0.1);
    let master = Seed::from_env();
    let found = |index: &u64| {
        let run = Run { seed: Seed::derive(master, "calibration of power", *index), effort: 1 };
        wrong.evidence(&run).expect("runs").p_value < 1e-3
    };
    let share = (0..RUNS).filter(found).count() as f64 / RUNS as f64;
    // Stated: 0.9. The test inside the cells adds 5e-4, the normal limit of a multinomial is off by O(1/√n): so 0.85 to 0.95, at a standard
    // error of √(0.9·0.1/1000) = 0.0095.
    eprintln!("found in {share} of the runs");
    assert!((0.85..=0.95).contains(&share), "{share}");
}
