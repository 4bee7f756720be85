//! Mitsuba's serialized meshes: several in one file, each compressed.

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use crate::Error;
use crate::shapes::MeshData;

/// The number that a file and each of its meshes begin with.
const MAGIC: u16 = 0x041c;

/// Most vertices and triangles of a mesh: 2²⁸, more than six gigabytes.
const MAX_COUNT: u64 = 1 << 28;

const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;

/// Reads the mesh of index `shape` in the serialized file `path` whose content is `bytes`; colours of vertices are left
/// aside.
///
/// # Errors
/// `Error::Format` for another format or version, an index beyond the meshes, and content that ends early.
///
/// # Source
/// Mitsuba 3.9.1, documentation of the plugin `serialized`: versions 3 and 4.
pub(super) fn parse(path: &Path, bytes: &[u8], shape: u32) -> Result<MeshData, Error> {
    mesh(bytes, shape).map_err(|message| Error::Format { path: path.into(), line: 0, column: 0, message })
}

fn mesh(bytes: &[u8], shape: u32) -> Result<MeshData, String> {
    let version = version_at(bytes, 0)?;
    let start = offset(bytes, version, shape)?;
    version_at(bytes, start)?;
    let mut data = Data { stream: ZlibDecoder::new(&bytes[start + 4..]), double: false };
    let flags = data.u32()?;
    data.double = flags & DOUBLE != 0;
    if version == 4 {
        while data.array::<1>()? != [0] {} // the mesh's name
    }
    let counts = [data.u64()?, data.u64()?];
    if let Some(count) = counts.into_iter().find(|&n| n > MAX_COUNT) {
        return Err(format!("mesh {shape} of {count} vertices or triangles; up to 2^28 are accepted"));
    }
    let [vertices, triangles] = counts;
    let positions = data.vectors(vertices)?;
    let normals = (flags & HAS_NORMALS != 0).then(|| data.vectors(vertices)).transpose()?;
    let uvs = (flags & HAS_UVS != 0).then(|| data.vectors(vertices)).transpose()?;
    if flags & HAS_COLORS != 0 {
        data.vectors::<3>(vertices)?;
    }
    let corner = |data: &mut Data<'_>| Ok([data.u32()?, data.u32()?, data.u32()?]);
    let triangles: Vec<[u32; 3]> =
        (0..triangles).map(|_| corner(&mut data)).collect::<Result<_, String>>()?;
    let finite = |values: &[f32]| values.iter().all(|v| v.is_finite());
    let flat = normals.as_deref().map_or(&[][..], |n: &[[f32; 3]]| n.as_flattened());
    let flat_uvs = uvs.as_deref().map_or(&[][..], |t: &[[f32; 2]]| t.as_flattened());
    if !(finite(positions.as_flattened()) && finite(flat) && finite(flat_uvs)) {
        return Err(format!("mesh {shape} has a number that is not finite; finite numbers are accepted"));
    }
    if let Some(index) = triangles.as_flattened().iter().find(|&&i| u64::from(i) >= vertices) {
        return Err(format!("mesh {shape}: vertex {index} of {vertices}; 0 to one less are accepted"));
    }
    Ok(MeshData { positions, normals, uvs, triangles, face_normals: flags & FACE_NORMALS != 0 })
}

/// The version of the file or of the mesh that begins at `start`.
fn version_at(bytes: &[u8], start: usize) -> Result<u16, String> {
    let accepted = "a serialized mesh of version 3 or 4 is accepted";
    let word = |at: usize| Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    match (word(start), start.checked_add(2).and_then(word)) {
        (Some(MAGIC), Some(version @ (3 | 4))) => Ok(version),
        (Some(MAGIC), Some(version)) => Err(format!("version {version}; {accepted}")),
        _ => Err(format!("no serialized mesh at byte {start}; {accepted}")),
    }
}

/// Where the mesh of index `shape` begins, by the table at the end of the file.
fn offset(bytes: &[u8], version: u16, shape: u32) -> Result<usize, String> {
    let count = bytes.last_chunk().map_or(0, |last| u32::from_le_bytes(*last));
    if shape >= count {
        return Err(format!("shape_index {shape} of {count} meshes; 0 to one less than that is accepted"));
    }
    let width: u64 = if version == 4 { 8 } else { 4 };
    let table = (bytes.len() as u64 - 4).checked_sub(width * u64::from(count));
    let entry = table.and_then(|table| usize::try_from(table + width * u64::from(shape)).ok());
    let start = entry.and_then(|entry| {
        let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
        let high = if version == 4 { u64::from(word(entry + 4)?) } else { 0 };
        usize::try_from(u64::from(word(entry)?) | high << 32).ok()
    });
    start.filter(|&s| s < bytes.len()).ok_or_else(|| "a table of meshes that ends early".into())
}

/// A mesh's content as it is unpacked.
struct Data<'b> {
    stream: ZlibDecoder<&'b [u8]>,
    /// Whether numbers are double precision.
    double: bool,
}

impl Data<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut bytes = [0; N];
        let refuse = |e: std::io::Error| format!("a mesh that cannot be unpacked: {e}");
        self.stream.read_exact(&mut bytes).map_err(refuse)?;
        Ok(bytes)
    }

    fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, String> {
        self.array().map(u64::from_le_bytes)
    }

    fn number(&mut self) -> Result<f32, String> {
        if !self.double {
            return self.array().map(f32::from_le_bytes);
        }
        #[expect(clippy::cast_possible_truncation, reason = "meshes are single precision")]
        let number = f64::from_le_bytes(self.array()?) as f32;
        Ok(number)
    }

    /// `count` vectors of N numbers; memory grows as they come, so that a false count costs none.
    fn vectors<const N: usize>(&mut self, count: u64) -> Result<Vec<[f32; N]>, String> {
        let mut vectors = Vec::new();
        for _ in 0..count {
            let mut vector = [0.0; N];
            for number in &mut vector {
                *number = self.number()?;
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::ZlibEncoder;

    use super::*;

    /// One triangle with texture coordinates, in single or double precision.
    fn triangle(version: u16, double: bool) -> Vec<u8> {
        let mut content = Vec::new();
        let precision = if double { DOUBLE } else { 0x1000 };
        content.extend((HAS_UVS | FACE_NORMALS | precision).to_le_bytes());
        if version == 4 {
            content.extend(b"name\0");
        }
        content.extend(3u64.to_le_bytes().into_iter().chain(1u64.to_le_bytes()));
        for value in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0] {
            if double {
                content.extend(f64::from(value).to_le_bytes());
            } else {
                content.extend(value.to_le_bytes());
            }
        }
        content.extend([0u32, 1, 2].into_iter().flat_map(u32::to_le_bytes));
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
        packed.write_all(&content).unwrap();
        let mut bytes: Vec<u8> = MAGIC.to_le_bytes().into_iter().chain(version.to_le_bytes()).collect();
        bytes.extend(packed.finish().unwrap());
        bytes
    }

    /// A file of two meshes of one version: double and single precision.
    fn file(version: u16) -> Vec<u8> {
        let [mut bytes, second] = [triangle(version, true), triangle(version, false)];
        let at = u32::try_from(bytes.len()).unwrap();
        bytes.extend(second);
        for offset in [0, at] {
            bytes.extend(offset.to_le_bytes());
            bytes.extend(&[0; 4][..if version == 4 { 4 } else { 0 }]);
        }
        bytes.extend(2u32.to_le_bytes());
        bytes
    }

    #[test]
    fn both_versions_and_precisions_are_read() {
        for version in [3, 4] {
            for shape in [0, 1] {
                let mesh = parse(Path::new("a.serialized"), &file(version), shape).unwrap();
                assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
                assert_eq!(mesh.uvs, Some(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]));
                assert_eq!((mesh.triangles, mesh.normals, mesh.face_normals), (vec![[0, 1, 2]], None, true));
            }
        }
    }

    #[test]
    fn damage_is_refused_and_never_a_panic() {
        let whole = file(4);
        let refused = |bytes: &[u8], shape| parse(Path::new("a"), bytes, shape).unwrap_err().to_string();
        assert_eq!(refused(&whole, 2), "a: shape_index 2 of 2 meshes; 0 to one less than that is accepted");
        assert!(refused(b"", 0).starts_with("a: no serialized mesh at byte 0;"));
        assert!(refused(&[0x1c, 4, 9, 0, 1, 0, 0, 0], 0).starts_with("a: version 9;"));
        for end in 0..whole.len() {
            assert!(parse(Path::new("a"), &whole[..end], 0).is_err(), "{end}");
        }
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x55;
            let _ = parse(Path::new("a"), &damaged, 1);
        }
    }
}
