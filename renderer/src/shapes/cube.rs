//! The cube as a mesh.

use super::MeshData;

/// Two triangles a face, each face with its own vertices, normal and texture square, as in Mitsuba's `cube`.
pub(super) fn data() -> MeshData {
    // Per face: outward normal, the axis along which u grows and the one along which v grows.
    let faces: [[[f32; 3]; 3]; 6] = [
        [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
        [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
        [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
    ];
    let mut mesh = MeshData::default();
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    for (face, [n, along_u, along_v]) in (0u32..).zip(faces) {
        for uv in [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            let [su, sv] = uv.map(|c| 2.0 * c - 1.0);
            mesh.positions.push(std::array::from_fn(|i| n[i] + su * along_u[i] + sv * along_v[i]));
            normals.push(n);
            uvs.push(uv);
        }
        let first = 4 * face;
        // u × v points inward, so the corners go round the other way.
        mesh.triangles.push([first, first + 2, first + 1]);
        mesh.triangles.push([first, first + 3, first + 2]);
    }
    mesh.normals = Some(normals);
    mesh.uvs = Some(uvs);
    mesh
}
