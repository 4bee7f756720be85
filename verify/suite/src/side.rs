//! One side of a comparison: an image with its errors, from one file or from one file a seed.

use std::path::{Path, PathBuf};

use renderer::io::exr;
use serde::Deserialize;
use verify::error::InputError;
use verify::image::{Image, TILE};

use crate::cli::CliError;

/// Name of the text that holds the number of replicates in files of other programs.
const REPLICATES: &str = "lightproof.replicates";

/// What it holds in an image that is known exactly, whose standard errors are all 0.
const EXACT: &str = "exact";

/// Replicates of an exact image: so many that an error of 0 has no uncertainty of its own (beyond 10⁶ Student's t is the normal's).
const KNOWN: u64 = 1 << 52;

/// By how much a tile's mean over seeds may differ from its pixels' sum, relative: pixels are single precision, each off by 2⁻²⁴ at most.
const ROUNDING: f64 = 1e-6;

/// By how much renderers that add samples up in f32 may be off: 4,096 equal ones, one after the other, by 4096/2·2⁻²⁴. Mitsuba 3.9.1 is by up to
/// 3e-6 at 256 samples of a sky of one radiance, by 4e-5 at 4,096, in every seed alike; nothing else tells such pixels' error.
const F32_SUMS: f64 = 4096.0 / 2.0 / 16_777_216.0;

/// Images and what is known of their errors.
pub(crate) struct Side {
    /// As the comparison takes it.
    pub(crate) image: Image,
    /// Pixels in a row.
    pub(crate) width: usize,
    /// Mean of each pixel over channels and files, row by row.
    pub(crate) grey: Vec<f64>,
    /// Whether it says that it is exact.
    pub(crate) exact: bool,
}

/// What a JSON file beside an image says; further members are not looked at.
#[derive(Deserialize)]
struct Sidecar {
    tile: usize,
    /// Seeds, rows of tiles, columns, channels.
    tile_sums: Vec<Vec<Vec<[f64; 3]>>>,
}

impl Side {
    /// Reads the files of one side; there is at least one.
    pub(crate) fn read(paths: &[PathBuf]) -> Result<Self, CliError> {
        let files = paths.iter().map(|path| exr::read(path)).collect::<Result<Vec<_>, _>>()?;
        let (first, path) = (&files[0], &paths[0]);
        let refused =
            |path: &Path, reason: InputError| CliError::Test { subject: path.display().to_string(), reason };
        if let Some((other, path)) =
            files.iter().zip(paths).find(|(f, _)| (f.width, f.height) != (first.width, first.height))
        {
            return Err(CliError::Arguments(format!(
                "{} has {}×{} pixels; {}×{} as in {} are accepted",
                path.display(),
                other.width,
                other.height,
                first.width,
                first.height,
                paths[0].display()
            )));
        }
        let size = [first.width, first.height];
        let values: Vec<Vec<f64>> = files
            .iter()
            .map(|file| file.rgb.as_flattened().iter().map(|&v| f64::from(v)).collect())
            .collect();
        let image = if let [values] = values.as_slice() {
            single(path, first, values)?
        } else {
            Image::from_seeds(size, 3, &values).map_err(|reason| refused(path, reason))?
        };
        let count = 3.0 * f64::from(u32::try_from(files.len()).unwrap_or(u32::MAX));
        let grey = |pixel: usize| {
            values.iter().map(|file| file[3 * pixel..3 * pixel + 3].iter().sum::<f64>()).sum::<f64>() / count
        };
        let says_exact = first.metadata.texts.get(REPLICATES).is_some_and(|text| text.trim() == EXACT);
        let exact = files.len() == 1 && says_exact;
        let sums_are_f64 = exact || files.iter().all(|file| file.metadata.provenance.is_some());
        let image = if sums_are_f64 { image } else { image.with_rounding(F32_SUMS) };
        Ok(Self { image, width: first.width, grey: (0..first.rgb.len()).map(grey).collect(), exact })
    }
}

/// An image from one file: errors from its own channels, and from the sums of its seeds where they lie beside it.
fn single(path: &Path, file: &renderer::io::Image, values: &[f64]) -> Result<Image, CliError> {
    let refused = |reason| CliError::Test { subject: path.display().to_string(), reason };
    let errors: Vec<f64> = file.stderr.iter().flatten().flatten().map(|&v| f64::from(v)).collect();
    let replicates = if errors.is_empty() { 1 } else { replicates(path, file)? };
    let size = [file.width, file.height];
    let image = Image::with_errors(size, 3, values.to_vec(), &errors, replicates).map_err(refused)?;
    let share = file.metadata.provenance.as_ref().map_or(0.0, |provenance| provenance.largest_share);
    let shared_by = file.metadata.provenance.as_ref().map_or(1, |provenance| provenance.shared_by);
    let image = image.with_largest_share(share).with_errors_shared_by(shared_by.into());
    match seed_tiles(&path.with_extension("json"), size, values)? {
        Some(sums) => image.with_seed_tiles(sums).map_err(refused),
        None => Ok(image),
    }
}

/// The number of replicates that a file with standard errors says it has; [`KNOWN`] for one that says it is exact.
fn replicates(path: &Path, file: &renderer::io::Image) -> Result<u64, CliError> {
    if let Some(provenance) = &file.metadata.provenance {
        return Ok(u64::from(provenance.replicates));
    }
    let text = file.metadata.texts.get(REPLICATES);
    if text.is_some_and(|text| text.trim() == EXACT) {
        let error = file.stderr.iter().flatten().flatten().find(|&&error| error != 0.0);
        return match error {
            None => Ok(KNOWN),
            Some(error) => Err(CliError::Arguments(format!(
                "{}: its attribute {REPLICATES} is {EXACT:?}, but it has a standard error of {error}; 0 is accepted",
                path.display()
            ))),
        };
    }
    text.and_then(|text| text.trim().parse().ok()).ok_or_else(|| {
        let found = text.map_or(String::from("missing"), |text| format!("{text:?}"));
        CliError::Arguments(format!(
            "{}: it has standard errors, but its attribute {REPLICATES} is {found}; the number of independent replicates, or \"exact\" with errors of 0, is accepted",
            path.display()
        ))
    })
}

/// Sums over tiles of each seed, from the JSON file beside an image; none where there is no such file, or it has none.
fn seed_tiles(path: &Path, size: [usize; 2], values: &[f64]) -> Result<Option<Vec<Vec<f64>>>, CliError> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(None) };
    let contradiction = |message: String| CliError::Sidecar { path: path.to_owned(), message };
    let value: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| contradiction(error.to_string()))?;
    if value.get("tile_sums").is_none() {
        return Ok(None);
    }
    let sidecar: Sidecar = serde_json::from_value(value).map_err(|error| contradiction(error.to_string()))?;
    if sidecar.tile != TILE {
        return Err(contradiction(format!("tile is {}; {TILE} is accepted", sidecar.tile)));
    }
    let pixels = tile_sums(size, values);
    let flat = |seed: Vec<Vec<[f64; 3]>>| seed.into_iter().flatten().flatten().collect();
    let seeds: Vec<Vec<f64>> = sidecar.tile_sums.into_iter().map(flat).collect();
    if let Some(sums) = seeds.iter().find(|sums| sums.len() != pixels.len()) {
        let (given, needed) = (sums.len(), pixels.len());
        return Err(contradiction(format!("tile_sums has {given} values of a seed; {needed} are accepted")));
    }
    let count = f64::from(u32::try_from(seeds.len()).unwrap_or(u32::MAX));
    for (entry, pixels) in pixels.iter().enumerate() {
        let mean = seeds.iter().map(|sums| sums[entry]).sum::<f64>() / count;
        let agree = (mean - pixels).abs() <= ROUNDING * pixels.abs();
        if !agree {
            return Err(contradiction(format!(
                "tile {}, channel {} has the mean {mean} over seeds, but {pixels} in the image; sums of the same image are accepted",
                entry / 3,
                entry % 3
            )));
        }
    }
    Ok(Some(seeds))
}

/// Sums over tiles in rows, channels together.
fn tile_sums([width, height]: [usize; 2], values: &[f64]) -> Vec<f64> {
    let columns = width.div_ceil(TILE);
    let mut sums = vec![0.0; 3 * columns * height.div_ceil(TILE)];
    for (i, value) in values.iter().enumerate() {
        let (x, y) = (i / 3 % width, i / 3 / width);
        sums[3 * (y / TILE * columns + x / TILE) + i % 3] += value;
    }
    sums
}
