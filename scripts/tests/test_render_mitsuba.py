import numpy as np
import pytest

import compare_oiio
import make_spectra
import reference_image as ri
import render_mitsuba


def test_the_image_and_its_record_agree(rendered):
    header, channels = ri.read_exr(rendered)
    record = ri.read_record(rendered.with_suffix(".json"))
    assert channels["R"].shape == (32, 32) and np.all(channels["samples"] == 512)
    assert header["lightproof.replicates"] == "32"
    assert record["tile_sums"].shape == (32, 2, 2, 3)
    image = np.stack([channels[c] for c in "RGB"], axis=2)
    # The EXR rounds to single precision, 6e-8 a pixel; sums are of positive numbers.
    assert np.abs(ri.tile_sums(image) / record["tile_sums"].mean(axis=0) - 1).max() < 1e-7
    assert record["provenance"]["version"] == "3.9.1"
    assert list(record["provenance"]["sha256"]) == ["soft-shadow.xml"]


def test_openimageio_reads_it(rendered):
    assert compare_oiio.main([str(rendered), str(rendered), "--fail", "0"]) == 0


def test_pixels_of_a_seed_are_independent(rendered):
    """If pixels shared noise, tiles would scatter more than their pixels' errors say."""
    _, channels = ri.read_exr(rendered)
    record = ri.read_record(rendered.with_suffix(".json"))
    variance = np.stack([channels[f"stderr.{c}"] for c in "RGB"], axis=2).astype(float) ** 2
    ratio = (ri.standard_error(record["tile_sums"]) ** 2 / ri.tile_sums(variance)).mean()
    # Four tiles, channels almost copies of each other: variances from 31 degrees of freedom scatter by √(2/31) = 25 %,
    # their mean by 13 %; five times that.
    assert abs(ratio - 1) < 0.65


def test_seeds_share_no_noise():
    """Residuals of different seeds don't correlate, at no small shift of pixels either."""
    options = render_mitsuba.parse(["soft-shadow", "--res=64", "--spp=4"])
    import mitsuba as mi
    mi.set_variant(options.variant)
    image_of = render_mitsuba.renderer(options)
    images = np.array([image_of(seed)[:, :, 0] for seed in range(8)])
    # Differences of disjoint pairs have no mean left, and are independent if the seeds are.
    differences = images[0::2] - images[1::2]
    scale = np.sqrt((differences ** 2).mean(axis=0))
    z = differences[:, scale > 0] / scale[scale > 0]
    for a in range(4):
        for b in range(a):
            for shift in (0, 1, 2, 64):
                product = z[a] * np.roll(z[b], shift)
                # A mean of n products over its own deviation is normal for 4,000 pixels; 24 looks at 6: 5e-8 in all.
                assert abs(product.mean()) < 6 * product.std() / np.sqrt(product.size)
    # The same seed is the same image.
    assert np.array_equal(images[3], image_of(3)[:, :, 0])


def test_static_instants_average_to_the_motion(tmp_path):
    path = tmp_path / "moving.exr"
    arguments = ["moving", "--res=16", "--spp=1", "--seeds=2", "-o", str(path)]
    assert render_mitsuba.main(arguments) == 2
    assert render_mitsuba.main([*arguments, "--instants=8"]) == 0
    _, channels = ri.read_exr(path)
    assert np.all(channels["samples"] == 16) and np.all(channels["R"] >= 0)


def test_another_filter_replaces_the_scenes():
    """A wide filter shares samples between pixels: neighbours correlate, the box's don't."""
    correlations = {}
    for kind in ("box", "gaussian"):
        options = render_mitsuba.parse(["soft-shadow", "--res=32", "--spp=2", f"--rfilter={kind}"])
        image_of = render_mitsuba.renderer(options)
        noise = np.array([(image_of(2 * k) - image_of(2 * k + 1))[20:, :, 0] for k in range(8)])
        correlations[kind] = np.corrcoef(noise[:, :, 1:].ravel(), noise[:, :, :-1].ravel())[0, 1]
    # 2,976 pairs: a correlation is known to 0.018. Independent pixels: 0; five deviations are 0.09. Mitsuba's Gaussian
    # (deviation 0.5, so that neighbours share exp(-1) of their weight): 0.37 before it is lowered to end at zero.
    assert abs(correlations["box"]) < 0.09 and correlations["gaussian"] > 0.37 - 0.09


def test_a_rewritten_scene_is_the_same_scene():
    """Putting the box filter where there is one changes no bit: includes, names and files came through."""
    images = []
    for extra in ([], ["--rfilter=box"]):
        options = render_mitsuba.parse(["textured", "--res=32", "--spp=2", *extra])
        images.append(render_mitsuba.renderer(options)(0))
    assert np.array_equal(*images)


def test_a_single_seed_is_refused():
    with pytest.raises(SystemExit):
        render_mitsuba.parse(["cornell", "--seeds=1"])


def test_the_committed_colour_tables_are_mitsubas():
    assert make_spectra.main(["--check"]) == 0
