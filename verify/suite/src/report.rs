//! What a run of claims found, as data: the content of `report.json`, from which alone the page is made.

use std::path::Path;

use serde::{Deserialize, Serialize};
use verify::claim::{ControlOutcome, Evidence, Level, Outcome, Verdict};

pub mod calibration;
pub mod picture;

pub use calibration::Calibration;
pub use picture::PictureData;

/// Version of the format; a file of another version is refused.
pub const SCHEMA: u32 = 1;

/// A number that may be unknown or without limit: `null` in the file.
pub type Number = Option<f64>;

/// A run of claims.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Version of the format: 1.
    pub schema: u32,
    /// Version of the program that ran the claims.
    pub lightproof: String,
    /// Master seed.
    pub seed: u64,
    /// Level: `quick`, `standard` or `exhaustive`.
    pub level: String,
    /// Wall time of the whole run.
    pub seconds: f64,
    /// Processor, cores and system.
    pub machine: String,
    /// The claims that ran, in the order of their list.
    pub claims: Vec<ClaimReport>,
    /// The claims that could not run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<ClaimError>,
    /// Rendered scenes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gallery: Vec<Gallery>,
    /// What numeric stability costs, routine by routine; empty where no `stable` claim ran.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stability: Vec<StabilityRow>,
    /// Error rates of the tests themselves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calibration: Vec<Calibration>,
}

/// A routine in its usual form and in ours: the worst error of either, and its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StabilityRow {
    /// Routine and range.
    pub routine: String,
    /// What errors are measured in.
    pub unit: String,
    /// The usual form.
    pub naive: String,
    /// Its worst error; `null` where it gave no finite number, or a wrong decision.
    pub naive_error: Number,
    /// Our worst error.
    pub error: Number,
    /// The bound that the claim asserts for it.
    pub bound: f64,
    /// Nanoseconds a call of the usual form, with what the measurement adds to both.
    pub naive_ns: f64,
    /// Nanoseconds a call of ours.
    pub ours_ns: f64,
}

/// One claim of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClaimReport {
    /// Name, `group/subject/property`.
    pub id: String,
    /// The assertion in one sentence.
    pub says: String,
    /// The test of the last run.
    pub method: String,
    /// Independent draws of the last run.
    pub n: u64,
    /// Test statistic of the last run.
    pub statistic: Number,
    /// Its degrees of freedom.
    pub dof: Number,
    /// Probability of such a statistic if the subject is exactly right.
    pub p_value: Number,
    /// Estimate of the defect, in the quantity of `resolves`.
    pub estimate: Number,
    /// Its 99.9 % limits; `null` where there is none.
    pub interval: [Number; 2],
    /// What the defect must stay below.
    pub bound: f64,
    /// The conclusion.
    #[serde(with = "VerdictName")]
    pub verdict: Verdict,
    /// What the last run could have seen.
    pub resolves: Resolves,
    /// Wrong versions that the same test must reject.
    pub controls: Vec<ControlReport>,
    /// Runs of the subject: 1 to 3.
    pub runs: u8,
    /// Reasons not to trust normal theory here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
    /// Wall time of all runs and controls.
    pub seconds: f64,
    /// The command that repeats the claim.
    pub command: String,
    /// Data for pictures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<PictureData>,
}

/// The smallest defect that would have been caught.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Resolves {
    /// What the value measures.
    pub quantity: String,
    /// The smallest defect caught.
    pub value: Number,
    /// The probability of catching it.
    pub power: Number,
}

/// How a wrong version fared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ControlReport {
    /// Its name.
    pub name: String,
    /// Its probability under "exactly right"; `null` for claims that are judged by an interval.
    pub p_value: Number,
    /// Whether it was rejected, as it must be.
    pub rejected: bool,
}

/// A claim that could not run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClaimError {
    /// The claim's name.
    pub id: String,
    /// Why it could not run.
    pub message: String,
}

/// A rendered scene for the page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gallery {
    /// The scene's name.
    pub name: String,
    /// What is to be seen.
    pub caption: String,
    /// The picture: the bytes of a PNG file (base64 in the report).
    #[serde(with = "base64_text")]
    pub png: Vec<u8>,
}

/// The verdicts' names in the file.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Verdict", rename_all = "lowercase")]
enum VerdictName {
    Holds,
    Fails,
    Undecided,
}

/// Bytes as base64 text.
mod base64_text {
    use base64::{Engine as _, engine::general_purpose::STANDARD};
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(super) fn serialize<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&STANDARD.encode(bytes))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
        STANDARD.decode(String::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// Why a report could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It is not such a report.
    #[error("{0}; a report.json that lightproof verify wrote is accepted")]
    Json(#[from] serde_json::Error),
    /// It has another version.
    #[error("schema is {0}; {SCHEMA} is accepted")]
    Schema(u32),
}

impl Report {
    /// The number of claims with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.claims.iter().filter(|claim| claim.verdict == verdict).count()
    }

    /// Whether every claim ran and holds.
    pub fn all_hold(&self) -> bool {
        self.errors.is_empty() && self.claims.iter().all(|claim| claim.verdict == Verdict::Holds)
    }

    /// The file's text.
    ///
    /// # Errors
    /// None for a report made here: every key is a string and every number is finite or `null`.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// Reads a report.
    ///
    /// # Errors
    /// [`ReadError`] when the file cannot be read, is not a report, or has another schema.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        #[derive(Deserialize)]
        struct Version {
            schema: u32,
        }
        let text = std::fs::read_to_string(path)?;
        let Version { schema } = serde_json::from_str(&text)?;
        if schema != SCHEMA {
            return Err(ReadError::Schema(schema));
        }
        Ok(serde_json::from_str(&text)?)
    }
}

impl ClaimReport {
    /// The report on an outcome.
    pub fn of(outcome: &Outcome) -> Self {
        let Evidence { method, n, interval, bound, resolution, doubts, pictures, .. } = &outcome.evidence;
        let evidence = &outcome.evidence;
        Self {
            id: outcome.id.clone(),
            says: outcome.says.clone(),
            method: method.clone(),
            n: *n,
            statistic: finite(evidence.statistic),
            dof: evidence.dof.and_then(finite),
            p_value: finite(evidence.p_value),
            estimate: finite(evidence.estimate),
            interval: interval.map(finite),
            bound: *bound,
            verdict: outcome.verdict,
            resolves: Resolves {
                quantity: String::from(resolution.quantity),
                value: finite(resolution.value),
                power: finite(resolution.power),
            },
            controls: outcome.controls.iter().map(ControlReport::of).collect(),
            runs: outcome.runs,
            doubts: doubts.clone(),
            seconds: outcome.seconds,
            command: command(&outcome.id, outcome.seed, outcome.level),
            pictures: pictures.iter().map(PictureData::of).collect(),
        }
    }

    /// The group: what comes before the first slash of the name.
    pub fn group(&self) -> &str {
        self.id.split('/').next().unwrap_or(&self.id)
    }
}

impl ControlReport {
    fn of(control: &ControlOutcome) -> Self {
        Self { name: control.name.clone(), p_value: finite(control.p_value), rejected: control.rejected }
    }
}

/// The number, unless it is infinite or not a number.
fn finite(value: f64) -> Number {
    value.is_finite().then_some(value)
}

/// The command that repeats one claim.
fn command(id: &str, seed: u64, level: Level) -> String {
    format!("lightproof verify --only '{id}' --level {} --seed {seed}", level.name())
}

/// Processor, cores and system of this machine.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpuinfo
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or(std::env::consts::ARCH, |(_, model)| model.trim());
    format!("{model}, {cores} cores, {}", std::env::consts::OS)
}
