//! `lightproof analytic`: the closed-form scenes as files, so that any renderer can be held against them.

use std::io::Write;
use std::path::PathBuf;

use renderer::io::exr;

use super::output::Words;
use super::{CliError, Status, write_file};
use crate::analytic;

const EXAMPLES: &str = "Example:
  lightproof analytic scenes
  mitsuba -s 1 -o penumbra-1.exr scenes/penumbra.xml      and with other seeds
  lightproof compare penumbra-*.exr -- scenes/penumbra.exr --max-bias 0.2";

/// Write scenes with known images: Mitsuba XML, exact EXR, and a README of conventions
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Folder for the files; it is made where it is missing
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let scenes = analytic::all();
    let mut words = Words::beside(None);
    for scene in &scenes {
        let file = |extension: &str| args.folder.join(scene.name).with_extension(extension);
        write_file(&file("xml"), scene.xml.as_bytes())?;
        exr::write(&file("exr"), &scene.image())?;
        writeln!(words, "{:17} {}", scene.name, scene.says)?;
    }
    write_file(&args.folder.join("README.md"), analytic::readme(&scenes).as_bytes())?;
    words.flush()?;
    Ok(Status::Good)
}
