#!/usr/bin/env python3
"""Draws docs/six-methods.png: the asteroid by the six methods of the paper, one labelled crop each.

Run it in the project's folder after `make bunny`; it needs Pillow. Arguments: the command `isostudy`
and the picture to write; both may be left out.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

METHODS = [
    ("bu", "no clustering"),
    ("bi", "integrated clustering"),
    ("bp", "edge collapse"),
    ("su", "no clustering"),
    ("si", "integrated clustering"),
    ("sp", "edge collapse"),
]
LATTICES = {"b": "body-centred lattice", "s": "simple cubic lattice"}
FONT = "assets/fonts/DejaVuSans.ttf"
RENDERED = 1120  # pixels of the whole picture of a mesh, of which a crop is shown
CROP = (250, 290, 890, 810)  # left, upper, right, lower
SHOWN = (320, 260)
LABEL = 46
GAP = 8


def triangles(mesh):
    with open(mesh, "rb") as file:
        for line in file:
            if line.startswith(b"element face"):
                return int(line.split()[2])
    raise SystemExit(f"{mesh}: no faces")


def tiles(isostudy, folder):
    """Extracts the six meshes at the spacing of the paper's animations, and draws each with flat shading."""
    only = [word for method, _ in METHODS for word in ("--only", f"as_{method}")]
    subprocess.run([isostudy, "extract", "configs/paper.toml", *only, "-o", folder], check=True)
    for method, clustering in METHODS:
        mesh = folder / "meshes" / "stimulus" / f"as_{method}.ply"
        turn = folder / f"{method}.gif"
        look = ["--look", "flat", "--frames", "1", "--size", str(RENDERED)]
        subprocess.run([isostudy, "turntable", mesh, "-o", turn, *look], check=True)
        picture = Image.open(turn).convert("RGB").crop(CROP).resize(SHOWN, Image.Resampling.LANCZOS)
        lattice = LATTICES[method[0]]
        yield picture, f"{method}: {clustering}", f"{lattice}, {triangles(mesh):,} triangles"


def montage(tiles):
    width, height = SHOWN[0] + GAP, SHOWN[1] + LABEL + GAP
    sheet = Image.new("RGB", (3 * width + GAP, 2 * height + GAP), "white")
    draw = ImageDraw.Draw(sheet)
    bold, plain = ImageFont.truetype(FONT, 16), ImageFont.truetype(FONT, 13)
    for place, (picture, method, rest) in enumerate(tiles):
        x, y = GAP + place % 3 * width, GAP + place // 3 * height
        sheet.paste(picture, (x, y))
        draw.text((x + 2, y + SHOWN[1] + 3), method, "black", bold)
        draw.text((x + 2, y + SHOWN[1] + 24), rest, "#444444", plain)
    return sheet


def main():
    isostudy = sys.argv[1] if len(sys.argv) > 1 else "isostudy"
    picture = sys.argv[2] if len(sys.argv) > 2 else "docs/six-methods.png"
    with tempfile.TemporaryDirectory() as folder:
        sheet = montage(tiles(isostudy, Path(folder)))
    sheet.quantize(128, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(picture, optimize=True)
    print(picture)


if __name__ == "__main__":
    main()
