//! `lightproof verify`: runs the claims; writes a table, the page and its data.

use std::collections::HashMap;
use std::io::{Write, stdout};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::{ValueEnum, builder::PossibleValue};
use indicatif::{ProgressBar, ProgressStyle};
use verify::claim::{self, Claim};
use wildmatch::WildMatch;

use super::output::{Words, is_stdout};
use super::{CliError, Status, table, write_file};
use crate::report::{self, Calibration, ClaimReport, Report, StabilityRow};
use crate::runner::{self, Settings};
use crate::{claims, gallery, page};

const EXAMPLES: &str = "Examples:
  lightproof verify --only 'warp/disk/*' --json -    the claims about disks; JSON alone on standard output
  lightproof verify --level standard --seed 7        eight times the samples, other random numbers
  lightproof verify --list --only '*lens*'           the claims with \"lens\" in their names

The page and report.json go to target/lightproof.
Status: 0 every claim holds; 1 one fails or is undecided; 2 one could not run.";

/// Run the claims about the renderer; write a table, a page and its data
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Claims to run: names with `*` and `?`, where `*` crosses `/`; may be repeated
    #[arg(long, value_name = "GLOB")]
    only: Vec<String>,
    /// How thoroughly: 1, 8 or 64 times the samples; some claims are left to the higher levels
    #[arg(long, env = "VERIFY_LEVEL", default_value = "quick", value_enum)]
    level: Level,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", env = "VERIFY_SEED", default_value_t = 0)]
    seed: u64,
    /// Folder for the page (index.html) and its data (report.json)
    #[arg(long, value_name = "DIR", default_value = "target/lightproof")]
    report: PathBuf,
    /// Write the data to this file as well; `-` is standard output (the table goes to standard error)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Folder of reference scenes and images [default: that of the source]
    #[arg(long, value_name = "DIR")]
    references: Option<PathBuf>,
    /// List the claims instead of running them
    #[arg(long)]
    list: bool,
    /// How many claims to run at once [default: one a core]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
}

/// The level as an option's value.
#[derive(Clone, Copy)]
struct Level(claim::Level);

impl ValueEnum for Level {
    fn value_variants<'a>() -> &'a [Self] {
        use claim::Level::{Exhaustive, Quick, Standard};
        &[Self(Quick), Self(Standard), Self(Exhaustive)]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()))
    }
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    if let Some(folder) = &args.references {
        claims::set_references(folder);
    }
    let threads = match args.threads {
        Some(threads) => threads.get(),
        None => std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
    };
    // Before the claims are made: scenes build their trees on these threads.
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let all = claims::all();
    let chosen = choose(&all, &args.only, args.level.0)?;
    let mut words = Words::beside(args.json.as_deref());
    if args.list {
        let width = chosen.iter().map(|claim| claim.id().len()).max().unwrap_or(0);
        for claim in chosen {
            writeln!(words, "{:width$}  {}", claim.id(), claim.says())?;
        }
        return Ok(Status::Good);
    }
    let report = run_claims(args, chosen, threads)?;
    table::write(&mut words, &report)?;
    let index = write_report(args, &report)?;
    writeln!(words, "page: {}", index.display())?;
    words.flush()?;
    match report.errors.first() {
        Some(error) => Err(CliError::Claims {
            count: report.errors.len(),
            total: report.claims.len() + report.errors.len(),
            first: format!("{}: {}", error.id, error.message),
        }),
        None if report.all_hold() => Ok(Status::Good),
        None => Ok(Status::Bad),
    }
}

/// The level's claims that one of the patterns fits; all of them without a pattern.
fn choose<'a>(
    all: &'a [Claim],
    patterns: &[String],
    level: claim::Level,
) -> Result<Vec<&'a Claim>, CliError> {
    let matchers: Vec<WildMatch> = patterns.iter().map(|pattern| WildMatch::new(pattern)).collect();
    for (matcher, pattern) in matchers.iter().zip(patterns) {
        let first = all.iter().filter(|claim| matcher.matches(claim.id())).map(Claim::first_level).min();
        match first {
            None => {
                return Err(CliError::NoMatch { pattern: pattern.clone(), nearest: nearest(all, pattern) });
            }
            Some(first) if first > level => {
                return Err(CliError::AboveLevel { pattern: pattern.clone(), first });
            }
            Some(_) => {}
        }
    }
    let fits = |claim: &&Claim| {
        claim.first_level() <= level
            && (matchers.is_empty() || matchers.iter().any(|m| m.matches(claim.id())))
    };
    Ok(all.iter().filter(fits).collect())
}

/// The three names most like the pattern.
fn nearest(all: &[Claim], pattern: &str) -> String {
    let mut names: Vec<(f64, &str)> =
        all.iter().map(|claim| (strsim::jaro_winkler(pattern, claim.id()), claim.id())).collect();
    names.sort_by(|a, b| b.0.total_cmp(&a.0));
    names.iter().take(3).map(|(_, id)| *id).collect::<Vec<_>>().join(", ")
}

/// Runs the claims, longest first where an earlier report knows, and reports in the order of the list.
fn run_claims(args: &Args, chosen: Vec<&Claim>, threads: usize) -> Result<Report, CliError> {
    let known = known_seconds(&args.report);
    let seconds_of = |claim: &Claim| known.get(claim.id()).copied().unwrap_or(f64::INFINITY);
    let mut order: Vec<usize> = (0..chosen.len()).collect();
    order.sort_by(|&a, &b| seconds_of(chosen[b]).total_cmp(&seconds_of(chosen[a])));
    let by_length: Vec<&Claim> = order.iter().map(|&i| chosen[i]).collect();

    let bar = progress_bar(chosen.len());
    let start = Instant::now();
    let settings = Settings { seed: args.seed, level: args.level.0, threads };
    let results = runner::run(&by_length, settings, |claim| {
        bar.set_message(String::from(claim.id()));
        bar.inc(1);
    });
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();

    let mut results: Vec<_> = order.into_iter().zip(results).collect();
    results.sort_by_key(|(place, _)| *place);
    let (mut claims, mut errors) = (Vec::new(), Vec::new());
    for (_, result) in results {
        match result {
            Ok(outcome) => claims.push(ClaimReport::of(&outcome)),
            Err(error) => errors.push(error),
        }
    }
    Ok(Report {
        schema: report::SCHEMA,
        lightproof: String::from(env!("CARGO_PKG_VERSION")),
        seed: args.seed,
        level: String::from(args.level.0.name()),
        seconds,
        machine: report::machine(),
        claims,
        errors,
        gallery: gallery::take(),
        stability: stability(&chosen)?,
        calibration: calibration(&args.report)?,
    })
}

/// What stability costs, if one of the chosen claims is about it.
fn stability(chosen: &[&Claim]) -> Result<Vec<StabilityRow>, CliError> {
    if !chosen.iter().any(|claim| claim.id().starts_with("stable/")) {
        return Ok(Vec::new());
    }
    claims::stability_table().map_err(CliError::Stability)
}

/// Error rates of the tests: the committed long form, and the short form where the tests have left it beside the page.
fn calibration(report: &Path) -> Result<Vec<Calibration>, CliError> {
    let folders = [claims::references().join("calibration"), report.join("calibration")];
    let read = |folder: &PathBuf| {
        report::calibration::read(folder)
            .map_err(|(path, message)| CliError::Sidecar { path: PathBuf::from(path), message })
    };
    Ok(folders.iter().map(read).collect::<Result<Vec<_>, _>>()?.concat())
}

/// Seconds that claims took in the report that is about to be replaced; nothing where there is none that can be read.
fn known_seconds(folder: &Path) -> HashMap<String, f64> {
    let Ok(report) = Report::read(&folder.join("report.json")) else { return HashMap::new() };
    report.claims.into_iter().map(|claim| (claim.id, claim.seconds)).collect()
}

/// A bar on standard error; indicatif draws none where that is not a terminal.
fn progress_bar(claims: usize) -> ProgressBar {
    let bar = ProgressBar::new(u64::try_from(claims).unwrap_or(u64::MAX));
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}");
    bar.set_style(style.expect("the template names indicatif's own fields"));
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Writes data and page; returns the page's path.
fn write_report(args: &Args, report: &Report) -> Result<PathBuf, CliError> {
    let json = report.to_json()?;
    write_file(&args.report.join("report.json"), json.as_bytes())?;
    match args.json.as_deref() {
        Some(path) if is_stdout(path) => writeln!(stdout(), "{json}")?,
        Some(path) => write_file(path, json.as_bytes())?,
        None => {}
    }
    let index = args.report.join("index.html");
    write_file(&index, page::html(report).as_bytes())?;
    Ok(index)
}
