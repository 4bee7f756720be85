//! The command line: one file a command; what they share is here: the list of commands, errors and status.

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

mod analytic;
mod compare;
mod effects;
mod error;
mod image_file;
mod merge;
mod output;
mod page;
mod render;
mod samples;
mod table;
mod verify;

pub use error::CliError;
pub use samples::file as points;

/// What a command that could run says about its subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Status {
    /// Everything holds: status 0.
    Good,
    /// Something fails or is undecided: status 1.
    Bad,
}

const EXAMPLES: &str = "Without a command, lightproof runs `verify`.

Examples:
  lightproof                                  run all claims at the quick level
  lightproof verify --only 'warp/*'           run the claims about warps
  lightproof render scene.xml -o scene.exr     render a scene in Mitsuba's XML format
  lightproof effects scene.xml                what do its effects cost?
  lightproof compare ours.exr theirs.exr      are these the same image?
  lightproof analytic scenes                  write scenes with known images, for any renderer
  lightproof samples lens.npy --domain disk     do these points follow their density?
  lightproof merge a.part b.part -o scene.exr join ranges of samples
  lightproof page report.json -o page.html    make the page again from its data

Status: 0 everything holds; 1 something fails or is undecided; 2 it could not run.";

/// A distribution ray tracer that comes with the proof that it is right
#[derive(Parser)]
#[command(name = "lightproof", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    verify: verify::Args,
}

#[derive(Subcommand)]
enum Command {
    Verify(verify::Args),
    Render(render::Args),
    Effects(effects::Args),
    Compare(compare::Args),
    Analytic(analytic::Args),
    Samples(samples::Args),
    Merge(merge::Args),
    Page(page::Args),
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command.unwrap_or(Command::Verify(cli.verify)) {
        Command::Verify(args) => verify::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Effects(args) => effects::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Analytic(args) => analytic::run(&args),
        Command::Samples(args) => samples::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Page(args) => page::run(&args),
    };
    match result {
        Ok(Status::Good) => ExitCode::SUCCESS,
        Ok(Status::Bad) => ExitCode::from(1),
        Err(CliError::Closed) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Writes a file, and the folders that lead to it.
fn write_file(path: &Path, content: &[u8]) -> Result<(), CliError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(path, content))
        .map_err(|source| CliError::Io { path: path.to_owned(), source })
}
