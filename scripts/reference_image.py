"""Images with standard errors: their statistics, their EXR file, and the record beside it."""

import json
from pathlib import Path

import numpy as np
import OpenEXR

TILE = 16
CHANNELS = ("R", "G", "B")


def tile_sums(image, tile=TILE):
    """Sums over squares of `tile` pixels, those at the right and the bottom possibly smaller.

    * `image`: height by width by channels.
    Returns: rows of tiles by tiles a row by channels; rows from the top, as in the image.
    """
    rows = np.add.reduceat(np.asarray(image, dtype=np.float64), np.arange(0, image.shape[0], tile), axis=0)
    return np.add.reduceat(rows, np.arange(0, image.shape[1], tile), axis=1)


class Replicates:
    """Mean and standard error of images from independent seeds, and each seed's tile sums."""

    def __init__(self):
        self.count = 0
        self.tiles = []
        self._mean = 0.0
        self._squares = 0.0

    def add(self, image):
        """Take in one seed's image (height by width by 3), by Welford's update in f64."""
        image = np.asarray(image, dtype=np.float64)
        self.count += 1
        difference = image - self._mean
        self._mean = self._mean + difference / self.count
        self._squares = self._squares + difference * (image - self._mean)
        self.tiles.append(tile_sums(image))

    def mean(self):
        """The mean over seeds, pixel by pixel."""
        return self._mean

    def stderr(self):
        """The standard error of the mean, pixel by pixel: sample deviation over √seeds."""
        return np.sqrt(self._squares / (self.count - 1) / self.count)

    def pooled(self):
        """Mean over pixels and its standard error over seeds, per channel.

        The seeds' means are compared, not the pixels', so that noise which pixels share is counted.
        """
        pixels = self._mean.shape[0] * self._mean.shape[1]
        means = np.array(self.tiles).sum(axis=(1, 2)) / pixels
        return means.mean(axis=0), standard_error(means)

    def worst_tile(self):
        """The largest relative standard error of a tile's sum, over tiles that aren't black."""
        sums = np.array(self.tiles)
        means, errors = sums.mean(axis=0), standard_error(sums)
        return float((errors[means > 0] / means[means > 0]).max())


def standard_error(values):
    """The standard error of the mean along the first axis."""
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


def write_exr(path, mean, stderr, samples, attributes):
    """Write one part with FLOAT channels R G B stderr.R stderr.G stderr.B samples.

    * `samples`: samples per pixel over all seeds, the same in every pixel.
    * `attributes`: texts for the header.
    """
    planes = {c: mean[:, :, i] for i, c in enumerate(CHANNELS)}
    planes |= {f"stderr.{c}": stderr[:, :, i] for i, c in enumerate(CHANNELS)}
    planes["samples"] = np.full(mean.shape[:2], samples)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **attributes}
    channels = {k: np.ascontiguousarray(v, dtype=np.float32) for k, v in planes.items()}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))


def read_exr(path):
    """The header and the channels (name to height by width array) of an EXR file's first part."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return dict(file.header()), {name: channel.pixels.copy() for name, channel in file.channels().items()}


def write_record(path, replicates, provenance):
    """Write the JSON beside the image: what it is, how sure, each seed's tile sums; one seed a line."""
    mean, stderr = replicates.pooled()
    height, width, _ = replicates.mean().shape
    record = {
        "schema": 1,
        "image": Path(path).with_suffix(".exr").name,
        "width": width,
        "height": height,
        "seeds": replicates.count,
        "pooled_mean": mean.tolist(),
        "pooled_stderr": stderr.tolist(),
        "worst_tile_relative_stderr": replicates.worst_tile(),
        "provenance": provenance,
        "tile": TILE,
    }
    lines = [json.dumps([[[float(f"{v:.9g}") for v in tile] for tile in row] for row in seed]) for seed in replicates.tiles]
    text = json.dumps(record, indent=1)[:-2] + ',\n "tile_sums": [\n  ' + ",\n  ".join(lines) + "\n ]\n}\n"
    Path(path).write_text(text)


def read_record(path):
    """The JSON beside an image; `tile_sums` as an array over seeds, rows, columns, channels."""
    record = json.loads(Path(path).read_text())
    record["tile_sums"] = np.array(record["tile_sums"])
    return record
