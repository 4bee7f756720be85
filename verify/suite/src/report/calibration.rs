//! Error rates of the tests themselves, as `verify`'s calibration measured them: data for the page.

use std::path::Path;

use serde::{Deserialize, Serialize};

/// One kind of test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Its name.
    pub kind: String,
    /// What was tested on what.
    pub says: String,
    /// `short` (with all tests) or `long` (exhaustive level).
    pub form: String,
    /// Seed of the runs.
    pub seed: u64,
    /// Number of right runs.
    pub nulls: u64,
    /// Counts of their p-values in equal parts of [0, 1].
    pub histogram: Vec<u64>,
    /// How often levels reject right runs.
    pub rates: Vec<Rate>,
    /// What the resolution measures.
    pub quantity: String,
    /// The defect that is found with power 0.9, as the test states it.
    pub resolution: f64,
    /// Runs for each size of defect.
    pub runs: u64,
    /// Size of the defect in resolutions, and the share of runs that find it.
    pub power: Vec<[f64; 2]>,
}

/// How often a level rejects right runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// The level.
    pub level: f64,
    /// Runs that it rejects.
    pub rejected: u64,
    /// Fewest that a right test rejects with probability 0.9999.
    pub low: u64,
    /// Most.
    pub high: u64,
}

/// Why a file could not be taken: its name and the reason.
pub type Refused = (String, String);

/// Reads what lies in a folder, by name of the file; nothing where there is no such folder.
///
/// # Errors
/// The first file that is no calibration.
pub fn read(folder: &Path) -> Result<Vec<Calibration>, Refused> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(Vec::new()) };
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
    paths.sort();
    let one = |path: &std::path::PathBuf| {
        let refused = |reason: String| (path.display().to_string(), reason);
        let text = std::fs::read_to_string(path).map_err(|error| refused(error.to_string()))?;
        serde_json::from_str(&text).map_err(|error| refused(error.to_string()))
    };
    paths.iter().map(one).collect()
}
