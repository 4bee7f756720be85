import numpy as np
import pytest

import reference_image as ri


def test_tile_sums_add_up_and_partial_tiles_stay_apart():
    image = np.arange(20 * 35 * 3, dtype=float).reshape(20, 35, 3)
    sums = ri.tile_sums(image)
    assert sums.shape == (2, 3, 3)
    # Sums of whole numbers below 2^53 are exact in f64.
    assert np.array_equal(sums[0, 1], image[:16, 16:32].sum(axis=(0, 1)))
    assert np.array_equal(sums[1, 2], image[16:, 32:].sum(axis=(0, 1)))
    assert np.array_equal(sums.sum(axis=(0, 1)), image.sum(axis=(0, 1)))


def normal_images(count, shared=0.0, mean=2.0):
    """Images of normal noise of deviation 0.3 about `mean`; `shared` is the deviation that an image's pixels share."""
    rng = np.random.default_rng(1)
    for _ in range(count):
        yield mean + rng.normal(0, 0.3, (32, 32, 3)) + rng.normal(0, shared)


def replicates(images):
    result = ri.Replicates()
    for image in images:
        result.add(image)
    return result


def test_means_and_errors_are_those_of_the_whole_list():
    images = list(normal_images(16))
    found = replicates(images)
    # Welford's update against two passes: both round a few times per seed, 16 · 2^-52 each, far below 1e-13.
    assert np.abs(found.mean() - np.mean(images, axis=0)).max() < 1e-13
    assert np.abs(found.stderr() - np.std(images, axis=0, ddof=1) / 4).max() < 1e-13


def test_the_pooled_error_covers_the_truth_as_often_as_it_says():
    found = replicates(normal_images(64))
    mean, stderr = found.pooled()
    # Truth: 0.3 / √(1024·64) = 0.001172; the estimate from 64 seeds scatters by 1/√126 = 9 %, five times that is 45 %.
    assert np.all(np.abs(stderr / (0.3 / 256) - 1) < 0.45)
    # The mean lies within six of its errors (2e-8 for Student's t with 63 degrees of freedom: 1e-7).
    assert np.all(np.abs(mean - 2.0) < 6 * stderr)


def test_noise_that_pixels_share_counts_in_the_pooled_error():
    _, alone = replicates(normal_images(64)).pooled()
    _, shared = replicates(normal_images(64, shared=0.3)).pooled()
    # Deviation 0.3 a seed against 0.3/32: 32 times larger, known to 13 % (two estimates of 9 %); five times that.
    assert np.all(np.abs(shared / alone / 32 - 1) < 0.65)


def test_exr_and_record_read_back(tmp_path):
    rng = np.random.default_rng(2)
    mean, stderr = rng.random((18, 20, 3)), rng.random((18, 20, 3))
    path = tmp_path / "a.exr"
    ri.write_exr(path, mean, stderr, 4096, {"command": "x", "lightproof.replicates": "8"})
    header, channels = ri.read_exr(path)
    assert set(channels) == {"R", "G", "B", "stderr.R", "stderr.G", "stderr.B", "samples"}
    assert header["lightproof.replicates"] == "8"
    for i, name in enumerate("RGB"):
        assert channels[name].dtype == np.float32
        assert np.array_equal(channels[name], mean[:, :, i].astype(np.float32))
        assert np.array_equal(channels[f"stderr.{name}"], stderr[:, :, i].astype(np.float32))
    assert np.all(channels["samples"] == 4096)

    found = replicates(normal_images(4))
    ri.write_record(tmp_path / "a.json", found, {"renderer": "none"})
    record = ri.read_record(tmp_path / "a.json")
    assert record["tile_sums"].shape == (4, 2, 2, 3)
    # Nine significant digits.
    assert np.abs(record["tile_sums"] / np.array(found.tiles) - 1).max() < 5e-9
    assert record["pooled_mean"] == found.pooled()[0].tolist()


def test_one_seed_has_no_error():
    with pytest.warns(RuntimeWarning), np.errstate(invalid="warn"):
        error = ri.standard_error(np.ones((1, 3)))
    assert np.isnan(error).all()
