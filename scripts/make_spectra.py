"""Write the colour tables of references/spectra from Mitsuba 3.9.1.

The tables are what a reader of scene files needs to turn a wavelength spectrum
into linear sRGB as Mitsuba's rgb variants do, and Mitsuba's own results, to
which such a reader must agree. `rule` is the rule itself in Python: the oracle
tables are written only if it reproduces Mitsuba's values to 1e-5.

    python scripts/make_spectra.py             # writes references/spectra/*.csv
    python scripts/make_spectra.py --check     # compares them with what is committed
"""

import argparse
import csv
import io
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mitsuba as mi
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "references" / "spectra"
WAVELENGTHS = np.arange(360.0, 831.0, 5.0)
# 1 / sum of the observer's y over the table, as published with the tables.
Y_NORMALIZATION = 1.0 / 106.7502593994140625
# Makes the D65 table integrate to a luminance of 1.
D65_NORMALIZATION = 1.0 / 98.99741751876255
# Linear sRGB (ITU-R BT.709 primaries, D65 white) from CIE XYZ.
XYZ_TO_SRGB = np.array([
    [3.240479, -1.537150, -0.498535],
    [-0.969256, 1.875991, 0.041556],
    [0.055648, -0.204043, 1.057311],
])
# The largest difference between the rule and Mitsuba, relative to max(1, |value|).
AGREEMENT = 1e-5


def tables():
    """The observer x, y, z (n by 3) and D65 (n, published units) at 360, 365 ... 830 nm."""
    observer = np.array([list(mi.cie1931_xyz(float(w))) for w in WAVELENGTHS], dtype=np.float32)
    normalized = np.array([mi.cie_d65(float(w)) for w in WAVELENGTHS], dtype=np.float32)
    # CIE publishes D65 with at most six significant digits; single precision keeps seven.
    d65 = np.array([float(f"{v / D65_NORMALIZATION:.6g}") for v in normalized.astype(float)])
    if np.abs(d65 * D65_NORMALIZATION - normalized).max() > 2.0 ** -23:
        raise ValueError("the rounded D65 table is not the one that Mitsuba uses")
    return observer, d65


def rule(wavelengths, values, d65, bounded):
    """Linear sRGB of a spectrum given by a list; see references/spectra/README.md."""
    observer, illuminant = tables()
    w = 360.0 + np.arange(1000) / 999.0 * 470.0
    v = np.interp(w, wavelengths, values)
    v[(w < wavelengths[0]) | (w > wavelengths[-1])] = 0.0
    if d65:
        v = v * np.interp(w, WAVELENGTHS, illuminant * D65_NORMALIZATION)
    curves = np.stack([np.interp(w, WAVELENGTHS, observer[:, k].astype(float)) for k in range(3)])
    rgb = XYZ_TO_SRGB @ (curves @ v * (470.0 / 1000.0 * Y_NORMALIZATION))
    return np.clip(rgb, 0.0, 1.0 if bounded else np.inf)


def parse_spectrum(text):
    """The wavelengths and values of Mitsuba's `w:v, w:v …`."""
    pairs = [p.split(":") for p in text.replace(",", " ").split()]
    return [float(a) for a, _ in pairs], [float(b) for _, b in pairs]


def loaded(xml, *parameters):
    """The values, as three numbers, of the named parameters of a scene given as text."""
    scene = mi.traverse(mi.load_string(f'<scene version="3.0.0">{xml}</scene>'))
    keys = [next(k for k in scene.keys() if k.endswith(f"{p}.value")) for p in parameters]
    return [np.broadcast_to(np.ravel(np.array(scene[k], dtype=np.float64)), 3) for k in keys]


def sphere(bsdf):
    """A sphere of the given material, as text."""
    return f'<shape type="sphere">{bsdf}</shape>'


def from_mitsuba(kind, text):
    """Mitsuba's own linear sRGB of a spectrum in the place that `kind` names."""
    if kind == "emission":
        return loaded(f'<emitter type="constant"><spectrum name="radiance" value="{text}"/></emitter>', "radiance")[0]
    plugin, parameter = {"index": ("roughconductor", "eta"), "reflectance": ("diffuse", "reflectance")}[kind]
    bsdf = f'<bsdf type="{plugin}"><spectrum name="{parameter}" value="{text}"/></bsdf>'
    return loaded(sphere(bsdf), parameter)[0]


def spectra():
    """Name, kind and list of the Cornell box's spectra, and of a few made to meet every clamp."""
    tree = ElementTree.parse(ROOT / "references" / "scenes" / "cornell.xml")
    for bsdf in tree.iter("bsdf"):
        if bsdf.get("id"):
            yield bsdf.get("id"), "reflectance", bsdf.find("spectrum").get("value")
    yield "light_radiance", "emission", tree.find(".//emitter/spectrum").get("value")
    for kind in ("reflectance", "emission", "index"):
        yield "ramp", kind, "400:0.2, 700:3"
        yield "narrow_band", kind, "480:0.9, 500:1, 520:0.9"
        yield "wider_than_the_observer", kind, "300:1, 900:1"


def oracle():
    """The rows of cbox_rgb.csv; raises where the rule and Mitsuba disagree."""
    rows = []
    for name, kind, text in spectra():
        theirs = from_mitsuba(kind, text)
        ours = rule(*parse_spectrum(text), d65=kind != "emission", bounded=kind == "reflectance")
        difference = np.abs(ours - theirs).max() / max(1.0, np.abs(theirs).max())
        print(f"{name:24} {kind:12} {theirs}  largest difference {difference:.1e}")
        if difference > AGREEMENT:
            raise ValueError(f"{name}: the rule gives {ours}, Mitsuba {theirs}")
        rows.append([name, kind, *(digits(v) for v in theirs), " ".join(text.replace(",", " ").split())])
    return rows


def metals():
    """The rows of metals_rgb.csv: refractive indices of Mitsuba's named conductors."""
    folder = Path(mi.__file__).parent / "data" / "ior"
    rows = []
    for path in sorted(folder.glob("*.eta.spd")):
        name = path.name.removesuffix(".eta.spd")
        bsdf = f'<bsdf type="conductor"><string name="material" value="{name}"/></bsdf>'
        eta, k = loaded(sphere(bsdf), "eta", "k")
        rows.append([name, *(digits(v) for v in eta), *(digits(v) for v in k)])
    return rows


def digits(value):
    """The shortest decimal that is the same single-precision number."""
    return np.format_float_positional(np.float32(value), unique=True, trim="0")


def as_csv(header, rows):
    """The text of a CSV file."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def files():
    """Every file's name and text."""
    observer, d65 = tables()
    curves = [[f"{w:.0f}", *(digits(v) for v in xyz), repr(float(d))]
              for w, xyz, d in zip(WAVELENGTHS, observer, d65)]
    return {
        "cie1931_d65.csv": as_csv(["wavelength_nm", "x", "y", "z", "d65"], curves),
        "cbox_rgb.csv": as_csv(["name", "kind", "r", "g", "b", "spectrum"], oracle()),
        "metals_rgb.csv": as_csv(["name", "eta_r", "eta_g", "eta_b", "k_r", "k_g", "k_b"], metals()),
    }


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; status 1 if a file differs")
    options = parser.parse_args(arguments)
    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    differs = False
    for name, text in files().items():
        path = OUT / name
        if not options.check:
            path.write_text(text)
        elif path.read_text() != text:
            print(f"{path} differs from what Mitsuba {mi.__version__} gives")
            differs = True
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main())
