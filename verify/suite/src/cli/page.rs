//! `lightproof page`: makes the page again from its data.

use std::path::PathBuf;

use super::{CliError, Status, write_file};
use crate::page;
use crate::report::Report;

const EXAMPLES: &str = "Example:
  lightproof page target/lightproof/report.json -o page.html";

/// Make the page again from the data of a run
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The data: a report.json that `lightproof verify` wrote
    report: PathBuf,
    /// The page to write
    #[arg(short, long, value_name = "FILE", default_value = "index.html")]
    output: PathBuf,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let report = Report::read(&args.report)
        .map_err(|source| CliError::Report { path: args.report.clone(), source })?;
    write_file(&args.output, page::html(&report).as_bytes())?;
    Ok(Status::Good)
}
