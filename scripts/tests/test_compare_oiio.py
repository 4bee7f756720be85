import math

import numpy as np
import pytest

import compare_oiio
import reference_image as ri


def mitchell(x):
    a = abs(x)
    if a < 1:
        return (7 * a ** 3 - 12 * a ** 2 + 16 / 3) / 6
    return (-7 / 3 * a ** 3 + 12 * a ** 2 - 20 * a + 32 / 3) / 6 if a < 2 else 0.0


def gaussian(x):
    return max(0.0, math.exp(-2 * x * x) - math.exp(-8))


FILTERS = {  # name: radius, f; the Gaussian's deviation is 0.5
    "box": (0.5, lambda x: float(abs(x) <= 0.5)),
    "tent": (1.0, lambda x: max(0.0, 1 - abs(x))),
    "gaussian": (2.0, gaussian),
    "mitchell": (2.0, mitchell),
}


def filters_csv(path, change=None):
    """The four filters' values; `change` is a name and a function of its value."""
    lines = ["filter,radius,x,value"]
    for name, (radius, f) in FILTERS.items():
        for i in range(-110, 111):
            x = i / 100 * radius
            value = change[1](f(x)) if change and change[0] == name else f(x)
            lines.append(f"{name},{radius},{x!r},{value!r}")
    path.write_text("\n".join(lines) + "\n")
    return ["--filters", str(path)]


def test_the_formulas_are_openimageios(tmp_path):
    assert compare_oiio.main(filters_csv(tmp_path / "f.csv")) == 0


@pytest.mark.parametrize("name", FILTERS)
def test_a_filter_wrong_by_a_ten_thousandth_is_found(tmp_path, name):
    assert compare_oiio.main(filters_csv(tmp_path / "f.csv", (name, lambda v: v * 1.0001))) == 1


def test_a_file_without_a_filter_or_a_column_is_an_error(tmp_path):
    path = tmp_path / "f.csv"
    path.write_text("filter,radius,x,value\nbox,0.5,0,1\n")
    assert compare_oiio.main(["--filters", str(path)]) == 2
    path.write_text("filter,radius,x\nbox,0.5,0\n")
    assert compare_oiio.main(["--filters", str(path)]) == 2


def test_images_are_compared_by_their_rms(tmp_path, capsys):
    a, b = tmp_path / "a.exr", tmp_path / "b.exr"
    image = np.random.default_rng(3).random((8, 9, 3))
    ri.write_exr(a, image, np.zeros_like(image), 4, {})
    # stderr differs too, and must not count.
    ri.write_exr(b, image + 0.25, np.ones_like(image), 8, {})
    assert compare_oiio.main([str(a), str(a), "--fail", "0"]) == 0
    assert compare_oiio.main([str(a), str(b), "--fail", "0.2501"]) == 0
    assert compare_oiio.main([str(a), str(b), "--fail", "0.2499"]) == 1
    assert "R:float" in capsys.readouterr().out
    assert compare_oiio.main([str(a), str(tmp_path / "none.exr")]) == 2
