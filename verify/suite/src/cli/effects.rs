//! `lightproof effects`: what a scene calls for, and what each effect costs in time and in variance.

use std::hint::black_box;
use std::io::{Write, stderr, stdout};
use std::path::PathBuf;
use std::time::Instant;

use renderer::integrator::PathTracer;
use renderer::io;
use renderer::render::{RenderSettings, render};
use renderer::sampling::SamplerKind;
use renderer::scene::{Effect, Scene, SceneDescription};
use serde::Serialize;

use super::output::{Words, is_stdout};
use super::render::definition;
use super::{CliError, Status, write_file};
use crate::shares::{REPLICATES, Share, variance_shares};

const EXAMPLES: &str = "Example:
  lightproof effects references/scenes/thin-lens.xml

time is the share of the rendering time that goes when the effect is left out (negative: the scene without it takes
longer), the median of 5 rounds with their range. variance is the share of a pixel's variance that takes part in the
decisions made for the effect: half the mean squared change when they are drawn anew and the rest is kept, with 95 %
limits. Effects that act together share variance, so that the column may add up to more than 100 %.";

/// Say which effects a scene calls for, and what each costs in time and variance
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The scene
    scene: PathBuf,
    /// Writes the result as data; - for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Samples in each of 32 replicates
    #[arg(long, value_name = "N", default_value_t = 2048, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Gives $NAME in the scene another value; may be repeated
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = definition)]
    define: Vec<(String, String)>,
}

/// Rounds in which all versions of a scene are timed, one after the other.
const ROUNDS: usize = 5;

/// Time that one render in a round should take, in seconds.
const ROUND: f64 = 0.1;

#[derive(Serialize)]
struct Data {
    schema: u32,
    scene: String,
    seed: u64,
    samples: u64,
    effects: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    effect: &'static str,
    time: Option<Limits>,
    variance: Option<Limits>,
}

#[derive(Serialize, Clone, Copy)]
struct Limits {
    share: f64,
    interval: [f64; 2],
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let (description, notes) = io::mitsuba::read_scene(&args.scene, &args.define)?;
    for note in notes {
        writeln!(stderr(), "note: {note}")?;
    }
    let scene = Scene::new(&description)?;
    let called: Vec<Effect> = scene.effects.iter().collect();
    let integrator = PathTracer { settings: scene.integrator };
    let redraws: Vec<_> = called.iter().map(|effect| effect.decisions()).collect();
    let variance = variance_shares(&scene, &integrator, &redraws, args.samples, args.seed);
    let times = time_shares(&scene, &description, &called)?;
    let row = |(k, &effect): (usize, &Effect)| Row {
        effect: effect.name(),
        time: times[k],
        variance: variance.as_ref().map(|shares| shares[k].into()),
    };
    let data = Data {
        schema: 1,
        scene: args.scene.display().to_string(),
        seed: args.seed,
        samples: REPLICATES * u64::from(args.samples),
        effects: called.iter().enumerate().map(row).collect(),
    };
    let mut words = Words::beside(args.json.as_deref());
    table(&mut words, &data)?;
    if let Some(path) = &args.json {
        let json = serde_json::to_string(&data)?;
        if is_stdout(path) { writeln!(stdout(), "{json}")? } else { write_file(path, json.as_bytes())? }
    }
    Ok(Status::Good)
}

impl From<Share> for Limits {
    fn from(share: Share) -> Self {
        Self { share: share.value, interval: share.interval }
    }
}

fn table(words: &mut Words, data: &Data) -> std::io::Result<()> {
    if data.effects.is_empty() {
        return writeln!(words, "the scene calls for no effect");
    }
    writeln!(words, "{:16}  {:>22}  {:>22}", "effect", "time", "variance")?;
    for row in &data.effects {
        writeln!(words, "{:16}  {:>22}  {:>22}", row.effect, percent(row.time), percent(row.variance))?;
    }
    Ok(())
}

fn percent(limits: Option<Limits>) -> String {
    limits.map_or_else(
        || "-".into(),
        |l| {
            let [low, high] = l.interval.map(|x| 100.0 * x);
            format!("{:.1} % ({low:.1} to {high:.1})", 100.0 * l.share)
        },
    )
}

/// One minus the time without each effect over the time with it; `None` where it cannot be left out.
fn time_shares(
    scene: &Scene,
    description: &SceneDescription,
    called: &[Effect],
) -> Result<Vec<Option<Limits>>, CliError> {
    let mut versions = Vec::new();
    for &effect in called {
        let mut without = description.clone();
        versions.push(match without.leave_out(effect) {
            Ok(()) => Some(Scene::new(&without)?),
            Err(_) => None,
        });
    }
    let first = seconds(scene, 1)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 1000")]
    let samples = (ROUND / first).clamp(1.0, 1000.0) as u32;
    let mut shares = vec![Vec::with_capacity(ROUNDS); versions.len()];
    for _ in 0..ROUNDS {
        let with = seconds(scene, samples)?;
        for (shares, version) in shares.iter_mut().zip(&versions) {
            if let Some(version) = version {
                shares.push(1.0 - seconds(version, samples)? / with);
            }
        }
    }
    Ok(shares.into_iter().map(median).collect())
}

fn seconds(scene: &Scene, samples: u32) -> Result<f64, CliError> {
    let settings =
        RenderSettings { sampler: SamplerKind::Sobol, samples, replicates: 1, seed: 0, threads: 0 };
    let start = Instant::now();
    black_box(render(scene, &PathTracer { settings: scene.integrator }, &settings, &|_| ())?);
    Ok(start.elapsed().as_secs_f64())
}

/// The median of an odd number of values, and their range.
fn median(mut values: Vec<f64>) -> Option<Limits> {
    values.sort_by(f64::total_cmp);
    let (&low, &high) = (values.first()?, values.last()?);
    Some(Limits { share: values[values.len() / 2], interval: [low, high] })
}
