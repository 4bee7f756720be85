"""Renders scenes that `lightproof analytic` wrote by Mitsuba and holds them against their exact images.

    python scripts/compare_analytic.py SCENES [--program target/release/lightproof] [NAME …]

SCENES is the folder of `lightproof analytic`; the names default to eight scenes of different effects. Each is rendered from several
seeds, which tell their own errors, and `lightproof compare` judges them. Status 1 if one is not the same.
"""
import argparse
import pathlib
import subprocess
import sys

import mitsuba as mi

NAMES = ["edge-box", "zone-plate", "lit-by-rectangle", "lit-by-sphere", "penumbra", "ball-shadow", "defocused-edge", "furnace"]

SEEDS = 32

# Largest difference of the means in percent: that of the claims, 0.2 % of a scene's scale, where half of the image is bright.
MAX_BIAS = 0.4


def render(scene: pathlib.Path, seed: int, spp: int, out: pathlib.Path) -> None:
    """One image of a scene from a seed."""
    image = mi.render(mi.load_file(str(scene)), spp=spp, seed=seed)
    mi.Bitmap(image).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False).write(str(out))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", type=pathlib.Path)
    parser.add_argument("names", nargs="*", default=NAMES)
    parser.add_argument("--program", default="target/release/lightproof")
    parser.add_argument("--spp", type=int, default=1024)
    args = parser.parse_args()
    mi.set_variant("scalar_rgb")
    status = 0
    for name in args.names:
        files = [args.scenes / f"{name}-mitsuba-{seed}.exr" for seed in range(SEEDS)]
        for seed, file in enumerate(files):
            render(args.scenes / f"{name}.xml", seed, args.spp, file)
        command = [args.program, "compare", "--max-bias", str(MAX_BIAS), *map(str, files)]
        result = subprocess.run([*command, "--", str(args.scenes / f"{name}.exr")], capture_output=True, text=True)
        print(f"{name}: {result.stdout.strip() or result.stderr.strip()}", flush=True)
        status = max(status, result.returncode)
    return status


if __name__ == "__main__":
    sys.exit(main())
