//! The tests tested, one kind each: p-values under the truth are uniform, and a defect of the stated resolution is found as often as stated.
//!
//! The short form (1,000 right runs, 200 for each size of defect) runs with all tests; `VERIFY_LEVEL=exhaustive cargo test --release -p
//! verify --test calibration` takes 10,000 and 1,000, and writes what it finds to `references/calibration`. The short form writes to
//! `target/lightproof/calibration`. The page draws both.

mod cells;
mod estimators;
mod record;

use record::{Form, Record};
use verify::claim::{Evidence, Seed};
use verify::estimate::Moments;
use verify::goodness::kolmogorov_smirnov;
use verify::points::fill;
use verify::seeds::derive;

/// One kind of test on a cheap subject.
struct Kind {
    /// Name, which is also that of its file.
    name: &'static str,
    /// What is tested on what, in one line.
    says: &'static str,
    /// How its p-values behave under the truth.
    null: Null,
    /// Runs the test from a seed on a subject with a defect of that size, in the quantity of the resolution.
    trial: fn(u64, f64) -> Evidence,
    /// The defect that is found with power 0.9, from the evidence of a right run.
    resolution: fn(&Evidence) -> f64,
}

/// How p-values behave under the truth.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Null {
    /// As uniform numbers.
    Uniform,
    /// Nothing is left to chance: p is 1 for a right subject, and there is nothing to be uniform.
    Never,
}

/// Size of a defect in resolutions, for the power curve.
const DEFECTS: [f64; 6] = [0.25, 0.5, 0.75, 1.0, 1.25, 1.5];

/// Level at which a defect counts as found.
const LEVEL: f64 = 1e-3;

/// Probability with which a right test violates one check; three attempts from fresh seeds must all do so to fail: 1e-12.
const FALSE_ALARM: f64 = 1e-4;
const ATTEMPTS: u64 = 3;

/// Calibrates a kind of test.
fn check(kind: &Kind) {
    let form = Form::from_env();
    let mut last = String::new();
    for attempt in 0..ATTEMPTS {
        let seed = Seed::derive(Seed::from_env(), kind.name, attempt);
        let record = measure(kind, form, seed);
        match violation(kind, &record) {
            None => return record.write(),
            Some(reason) => last = reason,
        }
    }
    panic!("{}: {last}, in {ATTEMPTS} attempts", kind.name);
}

fn measure(kind: &Kind, form: Form, seed: u64) -> Record {
    let (nulls, runs) = form.counts();
    let right: Vec<Evidence> = (0..nulls).map(|i| (kind.trial)(derive(seed, 0, i), 0.0)).collect();
    let resolution = right.iter().take(64).map(kind.resolution).collect::<Moments>().mean();
    let share = |(place, &defect): (usize, &f64)| {
        let found =
            |i: &u64| (kind.trial)(derive(seed, 1 + place as u64, *i), defect * resolution).p_value < LEVEL;
        [defect, (0..runs).filter(found).count() as f64 / runs as f64]
    };
    Record {
        kind: kind.name,
        says: kind.says,
        form,
        seed,
        runs,
        p_values: right.iter().map(|evidence| evidence.p_value).collect(),
        quantity: right[0].resolution.quantity,
        resolution,
        power: DEFECTS.iter().enumerate().map(share).collect(),
    }
}

/// What speaks against a kind's error rates, if anything does.
fn violation(kind: &Kind, record: &Record) -> Option<String> {
    let p_values = &record.p_values;
    match kind.null {
        Null::Uniform => {
            let fit = kolmogorov_smirnov(p_values).expect("p-values are in [0, 1]");
            if fit.p_value < FALSE_ALARM {
                return Some(format!(
                    "p-values are {:.4} from uniform, p {:.1e}",
                    fit.statistic, fit.p_value
                ));
            }
        }
        Null::Never => {
            let rejected = p_values.iter().filter(|p| **p < 1.0).count();
            if rejected > 0 {
                return Some(format!("{rejected} right runs are rejected"));
            }
        }
    }
    for rate in record.rates() {
        let too_few = kind.null == Null::Uniform && rate.rejected < rate.low;
        if too_few || rate.rejected > rate.high {
            return Some(format!(
                "{} rejected at {}, not {} to {}",
                rate.rejected, rate.level, rate.low, rate.high
            ));
        }
    }
    let found = record.power.iter().find(|[defect, _]| *defect == 1.0).map_or(0.0, |[_, share]| *share);
    // 1,000 runs spread by √(0.9·0.1/1000) = 0.0095, a fifth of what is allowed; 200 by 0.021.
    let slack = match record.form {
        Form::Long => 0.05,
        Form::Short => 5.0 * (0.9 * 0.1 / record.runs as f64).sqrt(),
    };
    let share = 100.0 * found;
    ((found - 0.9).abs() > slack)
        .then(|| format!("a defect of the stated resolution is found in {share} % of the runs, not 90"))
}

/// A stream of independent numbers.
struct Stream {
    seed: u64,
    next: std::cell::Cell<u64>,
}

impl Stream {
    fn of(seed: u64) -> Self {
        Self { seed, next: std::cell::Cell::new(0) }
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

/// The resolution that evidence states.
fn stated(evidence: &Evidence) -> f64 {
    evidence.resolution.value
}

/// The control of this file: p-values of a test that forgets its second side are not taken for uniform, nor a blind test for a seeing one.
#[test]
fn wrong_tests_are_found_out() {
    let right = measure(&cells::KOLMOGOROV, Form::Short, 1);
    let halved = Record { p_values: right.p_values.iter().map(|p| 0.5 * p).collect(), ..right.clone() };
    assert!(violation(&cells::KOLMOGOROV, &halved).is_some());
    let blind = Record { power: DEFECTS.iter().map(|&defect| [defect, 0.6]).collect(), ..right };
    assert!(violation(&cells::KOLMOGOROV, &blind).is_some_and(|reason| reason.contains("60 %")));
}
