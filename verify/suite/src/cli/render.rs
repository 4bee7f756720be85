//! `lightproof render`: a scene file becomes an image with its errors.

use std::io::{IsTerminal, Write, stderr};
use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use indicatif::{ProgressBar, ProgressStyle};
use renderer::film::Reconstruction;
use renderer::integrator::PathTracer;
use renderer::io::{self, Provenance};
use renderer::render::{self, RenderSettings, Rendering};
use renderer::sampling::SamplerKind;
use renderer::scene::{Branch, Effect, IntegratorSettings, Scene, SceneDescription};

use super::{CliError, Status};

const EXAMPLES: &str = "Examples:
  lightproof render references/scenes/cornell.xml
  lightproof render scene.xml -o preview.png --spp 16 -D res=128
  lightproof render glass.xml --integrator distribution --branch both --replicates 32

An .exr file holds R G B, their standard errors (stderr.R stderr.G stderr.B) and the number of samples, and says how
it was made; a .png is for looking at. The result is the same for any number of threads.";

/// Render a scene file in Mitsuba's XML format
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The scene
    scene: PathBuf,
    /// The image, .exr or .png [default: the scene's name with .exr]
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
    #[arg(long, value_parser = ["importance", "weighted"], default_value = "importance")]
    reconstruction: String,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
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

/// Runs the command.
pub(super) fn run(args: &Args) -> Result<Status, CliError> {
    let output = args.output.clone().unwrap_or_else(|| args.scene.with_extension("exr"));
    let encode = encoder(&output)?;
    let (mut description, notes) = io::mitsuba::read_scene(&args.scene, &args.define)?;
    for note in notes {
        writeln!(stderr(), "note: {note}")?;
    }
    apply(args, &mut description)?;
    let [samples, replicates] = RenderSettings::split(description.sampler.spp, args.replicates);
    let settings = RenderSettings {
        sampler: description.sampler.kind,
        samples,
        replicates,
        seed: args.seed,
        threads: args.threads,
    };
    let scene = Scene::new(&description)?;
    let integrator = PathTracer { settings: description.integrator };
    let bar = progress_bar();
    let start = std::time::Instant::now();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 1000 steps")]
    let progress = |share: f64| bar.set_position((share * 1000.0) as u64);
    let rendering = render::render(&scene, &integrator, &settings, &progress)?;
    bar.finish_and_clear();
    encode(
        &output,
        &io::rendering::image(&rendering, Provenance::of(description.hash, &settings, &rendering)),
    )?;
    summarise(&rendering, &output, start.elapsed().as_secs_f64())?;
    Ok(Status::Good)
}

type Encode = fn(&Path, &io::Image) -> Result<(), renderer::Error>;

fn encoder(output: &Path) -> Result<Encode, CliError> {
    match output.extension().and_then(|e| e.to_str()) {
        Some("exr") => Ok(io::exr::write),
        Some("png") => Ok(|path, image| io::png::write(path, image, 0.0)),
        _ => Err(CliError::Kind { path: output.into(), accepted: ".exr or .png" }),
    }
}

/// Puts the options in the place of what the scene says.
fn apply(args: &Args, description: &mut SceneDescription) -> Result<(), CliError> {
    let named = |name: &str| SamplerKind::ALL.into_iter().find(|k| k.name() == name);
    if let Some(kind) = args.sampler.as_deref().and_then(named) {
        description.sampler.kind = kind;
    }
    description.sampler.spp = args.spp.unwrap_or(description.sampler.spp);
    let integrator = &mut description.integrator;
    match args.integrator.as_deref() {
        Some("direct") => integrator.max_depth = Some(2),
        Some("distribution") => integrator.branch = Branch::Both,
        Some(_) => integrator.branch = IntegratorSettings::PATH.branch,
        None => {}
    }
    let branch = args.branch.as_deref().and_then(|name| Branch::ALL.into_iter().find(|(n, _)| *n == name));
    integrator.branch = branch.map_or(integrator.branch, |(_, branch)| branch);
    if args.reconstruction == "weighted" {
        description.film.reconstruction = Reconstruction::Weighted;
    }
    let left_out = Effect::ALL.into_iter().filter(|(name, _)| args.without.iter().any(|w| w == name));
    for (_, effect) in left_out {
        description.leave_out(effect)?;
    }
    Ok(())
}

fn progress_bar() -> ProgressBar {
    if !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} of {duration}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1000).with_style(style)
}

fn summarise(rendering: &Rendering, output: &Path, seconds: f64) -> Result<(), CliError> {
    let (mut sum, mut variance, mut known) = (0.0, 0.0, true);
    for pixel in &rendering.pixels {
        sum += pixel.mean.iter().sum::<f64>();
        known &= pixel.standard_error.is_some();
        variance += pixel.standard_error.map_or(0.0, |e| e.iter().map(|e| e * e).sum());
    }
    let count = 3.0 * rendering.pixels.len() as f64;
    let error =
        if known { format!(" ± {:.2e}", f64::sqrt(variance) / count) } else { ", error unknown".into() };
    let mut err = stderr();
    writeln!(err, "{}: mean {:.6}{error}, {seconds:.1} s", output.display(), sum / count)?;
    if rendering.dropped > 0 {
        writeln!(err, "note: {} contributions were not finite and are left out", rendering.dropped)?;
    }
    Ok(())
}
