#!/usr/bin/env python3
"""Count instructions: of effects at their null values, which cost nothing, and of scenes, which cost no more than they did.

    cargo build --release && python scripts/instructions.py        # both checks
    python scripts/instructions.py --update "why it costs more"    # records the scenes' counts anew

Needs valgrind and the release build of the program; one thread under callgrind, where a count is the same every time.
For each effect of ARCHITECTURE.md's second idea the scene with the effect at its null value and the scene without it are
rendered; reading the file and building the tree count too. A box filter takes no radius in a file, so the filter's null
value has no scene here. Status 1 if a pair differs by more than --limit percent or in any bit of the image, or if a scene
takes over --growth percent more instructions than references/bench/instructions.json says.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from tables import ROOT, write

SCENE = """<scene version="3.0.0">
  <integrator type="{integrator}">{depth}</integrator>
  <sensor type="{sensor}">
    <float name="fov" value="40"/>{lens}{shutter}
    <transform name="to_world"><lookat origin="0.3, 1.5, 4" target="0, 0.6, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm">
      <integer name="width" value="24"/><integer name="height" value="24"/>
      <string name="pixel_format" value="rgb"/><string name="component_format" value="float32"/>
      <rfilter type="box"/>
    </film>
    <sampler type="sobol"><integer name="sample_count" value="16"/></sampler>
  </sensor>
  <shape type="sphere">
    <point name="center" x="0" y="0.5" z="0"/><float name="radius" value="0.5"/>{motion}
    {ball}
  </shape>
  <shape type="rectangle">
    <bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.5"/></bsdf>
    <transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform>
  </shape>
  <shape type="rectangle">
    <bsdf type="diffuse"><rgb name="reflectance" value="0, 0, 0"/></bsdf>
    <emitter type="area"><rgb name="radiance" value="5, 5, 5"/></emitter>
    <transform name="to_world"><scale value="0.8"/><rotate x="1" angle="90"/><translate y="2.5"/></transform>
  </shape>
  {more}
</scene>
"""

PLAIN = {
    "integrator": "path",
    "depth": '<integer name="max_depth" value="3"/>',
    "sensor": "perspective",
    "lens": "",
    "shutter": "",
    "motion": "",
    "ball": '<bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.7, 0.7"/></bsdf>',
    "more": "",
}

BLACK_BALL = """<shape type="sphere"><point name="center" x="1" y="0.3" z="0.5"/><float name="radius" value="0.3"/>
  <bsdf type="diffuse"><rgb name="reflectance" value="0, 0, 0"/></bsdf>{}</shape>"""
GLASS_BALL = """<shape type="sphere"><point name="center" x="0.2" y="0.7" z="1.5"/><float name="radius" value="0.4"/>
  <bsdf type="dielectric"><float name="int_ior" value="1"/><float name="ext_ior" value="1"/></bsdf></shape>"""
SLIDE = """<animation name="to_world"><transform time="0"></transform>
  <transform time="1"><translate x="0.5"/></transform></animation>"""
RADIANCE = '<emitter type="area"><rgb name="radiance" value="0, 0, 0"/></emitter>'
METAL = '<bsdf type="{}"><rgb name="eta" value="0.2, 0.9, 1.1"/><rgb name="k" value="3.9, 2.4, 2.2"/>{}</bsdf>'
DEPTH_2 = {"depth": '<integer name="max_depth" value="2"/>'}

# Effect: what differs from the plain scene where the effect is at its null value, and where it isn't mentioned.
PAIRS = {
    "lens": (
        {
            "sensor": "thinlens",
            "lens": '<float name="aperture_radius" value="0"/><float name="focus_distance" value="3"/>',
        },
        {},
    ),
    "shutter": (
        {
            "shutter": '<float name="shutter_open" value="0"/><float name="shutter_close" value="0"/>',
            "motion": SLIDE,
        },
        {},
    ),
    "area-light": ({"more": BLACK_BALL.format(RADIANCE)}, {"more": BLACK_BALL.format("")}),
    "rough": (
        {"ball": METAL.format("roughconductor", '<string name="distribution" value="ggx"/><float name="alpha" value="0"/>')},
        {"ball": METAL.format("conductor", "")},
    ),
    "dielectric": ({"more": GLASS_BALL}, {}),
    "inter-reflection": (DEPTH_2, {"integrator": "direct", "depth": ""}),
}


# Scenes of references/scenes that stand for the hot paths, at 24 pixels a side.
HOT = ["cornell", "soft-shadow", "thin-lens", "moving", "glass"]

BASELINE = ROOT / "references" / "bench" / "instructions.json"


def count(program, scene, image, *options):
    """Instructions of one render, and the bytes of its image's pixels."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    command += [str(program), "render", str(scene), "-o", str(image), "--threads", "1", *options]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found or int(found[1]) == 0:
        sys.exit(f"{scene}: {' '.join(command)}\n{run.stderr}")
    return int(found[1]), image.read_bytes()


def null_effects(program, folder, limit):
    """How many effects cost something at their null values, or change the image."""
    bad = 0
    for effect, pair in PAIRS.items():
        found = []
        for side, changes in zip(("null", "never"), pair):
            scene = folder / f"{effect}-{side}.xml"
            scene.write_text(SCENE.format(**{**PLAIN, **changes}), encoding="utf-8")
            found.append(count(program, scene, scene.with_suffix(".png")))
        (a, image_a), (b, image_b) = found
        percent = 100.0 * (a - b) / b
        same = image_a == image_b
        bad += abs(percent) > limit or not same
        print(f"{effect:16}  {a:>12}  {b:>12}  {percent:+.3f} %  {'same image' if same else 'ANOTHER IMAGE'}")
    return bad


def hot_counts(program, folder):
    """Instructions of each scene of HOT."""
    place = ROOT / "references" / "scenes"
    small = ("-D", "res=24", "--spp", "16")
    return {name: count(program, place / f"{name}.xml", folder / f"{name}.png", *small)[0] for name in HOT}


def grown(counts, baseline, growth):
    """The scenes whose count is over `growth` percent above the baseline's; all are printed."""
    bad = 0
    for name, instructions in counts.items():
        percent = 100.0 * (instructions / baseline[name] - 1.0)
        bad += percent > growth
        word = "GREW: make it less, or --update with the reason" if percent > growth else ""
        print(f"{name:16}  {instructions:>12}  {baseline[name]:>12}  {percent:+.3f} %  {word}")
    return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "target" / "release" / "lightproof")
    parser.add_argument("--limit", type=float, default=0.5, help="largest cost of a null value in percent (default: 0.5)")
    parser.add_argument("--growth", type=float, default=2.0, help="largest growth of a scene in percent (default: 2)")
    parser.add_argument("--update", metavar="REASON", help="record the scenes' counts, and why they changed")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        counts = hot_counts(options.program, pathlib.Path(folder))
        if options.update:
            write(BASELINE, {"reason": options.update, "counts": counts})
            return 0
        baseline = json.loads(BASELINE.read_text(encoding="utf-8"))["counts"]
        bad = grown(counts, baseline, options.growth)
        bad += null_effects(options.program, pathlib.Path(folder), options.limit)
    print(f"{len(HOT) + len(PAIRS) - bad} passed, {bad} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
