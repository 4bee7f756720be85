//! `lightproof compare`: are two images noisy renderings of the same thing?

use std::io::{Write, stdout};
use std::path::PathBuf;

use serde::Serialize;
use verify::claim::Verdict;
use verify::image::{self, Comparison};

use super::output::{Words, is_stdout};
use super::{CliError, Status, write_file};
use crate::figures::{probability, three};
use crate::report::Number;
use crate::side::Side;

mod heatmap;

const EXAMPLES: &str = "Errors come from the files' stderr channels, from the tile sums of every seed in a JSON file of the image's name
beside it, or from several files a side, each with another seed. Other programs may have added samples up in f32: up to 0.012 % of a
sum counts as rounding.

Examples:
  lightproof compare ours.exr theirs.exr --max-bias 0.5
  lightproof compare ours-*.exr -- scenes/penumbra.exr --max-bias 0.2      an exact image of lightproof analytic
  lightproof compare --json - --heatmap difference.png a1.exr a2.exr a3.exr -- b1.exr b2.exr b3.exr

Status: 0 the same within the bound; 1 different, or the errors are too large or unknown; 2 it could not run.";

/// Compare two images with their errors
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Image A and image B; or all files of A, if those of B follow `--`
    #[arg(required = true, value_name = "A.exr B.exr")]
    files: Vec<PathBuf>,
    /// Files of B, one a seed
    #[arg(last = true, value_name = "B.exr")]
    others: Vec<PathBuf>,
    /// Largest difference of the means, |mean A − mean B| / mean B in percent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.5)]
    max_bias: f64,
    /// Write the result to this file; `-` is standard output (the words go to standard error)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a picture: left the pixels' differences (±20 % of the mean), right those of tiles (±4 standard errors)
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let (a, b) = sides(args)?;
    let (a, b) = (Side::read(a)?, Side::read(b)?);
    let comparison = image::compare(&a.image, &b.image, args.max_bias)
        .map_err(|reason| CliError::Test { subject: String::from("compare"), reason })?;
    let mut words = Words::beside(args.json.as_deref());
    describe(&mut words, &comparison)?;
    for (name, _) in [("A", &a), ("B", &b)].iter().filter(|(_, side)| side.exact) {
        writeln!(words, "  {name} is exact: its standard errors are 0")?;
    }
    words.flush()?;
    if let Some(path) = &args.json {
        let json = serde_json::to_string(&Json::of(&comparison))?;
        if is_stdout(path) { writeln!(stdout(), "{json}")? } else { write_file(path, json.as_bytes())? }
    }
    if let Some(path) = &args.heatmap {
        write_file(path, &heatmap::png(&a, &b, &comparison.tiles.scores))?;
    }
    Ok(if comparison.verdict == Verdict::Holds { Status::Good } else { Status::Bad })
}

/// The files of either side.
fn sides(args: &Args) -> Result<(&[PathBuf], &[PathBuf]), CliError> {
    match (args.files.as_slice(), args.others.as_slice()) {
        ([a, b], []) => Ok((std::slice::from_ref(a), std::slice::from_ref(b))),
        (files, []) => Err(CliError::Arguments(format!(
            "compare takes two images, or several a side as A… -- B…; {} given without --",
            files.len()
        ))),
        (files, others) => Ok((files, others)),
    }
}

fn describe(words: &mut Words, comparison: &Comparison) -> std::io::Result<()> {
    let Comparison { verdict, bias_percent, interval, bound, pooled, tiles, pixels, .. } = comparison;
    let colour = if *verdict == Verdict::Holds { 32 } else { 31 };
    let known = |value: f64| three(value.is_finite().then_some(value));
    let verdict = words.painted(&verdict.to_string(), colour);
    writeln!(
        words,
        "{verdict}: bias {} % in [{}, {}] %, bound {bound} %",
        known(*bias_percent),
        known(interval[0]),
        known(interval[1])
    )?;
    if !comparison.error_known {
        return writeln!(words, "  errors are unknown on at least one side: no verdict rests on this");
    }
    let p = |value: f64| probability(value.is_finite().then_some(value));
    writeln!(
        words,
        "  means     {} and {}, p {}; would have found a bias of {} %",
        known(pooled.mean_a),
        known(pooled.mean_b),
        p(pooled.p_value),
        known(pooled.resolution_percent)
    )?;
    writeln!(
        words,
        "  {} tiles  worst is number {}, p {}; chi-square of the {} {}, p {}",
        tiles.count,
        tiles.worst,
        probability(tiles.worst_p_value),
        if tiles.worst_p_value.is_some() { "others" } else { "contrasts" },
        known(tiles.chi_square),
        probability(tiles.chi_square_p_value)
    )?;
    writeln!(
        words,
        "  {} pixels  {} beyond their errors, {} expected",
        pixels.count,
        pixels.beyond,
        known(pixels.expected)
    )?;
    comparison.evidence.doubts.iter().try_for_each(|doubt| writeln!(words, "  doubt: {doubt}"))
}

/// The result as data; `null` stands for what is not known.
#[derive(Serialize)]
struct Json {
    schema: u32,
    verdict: String,
    bias_percent: Number,
    interval: [Number; 2],
    bound: f64,
    p_value: Number,
    pooled: PooledJson,
    tiles: TilesJson,
    pixels: PixelsJson,
    error_known: bool,
    doubts: Vec<String>,
}

#[derive(Serialize)]
struct PooledJson {
    mean_a: f64,
    mean_b: f64,
    standard_error: Number,
    t: Number,
    dof: Number,
    p_value: Number,
    channel_p_value: Number,
    resolution_percent: Number,
}

#[derive(Serialize)]
struct TilesJson {
    count: usize,
    worst: usize,
    worst_p_value: Number,
    chi_square: Number,
    chi_square_p_value: Number,
}

#[derive(Serialize)]
struct PixelsJson {
    count: usize,
    beyond: u64,
    expected: Number,
    p_value: Number,
}

impl Json {
    fn of(comparison: &Comparison) -> Self {
        let known = |value: f64| value.is_finite().then_some(value);
        let Comparison { pooled, tiles, pixels, .. } = comparison;
        Self {
            schema: 1,
            verdict: comparison.verdict.to_string(),
            bias_percent: known(comparison.bias_percent),
            interval: comparison.interval.map(known),
            bound: comparison.bound,
            p_value: known(comparison.evidence.p_value),
            pooled: PooledJson {
                mean_a: pooled.mean_a,
                mean_b: pooled.mean_b,
                standard_error: known(pooled.standard_error),
                t: known(pooled.t),
                dof: known(pooled.dof),
                p_value: known(pooled.p_value),
                channel_p_value: known(pooled.channel_p_value),
                resolution_percent: known(pooled.resolution_percent),
            },
            tiles: TilesJson {
                count: tiles.count,
                worst: tiles.worst,
                worst_p_value: tiles.worst_p_value.and_then(known),
                chi_square: known(tiles.chi_square),
                chi_square_p_value: tiles.chi_square_p_value.and_then(known),
            },
            pixels: PixelsJson {
                count: pixels.count,
                beyond: pixels.beyond,
                expected: known(pixels.expected),
                p_value: known(pixels.p_value),
            },
            error_known: comparison.error_known,
            doubts: comparison.evidence.doubts.clone(),
        }
    }
}
