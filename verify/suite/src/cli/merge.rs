//! `lightproof merge`: ranges of an image's samples become the image.

use std::path::PathBuf;
use std::time::Instant;

use renderer::film::Part;
use renderer::io::part::{self, Origin};

use super::image_file::Kind;
use super::{CliError, Status};

const EXAMPLES: &str = "Examples:
  lightproof render scene.xml --spp 64 --samples 0..8 -o first.part
  lightproof render scene.xml --spp 64 --samples 8..16 -o second.part
  lightproof merge first.part second.part -o scene.exr

The image has the same bits as one that was rendered at once.";

/// Join ranges of samples that `render --samples` wrote
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The parts, in any order; together they hold a range without a gap
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// The image, .exr or .png, or again a .part
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let start = Instant::now();
    let kind = Kind::of(&args.output)?;
    let (origin, part) = joined(&args.parts)?;
    kind.write(&args.output, &origin, &part, start.elapsed())?;
    Ok(Status::Good)
}

/// All parts as one, from the first sample to the last.
fn joined(paths: &[PathBuf]) -> Result<(Origin, Part), CliError> {
    let mut parts = Vec::new();
    for path in paths {
        let (origin, part) = part::read(path)?;
        parts.push((path, origin, part));
    }
    parts.sort_by_key(|(.., part)| part.range);
    let mut parts = parts.into_iter();
    let Some((first, origin, mut whole)) = parts.next() else {
        return Err(CliError::Arguments("no parts".into()));
    };
    if !whole.is_complete() {
        let message = "tiles are missing; a render that was not cut off is accepted".into();
        return Err(CliError::Sidecar { path: first.clone(), message });
    }
    for (path, other, part) in parts {
        let refuse = |message| CliError::Sidecar { path: path.clone(), message };
        if let Some(difference) = other.difference(&origin) {
            return Err(refuse(difference));
        }
        whole = whole.join(&part).map_err(|reason| refuse(reason.to_string()))?;
    }
    Ok((origin, whole))
}
