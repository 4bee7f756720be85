"""Render a scene with Mitsuba and with lightproof, both anew, and let `lightproof compare` judge.

    python scripts/compare_mitsuba.py                              # soft-shadow at 32 by 32
    python scripts/compare_mitsuba.py cornell --spp 512 --program target/release/lightproof

The status is that of `lightproof compare`: 0 where the images are the same within the bound, 1 where they are
not or that is undecided, 2 where something could not run. Only images are compared, so it doesn't matter here
that Mitsuba calls wi what we call wo.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import render_mitsuba


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", default="soft-shadow", help="a name in references/scenes, or a path")
    parser.add_argument("--program", default=str(render_mitsuba.ROOT / "target" / "release" / "lightproof"))
    parser.add_argument("--res", type=int, default=32)
    parser.add_argument("--spp", type=int, default=64, help="samples a pixel, a seed (an instant, with --instants)")
    parser.add_argument("--seeds", type=int, default=32, help="Mitsuba's seeds and our replicates")
    parser.add_argument("--instants", type=int, default=0, help="static instants a seed, where things move")
    parser.add_argument("--max-bias", default="0.5", metavar="PCT")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder) / "ours.exr", Path(folder) / "theirs.exr"
        status = render_mitsuba.main(mitsuba_arguments(options, theirs))
        for command in lightproof_commands(options, ours, theirs):
            if status != 0:
                return 2
            status = subprocess.run(command, check=False).returncode
        return status


def mitsuba_arguments(options, output):
    """The arguments for render_mitsuba."""
    return [options.scene, f"--res={options.res}", f"--spp={options.spp}", f"--seeds={options.seeds}",
            f"--instants={options.instants}", "-o", str(output)]


def lightproof_commands(options, ours, theirs):
    """Render as many samples as Mitsuba took, as many replicates as it has seeds; then compare."""
    path = render_mitsuba.parse([options.scene]).path
    samples = options.spp * options.seeds * max(options.instants, 1)
    render = [options.program, "render", str(path), f"-Dres={options.res}", "--spp", str(samples),
              "--replicates", str(options.seeds), "-o", str(ours)]
    compare = [options.program, "compare", str(ours), str(theirs), "--max-bias", options.max_bias]
    return [render, compare]


if __name__ == "__main__":
    sys.exit(main())
