"""Look at our EXR files and filters through OpenImageIO, a reader and a filter library of other people.

    python scripts/compare_oiio.py A.exr                       # channels, sizes, header
    python scripts/compare_oiio.py A.exr B.exr --fail 0.01     # status 1 if the RMS difference is above 0.01
    python scripts/compare_oiio.py --filters FILTERS.csv       # status 1 if a value disagrees

The CSV has a header with at least the columns `filter,radius,x,value`: filter is box, tent, gaussian or
mitchell; radius is where the filter ends (box and tent: their radius; gaussian: 4 standard deviations;
mitchell: 2, with B = C = 1/3); x is the distance from the centre; value is f(x), not normalised: 1 at the
centre of box and tent, exp(-x²/2σ²) - exp(-8) for the Gaussian, and 8/9 at the centre of Mitchell's. All in
pixels and decimal. What OpenImageIO's filters of those names are: references/README.md.
"""

import argparse
import csv
import math
import sys

import OpenImageIO as oiio

NAMES = {"box": "box", "tent": "triangle", "gaussian": "gaussian", "mitchell": "mitchell"}
# OpenImageIO evaluates in single precision: ten operations of 6e-8 on values up to 1, with slopes up to 2.
ROUNDING = 1e-6
# Its exp is approximate, with a relative error up to 1.3e-5 (the largest of 1,000 values over the filter's
# support); `oracle` takes the fourth power.
EXP_ERROR = 4 * 1.3e-5


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("images", nargs="*", help="one image to describe, or two to compare")
    parser.add_argument("--fail", type=float, metavar="RMS", help="status 1 if the RMS difference is above this")
    parser.add_argument("--filters", metavar="FILE.csv", help="our filters' values, to hold against OpenImageIO's")
    options = parser.parse_args(arguments)
    if len(options.images) > 2 or not (options.images or options.filters):
        parser.error("one image, two images or --filters FILE.csv")
    try:
        return run(options)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2


def run(options):
    failed = False
    for path in options.images:
        describe(path)
    if len(options.images) == 2:
        failed |= not images_agree(*options.images, options.fail)
    if options.filters:
        failed |= not filters_agree(options.filters)
    return 1 if failed else 0


def opened(path):
    """An image as OpenImageIO reads it."""
    image = oiio.ImageBuf(path)
    if not image.read():
        raise OSError(f"{path}: {image.geterror()}")
    return image


def describe(path):
    """Print size, channels with their formats and header of an image."""
    spec = opened(path).spec()
    formats = [str(spec.channelformat(c)) for c in range(spec.nchannels)]
    print(f"{path}: {spec.width} x {spec.height}")
    print("  channels", " ".join(f"{n}:{f}" for n, f in zip(spec.channelnames, formats)))
    for attribute in spec.extra_attribs:
        print(f"  {attribute.name} = {attribute.value}")


def radiance(path):
    """The R, G and B channels alone."""
    image = opened(path)
    missing = {"R", "G", "B"} - set(image.spec().channelnames)
    if missing:
        raise ValueError(f"{path}: channel {sorted(missing)[0]} is missing; R, G and B are needed")
    return oiio.ImageBufAlgo.channels(image, ("R", "G", "B"))


def images_agree(first, second, limit):
    """Print OpenImageIO's measures of the difference; whether the RMS is within `limit` (None: always)."""
    a, b = radiance(first), radiance(second)
    if (a.spec().width, a.spec().height) != (b.spec().width, b.spec().height):
        raise ValueError(f"{first} and {second} differ in size")
    result = oiio.ImageBufAlgo.compare(a, b, math.inf, math.inf)
    print(f"mean error {result.meanerror:.6g}, RMS {result.rms_error:.6g}, PSNR {result.PSNR:.4g} dB, "
          f"max {result.maxerror:.6g} at ({result.maxx}, {result.maxy}) channel {'RGB'[result.maxc]}")
    return limit is None or result.rms_error <= limit


def oiio_filter(name, width, x):
    """OpenImageIO's 1-D filter of full width `width` at `x`.

    Its filters are reached through kernels: a kernel of one row samples the filter at whole pixels from its
    middle. The filters depend on x/width alone, so f(x; width) = f(1; width/|x|).
    """
    if x == 0.0:
        kernel = oiio.ImageBufAlgo.make_kernel(name, 1.0, 1.0, 1.0, False)
    else:
        kernel = oiio.ImageBufAlgo.make_kernel(name, width / abs(x), 1.0, 1.0, False)
    # A kernel is a product over its two axes, f(x; width)·f(0; 1), and that of one pixel is f(0)².
    peak = math.sqrt(oiio.ImageBufAlgo.make_kernel(name, 1.0, 1.0, 1.0, False).getpixel(0, 0)[0])
    offset = 0 if x == 0.0 else 1
    if offset >= kernel.roi.xend:
        return 0.0
    return kernel.getpixel(offset, 0)[0] / peak


def oracle(name, radius, x):
    """What OpenImageIO says our filter `name` is at `x`; None where its convention gives no answer."""
    if name not in NAMES:
        raise ValueError(f"filter {name}: {', '.join(NAMES)} are accepted")
    if name == "box" and abs(x) == radius:
        return None  # whether the edge belongs to the box is a convention
    if name != "gaussian":
        return oiio_filter(NAMES[name], 2.0 * radius, x)
    # Theirs of width w is exp(-8x²/w²), cut at w/2: ours before it is lowered by exp(-8) has w = 4σ = radius.
    # Theirs ends at half of our radius; beyond, exp(-x²/2σ²) is its value at x/2 to the fourth power.
    if abs(x) >= radius:
        return 0.0
    return oiio_filter("gaussian", radius, x / 2.0) ** 4 - math.exp(-8.0)


def allowance(name, value):
    """How far our value may be from OpenImageIO's `value` for reasons of its arithmetic."""
    return ROUNDING + (EXP_ERROR * (value + math.exp(-8.0)) if name == "gaussian" else 0.0)


def filters_agree(path):
    """Print the largest difference per filter, in units of what is allowed; whether all are allowed."""
    worst, counts = {}, {}
    with open(path, newline="") as file:
        rows = csv.DictReader(file)
        missing = {"filter", "radius", "x", "value"} - set(rows.fieldnames or ())
        if missing:
            raise ValueError(f"{path}: column {sorted(missing)[0]} is missing")
        for row in rows:
            theirs = oracle(row["filter"], float(row["radius"]), float(row["x"]))
            if theirs is not None:
                difference = abs(float(row["value"]) - theirs)
                share = difference / allowance(row["filter"], theirs)
                worst[row["filter"]] = max(worst.get(row["filter"], (-1.0, 0.0, "")), (share, difference, row["x"]))
                counts[row["filter"]] = counts.get(row["filter"], 0) + 1
    absent = set(NAMES) - set(counts)
    if absent:
        raise ValueError(f"{path}: no value of {', '.join(sorted(absent))}")
    for name, (share, difference, x) in worst.items():
        print(f"{name:9} {counts[name]} values, worst difference {difference:.2e} at x = {x}, {share:.2f} of what is allowed")
    return all(share <= 1.0 for share, _, _ in worst.values())


if __name__ == "__main__":
    sys.exit(main())
