//! Pictures: what is rendered goes out as PNG, textures and environment maps come in as PNG, JPEG, Radiance HDR or EXR.

use std::io::Cursor;
use std::path::Path;

use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, RgbImage};

use super::exr;
use super::image::{Image, MAX_PIXELS};
use crate::Error;

const ACCEPTED: &str = "a PNG, JPEG or Radiance HDR file of 1 to 2^28 pixels, or an EXR file by its name";
/// How Radiance's files begin, by Radiance and by others.
const RADIANCE: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Writes `image` to `path` as an 8-bit sRGB PNG; see [`encode`].
///
/// # Errors
/// `Error::Io` if the file cannot be written; else as [`encode`].
pub fn write(path: &Path, image: &Image, exposure: f32) -> Result<(), Error> {
    let bytes = encode(path, image, exposure)?;
    std::fs::write(path, bytes).map_err(|source| Error::Io { path: path.into(), source })
}

/// The bytes of an 8-bit sRGB PNG of `image`, after scaling by 2^`exposure`.
///
/// Values below 0 become 0, values above 1 become 1, NaN becomes 0: a picture to look at, not data.
///
/// * `path`: what messages call it.
///
/// # Errors
/// `Error::Format` if the image has no pixel or more than 2^32 in a row.
pub fn encode(path: &Path, image: &Image, exposure: f32) -> Result<Vec<u8>, Error> {
    let scale = libm::exp2f(exposure);
    let bytes = image.rgb.iter().flatten().map(|&value| srgb_byte(value * scale)).collect();
    let size = u32::try_from(image.width).ok().zip(u32::try_from(image.height).ok());
    let picture = size.and_then(|(width, height)| RgbImage::from_raw(width, height, bytes));
    let Some(picture) = picture.filter(|p| p.width() > 0 && p.height() > 0) else {
        return Err(format_error(path, "an image without pixels; 1 pixel or more is accepted"));
    };
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).map_err(|error| picture_error(path, error))?;
    Ok(bytes.into_inner())
}

/// Reads the texture `path`; see [`decode`].
///
/// # Errors
/// `Error::Io` if the file cannot be read; else as [`decode`].
pub fn read(path: &Path, raw: bool) -> Result<Image, Error> {
    let bytes = std::fs::read(path).map_err(|source| Error::Io { path: path.into(), source })?;
    decode(path, &bytes, raw)
}

/// The texture file `path` with the content `bytes` as linear values, rows from the top; a fourth channel is dropped, one
/// channel is repeated. PNG, JPEG and Radiance HDR are known by their content, EXR by its name.
///
/// * `raw`: take the stored values as they are (0 to 1) instead of decoding sRGB. HDR and EXR files are linear either way.
///
/// # Errors
/// `Error::Format` if it is none of the formats or too large.
pub fn decode(path: &Path, bytes: &[u8], raw: bool) -> Result<Image, Error> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return exr::decode(path, bytes);
    }
    let decoder = decoder(path, bytes)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format_error(path, format!("an image of {width} × {height} pixels; {ACCEPTED}")));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(|error| picture_error(path, error))?;
    Ok(Image::new(width as usize, height as usize, linear(&picture, raw)))
}

fn decoder<'a>(path: &Path, bytes: &'a [u8]) -> Result<Box<dyn ImageDecoder + 'a>, Error> {
    let decoder = if RADIANCE.iter().any(|signature| bytes.starts_with(signature)) {
        // Strictly only the first of both signatures is known.
        HdrDecoder::new_nonstrict(Cursor::new(bytes))
            .map(|decoder| Box::new(decoder) as Box<dyn ImageDecoder>)
    } else {
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let reader = reader.map_err(|source| Error::Io { path: path.into(), source })?;
        reader.into_decoder().map(|decoder| Box::new(decoder) as Box<dyn ImageDecoder>)
    };
    decoder.map_err(|error| picture_error(path, error))
}

fn linear(picture: &DynamicImage, raw: bool) -> Vec<[f32; 3]> {
    let is_linear = raw || matches!(picture, DynamicImage::ImageRgb32F(_));
    let decode = |value: f32| if is_linear { value } else { srgb_decode(value) };
    picture.to_rgb32f().pixels().map(|pixel| pixel.0.map(decode)).collect()
}

/// The sRGB code of a linear value, both from 0 to 1.
///
/// # Source
/// IEC 61966-2-1:1999.
fn srgb_encode(value: f64) -> f64 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * libm::pow(value, 1.0 / 2.4) - 0.055 }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0 to 255")]
fn srgb_byte(value: f32) -> u8 {
    (srgb_encode(f64::from(value.clamp(0.0, 1.0))) * 255.0).round() as u8 // NaN casts to 0
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
fn srgb_decode(code: f32) -> f32 {
    let code = f64::from(code);
    let value = if code <= 0.040_45 { code / 12.92 } else { libm::pow((code + 0.055) / 1.055, 2.4) };
    value as f32
}

fn format_error(path: &Path, message: impl Into<String>) -> Error {
    Error::Format { path: path.into(), line: 0, column: 0, message: message.into() }
}

fn picture_error(path: &Path, error: ImageError) -> Error {
    match error {
        ImageError::IoError(source) => Error::Io { path: path.into(), source },
        other => format_error(path, format!("{other}; {ACCEPTED} is accepted")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn temporary(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!("lightproof-{}-{name}", std::process::id()))
    }

    #[test]
    fn every_byte_comes_back() {
        let path = temporary("bytes.png");
        let values: Vec<[f32; 3]> = (0..=255_u8).map(|b| [srgb_decode(f32::from(b) / 255.0); 3]).collect();
        write(&path, &Image::new(16, 16, values.clone()), 0.0).unwrap();
        let back = read(&path, false).unwrap();
        let codes = read(&path, true).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(back.rgb, values);
        assert_eq!(codes.rgb[51], [0.2; 3]); // 51 of 255
    }

    #[test]
    fn exposure_doubles_and_nothing_overflows() {
        assert_eq!([f32::NAN, -1.0, 0.0, 2.0, f32::INFINITY].map(srgb_byte), [0, 0, 0, 255, 255]);
        let path = temporary("exposure.png");
        write(&path, &Image::new(1, 1, vec![[0.25, 0.125, 0.0]]), 1.0).unwrap();
        let codes = read(&path, true).unwrap().rgb[0].map(|c| (c * 255.0).round());
        std::fs::remove_file(&path).unwrap();
        assert_eq!(codes, [188.0, 137.0, 0.0]); // 255·(1.055·0.5^(1/2.4) − 0.055) = 187.5; of 0.25: 136.96
    }

    #[test]
    fn radiance_files_are_linear() {
        // Ward's shared exponents: (128, 64, 32) · 2^(129 − 136), and the same with an exponent of 143
        let pixels = b"\x80\x40\x20\x81\x80\x40\x20\x8f";
        let file = |signature: &str, size: &str| {
            [format!("{signature}\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").as_bytes(), pixels].concat()
        };
        let read = |bytes: &[u8], raw| decode(Path::new("sky.hdr"), bytes, raw);
        for (signature, raw) in [("#?RADIANCE", false), ("#?RADIANCE", true), ("#?RGBE", false)] {
            let image = read(&file(signature, "-Y 1 +X 2"), raw).unwrap();
            assert_eq!((image.width, image.height), (2, 1));
            assert_eq!(image.rgb, [[1.0, 0.5, 0.25], [16384.0, 8192.0, 4096.0]]);
        }
        for (bytes, expected) in [
            (file("#?RGBE", "-Y 1 +X 3"), "sky.hdr: "),
            (file("#?RGBE", "-Y 1000000 +X 1000000"), "an image of 1000000 × 1000000 pixels; "),
        ] {
            let message = read(&bytes, false).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn a_text_file_and_no_file_are_refused_by_name() {
        let path = temporary("not.png");
        std::fs::write(&path, "hello").unwrap();
        let message = read(&path, false).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(message.contains("not.png") && message.contains("PNG, JPEG or Radiance HDR"), "{message}");
        assert!(matches!(read(Path::new("/nowhere/a.png"), false), Err(Error::Io { .. })));
        assert!(matches!(write(&path, &Image::default(), 0.0), Err(Error::Format { .. })));
    }
}
