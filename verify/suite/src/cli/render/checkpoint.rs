//! What a long render keeps on disk, so that an interruption loses little of it.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use renderer::film::{Part, Reconstruction};
use renderer::io::part::{self, Origin};

use super::CliError;

/// A checkpoint takes at most one part of the time in this many.
const SPARING: u32 = 20;

/// The file beside an output that holds what is finished of it.
pub(super) struct Checkpoint {
    path: PathBuf,
    origin: Origin,
    /// Least time from one checkpoint to the next.
    interval: Duration,
    due: Mutex<Instant>,
}

impl Checkpoint {
    /// `OUTPUT.checkpoint`.
    pub(super) fn beside(output: &Path, origin: Origin, interval: Duration) -> Self {
        let mut name = output.as_os_str().to_owned();
        name.push(".checkpoint");
        Self { path: name.into(), origin, interval, due: Mutex::new(Instant::now() + interval) }
    }

    /// What an earlier run has finished of `wanted`; `None` where there is no checkpoint.
    ///
    /// * `allocated`: whether pixels have numbers of samples of their own, which are those of the checkpoint.
    pub(super) fn resume(&self, wanted: &Part, allocated: bool) -> Result<Option<Part>, CliError> {
        if !self.path.exists() {
            return Ok(None);
        }
        let (origin, found) = part::read(&self.path)?;
        let other = |message| CliError::Sidecar { path: self.path.clone(), message };
        if let Some(difference) = origin.difference(&self.origin) {
            return Err(other(difference));
        }
        if found.counts().is_some() != allocated || !found.is_of_ranges(wanted) {
            return Err(other("it holds other samples; those of the same options are accepted".into()));
        }
        Ok(Some(found))
    }

    /// Shows the error so far, and writes the checkpoint when it is time.
    pub(super) fn watch(&self, part: &Part, bar: &ProgressBar) {
        let mut due = self.due.lock().unwrap_or_else(PoisonError::into_inner);
        let start = Instant::now();
        if start < *due || part.is_complete() {
            return;
        }
        if let Some(percent) = pixel_error(part, self.origin.reconstruction) {
            bar.set_message(format!("± {percent:.2} % a pixel"));
        }
        if let Err(error) = part::write(&self.path, &self.origin, part) {
            bar.suspend(|| eprintln!("note: no checkpoint: {error}"));
        }
        *due = Instant::now() + self.interval.max(start.elapsed() * SPARING);
    }

    /// Takes the file away.
    pub(super) fn remove(&self) -> Result<(), CliError> {
        match std::fs::remove_file(&self.path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(CliError::Io { path: self.path.clone(), source: error })
            }
            _ => Ok(()),
        }
    }
}

/// Root mean square of the standard errors of the finished pixels, in percent of their mean.
fn pixel_error(part: &Part, reconstruction: Reconstruction) -> Option<f64> {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for pixel in part.estimates(reconstruction).iter().filter(|pixel| pixel.samples > 0) {
        sum += pixel.mean.iter().sum::<f64>();
        squares += pixel.standard_error?.iter().map(|e| e * e).sum::<f64>();
        count += 3.0;
    }
    (sum > 0.0).then(|| 100.0 * (squares / count).sqrt() / (sum / count))
}
