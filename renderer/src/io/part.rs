//! Files of renders that aren't whole: checkpoints, and ranges of samples to be merged.
//!
//! A header of lines, `name value`, up to an empty line; then, little-endian, the samples of each pixel (u32) if the header
//! says that they have counts of their own; then for each finished tile its index (u32), the largest sample (f64), the number of dropped contributions (u64) and its sums (f64); then a CRC-32 of all before it.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::image::Provenance;
use crate::Error;
use crate::film::{Allocation, Film, Part, Reconstruction, TileSums};
use crate::render::{RenderSettings, Rendering};

const FORMAT: &str = "lightproof part 3";

/// Whether all pixels have the samples of the range, or each a number of its own.
const EVEN: &str = "even";
const EACH: &str = "each";

/// What the samples of a part were made from; parts of one image agree in all of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Hash of the scene's files and overrides.
    pub scene_hash: String,
    /// Integrator and film, as text.
    pub how: String,
    /// Name of the sampler.
    pub sampler: String,
    /// Samples per pixel and replicate of the whole image.
    pub samples: u32,
    /// Seed of the samples.
    pub seed: u64,
    /// How the film makes a pixel of its samples.
    pub reconstruction: Reconstruction,
    /// Most pixels that have errors in common; 1 where each has its own.
    pub shared_by: u32,
    /// Version of the program.
    pub version: String,
}

impl Origin {
    /// Of a render with `settings` of the scene of that hash, whose pixels have errors of their own.
    ///
    /// * `how`: everything else that the samples depend on, in one line.
    pub fn new(
        scene_hash: u64,
        settings: &RenderSettings,
        how: &str,
        reconstruction: Reconstruction,
    ) -> Self {
        Self {
            scene_hash: format!("{scene_hash:016x}"),
            how: how.split_whitespace().collect::<Vec<_>>().join(" "),
            sampler: settings.sampler.name().into(),
            samples: settings.samples,
            seed: settings.seed,
            reconstruction,
            shared_by: 1,
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }

    fn lines(&self) -> [(&'static str, String); 8] {
        [
            ("scene_hash", self.scene_hash.clone()),
            ("how", self.how.clone()),
            ("sampler", self.sampler.clone()),
            ("samples", self.samples.to_string()),
            ("seed", self.seed.to_string()),
            ("reconstruction", self.reconstruction.name().into()),
            ("shared_by", self.shared_by.to_string()),
            ("version", self.version.clone()),
        ]
    }

    /// The first thing in which two origins differ, with both values; `None` if they are the same.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let pairs = self.lines().into_iter().zip(other.lines());
        let mut differing = pairs.filter(|(a, b)| a != b);
        differing.next().map(|((name, a), (_, b))| format!("{name} is {a}, and {b} is accepted"))
    }

    /// The provenance of the image that `part` makes.
    pub fn provenance(&self, part: &Part, rendering: &Rendering) -> Provenance {
        Provenance {
            scene_hash: self.scene_hash.clone(),
            seed: self.seed,
            sampler: self.sampler.clone(),
            replicates: part.replicates,
            sample_range: part.range.map(|index| u64::from(index) * u64::from(part.replicates)),
            largest_share: rendering.largest_share,
            shared_by: self.shared_by,
            version: self.version.clone(),
        }
    }
}

/// Writes a part so that a reader finds the last one or this one, whenever the process ends.
///
/// # Errors
/// `Error::Io` if the file beside `path`, or `path`, cannot be written.
pub fn write(path: &Path, origin: &Origin, part: &Part) -> Result<(), Error> {
    let bytes = encode(origin, part);
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    let beside = PathBuf::from(name);
    let replace = || {
        let mut file = File::create(&beside)?;
        file.write_all(&bytes)?;
        // The name must not come before the content.
        file.sync_all()?;
        fs::rename(&beside, path)
    };
    replace().map_err(|source| Error::Io { path: path.into(), source })
}

/// Reads a part.
///
/// # Errors
/// `Error::Io` if the file cannot be read; `Error::Format` if it is not a whole part.
pub fn read(path: &Path) -> Result<(Origin, Part), Error> {
    let bytes = fs::read(path).map_err(|source| Error::Io { path: path.into(), source })?;
    decode(&bytes).map_err(|message| Error::Format { path: path.into(), line: 0, column: 0, message })
}

fn encode(origin: &Origin, part: &Part) -> Vec<u8> {
    let ([width, height], [start, end]) = (part.size, part.range);
    let mut header = format!("{FORMAT}\n");
    for (name, value) in origin.lines() {
        header += &format!("{name} {value}\n");
    }
    header += &format!("size {width} {height}\nreplicates {}\nrange {start} {end}\n", part.replicates);
    header += &format!("counts {}\n\n", if part.counts().is_some() { EACH } else { EVEN });
    let mut bytes = header.into_bytes();
    part.counts().into_iter().flatten().for_each(|count| bytes.extend(count.to_le_bytes()));
    for (index, tile) in (0u32..).zip(part.tiles()) {
        let Some(tile) = tile else { continue };
        bytes.extend(index.to_le_bytes());
        bytes.extend(tile.largest.to_le_bytes());
        bytes.extend(tile.dropped.to_le_bytes());
        tile.sums.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

fn decode(bytes: &[u8]) -> Result<(Origin, Part), String> {
    let not_a_part = || format!("a part that begins with '{FORMAT}' is accepted");
    let (content, sum) = bytes.split_last_chunk().ok_or_else(not_a_part)?;
    if !content.starts_with(FORMAT.as_bytes()) {
        return Err(not_a_part());
    }
    if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
        return Err("the content does not have its checksum; a whole file is accepted".into());
    }
    let end = content.windows(2).position(|pair| pair == b"\n\n").ok_or_else(not_a_part)?;
    let header = std::str::from_utf8(&content[..end]).map_err(|error| error.to_string())?;
    let mut header = Header(header.lines().skip(1));
    let origin = Origin {
        scene_hash: header.text("scene_hash")?.into(),
        how: header.text("how")?.into(),
        sampler: header.text("sampler")?.into(),
        samples: header.number("samples")?,
        seed: header.number("seed")?,
        reconstruction: header.reconstruction()?,
        shared_by: header.number("shared_by")?,
        version: header.text("version")?.into(),
    };
    let size: [u32; 2] = header.pair("size")?;
    let replicates: u32 = header.number("replicates")?;
    let range: [u32; 2] = header.pair("range")?;
    let pixels = u64::from(size[0]) * u64::from(size[1]);
    if pixels == 0 || pixels > Film::MAX_PIXELS || replicates == 0 || range[0] >= range[1] {
        return Err("a film of 1 to 2^28 pixels, replicates and samples are accepted".into());
    }
    let mut rest = &content[end + 2..];
    let part = match header.text("counts")? {
        EVEN => Part::new(size, replicates, range),
        EACH => counted(size, replicates, range, &mut rest)?,
        other => return Err(format!("counts is '{other}'; {EVEN} or {EACH} is accepted")),
    };
    Ok((origin, tiles(part, rest)?))
}

/// An empty part whose pixels have the numbers of samples with which `bytes` begin, which are taken off.
fn counted(size: [u32; 2], replicates: u32, range: [u32; 2], bytes: &mut &[u8]) -> Result<Part, String> {
    if range[0] != 0 {
        return Err("range starts late; with counts of their own, pixels have samples from 0 on".into());
    }
    let cut_off = || String::from("the counts are cut off; one for each pixel is accepted");
    let pixels = size[0] as usize * size[1] as usize;
    let (counts, rest) = bytes.split_at_checked(4 * pixels).ok_or_else(cut_off)?;
    *bytes = rest;
    let counts = counts.as_chunks().0.iter().map(|count| u32::from_le_bytes(*count)).collect();
    let allocation = Allocation { counts, pilot: None };
    Part::allocated(size, replicates, range[1], allocation).map_err(|error| error.to_string())
}

/// Puts the tiles that `bytes` hold into an empty part.
fn tiles(mut part: Part, mut bytes: &[u8]) -> Result<Part, String> {
    let lengths = part.lengths();
    let cut_off = || String::from("a tile is cut off; whole tiles are accepted");
    while !bytes.is_empty() {
        let tile = u32::from_le_bytes(*take(&mut bytes).ok_or_else(cut_off)?) as usize;
        let largest = f64::from_le_bytes(*take(&mut bytes).ok_or_else(cut_off)?);
        let dropped = u64::from_le_bytes(*take(&mut bytes).ok_or_else(cut_off)?);
        let length = *lengths
            .get(tile)
            .ok_or_else(|| format!("tile {tile} is out of range; 0 to {} is accepted", lengths.len() - 1))?;
        let (numbers, rest) = bytes.split_at_checked(8 * length).ok_or_else(cut_off)?;
        bytes = rest;
        let sums = numbers.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number)).collect();
        part.finish(tile, TileSums { sums, largest, dropped });
    }
    Ok(part)
}

fn take<'a, const N: usize>(bytes: &mut &'a [u8]) -> Option<&'a [u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(first)
}

/// The lines of a header, in their order.
struct Header<'a>(std::iter::Skip<std::str::Lines<'a>>);

impl<'a> Header<'a> {
    fn text(&mut self, name: &str) -> Result<&'a str, String> {
        let line = self.0.next().and_then(|line| line.split_once(' '));
        line.filter(|(found, _)| *found == name)
            .map(|(_, value)| value)
            .ok_or_else(|| format!("the header has no '{name}' in its place"))
    }

    fn number<T: std::str::FromStr>(&mut self, name: &str) -> Result<T, String> {
        let text = self.text(name)?;
        text.parse().map_err(|_| format!("{name} is '{text}'; a number in its range is accepted"))
    }

    fn reconstruction(&mut self) -> Result<Reconstruction, String> {
        let text = self.text("reconstruction")?;
        Reconstruction::named(text)
            .ok_or_else(|| format!("reconstruction is '{text}'; importance or weighted is accepted"))
    }

    fn pair(&mut self, name: &str) -> Result<[u32; 2], String> {
        let text = self.text(name)?;
        let both = text.split_once(' ').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
        both.ok_or_else(|| format!("{name} is '{text}'; two numbers are accepted"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::SamplerKind;

    fn origin() -> Origin {
        let settings = RenderSettings {
            sampler: SamplerKind::Sobol,
            samples: 12,
            replicates: 2,
            seed: u64::MAX,
            threads: 0,
        };
        Origin::new(7, &settings, "path of\n any depth", Reconstruction::Importance)
    }

    fn part() -> Part {
        let mut part = Part::new([20, 3], 2, [3, 12]);
        let sums = (0..part.lengths()[1]).map(|i| 1.0 / (i as f64 + 3.0)).collect();
        part.finish(1, TileSums { sums, largest: 0.25, dropped: 3 });
        part
    }

    #[test]
    fn a_part_is_read_as_it_was_written() {
        let bytes = encode(&origin(), &part());
        assert_eq!(decode(&bytes), Ok((origin(), part())));
        let allocation = Allocation { counts: (1..=60).collect(), pilot: None };
        let counted = Part::allocated([20, 3], 2, 12, allocation).unwrap();
        assert_eq!(decode(&encode(&origin(), &counted)), Ok((origin(), counted)));
    }

    #[test]
    fn every_damage_is_noticed() {
        let bytes = encode(&origin(), &part());
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "{length} bytes");
        }
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert!(decode(&damaged).is_err(), "byte {place}");
        }
    }

    #[test]
    fn origins_say_where_they_differ() {
        let other = Origin { seed: 1, ..origin() };
        assert_eq!(origin().difference(&origin()), None);
        assert_eq!(other.difference(&origin()).unwrap(), "seed is 1, and 18446744073709551615 is accepted");
    }
}
