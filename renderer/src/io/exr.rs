//! OpenEXR: one part, FLOAT channels `R G B stderr.R stderr.G stderr.B samples`, the same bytes for the same image.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Layer, LayerAttributes,
    LineOrder, MetaData, ReadChannels, ReadLayers, Text, WritableImage,
};

use super::image::{Image, MAX_PIXELS, Metadata, Provenance};
use crate::Error;

const NO_BOUNDS: &str = "an image of 1 to 2^28 pixels whose data window is its display window is accepted";
const SCENE_HASH: &str = "lightproof.scene_hash";
const SEED: &str = "lightproof.seed";
const SAMPLER: &str = "lightproof.sampler";
const REPLICATES: &str = "lightproof.replicates";
const SAMPLE_RANGE: &str = "lightproof.sample_range";
const LARGEST_SHARE: &str = "lightproof.largest_share";
const SHARED_BY: &str = "lightproof.errors_shared_by";
const VERSION: &str = "lightproof.version";

/// Writes `image` to `path`.
///
/// # Errors
/// `Error::Io` if the file cannot be written; `Error::Format` if the image is empty or a text's name is reserved by OpenEXR.
pub fn write(path: &Path, image: &Image) -> Result<(), Error> {
    let bytes = encode(path, image)?;
    fs::write(path, bytes).map_err(|source| Error::Io { path: path.into(), source })
}

/// Reads the first flat layer of the EXR file `path` that has channels R, G and B.
///
/// # Errors
/// `Error::Io` if the file cannot be read; `Error::Format` if it is not a flat RGB image of accepted size.
pub fn read(path: &Path) -> Result<Image, Error> {
    let bytes = fs::read(path).map_err(|source| Error::Io { path: path.into(), source })?;
    decode(path, &bytes)
}

fn format_error(path: &Path, message: impl Into<String>) -> Error {
    Error::Format { path: path.into(), line: 0, column: 0, message: message.into() }
}

fn exr_error(path: &Path, error: exr::error::Error) -> Error {
    match error {
        exr::error::Error::Io(source) => Error::Io { path: path.into(), source },
        other => format_error(path, other.to_string()),
    }
}

fn encode(path: &Path, image: &Image) -> Result<Vec<u8>, Error> {
    let mut channels = Vec::new();
    push_rgb(&mut channels, "", &image.rgb);
    if let Some(stderr) = &image.stderr {
        push_rgb(&mut channels, "stderr.", stderr);
    }
    if let Some(samples) = &image.samples {
        channels.push(AnyChannel::new("samples", FlatSamples::F32(samples.clone())));
    }
    let attributes =
        LayerAttributes { other: attributes_of(&image.metadata).collect(), ..LayerAttributes::default() };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: exr::image::Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer =
        Layer::new((image.width, image.height), attributes, encoding, AnyChannels::sort(channels.into()));
    let mut bytes = Vec::new();
    let written = exr::image::Image::from_layer(layer).write().to_buffered(Cursor::new(&mut bytes));
    written.map_err(|error| exr_error(path, error))?;
    sort_attributes(&mut bytes);
    Ok(bytes)
}

fn push_rgb(channels: &mut Vec<AnyChannel<FlatSamples>>, prefix: &str, pixels: &[[f32; 3]]) {
    for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
        let values = pixels.iter().map(|pixel| pixel[index]).collect();
        channels.push(AnyChannel::new(format!("{prefix}{name}").as_str(), FlatSamples::F32(values)));
    }
}

fn attributes_of(metadata: &Metadata) -> impl Iterator<Item = (Text, AttributeValue)> {
    let text = |name: &str, value: &str| (Text::from(name), AttributeValue::Text(Text::from(value)));
    let mut list: Vec<_> = metadata.texts.iter().map(|(name, value)| text(name, value)).collect();
    if let Some(p) = &metadata.provenance {
        let [first, end] = p.sample_range;
        list.push(text(SCENE_HASH, &p.scene_hash));
        list.push(text(SEED, &p.seed.to_string()));
        list.push(text(SAMPLER, &p.sampler));
        list.push(text(REPLICATES, &p.replicates.to_string()));
        list.push(text(SAMPLE_RANGE, &format!("{first}..{end}")));
        list.push((Text::from(LARGEST_SHARE), AttributeValue::F64(p.largest_share)));
        if p.shared_by > 1 {
            list.push(text(SHARED_BY, &p.shared_by.to_string()));
        }
        list.push(text(VERSION, &p.version));
    }
    list.into_iter()
}

/// Puts the attributes of a one-part file's header into the order of their names.
///
/// The writer keeps custom attributes in a hash map, whose order differs between runs. An attribute is a
/// name, a type (both end with a zero byte), a four-byte little-endian length and that many bytes; an empty name ends
/// the header. The header's length stays, so the offsets after it do too.
///
/// # Source
/// "OpenEXR File Layout", Academy Software Foundation, section Header.
fn sort_attributes(bytes: &mut [u8]) {
    const MAGIC_AND_VERSION: usize = 8;
    let text_end = |from: usize| from + bytes[from..].iter().position(|&b| b == 0).unwrap_or(0);
    let mut attributes = Vec::new();
    let mut start = MAGIC_AND_VERSION;
    while bytes[start] != 0 {
        let length_at = text_end(text_end(start) + 1) + 1;
        let mut length = [0; 4];
        length.copy_from_slice(&bytes[length_at..length_at + 4]);
        let end = length_at + 4 + u32::from_le_bytes(length) as usize;
        attributes.push(bytes[start..end].to_vec());
        start = end;
    }
    attributes.sort();
    bytes[MAGIC_AND_VERSION..start].copy_from_slice(&attributes.concat());
}

/// The image in the EXR file `path` whose content is `bytes`; see [`read`].
///
/// # Errors
/// `Error::Format`, as [`read`].
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Image, Error> {
    check_sizes(path, bytes)?;
    let reader = exr::image::read::read().no_deep_data().largest_resolution_level().all_channels();
    let file = reader
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| exr_error(path, error))?;
    let layer = file.layer_data;
    let (width, height) = (layer.size.x(), layer.size.y());
    let channel = |name: &str| -> Option<Vec<f32>> {
        let found = layer.channel_data.list.iter().find(|c| c.name.eq(name))?;
        let values: Vec<f32> = found.sample_data.values_as_f32().collect();
        (values.len() == width * height).then_some(values)
    };
    let triple = |prefix: &str| -> Option<Vec<[f32; 3]>> {
        let [r, g, b] = ["R", "G", "B"].map(|name| channel(&format!("{prefix}{name}")));
        Some(r?.into_iter().zip(g?).zip(b?).map(|((r, g), b)| [r, g, b]).collect())
    };
    let rgb = triple("").ok_or_else(|| {
        let names: Vec<String> = layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        let names = names.join(" ");
        format_error(path, format!("channels are {names}; full-resolution channels R, G and B are accepted"))
    })?;
    let others = layer.attributes.other.iter().chain(file.attributes.other.iter());
    let metadata = metadata_of(path, others)?;
    Ok(Image { width, height, rgb, stderr: triple("stderr."), samples: channel("samples"), metadata })
}

/// Refuses sizes that would not fit, before anything is allocated for them.
fn check_sizes(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| exr_error(path, e))?;
    for header in &meta.headers {
        let [width, height] = [header.layer_size.x(), header.layer_size.y()];
        let pixels = width as u64 * height as u64;
        let whole = header.data_window() == header.shared_attributes.display_window;
        if pixels == 0 || pixels > MAX_PIXELS || !whole {
            return Err(format_error(path, format!("an image of {width} × {height} pixels; {NO_BOUNDS}")));
        }
    }
    Ok(())
}

fn metadata_of<'a>(
    path: &Path,
    attributes: impl Iterator<Item = (&'a Text, &'a AttributeValue)>,
) -> Result<Metadata, Error> {
    let mut metadata = Metadata::default();
    let mut share = 0.0;
    for (name, value) in attributes {
        match value {
            AttributeValue::Text(text) => {
                metadata.texts.insert(name.to_string(), text.to_string());
            }
            AttributeValue::F64(number) if name.eq(LARGEST_SHARE) => share = *number,
            _ => {}
        }
    }
    if metadata.texts.contains_key(SCENE_HASH) {
        metadata.provenance = Some(provenance_of(path, &mut metadata, share)?);
    }
    Ok(metadata)
}

fn provenance_of(path: &Path, metadata: &mut Metadata, largest_share: f64) -> Result<Provenance, Error> {
    let mut take = |name: &str| {
        let missing = || format_error(path, format!("attribute {name} is missing beside {SCENE_HASH}"));
        metadata.texts.remove(name).ok_or_else(missing)
    };
    let bad = |name: &str, value: &str, accepted: &str| {
        format_error(path, format!("attribute {name} is '{value}'; {accepted} is accepted"))
    };
    let shared_by = take(SHARED_BY).unwrap_or_else(|_| "1".into());
    let seed = take(SEED)?;
    let replicates = take(REPLICATES)?;
    let range = take(SAMPLE_RANGE)?;
    let bounds = range.split_once("..").and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    Ok(Provenance {
        scene_hash: take(SCENE_HASH)?,
        sampler: take(SAMPLER)?,
        version: take(VERSION)?,
        seed: seed.parse().map_err(|_| bad(SEED, &seed, "a whole number"))?,
        replicates: replicates.parse().map_err(|_| bad(REPLICATES, &replicates, "a whole number"))?,
        sample_range: bounds.ok_or_else(|| bad(SAMPLE_RANGE, &range, "FIRST..END"))?,
        largest_share,
        shared_by: shared_by.parse().map_err(|_| bad(SHARED_BY, &shared_by, "a whole number of pixels"))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Image {
        let pixel = |i: u8| [f32::from(i), f32::from(i) * 0.1, -1e-30];
        let mut image = Image::new(3, 2, (0..6).map(pixel).collect());
        image.stderr = Some((6..12).map(pixel).collect());
        image.samples = Some(vec![16.0; 6]);
        image.metadata.texts = [("note".into(), "a b".into()), ("author".into(), "x".into())].into();
        image.metadata.provenance = Some(Provenance {
            scene_hash: "00ff".into(),
            seed: u64::MAX,
            sampler: "sobol".into(),
            replicates: 4,
            sample_range: [0, 16],
            largest_share: 0.125,
            shared_by: 8,
            version: "0.1.0".into(),
        });
        image
    }

    fn encoded(image: &Image) -> Vec<u8> {
        encode(Path::new("x.exr"), image).unwrap()
    }

    #[test]
    fn what_is_written_is_read() {
        let image = example();
        assert_eq!(decode(Path::new("x.exr"), &encoded(&image)).unwrap(), image);
    }

    #[test]
    fn means_alone_have_no_error() {
        let image = Image::new(1, 1, vec![[1.0, 2.0, 3.0]]);
        let back = decode(Path::new("x.exr"), &encoded(&image)).unwrap();
        assert_eq!((back.stderr, back.samples, back.metadata), (None, None, Metadata::default()));
    }

    #[test]
    fn the_same_image_gives_the_same_bytes_in_every_run() {
        let bytes = encoded(&example());
        for _ in 0..20 {
            assert_eq!(encoded(&example()), bytes); // each writer has a hash map with a fresh random order
        }
        let meta = MetaData::read_from_buffered(Cursor::new(&bytes), true).unwrap();
        assert_eq!(meta.headers.len(), 1);
    }

    #[test]
    fn half_floats_and_other_programs_files_are_read() {
        use exr::prelude::f16;
        let half = |v: f32| FlatSamples::F16(vec![f16::from_f32(v); 4]);
        let channels = [("A", 1.0), ("B", 0.25), ("G", 0.5), ("R", 2.0)];
        let list: Vec<_> = channels.into_iter().map(|(name, v)| AnyChannel::new(name, half(v))).collect();
        let image = exr::image::Image::from_channels((2, 2), AnyChannels::sort(list.into()));
        let mut bytes = Vec::new();
        image.write().to_buffered(Cursor::new(&mut bytes)).unwrap();
        let read = decode(Path::new("x.exr"), &bytes).unwrap();
        assert_eq!(read.rgb, vec![[2.0, 0.5, 0.25]; 4]); // powers of two are exact in 16 bits
    }

    #[test]
    fn a_grey_image_is_refused_by_its_channels() {
        let channel = AnyChannel::new("Y", FlatSamples::F32(vec![0.0]));
        let image = exr::image::Image::from_channels((1, 1), AnyChannels::sort(vec![channel].into()));
        let mut bytes = Vec::new();
        image.write().to_buffered(Cursor::new(&mut bytes)).unwrap();
        let message = decode(Path::new("grey.exr"), &bytes).unwrap_err().to_string();
        assert!(message.starts_with("grey.exr: channels are Y;"), "{message}");
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = read(Path::new("/nowhere/a.exr")).unwrap_err().to_string();
        assert!(message.contains("/nowhere/a.exr"), "{message}");
    }

    #[test]
    fn cut_and_flipped_files_never_panic() {
        let bytes = encoded(&example());
        for cut in 0..bytes.len() {
            let _ = decode(Path::new("x.exr"), &bytes[..cut]);
            let mut flipped = bytes.clone();
            flipped[cut] ^= 0xff;
            let _ = decode(Path::new("x.exr"), &flipped);
        }
    }
}
