#!/usr/bin/env python3
"""Renders the reference scenes with Lightproof and puts them side by side: the README's picture."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parent.parent
SCENES = ["cornell", "glass", "thin-lens", "moving", "mesh", "textured"]
SIDE = 192
GAP = 4


def render(program: str, scene: str, spp: int, folder: Path) -> oiio.ImageBuf:
    """The picture of a scene, SIDE pixels wide and high."""
    picture = folder / f"{scene}.png"
    command = [program, "render", str(ROOT / f"references/scenes/{scene}.xml"), f"-Dres={SIDE}", "--spp", str(spp)]
    subprocess.run([*command, "-o", str(picture)], check=True)
    return oiio.ImageBuf(str(picture))


def montage(pictures: list[oiio.ImageBuf]) -> oiio.ImageBuf:
    """The pictures in a row of white gaps."""
    width = len(pictures) * (SIDE + GAP) - GAP
    row = oiio.ImageBuf(oiio.ImageSpec(width, SIDE, 3, oiio.UINT8))
    oiio.ImageBufAlgo.fill(row, (1.0, 1.0, 1.0))
    for place, picture in enumerate(pictures):
        oiio.ImageBufAlgo.paste(row, place * (SIDE + GAP), 0, 0, 0, picture)
    return row


def main(arguments: list[str]) -> int:
    """The program."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "target/release/lightproof"), help="lightproof")
    parser.add_argument("--spp", type=int, default=512, help="samples a pixel")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "references/gallery.png", help="the picture")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        pictures = [render(options.program, scene, options.spp, Path(folder)) for scene in SCENES]
        row = montage(pictures)
    if not row.write(str(options.output)):
        print(f"error: {options.output}: {row.geterror()}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
