"""The tables of references/stability are those of the script as it is, and right where a second formula says so."""

import csv
import math

import make_oracles
from mpmath import mp, mpf


def table(name):
    """The rows of a committed table: inputs as the binary numbers they are, values to all their digits."""
    inputs = next(row[1].split() for row in make_oracles.TABLES if row[0] == name)
    lines = (make_oracles.OUT / f"{name}.csv").read_text().splitlines()
    assert make_oracles.source_hash() in lines[0]
    return [{k: mpf(float(v) if k in inputs else v) for k, v in row.items()} for row in csv.DictReader(lines[1:])]


def test_what_is_committed_is_what_the_script_gives():
    assert make_oracles.main(["--check"]) == 0


def test_values_have_fifty_digits_and_inputs_are_single_precision():
    line = (make_oracles.OUT / "ggx.csv").read_text().splitlines()[3]
    cells = line.split(",")
    assert all(make_oracles.single(float(c)) == float(c) for c in cells[:5])
    # Zeros at the end are not written: five of them once in 10⁵ values.
    assert 45 <= len(cells[5].split("e")[0].replace(".", "")) <= 50


def test_one_minus_cos_is_twice_the_square_of_half_the_sine():
    for row in table("one_minus_cos"):
        expected = 2 * mp.sin(mp.asin(mp.sqrt(row["sin2"])) / 2) ** 2
        # One is written to 50 digits.
        assert abs(row["value"] - expected) <= mpf(10) ** -49 * expected


def test_power_is_kept_at_a_boundary():
    for row in table("dielectric"):
        assert abs(row["reflectance"] + row["transmittance"] - 1) < mpf(10) ** -49


def test_a_conductor_that_does_not_absorb_is_a_dielectric():
    for row in table("conductor"):
        if row["k"] == 0 and row["cos_i"] > 0 and row["eta"] > 0:
            assert abs(row["reflectance"] - make_oracles.fresnel(row["cos_i"], row["eta"])[0]) < mpf(10) ** -49


def test_small_triangles_have_the_solid_angle_of_their_projected_area():
    for row in table("triangle_solid_angle"):
        a, b, c = ([row[v + i] for i in "xyz"] for v in "abc")
        size = make_oracles.length(make_oracles.minus(b, a)) + make_oracles.length(make_oracles.minus(c, a))
        if size < 1e-4:
            volume = abs(make_oracles.dot(a, make_oracles.cross(b, c)))
            centre = make_oracles.length([x + y + z for x, y, z in zip(a, b, c)]) / 3
            # The projected area over the squared distance, to first order in the size.
            assert abs(row["sr"] / (volume / 2 / centre ** 3) - 1) < 4 * size


def test_a_square_overhead_fills_the_share_that_its_height_says():
    for row in table("rectangle_solid_angle"):
        assert 0 < row["sr"] < 2 * math.pi
