//! What `render` and `merge` write: an image, or samples that are still to be merged.

use std::io::{Write, stderr};
use std::path::Path;
use std::time::Duration;

use renderer::film::Part;
use renderer::io;
use renderer::io::part::Origin;
use renderer::render::Rendering;

use super::CliError;

/// The kind of a file, by its ending.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Exr,
    Png,
    Part,
}

impl Kind {
    /// The kind that `path` ends in.
    pub(super) fn of(path: &Path) -> Result<Self, CliError> {
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            Some("part") => Ok(Self::Part),
            _ => Err(CliError::Kind { path: path.into(), accepted: ".exr, .png or .part" }),
        }
    }

    /// Writes `part`, or the image that it makes, and says the image's mean and the time that it took.
    pub(super) fn write(
        self,
        path: &Path,
        origin: &Origin,
        part: &Part,
        time: Duration,
    ) -> Result<(), CliError> {
        let rendering = Rendering::of(part, origin.reconstruction);
        let image = || io::rendering::image(&rendering, Some(origin.provenance(part, &rendering)));
        match self {
            Self::Exr => io::exr::write(path, &image())?,
            Self::Png => io::png::write(path, &image(), 0.0)?,
            Self::Part => io::part::write(path, origin, part)?,
        }
        summarise(&rendering, origin.shared_by, path, time)
    }
}

/// * `shared_by`: how many pixels have errors in common at most, which adds up to so many times the variance of independent ones.
fn summarise(rendering: &Rendering, shared_by: u32, output: &Path, time: Duration) -> Result<(), CliError> {
    let (mut sum, mut variance, mut known) = (0.0, 0.0, true);
    for pixel in &rendering.pixels {
        sum += pixel.mean.iter().sum::<f64>();
        known &= pixel.standard_error.is_some();
        variance += pixel.standard_error.map_or(0.0, |e| e.iter().map(|e| e * e).sum());
    }
    let count = 3.0 * rendering.pixels.len() as f64;
    let error = if known {
        format!(" ± {:.2e}", f64::sqrt(f64::from(shared_by) * variance) / count)
    } else {
        ", error unknown".into()
    };
    let (mean, seconds) = (sum / count, time.as_secs_f64());
    let mut err = stderr();
    writeln!(err, "{}: mean {mean:.6}{error}, {seconds:.2} s", output.display())?;
    if rendering.dropped > 0 {
        writeln!(err, "note: {} contributions were not finite and are left out", rendering.dropped)?;
    }
    Ok(())
}
