"""The committed references belong to the committed scenes and are as sure as the claims on them need."""

import copy
import hashlib
import xml.etree.ElementTree as ElementTree

import mitsuba as mi
import numpy as np
import pytest

import make_meshes
import reference_image as ri
import scene_xml
from render_mitsuba import ROOT

SCENES = sorted((ROOT / "references" / "scenes").glob("*.xml"))
RECORDS = sorted((ROOT / "references" / "mitsuba").glob("*.json"))


@pytest.mark.parametrize("path", SCENES, ids=lambda p: p.stem)
def test_mitsuba_loads_the_scene_and_its_transforms_are_what_we_read(path):
    """Mitsuba's boxes of the shapes are those after our own reading of the transforms."""
    mi.set_variant("scalar_rgb")
    root, _ = scene_xml.read(path, {"res": "8", "spp": "1"})
    if scene_xml.moves(root):
        root = scene_xml.at_instant(root, 0.0)
    ours, theirs = boxes(with_matrices(root)), boxes(root)
    assert ours.shape == theirs.shape and len(theirs) >= 3
    # The order of shapes isn't kept. Distances between all pairs of boxes, and the nearest of each.
    distances = np.abs(ours[:, None] - theirs[None]).max(axis=2)
    # Products of up to four single-precision matrices against one rounded from f64: 4 · 4 roundings of 6e-8.
    assert max(distances.min(axis=0).max(), distances.min(axis=1).max()) < 1e-6 * max(np.abs(theirs).max(), 1.0)


def boxes(root):
    """The bounding boxes of the shapes that Mitsuba makes of the tree, six numbers each."""
    found = [shape.bbox() for shape in mi.load_string(scene_xml.to_text(root)).shapes()]
    return np.array([[*box.min, *box.max] for box in found])


def with_matrices(root):
    """The tree with each shape's transform replaced by the one matrix that we make of it."""
    root = copy.deepcopy(root)
    for shape in root.iter("shape"):
        for transform in shape.findall("transform"):
            matrix = scene_xml.matrix_of(transform)
            for operation in list(transform):
                transform.remove(operation)
            ElementTree.SubElement(transform, "matrix", value=" ".join(map(repr, matrix.ravel().tolist())))
    return root


@pytest.mark.parametrize("path", RECORDS, ids=lambda p: p.stem)
def test_the_reference_is_of_the_committed_scene(path):
    record = ri.read_record(path)
    for name, digest in record["provenance"]["sha256"].items():
        file = ROOT / "references" / "scenes" / name
        assert hashlib.sha256(file.read_bytes()).hexdigest() == digest, f"{name} changed: render it again"


@pytest.mark.parametrize("path", RECORDS, ids=lambda p: p.stem)
def test_the_reference_is_sure_enough_and_agrees_with_its_record(path):
    record = ri.read_record(path)
    mean, stderr = np.array(record["pooled_mean"]), np.array(record["pooled_stderr"])
    assert record["seeds"] >= 32
    assert np.all(stderr / mean < 3e-4) and record["worst_tile_relative_stderr"] < 5e-3
    _, channels = ri.read_exr(path.with_suffix(".exr"))
    image = np.stack([channels[c] for c in "RGB"], axis=2)
    sums = record["tile_sums"].mean(axis=0)
    # Single precision in the image, 6e-8 a pixel, and nine digits in the record.
    assert np.abs(ri.tile_sums(image) - sums).max() <= 1e-7 * sums.max()


@pytest.mark.parametrize("path", RECORDS, ids=lambda p: p.stem)
def test_seeds_and_pixels_of_the_reference_are_independent(path):
    record = ri.read_record(path)
    _, channels = ri.read_exr(path.with_suffix(".exr"))
    variance = np.stack([channels[f"stderr.{c}"] for c in "RGB"], axis=2).astype(float) ** 2
    tiles, pixels = ri.standard_error(record["tile_sums"]) ** 2, ri.tile_sums(variance)
    # About 50 tiles with 31 or more degrees of freedom, channels not counted: the mean of their ratios is known to
    # √(2/31/50) = 3.6 %, six times that.
    lit = pixels > 0
    assert abs((tiles[lit] / pixels[lit]).mean() - 1) < 0.22
    for lag in (1, 2, 3):
        assert abs(seed_correlation(record["tile_sums"], lag)) < 6


def seed_correlation(tile_sums, lag):
    """Correlation of a tile's noise between seeds `lag` apart, in units of its own standard deviation."""
    seeds = tile_sums.sum(axis=-1).reshape(len(tile_sums), -1)
    noise = seeds - seeds.mean(axis=0)
    noise = noise[:, noise.std(axis=0) > 1e-9 * seeds.max()]
    products = noise[lag:] * noise[:-lag] / noise.var(axis=0)
    # Subtracting the mean makes the expectation -1/seeds; the mean of n products of unit variance is known to 1/√n.
    return (products.mean() + 1 / len(seeds)) * np.sqrt(products.size)


def test_seeds_that_share_half_their_noise_with_the_one_before_are_found():
    rng = np.random.default_rng(4)
    fresh = rng.normal(size=(33, 8, 8, 3))
    # Half of each variance is the seed's before: a correlation of ½, which 31·64 products see as 22 deviations.
    assert abs(seed_correlation(10 + fresh, 1)) < 6
    assert seed_correlation(10 + fresh[1:] + fresh[:-1], 1) > 6


def test_meshes_and_bitmap_are_those_of_the_script():
    scenes = ROOT / "references" / "scenes"
    # Text with five decimals: sines may differ in the last bit between machines, not in the fifth decimal.
    assert (scenes / "meshes" / "torus.obj").read_text() == make_meshes.obj_text(*make_meshes.torus())
    vertices, faces = make_meshes.gem()
    data = (scenes / "meshes" / "gem.ply").read_bytes()
    written = np.frombuffer(data[data.index(b"end_header\n") + 11:][:12 * len(vertices)], dtype="<f4")
    # A unit in the last place of single precision below 2.
    assert np.abs(written.reshape(-1, 3) - vertices).max() < 2.0 ** -23
    assert data.endswith(make_meshes.ply_bytes(vertices, faces)[-13 * len(faces):])
    texels = mi.Bitmap(str(scenes / "textures" / "patches.png"))
    assert np.array_equal(np.array(texels), make_meshes.patches())
