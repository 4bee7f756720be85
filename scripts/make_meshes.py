"""Write the meshes and the bitmap that references/scenes use and that aren't published data.

    python scripts/make_meshes.py          # writes references/scenes/meshes, references/scenes/textures
"""

import struct
import sys
import zlib
from pathlib import Path

import numpy as np

SCENES = Path(__file__).resolve().parent.parent / "references" / "scenes"


def torus(rings=48, sides=24, radius=0.62, tube=0.22):
    """A torus about the z axis: vertices, unit normals, texture coordinates, quads (index rows)."""
    u, v = np.meshgrid(np.arange(rings + 1) / rings, np.arange(sides + 1) / sides, indexing="ij")
    a, b = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    normals = np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)], axis=1)
    centres = radius * np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], axis=1)
    i, j = (g.ravel() for g in np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij"))
    corner = i * (sides + 1) + j
    quads = np.stack([corner, corner + sides + 1, corner + sides + 2, corner + 1], axis=1)
    return centres + tube * normals, normals, np.stack([u.ravel(), v.ravel()], axis=1), quads


def gem(levels=3):
    """An icosahedron, each face cut in four `levels` times, its vertices pushed to uneven radii."""
    g = (1 + 5 ** 0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
              (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    for _ in range(levels):
        points, faces = subdivided(points, faces)
    p = np.array(points)
    wave = np.cos(5 * p[:, 0]) * np.cos(4 * p[:, 1] + 1) * np.cos(6 * p[:, 2] + 2)
    return p * (1 + 0.12 * wave)[:, None], np.array(faces)


def subdivided(points, faces):
    """Four faces for each, with the new vertices on the unit sphere."""
    points, midpoints, result = list(points), {}, []

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in midpoints:
            p = points[a] + points[b]
            points.append(p / np.linalg.norm(p))
            midpoints[key] = len(points) - 1
        return midpoints[key]

    for a, b, c in faces:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        result += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return points, result


def obj_text(vertices, normals, coordinates, quads):
    """A Wavefront OBJ file of triangles, with normals and texture coordinates."""
    lines = ["# Written by scripts/make_meshes.py"]
    lines += ["v {:.5f} {:.5f} {:.5f}".format(*v) for v in vertices]
    lines += ["vt {:.5f} {:.5f}".format(*c) for c in coordinates]
    lines += ["vn {:.5f} {:.5f} {:.5f}".format(*n) for n in normals]
    for quad in quads + 1:
        for triangle in ((0, 1, 2), (0, 2, 3)):
            lines.append("f " + " ".join(f"{quad[k]}/{quad[k]}/{quad[k]}" for k in triangle))
    return "\n".join(lines) + "\n"


def ply_bytes(vertices, faces):
    """A binary little-endian PLY file."""
    header = ("ply\nformat binary_little_endian 1.0\ncomment Written by scripts/make_meshes.py\n"
              f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
              f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    body = vertices.astype("<f4").tobytes()
    return header.encode() + body + b"".join(struct.pack("<B3i", 3, *face) for face in faces)


def patches(width=12, height=8):
    """Eight-bit colours without any symmetry: a gradient each way, and every third texel darkened."""
    y, x = np.mgrid[0:height, 0:width]
    rgb = np.stack([40 + 16 * x, 60 + 22 * y, 210 - 9 * x - 6 * y], axis=2)
    rgb[(x + 2 * y) % 3 == 0] //= 2
    return rgb.astype(np.uint8)


def sky(width=32, height=16):
    """A sky by latitude and longitude: blue above, brown below, a bright window and a green one."""
    rows, columns = np.mgrid[0:height, 0:width]
    up = rows[:, :, None] < height // 2
    rgb = np.where(up, [110, 140, 190], [90, 75, 60]) + 2 * (columns % 5)[:, :, None]
    rgb[3:5, 10:13] = 255
    rgb[9, 25:27] = [60, 220, 90]
    return rgb.astype(np.uint8)


def png_bytes(rgb):
    """An eight-bit RGB PNG file without a colour profile (read as sRGB)."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = rgb.shape
    rows = b"".join(b"\0" + row.tobytes() for row in rgb)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def main():
    for folder in ("meshes", "textures"):
        (SCENES / folder).mkdir(parents=True, exist_ok=True)
    (SCENES / "meshes" / "torus.obj").write_text(obj_text(*torus()))
    (SCENES / "meshes" / "gem.ply").write_bytes(ply_bytes(*gem()))
    (SCENES / "textures" / "patches.png").write_bytes(png_bytes(patches()))
    (SCENES / "textures" / "sky.png").write_bytes(png_bytes(sky()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
