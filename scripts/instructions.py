#!/usr/bin/env python3
"""Counts the instructions of renders in which an effect is at its null value, and of the same scene without it.

Needs valgrind and the release build of the program. For each effect of ARCHITECTURE.md's second idea both scenes are
rendered by one thread under callgrind; reading the file and building the tree count too. A box filter takes no
radius in a file, so the filter's null value has no scene here. Status 1 if a pair differs by more than --limit percent or in any bit of the image.

    cargo build --release && python3 scripts/instructions.py
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

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


def count(program, folder, name, changes):
    """Instructions of one render, and the bytes of its image's pixels."""
    scene, image = folder / f"{name}.xml", folder / f"{name}.png"
    scene.write_text(SCENE.format(**{**PLAIN, **changes}))
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    command += [str(program), "render", str(scene), "-o", str(image), "--threads", "1"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found or int(found[1]) == 0:
        sys.exit(f"{name}: {' '.join(command)}\n{run.stderr}")
    return int(found[1]), image.read_bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("target/release/lightproof"))
    parser.add_argument("--limit", type=float, default=0.5, help="largest difference in percent")
    arguments = parser.parse_args()
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        for effect, (null, never) in PAIRS.items():
            sides = [(f"{effect}-null", null), (f"{effect}-never", never)]
            (a, image_a), (b, image_b) = (
                count(arguments.program, pathlib.Path(folder), name, changes) for name, changes in sides
            )
            percent = 100.0 * (a - b) / b
            same = image_a == image_b
            bad += abs(percent) > arguments.limit or not same
            print(f"{effect:16}  {a:>12}  {b:>12}  {percent:+.3f} %  {'same image' if same else 'ANOTHER IMAGE'}")
    print(f"{len(PAIRS) - bad} passed, {bad} failed")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
