//! Triangle meshes from files, checked, with the normals that Mitsuba gives them.

use std::path::Path;

use glam::{DMat3, DVec3};

use super::{obj, ply, serialized};
use crate::Error;
use crate::shapes::MeshData;

/// A format of mesh files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront.
    Obj,
    /// Stanford.
    Ply,
    /// One mesh of Mitsuba's own format.
    Serialized {
        /// Which one, from 0.
        shape: u32,
    },
}

/// Reads the mesh of `format` whose file `path` has the content `bytes`. Every number is finite, every index exists, and
/// there is at least one triangle.
///
/// # Errors
/// `Error::Format`, with line and column or the number of the vertex or face.
pub fn parse(path: &Path, bytes: &[u8], format: MeshFormat) -> Result<MeshData, Error> {
    let mesh = match format {
        MeshFormat::Obj => obj::parse(path, bytes)?,
        MeshFormat::Ply => ply::parse(path, bytes)?,
        MeshFormat::Serialized { shape } => serialized::parse(path, bytes, shape)?,
    };
    if mesh.triangles.is_empty() {
        let message = "a mesh without faces; one face or more is accepted".into();
        return Err(Error::Format { path: path.into(), line: 0, column: 0, message });
    }
    Ok(mesh)
}

/// Normals at the vertices of `mesh` from the faces around them, weighted by the faces' angles there.
///
/// * `to_world`: the linear part of the mesh's transform; angles are those in the world.
///
/// Returns: normals in object space, of any length; a vertex without a face of positive area has +x. Faces turn counter-clockwise
/// in the world: a reflection turns the mesh inside out.
///
/// # Source
/// Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets", doi:10.1080/10867651.1998.10487487;
/// Mitsuba 3.9.1 does so for meshes that bring no normals.
///
/// # Verified by
/// `io::mesh::tests::normals_are_mitsubas`
pub fn vertex_normals(mesh: &MeshData, to_world: DMat3) -> Vec<[f32; 3]> {
    let world = |index: u32| to_world * DVec3::from(mesh.positions[index as usize].map(f64::from));
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let p = triangle.map(world);
        let Some(n) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize() else { continue };
        for corner in 0..3 {
            let [a, b] = [1, 2].map(|step| p[(corner + step) % 3] - p[corner]);
            normals[triangle[corner] as usize] += n * a.angle_between(b);
        }
    }
    let back = to_world.transpose();
    normals.into_iter().map(|n| (back * n.try_normalize().unwrap_or(DVec3::X)).as_vec3().to_array()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOLDED: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0\nv 0.5 1.5 1\nf 1 2 3 4 5\n";

    #[test]
    fn normals_are_mitsubas() {
        let mesh = parse(Path::new("a.obj"), FOLDED, MeshFormat::Obj).unwrap();
        let ours = vertex_normals(&mesh, DMat3::IDENTITY);
        // What Mitsuba 3.9.1 (scalar_rgb) computed for the same file, to three decimals.
        let theirs =
            [[0.309, -0.116, 0.944], [0.0, -0.196, 0.981], [-0.099, -0.099, 0.99], [0.915, 0.0, 0.404]];
        for (a, b) in ours.iter().flatten().zip(theirs.iter().flatten()) {
            assert!((a - b).abs() <= 0.5e-3 + f32::EPSILON, "{a} against {b}"); // half of the last decimal
        }
    }

    #[test]
    fn a_stretched_mesh_has_the_normals_of_its_image() {
        let mesh = parse(Path::new("a.obj"), FOLDED, MeshFormat::Obj).unwrap();
        let stretch = DMat3::from_diagonal(DVec3::new(1.0, 3.0, -0.5));
        let mut image = mesh.clone();
        for p in &mut image.positions {
            *p = (stretch * DVec3::from(p.map(f64::from))).as_vec3().to_array();
        }
        let direct = vertex_normals(&image, DMat3::IDENTITY);
        let mapped = vertex_normals(&mesh, stretch);
        for (a, b) in direct.iter().zip(&mapped) {
            let b = stretch.inverse().transpose() * DVec3::from(b.map(f64::from));
            let cos = DVec3::from(a.map(f64::from)).dot(b.normalize());
            assert!((cos - 1.0).abs() < 1e-6, "{cos}"); // f32 positions and normals
        }
    }

    #[test]
    fn an_empty_mesh_is_refused() {
        let message = parse(Path::new("a.obj"), b"v 0 0 0\n", MeshFormat::Obj).unwrap_err().to_string();
        assert_eq!(message, "a.obj: a mesh without faces; one face or more is accepted");
    }
}
