"""Render a scene with Mitsuba 3.9.1 from many independent seeds, and keep the error with the image.

    python scripts/render_mitsuba.py cornell                        # references/scenes/cornell.xml
    python scripts/render_mitsuba.py moving --instants 64 --spp 4   # mean over static instants
    python scripts/render_mitsuba.py PATH.xml -Dres=128 --rfilter box -o OUT.exr

Writes NAME.exr (channels R G B stderr.R stderr.G stderr.B samples) and NAME.json (each seed's sums over
16 by 16 tiles, provenance) to references/mitsuba, or where -o says. Layouts: references/README.md.
"""

import argparse
import datetime
import hashlib
import json
import sys
from pathlib import Path

import drjit
import mitsuba as mi
import numpy as np

import reference_image
import scene_xml

ROOT = Path(__file__).resolve().parent.parent
# Mitsuba's seeds are not taken one after the other. Its scalar variants start the random stream of pixel p at state
# seed·(pixels of the film) + p of one linear congruential sequence, modulo 2^32, and equally spaced streams are
# correlated: with 1 sample a pixel the tiles of successive seeds are by more than 10 standard errors. Seeds from a
# permutation are not equally spaced, and those below 2^18 have different streams for films up to 128 by 128.
# The llvm variants hash the seed; there it makes no difference.
MITSUBA_SEEDS = np.random.default_rng(0).permutation(2 ** 18)


def renderer(options):
    """A function from a seed to its image: of the file as it is, or the mean over static instants."""
    if not (options.rfilter or options.instants):
        scene = mi.load_file(str(options.path), **options.parameters)
        return lambda seed: one_render(scene, options.spp, seed)
    root, _ = scene_xml.read(options.path, options.parameters)
    if options.rfilter:
        root = scene_xml.with_filter(root, options.rfilter)
    if not options.instants:
        scene = mi.load_string(scene_xml.to_text(root))
        return lambda seed: one_render(scene, options.spp, seed)
    return lambda seed: mean_over_instants(root, options, seed)


def mean_over_instants(root, options, seed):
    """The mean of static renders at times spread over the shutter's interval."""
    times = instants(*scene_xml.shutter(root), options.instants, seed)
    total = 0.0
    for k, time in enumerate(times):
        scene = mi.load_string(scene_xml.to_text(scene_xml.at_instant(root, time)))
        total = total + one_render(scene, options.spp, seed * options.instants + k)
    return total / options.instants


def instants(opens, closes, count, seed):
    """One uniform time in each of `count` equal parts of the shutter's interval: unbiased for any count."""
    jitter = np.random.default_rng(seed).random(count)
    return opens + (np.arange(count) + jitter) / count * (closes - opens)


def one_render(scene, spp, seed):
    """Mitsuba's image in f64; raises on a value that isn't finite."""
    image = np.array(mi.render(scene, spp=spp, seed=int(MITSUBA_SEEDS[seed])), dtype=np.float64)[:, :, :3]
    if not np.isfinite(image).all():
        raise ValueError(f"Mitsuba gave a value that isn't finite, seed {seed}")
    return image


def provenance(options, files):
    """Where the image comes from: program, command, seeds, and a hash of every file read."""
    folder = options.path.parent
    hashes = {f.relative_to(folder).as_posix() if f.is_relative_to(folder) else f.name:
              hashlib.sha256(f.read_bytes()).hexdigest() for f in files}
    return {
        "renderer": "Mitsuba",
        "version": mi.__version__,
        "variant": options.variant,
        "drjit": drjit.__version__,
        "command": command(options),
        "first_seed": options.first_seed,
        "spp_per_seed": options.spp * max(options.instants, 1),
        "instants_per_seed": options.instants,
        "rfilter": options.rfilter or "as in the scene",
        "parameters": options.parameters,
        "date": datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
        "sha256": hashes,
    }


def command(options):
    """The command that makes the image again, without this machine's folders."""
    words = ["python", "scripts/render_mitsuba.py", options.scene if options.named else options.path.name]
    words += [f"--spp={options.spp}", f"--seeds={options.seeds}", f"--variant={options.variant}"]
    words += [f"--first-seed={options.first_seed}"] if options.first_seed else []
    words += [f"--instants={options.instants}"] if options.instants else []
    words += [f"--rfilter={options.rfilter}"] if options.rfilter else []
    return " ".join(words + [f"-D{k}={v}" for k, v in options.parameters.items()])


def attributes(options, record):
    """What goes into the EXR's header, as text; the number of replicates under the name that `lightproof` reads."""
    return {
        "renderer": f"Mitsuba {record['version']} {record['variant']}",
        "scene": options.path.name,
        "scene_sha256": next(iter(record["sha256"].values())),
        "command": record["command"],
        "lightproof.replicates": str(options.seeds),
        "first_seed": str(options.first_seed),
        "spp": str(options.seeds * record["spp_per_seed"]),
    }


def parse(arguments):
    """The command line, with the scene's path and its overridden parameters."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", help="a name in references/scenes, or a path")
    parser.add_argument("-o", "--output", type=Path, help="the EXR file; the JSON goes beside it")
    parser.add_argument("-D", dest="define", action="append", default=[], metavar="name=value")
    parser.add_argument("--res", type=int, help="the same as -Dres=N; 128 for a named scene")
    parser.add_argument("--spp", type=int, default=64, help="samples a pixel, a seed (an instant, with --instants)")
    parser.add_argument("--seeds", type=int, default=32)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--instants", type=int, default=0, help="static instants a seed; needed where things move")
    parser.add_argument("--rfilter", help="replaces the film's reconstruction filter, box for instance")
    parser.add_argument("--variant", default="scalar_rgb", help="llvm_ad_rgb is faster and needs LLVM 16 or newer")
    parser.add_argument("--threads", type=int, default=0, help="0 for all")
    options = parser.parse_args(arguments)
    if options.seeds < 2:
        parser.error("--seeds: at least 2, else there is no error to state")
    options.named = not options.scene.endswith(".xml")
    options.path = (ROOT / "references" / "scenes" / f"{options.scene}.xml" if options.named
                    else Path(options.scene)).resolve()
    options.output = options.output or ROOT / "references" / "mitsuba" / f"{options.path.stem}.exr"
    options.parameters = dict(d.split("=", 1) for d in options.define)
    if options.res or options.named:
        options.parameters.setdefault("res", str(options.res or 128))
    return options


def main(arguments=None):
    options = parse(arguments)
    mi.set_variant(options.variant)
    mi.set_log_level(mi.LogLevel.Error)
    if options.threads:
        drjit.set_thread_count(options.threads)
    root, files = scene_xml.read(options.path, options.parameters)
    if scene_xml.moves(root) and not options.instants:
        print(f"{options.path.name}: things move; say --instants K", file=sys.stderr)
        return 2
    replicates = reference_image.Replicates()
    image_of = renderer(options)
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        replicates.add(image_of(seed))
    record = provenance(options, files)
    samples = options.seeds * record["spp_per_seed"]
    reference_image.write_exr(options.output, replicates.mean(), replicates.stderr(), samples, attributes(options, record))
    reference_image.write_record(options.output.with_suffix(".json"), replicates, record)
    mean, stderr = replicates.pooled()
    print(json.dumps({"image": options.output.name, "pooled_mean": mean.tolist(),
                      "pooled_relative_stderr": (stderr / mean).tolist(),
                      "worst_tile_relative_stderr": replicates.worst_tile()}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
