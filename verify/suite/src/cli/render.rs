//! `lightproof render`: a scene file becomes an image with its errors.

use std::io::{IsTerminal, Write, stderr};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::PossibleValuesParser;
use indicatif::{ProgressBar, ProgressStyle};
use renderer::film::{Part, Reconstruction};
use renderer::integrator::reuse::MATES;
use renderer::integrator::{Integrator, PathTracer};
use renderer::io;
use renderer::io::part::Origin;
use renderer::render::{self, Progress, RenderSettings, light_image, pilot};
use renderer::sampling::SamplerKind;
use renderer::scene::{Branch, Effect, IntegratorSettings, Scene, SceneDescription};

mod checkpoint;

use super::image_file::Kind;
use super::{CliError, Status};
use checkpoint::Checkpoint;

const EXAMPLES: &str = "Examples:
  lightproof render references/scenes/cornell.xml
  lightproof render scene.xml -o preview.png --spp 16 -D res=128
  lightproof render glass.xml --integrator distribution --branch both --replicates 32
  lightproof render scene.xml --spp 64 --allocate          most samples where the image is most uncertain
  lightproof render scene.xml --spp 64 --allocate --reuse  and light between surfaces shared by neighbours
  lightproof render glass.xml --spp 64 --light-paths       caustics found by paths from the lights, too
  lightproof render scene.xml --spp 4096 --resume          go on where a run was cut off
  lightproof render scene.xml --spp 64 --samples 0..8 -o first.part

A run keeps a checkpoint beside its output, from the tenth second until it is done (--checkpoint). Samples are counted in each
replicate: of --spp 64 in 4 replicates, each has 0..16; parts of them are joined by `merge`, to the same bits.
An .exr file holds R G B, their standard errors (stderr.R stderr.G stderr.B) and the number of samples, and says how
it was made; a .png is for looking at. The result is the same for any number of threads.";

/// Render a scene file in Mitsuba's XML format
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The scene
    scene: PathBuf,
    /// The image, .exr or .png, or samples to be merged, .part [default: the scene's name with .exr, or .part with --samples]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Samples per pixel [default: the scene's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Independent parts that the samples are divided into; errors come from their spread
    #[arg(long, value_name = "R", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    replicates: u32,
    /// Where numbers come from [default: the scene's]
    #[arg(long, value_parser = PossibleValuesParser::new(SamplerKind::ALL.map(SamplerKind::name)))]
    sampler: Option<String>,
    /// Which light paths are followed [default: the scene's]
    #[arg(long, value_parser = ["path", "direct", "distribution"])]
    integrator: Option<String>,
    /// What is done at glass: follow both branches, one with probability a half, or one by its share
    #[arg(long, value_parser = PossibleValuesParser::new(Branch::ALL.map(|(name, _)| name)))]
    branch: Option<String>,
    /// Leaves an effect out; may be repeated
    #[arg(long, value_name = "EFFECT", value_parser = PossibleValuesParser::new(Effect::ALL.map(|(name, _)| name)))]
    without: Vec<String>,
    /// The mean of signed weights (importance) or the weighted average of the pixel filter
    #[arg(long, value_parser = PossibleValuesParser::new(Reconstruction::ALL.map(Reconstruction::name)), default_value = "importance")]
    reconstruction: String,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Only these samples of each replicate, written as a .part for `merge`
    #[arg(long, value_name = "A..B", value_parser = range)]
    samples: Option<Range<u32>>,
    /// Gives pixels samples in proportion to their error, as a quarter of them, taken first, finds it; --spp is their mean
    #[arg(long, conflicts_with = "samples")]
    allocate: bool,
    /// Lets samples of neighbouring pixels share what their paths find; neighbours then have errors in common
    #[arg(long)]
    reuse: bool,
    /// Lets paths from lights, too, look for what reaches diffuse surfaces by way of glass and metal (caustics)
    #[arg(long, conflicts_with = "samples")]
    light_paths: bool,
    /// Goes on from the checkpoint of a run of the same scene and options that was cut off, if there is one
    #[arg(long)]
    resume: bool,
    /// Seconds from one checkpoint to the next
    #[arg(long, value_name = "SECS", default_value_t = 10.0, value_parser = seconds)]
    checkpoint: f64,
    /// Threads [default: one a core]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    threads: usize,
    /// Gives $NAME in the scene another value; may be repeated
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = definition)]
    define: Vec<(String, String)>,
}

pub(super) fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.into(), value.into())),
        _ => Err("NAME=VALUE is accepted".into()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|seconds| (0.0..=1e9).contains(seconds));
    number.ok_or_else(|| "0 to 1e9 is accepted".into())
}

fn range(text: &str) -> Result<Range<u32>, String> {
    let both = text.split_once("..").and_then(|(a, b)| Some(a.parse().ok()?..b.parse().ok()?));
    both.filter(|range: &Range<u32>| !range.is_empty())
        .ok_or_else(|| "A..B with A below B is accepted, as in 0..8".into())
}

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let ending = if args.samples.is_some() { "part" } else { "exr" };
    let output = args.output.clone().unwrap_or_else(|| args.scene.with_extension(ending));
    let kind = Kind::of(&output)?;
    if args.samples.is_some() && kind != Kind::Part {
        return Err(CliError::Kind { path: output, accepted: "with --samples, .part" });
    }
    let (mut description, notes) = io::mitsuba::read_scene(&args.scene, &args.define)?;
    for note in notes {
        writeln!(stderr(), "note: {note}")?;
    }
    apply(args, &mut description)?;
    let settings = settings(args, &description);
    let part = empty_part(args, &description, &settings)?;
    let how = format!("{:?} {:?} {:?}", description.integrator, description.film, args.without);
    let scene = Scene::new(&description)?;
    let integrator = PathTracer { settings: description.integrator };
    if args.reuse && !integrator.reuses(&scene) {
        return Err(CliError::Arguments(
            "--reuse: samples of different moments can't share paths; a scene without shutter is accepted, as by --without shutter".into(),
        ));
    }
    if args.light_paths && scene.emission.is_none() {
        return Err(CliError::Arguments(
            "--light-paths: a scene with a perspective camera, a shape that emits and isn't hidden (hide_emitters), and a surface that isn't diffuse is accepted".into(),
        ));
    }
    let origin = Origin {
        shared_by: shared_by(&scene, &integrator),
        ..Origin::new(description.hash, &settings, &how, description.film.reconstruction)
    };
    let checkpoint = Checkpoint::beside(&output, origin.clone(), Duration::from_secs_f64(args.checkpoint));
    let bar = progress_bar();
    let start = std::time::Instant::now();
    let found = if args.resume { checkpoint.resume(&part, args.allocate)? } else { None };
    let watch = |progress: Progress| match progress {
        Progress::Pilot(share) => show(&bar, share, Some("first samples")),
        Progress::LightPaths(share) => show(&bar, share, Some("paths from lights")),
        Progress::Image(part) => {
            show(&bar, part.share(), None);
            checkpoint.watch(part, &bar);
        }
    };
    let part = match found {
        Some(found) => found,
        None if args.allocate => pilot::allocated(&scene, &integrator, &settings, &watch)?,
        None => part,
    };
    let part = render::go_on(&scene, &integrator, &settings, part, &watch)?;
    bar.finish_and_clear();
    kind.write(&output, &origin, &part, start.elapsed())?;
    checkpoint.remove()?;
    Ok(Status::Good)
}

/// By how many pixels errors are shared: those whose paths are, or those that a path from a light reaches.
fn shared_by(scene: &Scene, integrator: &PathTracer) -> u32 {
    let mates = if integrator.reuses(scene) { MATES } else { 1 };
    let reached = if scene.emission.is_some() { scene.film.filter.pixels() } else { 1 };
    mates.max(reached)
}

fn settings(args: &Args, description: &SceneDescription) -> RenderSettings {
    let [samples, replicates] = RenderSettings::split(description.sampler.spp, args.replicates);
    RenderSettings {
        sampler: description.sampler.kind,
        samples,
        replicates,
        seed: args.seed,
        threads: args.threads,
    }
}

/// The samples asked for, none of them taken yet; refused where they don't fit into the memory.
fn empty_part(
    args: &Args,
    description: &SceneDescription,
    settings: &RenderSettings,
) -> Result<Part, CliError> {
    let range = args.samples.clone().unwrap_or(0..settings.samples);
    if range.end > settings.samples {
        return Err(CliError::Arguments(format!(
            "--samples {}..{}: each of {} replicates has {} samples; a range in 0..{} is accepted",
            range.start, range.end, settings.replicates, settings.samples, settings.samples
        )));
    }
    let [width, height] = description.film.size();
    let part = Part::new([width, height], settings.replicates, [range.start, range.end]);
    let pixels = u64::from(width) * u64::from(height);
    let lights = if args.light_paths { light_image::BYTES * u64::from(settings.replicates) } else { 0 };
    let needed = part.bytes() + pixels * lights;
    match available_memory() {
        Some(available) if needed > available => Err(CliError::Arguments(format!(
            "a film of {width} × {height} pixels in {} replicates needs {:.1} GiB, and {:.1} GiB are free",
            settings.replicates,
            needed as f64 / f64::from(1 << 30),
            available as f64 / f64::from(1 << 30)
        ))),
        _ => Ok(part),
    }
}

/// Free memory in bytes, where the system says it.
fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib * 1024)
}

/// Puts the options in the place of what the scene says.
fn apply(args: &Args, description: &mut SceneDescription) -> Result<(), CliError> {
    let named = |name: &str| SamplerKind::ALL.into_iter().find(|k| k.name() == name);
    if let Some(kind) = args.sampler.as_deref().and_then(named) {
        description.sampler.kind = kind;
    }
    description.sampler.spp = args.spp.unwrap_or(description.sampler.spp);
    let integrator = &mut description.integrator;
    integrator.reuse = args.reuse;
    integrator.light_paths = args.light_paths;
    match args.integrator.as_deref() {
        Some("direct") => integrator.max_depth = Some(2),
        Some("distribution") => integrator.branch = Branch::Both,
        Some(_) => integrator.branch = IntegratorSettings::PATH.branch,
        None => {}
    }
    let branch = args.branch.as_deref().and_then(|name| Branch::ALL.into_iter().find(|(n, _)| *n == name));
    integrator.branch = branch.map_or(integrator.branch, |(_, branch)| branch);
    description.film.reconstruction = Reconstruction::named(&args.reconstruction).unwrap_or_default();
    let left_out = Effect::ALL.into_iter().filter(|(name, _)| args.without.iter().any(|w| w == name));
    for (_, effect) in left_out {
        description.leave_out(effect)?;
    }
    Ok(())
}

/// Shows the share of what is being done that is finished, and what that is if it isn't the image itself.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 1000 steps")]
fn show(bar: &ProgressBar, share: f64, what: Option<&'static str>) {
    let position = (share * 1000.0) as u64;
    if position < bar.position() {
        // Something else has begun, at a speed of its own.
        bar.reset_eta();
        bar.set_message("");
    }
    bar.set_position(position);
    if let Some(what) = what {
        bar.set_message(what);
    }
}

fn progress_bar() -> ProgressBar {
    if !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of {duration}  {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1000).with_style(style)
}
