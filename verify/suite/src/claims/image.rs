//! Images of the reference scenes against another renderer's.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use renderer::film::PixelEstimate;
use renderer::integrator::PathTracer;
use renderer::io::{mitsuba, png, rendering};
use renderer::render::{RenderSettings, Rendering, render};
use renderer::scene::Scene;
use verify::claim::{Claim, Level, Run, claim};
use verify::error::InputError;
use verify::image::{Image, compare};

use crate::bounds;
use crate::gallery;
use crate::report::Gallery;
use crate::setup::subject;
use crate::side::Side;

mod comparison;

/// Each scene with what it shows, the samples a pixel, the bound in percent that they settle, and the first level.
const SCENES: [(&str, &str, u32, f64, Level); 8] = [
    (
        "cornell",
        "the Cornell box: inter-reflection between diffuse surfaces",
        96,
        bounds::INTER_REFLECTION_PERCENT,
        Level::Quick,
    ),
    (
        "soft-shadow",
        "a square light over a square blocker: soft shadows",
        16,
        bounds::IMAGE_PERCENT,
        Level::Quick,
    ),
    ("thin-lens", "spheres at several depths: depth of field", 32, bounds::IMAGE_PERCENT, Level::Quick),
    ("moving", "moving objects: motion blur", 64, bounds::IMAGE_PERCENT, Level::Standard),
    ("glass", "glass and rough metal", 96, bounds::IMAGE_PERCENT, Level::Standard),
    ("mesh", "triangle meshes with smooth normals", 16, bounds::IMAGE_PERCENT, Level::Standard),
    (
        "coats",
        "ground glass, plastics, brushed metal, a mask and a blend under a sky",
        64,
        bounds::INTER_REFLECTION_PERCENT,
        Level::Standard,
    ),
    ("textured", "textures", 48, bounds::INTER_REFLECTION_PERCENT, Level::Standard),
];

/// Side of the reference images in pixels.
const SIDE: &str = "128";

/// Independent parts of each image; errors come from their spread.
const REPLICATES: u32 = 8;

static REFERENCES: OnceLock<PathBuf> = OnceLock::new();

/// Says where the reference scenes and images are; the first call counts.
pub fn set_references(folder: &Path) {
    REFERENCES.get_or_init(|| folder.to_owned());
}

/// Folder of the reference scenes and images.
pub fn references() -> &'static Path {
    REFERENCES.get_or_init(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references"))
}

/// The claims of the group.
///
/// A reference is drawn once, so that the three runs of a failing claim share its error, which the comparison counts.
pub(super) fn claims() -> Vec<Claim> {
    let images = SCENES
        .into_iter()
        .map(|(name, shows, spp, bound, level)| against_mitsuba(name, shows, spp, bound).from_level(level));
    images.chain([comparison::biases()]).collect()
}

fn against_mitsuba(name: &'static str, shows: &'static str, spp: u32, bound: f64) -> Claim {
    let last: Arc<Mutex<Option<(Run, Pixels)>>> = Arc::default();
    let against = move |run: &Run, change: &dyn Fn(&mut Pixels)| {
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        let mut ours = match &*last {
            // the controls change what the subject rendered
            Some((known, ours)) if known == run => ours.clone(),
            _ => last.insert((*run, ours(name, shows, spp, run)?)).1.clone(),
        };
        change(&mut ours);
        let theirs =
            Side::read(&[references().join("mitsuba").join(name).with_extension("exr")]).map_err(subject)?;
        compare(&ours.image()?, &theirs.image, bound).map(|comparison| comparison.evidence)
    };
    let (brighter, shifted) = (against.clone(), against.clone());
    claim(format!("image/{name}/mitsuba"), format!("{shows}: the image is Mitsuba's"))
        .rejects("2.2 × resolution brighter", move |run| {
            let percent = 2.2 * brighter(run, &|_| ())?.resolution.value;
            brighter(run, &|ours| ours.brighten(1.0 + percent / 100.0))
        })
        .rejects("one pixel to the side", move |run| shifted(run, &Pixels::shift))
        .by(move |run| against(run, &|_| ()))
}

/// Means and standard errors, three channels a pixel.
#[derive(Clone)]
struct Pixels {
    size: [usize; 2],
    means: Vec<f64>,
    errors: Vec<f64>,
    largest_share: f64,
}

impl Pixels {
    fn image(&self) -> Result<Image, InputError> {
        Image::with_errors(self.size, 3, self.means.clone(), &self.errors, u64::from(REPLICATES))
            .map(|image| image.with_largest_share(self.largest_share))
    }

    fn brighten(&mut self, factor: f64) {
        self.means.iter_mut().chain(&mut self.errors).for_each(|v| *v *= factor);
    }

    /// Every pixel takes its left neighbour's place; the first of each row stays.
    fn shift(&mut self) {
        for row in self.means.chunks_mut(3 * self.size[0]).chain(self.errors.chunks_mut(3 * self.size[0])) {
            row.copy_within(..row.len() - 3, 3);
        }
    }
}

/// Our image of a scene, which the page shows too.
fn ours(name: &str, shows: &str, spp: u32, run: &Run) -> Result<Pixels, InputError> {
    let path = references().join("scenes").join(name).with_extension("xml");
    let (description, _) = mitsuba::read_scene(&path, &[("res".into(), SIDE.into())]).map_err(subject)?;
    let scene = Scene::new(&description).map_err(subject)?;
    let samples = spp / REPLICATES * u32::try_from(run.effort).map_err(subject)?;
    let settings = RenderSettings {
        sampler: description.sampler.kind,
        samples,
        replicates: REPLICATES,
        seed: run.seed,
        threads: 0,
    };
    let integrator = PathTracer { settings: scene.integrator };
    let rendering = render(&scene, &integrator, &settings, &|_| ()).map_err(subject)?;
    show(name, shows, &rendering)?;
    let numbers = |of: fn(&PixelEstimate) -> [f64; 3]| rendering.pixels.iter().flat_map(of).collect();
    Ok(Pixels {
        size: [rendering.width as usize, rendering.height as usize],
        means: numbers(|p| p.mean),
        errors: numbers(|p| p.standard_error.unwrap_or([f64::NAN; 3])),
        largest_share: rendering.largest_share,
    })
}

fn show(name: &str, shows: &str, rendering: &Rendering) -> Result<(), InputError> {
    let image = rendering::image(rendering, None);
    let png = png::encode(Path::new(name), &image, 0.0).map_err(subject)?;
    gallery::keep(Gallery { name: name.into(), caption: shows.into(), png });
    Ok(())
}
