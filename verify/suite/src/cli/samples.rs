//! `lightproof samples`: do points that any program wrote follow a density on a domain?

use std::io::{Write, stdout};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde::Serialize;
use verify::claim::{Evidence, Verdict};
use verify::independence::Source;
use verify::picture;

use super::output::{Words, is_stdout};
use super::{CliError, Status, write_file};
use crate::figures::{count, probability, three};
use crate::report::{Number, PictureData, Resolves};
use domain::Spec;
use file::{Points, refused};
use subject::{Atom, Pdf};

mod csv;
mod domain;
pub mod file;
mod npy;
mod subject;

const EXAMPLES: &str = "Points are rows of .npy arrays (float32 or float64), lines of .csv files, or raw little-endian numbers. They are read
piece by piece, whatever their number. P and V are points and vectors as X/Y or X/Y/Z; directions are unit vectors.

Examples:
  lightproof samples lens.npy --domain disk:r=0.3
  lightproof samples lobe.csv --domain hemisphere --pdf cosine --heatmap lobe.svg
  lightproof samples sampler.f32 --dtype f32 --domain cube:d=6 --json -
  lightproof samples glass.npy --domain sphere --pdf lobes.npy --atom 0/0/1=0.04

Status: 0 the points follow the density within the bound; 1 they do not, or are too few to tell; 2 it could not run.";

/// Test points that any program wrote
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The points: .npy, .csv, or raw numbers with --dtype
    file: PathBuf,
    #[doc = "Where the points lie: interval[:a=0,b=1], square, rectangle:low=X/Y,high=X/Y, cube:d=N, disk[:r=1], triangle:a=P,b=P,c=P, \
parallelogram:o=P,a=V,b=V, sphere, hemisphere, cone:angle=RADIANS, spherical-triangle:a=V,b=V,c=V, spherical-rectangle:corner=V,a=V,b=V"]
    #[arg(long, value_name = "DOMAIN")]
    domain: String,
    /// Density per unit of the domain's length, area or solid angle: uniform, cosine (cos θ/π), or a .npy table of its values on a
    /// regular grid over the domain's coordinates, (rows, columns)
    #[arg(long, value_name = "PDF", default_value = "uniform")]
    pdf: String,
    /// A point that has a probability of its own, such as a mirror's direction; may be repeated
    #[arg(long, value_name = "P=PROBABILITY")]
    atom: Vec<String>,
    /// How a raw file stores its numbers
    #[arg(long, value_enum)]
    dtype: Option<Dtype>,
    /// Largest RMS relative error over cells, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0)]
    bound: f64,
    /// What the program declares of its points; those of a low-discrepancy sequence are too even to be tested so, and are refused
    #[arg(long, value_enum, default_value_t = Declared::Independent)]
    source: Declared,
    /// Write the result to this file; `-` is standard output (the words go to standard error)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw observed and expected counts, residuals and the worst cells [default: only if the points fail, beside the page]
    #[arg(long, value_name = "FILE.svg")]
    heatmap: Option<PathBuf>,
}

/// Raw numbers, little-endian.
#[derive(Clone, Copy, ValueEnum)]
enum Dtype {
    F32,
    F64,
}

/// What a source says of its points.
#[derive(Clone, Copy, ValueEnum)]
enum Declared {
    Independent,
    LowDiscrepancy,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let tested = |reason| CliError::Test { subject: args.file.display().to_string(), reason };
    let declared = match args.source {
        Declared::Independent => Source::Independent,
        Declared::LowDiscrepancy => Source::LowDiscrepancy,
    };
    declared.independent("samples").map_err(tested)?;
    let evidence = test(args)?.map_err(tested)?;
    let verdict = evidence.verdict_of_single_run();
    let command = command(args);
    let mut words = Words::beside(args.json.as_deref());
    describe(&mut words, args, &evidence)?;
    if let Some(path) = picture_path(args, verdict) {
        let title = format!("{} on {} {verdict}", args.file.display(), args.domain);
        let drawn = picture::svg(&title, &command, &evidence).unwrap_or_default();
        write_file(&path, drawn.as_bytes())?;
        writeln!(words, "  picture: {}", path.display())?;
    }
    if verdict != Verdict::Holds {
        writeln!(words, "  repeat with: {command}")?;
    }
    words.flush()?;
    if let Some(path) = &args.json {
        let json = serde_json::to_string(&Json::of(args, &evidence, command))?;
        if is_stdout(path) { writeln!(stdout(), "{json}")? } else { write_file(path, json.as_bytes())? }
    }
    Ok(if verdict == Verdict::Holds { Status::Good } else { Status::Bad })
}

/// Reads and counts the points, and tests the counts.
fn test(args: &Args) -> Result<Result<Evidence, verify::error::InputError>, CliError> {
    let wrong = |message: String| CliError::Arguments(format!("--domain: {message}"));
    let spec = Spec::parse(&args.domain).map_err(wrong)?;
    let dimensions = spec.dimensions().map_err(wrong)?;
    let atoms = args.atom.iter().map(|text| atom(text)).collect::<Result<Vec<_>, _>>()?;
    let mut subject = spec.subject(&pdf(&args.pdf)?, &atoms).map_err(wrong)?;
    let number =
        args.dtype.map(|dtype| file::Number { double: matches!(dtype, Dtype::F64), big_endian: false });
    let mut points = Points::open(&args.file, dimensions, number)?;
    let mut values = Vec::new();
    while points.next(&mut values)? {
        subject.add(&values);
    }
    Ok(subject.judge(0.01 * args.bound))
}

fn pdf(text: &str) -> Result<Pdf, CliError> {
    match text {
        "uniform" => return Ok(Pdf::Uniform),
        "cosine" => return Ok(Pdf::Cosine),
        _ => {}
    }
    let path = Path::new(text);
    if path.extension().is_none_or(|ending| ending != "npy") {
        let message = format!("--pdf {text}; uniform, cosine or a .npy file is accepted");
        return Err(CliError::Arguments(message));
    }
    let shape = std::fs::File::open(path)
        .map_err(|source| CliError::Io { path: path.to_owned(), source })
        .and_then(|mut file| {
            npy::header(&mut file)
                .and_then(|header| header.table())
                .map_err(|message| refused(path, &message))
        })?;
    // Its rows are points of as many coordinates as it has columns; a list has one.
    let dimensions = if shape[1] == 1 { 1 } else { shape[0] };
    let (mut all, mut values) = (Vec::new(), Vec::new());
    let mut rows = Points::open(path, dimensions.max(1), None)?;
    while rows.next(&mut values)? {
        all.append(&mut values);
    }
    Ok(Pdf::Cells(shape, all))
}

fn atom(text: &str) -> Result<Atom, CliError> {
    let wrong = |message: String| CliError::Arguments(format!("--atom {text}: {message}"));
    let (place, probability) =
        text.split_once('=').ok_or_else(|| wrong(String::from("P=PROBABILITY is accepted")))?;
    let place = domain::numbers(place).map_err(wrong)?;
    match domain::numbers(probability).map_err(wrong)?.as_slice() {
        [probability @ 0.0..=1.0] => Ok(Atom { place, probability: *probability }),
        _ => Err(wrong(String::from("a probability from 0 to 1 is accepted"))),
    }
}

/// Where to draw: where asked for, and for points that fail in the folder of the page.
fn picture_path(args: &Args, verdict: Verdict) -> Option<PathBuf> {
    let name = args.file.file_stem().unwrap_or_default();
    let beside_page = || Path::new("target/lightproof").join(name).with_extension("svg");
    args.heatmap.clone().or_else(|| (verdict == Verdict::Fails).then(beside_page))
}

/// The command as it was given.
fn command(args: &Args) -> String {
    let quoted = |text: &str| {
        let plain = |c: char| c.is_alphanumeric() || "-_./:=,".contains(c);
        if text.chars().all(plain) {
            String::from(text)
        } else {
            format!("'{}'", text.replace('\'', "'\\''"))
        }
    };
    let mut words = vec![quoted(&args.file.to_string_lossy()), format!("--domain {}", quoted(&args.domain))];
    if args.pdf != "uniform" {
        words.push(format!("--pdf {}", quoted(&args.pdf)));
    }
    words.extend(args.atom.iter().map(|atom| format!("--atom {}", quoted(atom))));
    if let Some(dtype) = args.dtype {
        words.push(format!("--dtype {}", if matches!(dtype, Dtype::F64) { "f64" } else { "f32" }));
    }
    format!("lightproof samples {} --bound {}", words.join(" "), args.bound)
}

fn describe(words: &mut Words, args: &Args, evidence: &Evidence) -> std::io::Result<()> {
    let verdict = evidence.verdict_of_single_run();
    let colour = if verdict == Verdict::Holds { 32 } else { 31 };
    let known = |value: f64| three(value.is_finite().then_some(value));
    let painted = words.painted(&verdict.to_string(), colour);
    let [low, high] = evidence.interval;
    writeln!(
        words,
        "{painted}: {} points on {}, p {}",
        count(evidence.n),
        args.domain,
        probability(Some(evidence.p_value))
    )?;
    writeln!(words, "  {}", evidence.method)?;
    writeln!(
        words,
        "  {}: {} % in [{}, {}] %, bound {} %; would have found {} %",
        evidence.resolution.quantity,
        known(100.0 * evidence.estimate),
        known(100.0 * low),
        known(100.0 * high),
        known(args.bound),
        known(100.0 * evidence.resolution.value)
    )?;
    evidence.doubts.iter().try_for_each(|doubt| writeln!(words, "  doubt: {doubt}"))?;
    if verdict == Verdict::Holds {
        return Ok(());
    }
    for worst in evidence.pictures.iter().flat_map(|picture| picture::worst_cells(picture, 3)) {
        let [column, row] = worst.cell;
        writeln!(
            words,
            "  column {column}, row {row}: observed {}, expected {:.1}, residual {:+.2} σ",
            worst.observed, worst.expected, worst.deviations
        )?;
    }
    Ok(())
}

/// The result as data; `null` stands for what is not known.
#[derive(Serialize)]
struct Json {
    schema: u32,
    file: String,
    domain: String,
    verdict: String,
    method: String,
    n: u64,
    statistic: Number,
    dof: Number,
    p_value: Number,
    estimate: Number,
    interval: [Number; 2],
    bound: f64,
    resolves: Resolves,
    doubts: Vec<String>,
    pictures: Vec<PictureData>,
    command: String,
}

impl Json {
    fn of(args: &Args, evidence: &Evidence, command: String) -> Self {
        let known = |value: f64| value.is_finite().then_some(value);
        let resolution = &evidence.resolution;
        Self {
            schema: crate::report::SCHEMA,
            file: args.file.display().to_string(),
            domain: args.domain.clone(),
            verdict: evidence.verdict_of_single_run().to_string(),
            method: evidence.method.clone(),
            n: evidence.n,
            statistic: known(evidence.statistic),
            dof: evidence.dof,
            p_value: known(evidence.p_value),
            estimate: known(evidence.estimate),
            interval: evidence.interval.map(known),
            bound: evidence.bound,
            resolves: Resolves {
                quantity: String::from(resolution.quantity),
                value: known(resolution.value),
                power: known(resolution.power),
            },
            doubts: evidence.doubts.clone(),
            pictures: evidence.pictures.iter().map(PictureData::of).collect(),
            command,
        }
    }
}
