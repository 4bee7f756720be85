//! Wavefront OBJ: vertices, texture coordinates, normals and polygons; groups and materials are left aside.

use std::collections::HashMap;
use std::path::Path;

use crate::Error;
use crate::shapes::MeshData;

/// Reads the OBJ file `path` whose content is `bytes`; polygons become fans around their first vertex.
///
/// Texture coordinates are as in the file; [`MeshData::face_normals`] is false.
///
/// # Errors
/// `Error::Format` with line and column: a keyword, number or index that is not accepted, or corners with and without
/// texture coordinates or normals in one file.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<MeshData, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut obj = Obj::default();
    for (index, line) in text.lines().enumerate() {
        let refuse = |(word, message): Refusal| Error::Format {
            path: path.into(),
            line: u32::try_from(index + 1).unwrap_or(u32::MAX),
            column: column(line, word),
            message,
        };
        obj.take(line).map_err(refuse)?;
    }
    Ok(obj.finish())
}

/// What is wrong, and the word where it is.
type Refusal<'a> = (&'a str, String);

/// Column from 1 of `word`, a part of `line`.
fn column(line: &str, word: &str) -> u32 {
    let offset = (word.as_ptr() as usize).saturating_sub(line.as_ptr() as usize);
    u32::try_from(offset + 1).unwrap_or(u32::MAX)
}

/// Indices of position, texture coordinates and normal.
type Corner = (u32, Option<u32>, Option<u32>);

#[derive(Default)]
struct Obj {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    known: HashMap<Corner, u32>,
    triangles: Vec<[u32; 3]>,
}

impl Obj {
    fn take<'a>(&mut self, line: &'a str) -> Result<(), Refusal<'a>> {
        let line = line.split('#').next().unwrap_or("");
        let Some(keyword) = line.split_whitespace().next() else { return Ok(()) };
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        match keyword {
            "v" => {
                self.positions.push(numbers(keyword, &words)?);
                homogeneous(&words)
            }
            "vt" => numbers(keyword, &words).map(|uv| self.uvs.push(uv)),
            "vn" => numbers(keyword, &words).map(|n| self.normals.push(n)),
            "f" => self.face(keyword, &words),
            "o" | "g" | "s" | "usemtl" | "mtllib" => Ok(()),
            _ => Err((
                keyword,
                format!("keyword '{keyword}'; v, vt, vn, f, o, g, s, usemtl, mtllib are accepted"),
            )),
        }
    }

    fn face<'a>(&mut self, keyword: &'a str, words: &[&'a str]) -> Result<(), Refusal<'a>> {
        if words.len() < 3 {
            return Err((keyword, format!("a face of {} vertices; 3 or more are accepted", words.len())));
        }
        let mut face = Vec::with_capacity(words.len());
        for word in words {
            let corner = self.corner(word)?;
            face.push(self.vertex(corner).map_err(|message| (*word, message))?);
        }
        self.triangles.extend(face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]));
        Ok(())
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner<'a>(&self, word: &'a str) -> Result<Corner, Refusal<'a>> {
        let mut parts = word.split('/');
        let mut part = |name, count| match parts.next() {
            None | Some("") => Ok(None),
            Some(text) => index(text, name, count).map(Some).map_err(|message| (word, message)),
        };
        let v = part("vertex", self.positions.len())?;
        let (uv, n) = (part("texture coordinate", self.uvs.len())?, part("normal", self.normals.len())?);
        match (v, parts.next()) {
            (Some(v), None) => Ok((v, uv, n)),
            _ => Err((word, format!("corner '{word}'; v, v/vt, v//vn or v/vt/vn is accepted"))),
        }
    }

    fn vertex(&mut self, corner: Corner) -> Result<u32, String> {
        if let Some(&known) = self.known.get(&corner) {
            return Ok(known);
        }
        let mixed = |first: &Corner| {
            (first.1.is_some(), first.2.is_some()) != (corner.1.is_some(), corner.2.is_some())
        };
        if self.corners.first().is_some_and(mixed) {
            return Err("corners with and without texture coordinates or normals in one file; \
                        either in every corner or in none is accepted"
                .into());
        }
        let number = u32::try_from(self.corners.len()).map_err(|_| "more than 2^32 vertices".to_string())?;
        self.corners.push(corner);
        self.known.insert(corner, number);
        Ok(number)
    }

    fn finish(self) -> MeshData {
        let pick = |i: u32| i as usize;
        MeshData {
            positions: self.corners.iter().map(|c| self.positions[pick(c.0)]).collect(),
            uvs: self.corners.iter().map(|c| c.1.map(|i| self.uvs[pick(i)])).collect(),
            normals: self.corners.iter().map(|c| c.2.map(|i| self.normals[pick(i)])).collect(),
            triangles: self.triangles,
            face_normals: false,
        }
    }
}

/// The first `N` of `words` as finite numbers.
fn numbers<'a, const N: usize>(keyword: &'a str, words: &[&'a str]) -> Result<[f32; N], Refusal<'a>> {
    if words.len() < N {
        return Err((keyword, format!("'{keyword}' with {} numbers; {N} are accepted", words.len())));
    }
    let mut values = [0.0; N];
    for (value, word) in values.iter_mut().zip(words) {
        let number: Option<f32> = word.parse().ok().filter(|v: &f32| v.is_finite());
        *value = number.ok_or_else(|| (*word, format!("'{word}'; a finite number is accepted")))?;
    }
    Ok(values)
}

/// Refuses a fourth coordinate other than 1; more numbers are a colour.
fn homogeneous<'a>(words: &[&'a str]) -> Result<(), Refusal<'a>> {
    match words {
        [_, _, _, w] if w.parse() != Ok(1.0_f32) => {
            Err((*w, format!("fourth coordinate '{w}'; three coordinates or a fourth of 1 are accepted")))
        }
        _ => Ok(()),
    }
}

/// An index from 1, or from the end if negative, as an index from 0.
fn index(text: &str, name: &str, count: usize) -> Result<u32, String> {
    let number: i64 =
        text.parse().map_err(|_| format!("{name} index '{text}'; a whole number is accepted"))?;
    let count = i64::try_from(count).unwrap_or(i64::MAX);
    let from_zero = if number < 0 { count.saturating_add(number) } else { number - 1 };
    let valid = (0..count).contains(&from_zero) && number != 0;
    u32::try_from(from_zero)
        .ok()
        .filter(|_| valid)
        .ok_or_else(|| format!("{name} index {number} is out of range; 1 to {count} is accepted"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<MeshData, Error> {
        parse(Path::new("a.obj"), text.as_bytes())
    }

    fn refused(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_are_fans_and_corners_are_shared() {
        let mesh = read(&format!("# a square\n{SQUARE}g x\nf 1 2 3 4\nf -4 -3 -2\n")).unwrap();
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert_eq!((mesh.normals, mesh.uvs), (None, None));
    }

    #[test]
    fn one_position_with_two_normals_is_two_vertices() {
        let text =
            format!("{SQUARE}vt 0 0.25\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2/1/1 3/1/1\nf 1/1/2 2/1/2 3/1/2\n");
        let mesh = read(&text).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(mesh.positions[0], mesh.positions[3]);
        assert_eq!(mesh.uvs.unwrap()[5], [0.0, 0.25]);
        assert_eq!(mesh.normals.unwrap()[3], [0.0, 1.0, 0.0]);
    }

    #[test]
    fn refusals_name_line_column_and_what_is_accepted() {
        let expect = |text: &str, message: &str| assert_eq!(refused(&format!("{SQUARE}{text}")), message);
        expect("v 0 nan 0", "a.obj:5:5: 'nan'; a finite number is accepted");
        expect("v 0 1e99 0", "a.obj:5:5: '1e99'; a finite number is accepted");
        expect("v 0 x 0", "a.obj:5:5: 'x'; a finite number is accepted");
        expect("v 0 1", "a.obj:5:1: 'v' with 2 numbers; 3 are accepted");
        expect("f 1 2 5", "a.obj:5:7: vertex index 5 is out of range; 1 to 4 is accepted");
        expect("f 1 2 0", "a.obj:5:7: vertex index 0 is out of range; 1 to 4 is accepted");
        expect("f 1 -5 2", "a.obj:5:5: vertex index -5 is out of range; 1 to 4 is accepted");
        expect("f 1/1 2 3", "a.obj:5:3: texture coordinate index 1 is out of range; 1 to 0 is accepted");
        expect("f 1 2", "a.obj:5:1: a face of 2 vertices; 3 or more are accepted");
        expect("curv 1", "a.obj:5:1: keyword 'curv'; v, vt, vn, f, o, g, s, usemtl, mtllib are accepted");
        expect(
            "v 1 1 1 2",
            "a.obj:5:9: fourth coordinate '2'; three coordinates or a fourth of 1 are accepted",
        );
        assert!(refused(&format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3")).starts_with("a.obj:6:13: corners with"));
    }

    #[test]
    fn another_reader_finds_the_same_triangles() {
        let text = include_str!("../../../references/scenes/meshes/torus.obj");
        let ours = read(text).unwrap();
        let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
        let theirs = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Err(tobj::LoadError::ReadError));
        let theirs = &theirs.unwrap().0[0].mesh;
        assert_eq!(ours.positions.concat(), theirs.positions);
        assert_eq!(ours.normals.unwrap().concat(), theirs.normals);
        assert_eq!(ours.triangles.concat(), theirs.indices);
    }
}
