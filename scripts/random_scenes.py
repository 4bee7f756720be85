"""Random scenes of the plugins that both renderers know, rendered by both, and judged by `lightproof compare`.

    python scripts/random_scenes.py                           # twenty scenes
    python scripts/random_scenes.py --first 100 --scenes 50   # others
    python scripts/random_scenes.py --first 117 --scenes 1 --keep target/random

A scene follows from its number: a floor, some shapes under random transforms, reflections and instances among them, random
materials, lights and cameras. Not drawn is where Mitsuba 3.9.1 is known to mean something else or to be biased:

* `mask` under `path`: light points count with opacity²; under `direct` they are right, and drawn;
* `blendbsdf` with a smooth metal or plastic in it: not the mean of its two parts;
* emitters with interpolated normals, which emit on the side of those, and reflected cylinders that emit;
* emitters of `thindielectric` or `mask`: a path that goes straight through and meets nothing else loses their light;
* `hide_emitters` beside spheres and cylinders, which are shaded in a wrong place where a hidden emitter is before them;
* filters wider than a pixel: at borders of films Mitsuba has no samples from beyond.

Nor are orthographic sensors, irradiance meters, serialized meshes and motion, which other tests look at.

A table, a line a scene; status 1 if the images of any scene differ (`fails` at 1e-9), 2 where something could not run. Images that are too
noisy to be held to the bound are `undecided` and change no status.
"""

import argparse
import random
import subprocess
import sys
import tempfile
from pathlib import Path

from render_mitsuba import ROOT

SEEDS = 4  # of Mitsuba; ours takes as many samples in twice as many replicates
FILES = ROOT / "references" / "scenes"


class Scenes(random.Random):
    """Random parts of scenes, as text."""

    def value(self, tag, name, low, high):
        return f'<{tag} name="{name}" value="{self.uniform(low, high):.4f}"/>'

    def float(self, name, low, high):
        return self.value("float", name, low, high)

    def rgb(self, name, low=0.1, high=0.9):
        values = ", ".join(f"{self.uniform(low, high):.3f}" for _ in range(3))
        return f'<rgb name="{name}" value="{values}"/>'

    def string(self, name, *values):
        return f'<string name="{name}" value="{self.choice(values)}"/>'

    def boolean(self, name):
        return f'<boolean name="{name}" value="{self.choice(["true", "false"])}"/>'

    def maybe(self, text, probability=0.4):
        return text if self.random() < probability else ""

    def point(self, tag, name, *ranges):
        places = " ".join(f'{axis}="{self.uniform(*r):.3f}"' for axis, r in zip("xyz", ranges))
        return f'<{tag} name="{name}" {places}/>'

    def texture(self, name):
        places = (f'<scale x="{self.uniform(1, 6):.2f}" y="{self.uniform(1, 6):.2f}"/><rotate z="1" angle="{self.uniform(0, 360):.1f}"/>'
                  f'<translate x="{self.random():.2f}" y="{self.random():.2f}"/>')
        to_uv = f'<transform name="to_uv">{places}</transform>'
        board = f'<texture type="checkerboard" name="{name}">{self.rgb("color0")}{self.rgb("color1")}{to_uv}</texture>'
        options = self.string("filter_type", "bilinear", "nearest") + self.string("wrap_mode", "repeat", "mirror", "clamp") + self.boolean("raw")
        file = self.string("filename", FILES / "textures" / "patches.png")
        bitmap = f'<texture type="bitmap" name="{name}">{file}{options}{to_uv}</texture>'
        return self.choice([self.rgb(name), self.rgb(name), board, bitmap])

    def roughness(self):
        both = self.float("alpha_u", 0.15, 0.6) + self.float("alpha_v", 0.15, 0.6)
        return self.choice([self.float("alpha", 0.15, 0.6), both]) + self.string("distribution", "ggx", "beckmann")

    def metal(self):
        index = self.float("eta", 0.2, 2) + self.float("k", 1, 4)
        return self.choice([self.string("material", "Au", "Cu", "Al", "none"), index]) + self.maybe(self.texture("specular_reflectance"))

    def glass(self):
        index = self.choice([self.string("int_ior", "bk7", "water", "diamond"), self.float("int_ior", 1.1, 2)])
        return index + self.maybe(self.rgb("specular_reflectance")) + self.maybe(self.texture("specular_transmittance"))

    def coat(self):
        return self.float("int_ior", 1.2, 1.8) + self.texture("diffuse_reflectance") + self.boolean("nonlinear")

    def nested_bsdf(self):
        """One that others may hold: without mirrors, smooth plastics or glass."""
        kind = self.choice(["diffuse", "diffuse", "roughconductor", "roughplastic"])
        rough = self.float("alpha", 0.1, 0.6) + self.string("distribution", "ggx", "beckmann")
        parts = {
            "diffuse": lambda: self.texture("reflectance"),
            "roughconductor": lambda: self.metal() + self.roughness(),
            "roughplastic": lambda: self.coat() + rough,
        }
        return f'<bsdf type="{kind}">{parts[kind]()}</bsdf>'

    def bsdf(self, has_masks, emits=False):
        kinds = ["conductor", "dielectric", "roughdielectric", "plastic", "twosided", "blendbsdf"] + ["nested"] * 6
        kind = self.choice(kinds + ["mask"] * (has_masks and not emits) + ["thindielectric"] * (not emits))
        parts = {
            "conductor": self.metal,
            "dielectric": self.glass,
            "thindielectric": self.glass,
            "roughdielectric": lambda: self.float("int_ior", 1.2, 1.8) + self.roughness(),
            "plastic": self.coat,
            "twosided": lambda: self.nested_bsdf() + self.maybe(self.nested_bsdf()),
            "mask": lambda: self.float("opacity", 0.2, 0.8) + self.nested_bsdf(),
            "blendbsdf": lambda: self.float("weight", 0.2, 0.8) + self.nested_bsdf() + self.nested_bsdf(),
        }
        return self.nested_bsdf() if kind == "nested" else f'<bsdf type="{kind}">{parts[kind]()}</bsdf>'

    def transform(self, is_round, is_reflected):
        x, y, z = (self.uniform(0.4, 1.1) for _ in range(3))
        scale = f'<scale value="{x:.3f}"/>' if is_round else f'<scale x="{x:.3f}" y="{y:.3f}" z="{z:.3f}"/>'
        axis = [self.gauss(0, 1) for _ in range(3)]
        length = sum(a * a for a in axis) ** 0.5
        turn = " ".join(f'{name}="{a / length:.9f}"' for name, a in zip("xyz", axis))
        place = f'x="{self.uniform(-2, 2):.3f}" y="{self.uniform(0.5, 2):.3f}" z="{self.uniform(-2, 1.5):.3f}"'
        return (f'<transform name="to_world">{scale}{is_reflected * """<scale x="-1"/>"""}'
                f'<rotate {turn} angle="{self.uniform(0, 360):.1f}"/><translate {place}/></transform>')

    def shape(self, number, has_masks, emits=False):
        kind = self.choice(["sphere", "cube", "rectangle", "disk", "cylinder", "obj", "ply"])
        own = self.maybe('<boolean name="flip_normals" value="true"/>', 0.25)
        if kind in ("obj", "ply"):
            faces = '<boolean name="face_normals" value="true"/>' if emits else self.boolean("face_normals")
            own += self.string("filename", FILES / "meshes" / {"obj": "torus.obj", "ply": "gem.ply"}[kind]) + faces
        if kind == "cylinder":
            own += '<point name="p0" x="0" y="0" z="-0.6"/><point name="p1" x="0" y="0.1" z="0.6"/><float name="radius" value="0.5"/>'
        is_round = kind in ("sphere", "cylinder")
        place = self.transform(is_round, self.random() < 0.3 and not (emits and kind == "cylinder"))
        if emits:
            emitter = f'<emitter type="area">{self.rgb("radiance", 2, 6)}</emitter>'
            return f'<shape type="{kind}">{own}{place}{self.maybe(self.bsdf(has_masks, emits))}{emitter}</shape>'
        own += self.bsdf(has_masks)
        if self.random() < 0.8:
            return f'<shape type="{kind}">{own}{place}</shape>'
        turned = self.maybe(f'<transform name="to_world"><scale x="{self.choice([1, -1])}"/><rotate y="1" angle="40"/></transform>', 0.5)
        group = f'<shape type="shapegroup" id="group{number}"><shape type="{kind}">{own}{turned}</shape></shape>'
        return f'{group}<shape type="instance"><ref id="group{number}"/>{place}</shape>'

    def light(self, number, has_masks):
        turn = f'<rotate y="1" angle="{self.uniform(0, 360):.1f}"/><rotate x="1" angle="{self.uniform(0, 90):.1f}"/>'
        sky = self.string("filename", FILES / "textures" / "sky.png") + self.float("scale", 0.5, 2)
        above = f'origin="{self.uniform(-2, 2):.2f}, 5, {self.uniform(-2, 2):.2f}" target="0, 0.5, 0" up="0, 0, 1"'
        cone = self.float("cutoff_angle", 20, 50) + self.maybe(self.float("beam_width", 5, 19), 0.6)
        kinds = {
            "constant": self.rgb("radiance", 0.2, 1),
            "envmap": f'{sky}<transform name="to_world">{turn}</transform>',
            "point": self.point("point", "position", (-3, 3), (3, 6), (-2, 4)) + self.rgb("intensity", 5, 20),
            "directional": self.point("vector", "direction", (-1, 1), (-1, -1), (-1, 1)) + self.rgb("irradiance", 1, 3),
            "spot": f'<transform name="to_world"><lookat {above}/></transform>{cone}{self.rgb("intensity", 10, 40)}',
        }
        kind = self.choice(["area", "area", *kinds])
        return self.shape(number, has_masks, emits=True) if kind == "area" else f'<emitter type="{kind}">{kinds[kind]}</emitter>'

    def sensor(self):
        lens = self.random() < 0.3
        angle = self.float("fov", 30, 60) + self.string("fov_axis", "x", "y", "smaller", "larger", "diagonal")
        own = self.choice([angle, self.string("focal_length", "28mm", "40mm", "60mm")])
        if lens:
            own += self.float("aperture_radius", 0.05, 0.3) + self.float("focus_distance", 4, 8)
        view = (f'origin="{self.uniform(-2, 2):.2f}, {self.uniform(1, 4):.2f}, 6" target="0, 0.8, 0" '
                f'up="{self.uniform(-0.3, 0.3):.2f}, 1, 0"')
        width, height = self.choice([(48, 48), (64, 32), (32, 56)])
        sizes = {"width": width, "height": height}
        if self.random() < 0.25:
            sizes |= {"crop_offset_x": 8, "crop_offset_y": 4, "crop_width": 16, "crop_height": 24}
        film = "".join(f'<integer name="{name}" value="{value}"/>' for name, value in sizes.items())
        film = f'<film type="hdrfilm">{film}<string name="component_format" value="float32"/><rfilter type="box"/></film>'
        return f'<sensor type="{"thinlens" if lens else "perspective"}">{own}<transform name="to_world"><lookat {view}/></transform>{film}</sensor>'

    def scene(self):
        is_direct = self.random() < 0.25
        floor = '<scale value="6"/><rotate x="1" angle="-90"/>'
        parts = [self.sensor(),
                 f'<shape type="rectangle"><transform name="to_world">{floor}</transform><bsdf type="diffuse">{self.texture("reflectance")}</bsdf></shape>']
        parts += [self.shape(i, is_direct) for i in range(self.randint(2, 4))]
        lights = [self.light(10 + i, is_direct) for i in range(self.randint(1, 2))]
        skies = [light for light in lights if 'type="constant"' in light or 'type="envmap"' in light]
        # One sky at most, and a dim one at least, so that no image is black.
        parts += lights[:1] if len(skies) > 1 else lights
        if not skies:
            parts.append('<emitter type="constant"><rgb name="radiance" value="0.02"/></emitter>')
        depth = f'<integer name="max_depth" value="{self.choice([2, 3, 5, 8])}"/><integer name="rr_depth" value="100"/>'
        is_round = any(f'type="{kind}"' in part for part in parts for kind in ("sphere", "cylinder"))
        hidden = "" if is_round else self.maybe('<boolean name="hide_emitters" value="true"/>', 0.5)
        kind = "direct" if is_direct else "path"
        parts.insert(0, f'<integrator type="{kind}">{depth * (not is_direct)}{hidden}</integrator>')
        return '<scene version="3.0.0">\n' + "\n".join(parts) + "\n</scene>\n"


def mitsuba_images(path, spp, folder):
    """Renders the scene with Mitsuba from each seed; the files."""
    import mitsuba as mi
    import numpy as np

    scene = mi.load_file(str(path))
    files = []
    for seed in range(SEEDS):
        pixels = np.array(mi.render(scene, spp=spp, seed=seed + 1))[..., :3].astype(np.float32)
        files.append(str(folder / f"{path.stem}-mitsuba-{seed}.exr"))
        mi.Bitmap(pixels).write(files[-1])
    return files


def judged(number, options, folder):
    """The first words of `lightproof compare` about the scene `number`; of ours, what it said where it refused."""
    path = folder / f"{number}.xml"
    path.write_text(Scenes(number).scene())
    ours = str(folder / f"{number}-ours.exr")
    samples = ["--spp", str(SEEDS * options.spp), "--replicates", str(2 * SEEDS), "-o", ours]
    render = subprocess.run([options.program, "render", str(path), *samples], capture_output=True, text=True, check=False)
    if render.returncode != 0:
        return "could not run: " + render.stderr.strip()
    theirs = mitsuba_images(path, options.spp, folder)
    compare = [options.program, "compare", "--max-bias", options.max_bias, ours, "--", *theirs]
    result = subprocess.run(compare, capture_output=True, text=True, check=False)
    return (result.stdout or "could not run: " + result.stderr.strip()).splitlines()[0]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--scenes", type=int, default=20, help="how many")
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "lightproof"))
    parser.add_argument("--spp", type=int, default=256, help=f"samples a pixel of each of Mitsuba's {SEEDS} seeds")
    parser.add_argument("--max-bias", default="1", metavar="PCT")
    parser.add_argument("--variant", default="scalar_rgb", help="llvm_ad_rgb is faster and needs LLVM 16 or newer")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep scenes and images here")
    options = parser.parse_args(arguments)
    import mitsuba as mi

    mi.set_variant(options.variant)
    mi.set_log_level(mi.LogLevel.Error)
    status = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for number in range(options.first, options.first + options.scenes):
            words = judged(number, options, folder)
            print(f"{number:6}  {words}", flush=True)
            status = max(status, 1 if words.startswith("fails") else 2 if words.startswith("could not run") else 0)
    return status


if __name__ == "__main__":
    sys.exit(main())
