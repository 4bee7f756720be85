//! What a calibration found, as a file that the page draws.

use std::path::{Path, PathBuf};

use verify::claim::Level;

use crate::FALSE_ALARM;

/// How many runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Short,
    Long,
}

impl Form {
    /// Long at `VERIFY_LEVEL=exhaustive`.
    pub(crate) fn from_env() -> Self {
        if Level::from_env() == Level::Exhaustive { Self::Long } else { Self::Short }
    }

    /// Right runs, and runs for each size of defect.
    pub(crate) fn counts(self) -> (u64, u64) {
        match self {
            Self::Short => (1000, 200),
            Self::Long => (10_000, 1000),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Short => "short",
            Self::Long => "long",
        }
    }

    /// Where its results lie.
    fn folder(self) -> PathBuf {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        root.join(match self {
            Self::Short => "target/lightproof/calibration",
            Self::Long => "references/calibration",
        })
    }
}

/// How often a level rejects right runs, and how often it may.
pub(crate) struct Rate {
    pub(crate) level: f64,
    pub(crate) rejected: u64,
    /// The 99.99 % limits of a binomial count.
    pub(crate) low: u64,
    pub(crate) high: u64,
}

/// What a calibration found.
#[derive(Debug, Clone)]
pub(crate) struct Record {
    pub(crate) kind: &'static str,
    pub(crate) says: &'static str,
    pub(crate) form: Form,
    pub(crate) seed: u64,
    /// Runs for each size of defect.
    pub(crate) runs: u64,
    /// p-values of right runs.
    pub(crate) p_values: Vec<f64>,
    pub(crate) quantity: &'static str,
    pub(crate) resolution: f64,
    /// Size of the defect in resolutions, and the share of runs that find it.
    pub(crate) power: Vec<[f64; 2]>,
}

impl Record {
    pub(crate) fn rates(&self) -> [Rate; 3] {
        [0.1, 0.01, 0.001].map(|level| {
            let rejected = self.p_values.iter().filter(|p| **p < level).count() as u64;
            let [low, high] = binomial_limits(self.p_values.len() as u64, level);
            Rate { level, rejected, low, high }
        })
    }

    /// Counts of p-values in twenty equal parts of [0, 1].
    fn histogram(&self) -> [u32; 20] {
        let mut counts = [0; 20];
        for p in &self.p_values {
            let part = (0..20).rfind(|&part| *p * 20.0 >= f64::from(part)).unwrap_or(0);
            counts[part as usize] += 1;
        }
        counts
    }

    fn json(&self) -> String {
        let rate = |r: &Rate| {
            format!(
                "{{\"level\": {}, \"rejected\": {}, \"low\": {}, \"high\": {}}}",
                r.level, r.rejected, r.low, r.high
            )
        };
        let rates: Vec<String> = self.rates().iter().map(rate).collect();
        format!(
            "{{\n\"kind\": {:?}, \"says\": {:?}, \"form\": {:?}, \"seed\": {},\n\"nulls\": {}, \"histogram\": {:?},\n\"rates\": [{}],\n\
             \"quantity\": {:?}, \"resolution\": {:e}, \"runs\": {},\n\"power\": {:?}\n}}\n",
            self.kind,
            self.says,
            self.form.name(),
            self.seed,
            self.p_values.len(),
            self.histogram(),
            rates.join(", "),
            self.quantity,
            self.resolution,
            self.runs,
            self.power
        )
    }

    /// Writes the file of this kind.
    pub(crate) fn write(&self) {
        let folder = self.form.folder();
        std::fs::create_dir_all(&folder).expect("the folder for results can be made");
        let path = folder.join(self.kind.replace(' ', "-")).with_extension("json");
        std::fs::write(&path, self.json()).expect("the file for results can be written");
    }
}

/// Counts that a binomial variable is below, or above, with half of the false-alarm rate each.
fn binomial_limits(n: u64, p: f64) -> [u64; 2] {
    // Weights relative to that of the mode, where nothing underflows.
    let mode = (n as f64 * p).floor();
    let odds = p / (1.0 - p);
    let ratio = |k: f64| (n as f64 - k) / (k + 1.0) * odds;
    let up = std::iter::successors(Some((mode, 1.0)), |&(k, w)| Some((k + 1.0, w * ratio(k))));
    let down =
        std::iter::successors(Some((mode, 1.0)), |&(k, w)| (k > 0.0).then(|| (k - 1.0, w / ratio(k - 1.0))));
    let lower: Vec<(f64, f64)> = down.skip(1).take_while(|(_, w)| *w > 1e-18).collect();
    let all: Vec<(f64, f64)> = lower.into_iter().rev().chain(up.take_while(|(_, w)| *w > 1e-18)).collect();
    let total: f64 = all.iter().map(|(_, w)| w).sum();
    let mut below = 0.0;
    let cumulative = all.into_iter().map(|(k, w)| {
        below += w / total;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from 0 to n")]
        let count = k as u64;
        (count, below)
    });
    let cumulative: Vec<(u64, f64)> = cumulative.collect();
    [0.5 * FALSE_ALARM, 1.0 - 0.5 * FALSE_ALARM]
        .map(|limit| cumulative.iter().find(|(_, share)| *share > limit).map_or(n, |(k, _)| *k))
}

#[test]
fn limits_are_those_of_the_binomial_distribution() {
    // scipy 1.17.1: binom.ppf([5e-5, 1 - 5e-5], n, p).
    assert_eq!(binomial_limits(10_000, 0.001), [1, 24]);
    assert_eq!(binomial_limits(10_000, 0.1), [885, 1119]);
}
