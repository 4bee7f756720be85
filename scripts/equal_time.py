"""Error at equal time beside Mitsuba: variance x seconds of both programs, on the scenes of benches/scenes.

    python scripts/equal_time.py                           # every scene, 64 samples a pixel
    python scripts/equal_time.py direct cornell --rounds 5 --mesh target/tmp/mesh.ply

The variance of a pixel's value, averaged over pixels and channels, is that over independent seeds at 128 by 128 pixels.
The seconds are those of a render at 512 by 512, medians over rounds in which both programs take turns; reading the
scene and Mitsuba's compilation aren't counted. Mitsuba (llvm_ad_rgb) has each of its samplers, and the one of least
variance x seconds stands for it. Ours has one set of points a pixel (--replicates 1), as Mitsuba has, and gives pixels
samples by their error (--allocate), the pilot's included, with the same mean number; with --even each has that number.
Ours is rendered in four ways, with a line for each: as it is, with paths that neighbours share (--reuse), with both
branches at glass as well, and where a scene calls for them with paths from lights, too (--light-paths). Shared paths give neighbours errors in common, which the variance of a pixel doesn't see: the
last column is the same ratio for means of blocks of 8 by 8 pixels.
On a busy machine --clock cpu compares seconds of processor time, start-up taken off.

Mitsuba needs LLVM's shared library, 16 or newer: the file in DRJIT_LIBLLVM_PATH, or one that the system finds. The mesh is written by
`cargo bench -p benches --bench shading -- --test`.
"""

import argparse
import ctypes.util
import glob
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import reference_image

ROOT = Path(__file__).resolve().parent.parent
SCENES = ("direct", "cornell", "dof", "glass", "mesh")
SAMPLERS = ("independent", "stratified", "multijitter", "ldsampler")
WAYS = {"alone": [], "reuse": ["--reuse"], "reuse+both": ["--reuse", "--branch=both"]}
LIGHTS = "lights+reuse+both"
WAYS[LIGHTS] = ["--light-paths", *WAYS["reuse+both"]]
CAUSTICS = ("glass",)
BLOCK = 8


def find_llvm():
    """The path of LLVM's shared library, where Dr.Jit would not look by itself; None if there is none of version 16 or newer (with 15, Mitsuba aborts)."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    if named:
        return named
    for version in range(22, 15, -1):
        installed = sorted(glob.glob(f"/usr/lib/llvm-{version}/lib/libLLVM*.so*"))
        found = ctypes.util.find_library(f"LLVM-{version}") or next(iter(installed), None)
        if found:
            return found
    return None


def processor_seconds(who):
    """Processor time so far of this process (RUSAGE_SELF) or of those it has waited for (RUSAGE_CHILDREN)."""
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def variances(images):
    """Of a pixel's value over images, the mean of pixels and channels; and of the means of blocks of pixels."""
    images = np.array(images)
    count, height, width, channels = images.shape
    blocks = images.reshape(count, height // BLOCK, BLOCK, width // BLOCK, BLOCK, channels).mean(axis=(2, 4))
    return [float(values.var(axis=0, ddof=1).mean()) for values in (images, blocks)]


class Mitsuba:
    """Renders of one scene by Mitsuba with one sampler."""

    def __init__(self, scene, sampler, options):
        import mitsuba as mi

        self.mi, self.spp = mi, options.spp
        parameters = {"spp": options.spp, "sampler": sampler, **options.parameters(scene)}
        self.scenes = {res: mi.load_file(str(options.path(scene)), res=res, **parameters) for res in (128, 512)}
        self.image(128, 0)  # compiles

    def image(self, res, seed):
        """The image of a seed in f64."""
        return np.array(self.mi.render(self.scenes[res], spp=self.spp, seed=seed), dtype=np.float64)[:, :, :3]

    def variances(self, seeds):
        """Of a pixel, and of a block's mean."""
        return variances([self.image(128, seed) for seed in range(seeds)])

    def seconds(self, seed):
        """Of the clock and of processor time for a render at 512 by 512."""
        wall, cpu = time.perf_counter(), processor_seconds(resource.RUSAGE_SELF)
        self.image(512, seed)
        return time.perf_counter() - wall, processor_seconds(resource.RUSAGE_SELF) - cpu


class Lightproof:
    """Renders of one scene by the program of this repository."""

    def __init__(self, scene, way, options):
        self.command = [options.program, "render", str(options.path(scene)), "--replicates=1", "--sampler=sobol"]
        self.more = WAYS[way] + ([] if options.even else ["--allocate"])
        self.command += [f"-D{name}={value}" for name, value in options.parameters(scene).items()]
        self.spp = options.spp
        with tempfile.TemporaryDirectory() as folder:
            self.start = self.render(Path(folder), 1, options.spp, 0)[1]

    def render(self, folder, res, spp, seed):
        """The seconds of a render: as the program says, and of processor time; the image is folder/ours.exr."""
        cpu = processor_seconds(resource.RUSAGE_CHILDREN)
        options = [f"-Dres={res}", f"--spp={spp}", f"--seed={seed}", "-o", str(folder / "ours.exr")]
        options += self.more
        run = subprocess.run(self.command + options, capture_output=True, text=True, check=False)
        said = re.search(r", ([\d.]+) s$", run.stderr, re.MULTILINE)
        if run.returncode != 0 or not said:
            sys.exit(f"{' '.join(self.command + options)}\n{run.stderr}")
        return float(said[1]), processor_seconds(resource.RUSAGE_CHILDREN) - cpu

    def image(self, seed):
        """The image of a seed at 128 by 128."""
        with tempfile.TemporaryDirectory() as folder:
            self.render(Path(folder), 128, self.spp, seed)
            _, channels = reference_image.read_exr(Path(folder) / "ours.exr")
        return np.stack([channels[c] for c in "RGB"], axis=2).astype(np.float64)

    def variances(self, seeds):
        """Of a pixel, and of a block's mean."""
        return variances([self.image(seed) for seed in range(seeds)])

    def seconds(self, seed):
        """Of the clock and of processor time for a render at 512 by 512."""
        with tempfile.TemporaryDirectory() as folder:
            wall, cpu = self.render(Path(folder), 512, self.spp, seed)
        return wall, cpu - self.start


def compare(scene, options):
    """The table's lines of a scene: Mitsuba's best sampler beside each of our ways, in one run."""
    ways = [way for way in options.ways if way != LIGHTS or scene in CAUSTICS]
    ours = {way: Lightproof(scene, way, options) for way in ways}
    theirs = {sampler: Mitsuba(scene, sampler, options) for sampler in options.samplers}
    everyone = [*ours.items(), *theirs.items()]
    seconds = {name: [] for name, _ in everyone}
    clock = 0 if options.clock == "wall" else 1
    for k in range(options.rounds):
        for name, renderer in everyone:
            seconds[name].append(renderer.seconds(k)[clock])
    seconds = {name: statistics.median(rounds) for name, rounds in seconds.items()}
    variance = {name: renderer.variances(options.seeds) for name, renderer in everyone}
    best = min(theirs, key=lambda name: variance[name][0] * seconds[name])
    product = {name: f"{variance[name][0]:.2e} x {seconds[name]:.2f} s" for name, _ in everyone}

    def line(way):
        better = [variance[best][i] * seconds[best] / (variance[way][i] * seconds[way]) for i in (0, 1)]
        return f"| {scene} | {best} | {product[best]} | {way} | {product[way]} | {better[0]:.2f} | {better[1]:.2f} |"

    return "\n".join(map(line, ours))


class Options(argparse.Namespace):
    """The command line, and what it says of a scene."""

    def path(self, scene):
        """The scene's file."""
        return ROOT / "benches" / "scenes" / f"{scene}.xml"

    def parameters(self, scene):
        """What is set in the scene's file."""
        return {"ply": str(Path(self.mesh).resolve())} if scene == "mesh" else {}


def parse(arguments):
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="of benches/scenes; all by default")
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "lightproof"))
    parser.add_argument("--mesh", default=str(ROOT / "target" / "tmp" / "mesh.ply"), help="the mesh of the scene mesh")
    parser.add_argument("--samplers", nargs="+", default=SAMPLERS, choices=SAMPLERS, help="Mitsuba's")
    parser.add_argument("--ways", nargs="+", default=tuple(WAYS), choices=tuple(WAYS), help="ours")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--clock", choices=["wall", "cpu"], default="wall")
    parser.add_argument("--even", action="store_true", help="ours with the same number of samples for each pixel")
    parser.add_argument("--threads", type=int, default=0, help="of Mitsuba; 0 for all, as ours")
    options = parser.parse_args(arguments, namespace=Options())
    if options.seeds < 2 or options.rounds < 1:
        parser.error("--seeds: at least 2, else there is no variance; --rounds: at least 1")
    unknown = [scene for scene in options.scenes if scene not in SCENES]
    if unknown:
        parser.error(f"{unknown[0]}: one of {', '.join(SCENES)} is accepted")
    options.scenes = tuple(options.scenes) or SCENES
    return options


def main(arguments=None):
    options = parse(arguments)
    llvm = find_llvm()
    if not llvm:
        print("no LLVM library of version 16 or newer: name it in DRJIT_LIBLLVM_PATH (Debian: libllvm19)", file=sys.stderr)
        return 2
    os.environ["DRJIT_LIBLLVM_PATH"] = llvm
    import drjit
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    if options.threads:
        drjit.set_thread_count(options.threads)
    theirs = f"Mitsuba {mi.__version__}: variance x {options.clock}"
    print(f"| scene | Mitsuba's sampler | {theirs} | our way | ours | better by | blocks |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for scene in options.scenes:
        print(compare(scene, options), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
