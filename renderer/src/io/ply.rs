//! Stanford PLY, ASCII and binary: elements `vertex` (x y z, nx ny nz, u v or s t) and `face` (`vertex_indices`).

use std::io::{BufRead, Cursor};
use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult};

use crate::Error;
use crate::shapes::MeshData;

/// Reads the PLY file `path` whose content is `bytes`; polygons become fans around their first vertex.
///
/// Properties and elements that a mesh does not need are left aside, as the format means them to be.
///
/// # Errors
/// `Error::Format`: the line in an ASCII file, the number of the vertex or face (from 0) where a number or an index is not
/// accepted.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<MeshData, Error> {
    let refuse = |message: String| Error::Format { path: path.into(), line: 0, column: 0, message };
    let refuse_at = |error: ParseError| Error::Format {
        path: path.into(),
        line: error.line().and_then(|line| u32::try_from(line).ok()).unwrap_or(0),
        column: 0,
        message: format!("{}; a PLY file of format 1.0 is accepted", one_line(&error)),
    };
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(refuse_at)?;
    check_header(&header, bytes.len()).map_err(refuse)?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => vertices = rows::<Vertex>(&mut reader, element, &header).map_err(refuse_at)?,
            "face" => faces = rows::<Face>(&mut reader, element, &header).map_err(refuse_at)?,
            _ => drop(rows::<Skipped>(&mut reader, element, &header).map_err(refuse_at)?),
        }
    }
    mesh(&header, &vertices, &faces).map_err(refuse)
}

fn rows<E: PropertyAccess>(
    reader: &mut Reader<impl BufRead>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, ParseError> {
    Parser::<E>::new().read_payload_for_element(reader, element, header)
}

/// The crate's message as one line without control characters.
fn one_line(error: &ParseError) -> String {
    let text: String =
        error.to_string().chars().take(300).map(|c| if c.is_control() { ' ' } else { c }).collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn check_header(header: &Header, bytes: usize) -> Result<(), String> {
    for (name, element) in &header.elements {
        // An element takes at least one byte: a list's length, or a line's end.
        if element.count > bytes || element.properties.is_empty() && element.count > 0 {
            let count = element.count;
            return Err(format!(
                "{count} elements '{name}' in a file of {bytes} bytes; at most one a byte is accepted"
            ));
        }
    }
    for (element, property) in [("vertex", "x"), ("vertex", "y"), ("vertex", "z")] {
        if !has(header, element, property) {
            return Err(format!("element '{element}' has no property '{property}'; x, y and z are accepted"));
        }
    }
    if INDICES.iter().any(|name| has(header, "face", name)) {
        return Ok(());
    }
    Err("element 'face' has no property 'vertex_indices'; vertex_indices or vertex_index is accepted".into())
}

fn has(header: &Header, element: &str, property: &str) -> bool {
    header.elements.get(element).is_some_and(|e| e.properties.contains_key(property))
}

const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

#[derive(Default)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
}

#[derive(Default)]
struct Face(Vec<u32>);

struct Skipped;

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let target = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "u" | "s" => &mut self.uv[0],
            "v" | "t" => &mut self.uv[1],
            _ => return PropertyAccessResult::Ignored,
        };
        let Some(value) = property.to_f32_lossy() else { return PropertyAccessResult::UnsupportedType };
        *target = value;
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !INDICES.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        let Some(indices) = property.to_u32_list() else { return PropertyAccessResult::UnsupportedType };
        self.0 = indices;
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

fn mesh(header: &Header, vertices: &[Vertex], faces: &[Face]) -> Result<MeshData, String> {
    let all = |names: &[&str]| names.iter().all(|name| has(header, "vertex", name));
    let with_normals = all(&["nx", "ny", "nz"]);
    let with_uvs = all(&["u", "v"]) || all(&["s", "t"]);
    for (number, vertex) in vertices.iter().enumerate() {
        let numbers = vertex.position.iter().chain(&vertex.normal).chain(&vertex.uv);
        if let Some(bad) = numbers.copied().find(|v| !v.is_finite()) {
            return Err(format!("vertex {number} has the number {bad}; finite numbers are accepted"));
        }
    }
    let mut triangles = Vec::with_capacity(faces.len());
    for (number, Face(face)) in faces.iter().enumerate() {
        if face.len() < 3 {
            return Err(format!("face {number} has {} vertices; 3 or more are accepted", face.len()));
        }
        if let Some(bad) = face.iter().find(|&&index| index as usize >= vertices.len()) {
            let last = vertices.len().wrapping_sub(1) as i64;
            return Err(format!(
                "vertex index {bad} of face {number} is out of range; 0 to {last} is accepted"
            ));
        }
        triangles.extend(face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]));
    }
    Ok(MeshData {
        positions: vertices.iter().map(|v| v.position).collect(),
        normals: with_normals.then(|| vertices.iter().map(|v| v.normal).collect()),
        uvs: with_uvs.then(|| vertices.iter().map(|v| v.uv).collect()),
        triangles,
        face_normals: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ascii(vertices: &[&str], faces: &[&str]) -> String {
        let head = "ply\nformat ascii 1.0\ncomment x\nelement vertex";
        let mid = "property float x\nproperty double y\nproperty float z\nelement face";
        let end = "property list uchar int vertex_indices\nend_header";
        let (v, f) = (vertices.join("\n"), faces.join("\n"));
        format!("{head} {}\n{mid} {}\n{end}\n{v}\n{f}\n", vertices.len(), faces.len())
    }

    fn refused(text: &str) -> String {
        parse(Path::new("a.ply"), text.as_bytes()).unwrap_err().to_string()
    }

    const SQUARE: [&str; 4] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];

    #[test]
    fn ascii_and_both_binaries_are_the_same_mesh() {
        let text = ascii(&SQUARE, &["4 0 1 2 3"]);
        let mesh = parse(Path::new("a.ply"), text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        for (name, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
            let header_end = text.find("end_header\n").unwrap() + 11;
            let mut bytes = text[..header_end].replace("ascii", name).into_bytes();
            for [x, y, z] in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0_f32]] {
                let ordered = |b: &mut [u8]| {
                    if !little {
                        b.reverse();
                    }
                };
                let (mut xb, mut yb, mut zb) = (x.to_le_bytes(), f64::from(y).to_le_bytes(), z.to_le_bytes());
                [&mut xb[..], &mut yb[..], &mut zb[..]].into_iter().for_each(ordered);
                bytes.extend(xb.iter().chain(&yb).chain(&zb));
            }
            bytes.push(4);
            (0..4_i32).for_each(|i| bytes.extend(if little { i.to_le_bytes() } else { i.to_be_bytes() }));
            assert_eq!(parse(Path::new("a.ply"), &bytes).unwrap(), mesh, "{name}");
            for cut in 0..bytes.len() {
                assert!(parse(Path::new("a.ply"), &bytes[..cut]).is_err(), "cut at {cut}");
            }
        }
    }

    #[test]
    fn refusals_name_the_line_or_the_vertex_or_face() {
        let expect = |text: &str, part: &str| assert!(refused(text).contains(part), "{}", refused(text));
        let face = ["3 0 1 2"];
        expect(&ascii(&["0 0 0", "1 nan 0", "1 1 0"], &face), "a.ply:12: ");
        expect(&ascii(&["0 0 0", "1 1e60 0", "1 1 0"], &face), "vertex 1 has the number inf");
        expect(&ascii(&["0 0 0", "1 x 0", "1 1 0"], &face), "a.ply:12: ");
        expect(
            &ascii(&SQUARE, &["3 0 1 2", "3 0 1 4"]),
            "vertex index 4 of face 1 is out of range; 0 to 3 is accepted",
        );
        expect(&ascii(&SQUARE, &["3 0 1 -1"]), "a.ply:");
        expect(&ascii(&SQUARE, &["2 0 1"]), "face 0 has 2 vertices; 3 or more");
        expect("ply\nformat ascii 1.0\nend_header\n", "element 'vertex' has no property 'x'");
        expect("hello\n", "a.ply:1: ");
        let many = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nend_header\n";
        expect(many, "4000000000000 elements 'vertex' in a file of");
    }
}
