#!/usr/bin/env python3
"""Draws the pictures of docs/: tiles that isostudy rendered, one label each, and the figure of edge groups.

Usage: scripts/docs-pictures.py [ISOSTUDY [PICTURE...]]

ISOSTUDY is the command, `isostudy` if left out; PICTURE one of six-methods, surfaces, cubes-methods, edge-groups and labels, all if
left out. Run it in the project's folder; it needs Pillow. surfaces and labels need `scripts/fetch-samples.sh` first.
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

# What docs/surfaces.md lists under "Files that were tried".
SURFACES = [
    ("CT of a chest, bone", ["--volume", "ct_chest.nrrd", "--isovalue", "200.5"]),
    ("MNI152 brain", ["--volume", "mni152_t1.toml", "--isovalue", "60.5"]),
    ("robot's foot, 58 holes", ["--mesh", "robot_link0.stl", "--allow-open"]),
    ("palm of a hand, 7 holes", ["--mesh", "hand_palm.stl", "--allow-open"]),
]
SAMPLES = Path("cache/samples")

# Of docs/methods.md. A surface with bends and ambiguous cells, so coarse that each triangle is seen.
TANGLE = ["--field", "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8", "--bounds=-2.6,-2.6,-2.6,2.6,2.6,2.6", "--cells", "16"]
CUBES = [
    ("mc", "fans of triangles"),
    ("mc-edge-groups", "by a table"),
    ("mc-quality", "best diagonals"),
    ("mc33", "trilinear"),
    ("snapmc", "drawn to points"),
    ("macet", "edges turned"),
]
# Of the figure of edge groups in docs/cubes.md.
TABLES = ["mc", "mc-edge-groups", "hull", "mc-quality", "su", "bu"]
# Two drops whose neck runs through the middle cell from corner to corner: there it is decided by more than signs.
DROPS = [
    *("--field", "((x-0.5)^2+(y+0.5)^2+(z-0.5)^2)*((x+0.5)^2+(y-0.5)^2+(z+0.5)^2) - 0.61"),
    *("--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--cells", "9"),
]

# Of docs/nets.md: three balls that meet, cut through the middle, on so many samples along x, y and z.
BALLS = {"size": (44, 20, 40), "radius": 11.3, "centres": [(13.7, 0, 14.2), (27.3, 0, 14.2), (20.5, 0, 25.9)]}

FONT = "assets/fonts/DejaVuSans.ttf"
RENDERED = 1120  # pixels of the whole picture of an asteroid, of which a crop is shown
CROP = (250, 290, 890, 810)  # left, upper, right, lower
LABEL = 46
GAP = 8


def triangles(mesh):
    with open(mesh, "rb") as file:
        for line in file:
            if line.startswith(b"element face"):
                return f"{int(line.split()[2]):,} triangles"
    raise SystemExit(f"{mesh}: no faces")


def run(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)


def six_methods(isostudy, folder):
    """The asteroid at the spacing of the paper's animations by six methods, flat shading."""
    only = [word for method, _ in METHODS for word in ("--only", f"as_{method}")]
    run(isostudy, "extract", "configs/paper.toml", *only, "-o", folder)
    for method, clustering in METHODS:
        mesh = folder / "meshes" / "stimulus" / f"as_{method}.ply"
        turn = folder / f"{method}.gif"
        look = ["--look", "flat", "--frames", "1", "--size", str(RENDERED)]
        run(isostudy, "turntable", mesh, "-o", turn, *look)
        picture = Image.open(turn).convert("RGB").crop(CROP)
        yield picture, f"{method}: {clustering}", f"{LATTICES[method[0]]}, {triangles(mesh)}"


def surfaces(isostudy, folder):
    """Other people's files, as docs/surfaces.md extracts them."""
    for number, (label, (kind, name, *rest)) in enumerate(SURFACES):
        mesh, picture = folder / f"{number}.ply", folder / f"{number}.png"
        run(isostudy, "extract", kind, SAMPLES / name, *rest, "-o", mesh, "--picture", picture)
        yield Image.open(picture).convert("RGB"), label, triangles(mesh)


def cubes_methods(isostudy, folder):
    """What each change to marching cubes does to one surface; and two drops, in which two methods differ."""

    def tile(method, label, source, crop):
        mesh, turn = folder / f"{method}.ply", folder / f"{method}.gif"
        run(isostudy, "extract", *source, "--method", method, "-o", mesh)
        look = ["--look", "smooth-wireframe", "--frames", "1", "--size", "1000"]
        run(isostudy, "turntable", mesh, "-o", turn, *look)
        found = Image.open(turn).convert("RGB").crop(crop), f"{method}: {label}", triangles(mesh)
        mesh.unlink()
        turn.unlink()
        return found

    for method, label in CUBES:
        yield tile(method, label, TANGLE, (100, 100, 600, 600))
    for method, label in [("mc", "two drops"), ("mc33", "the same drops")]:
        yield tile(method, label, DROPS, (110, 160, 840, 890))


def labels(isostudy, folder):
    """Boundaries of labels: balls that meet, open where the volume ends, and organs of a chest."""
    nx, ny, nz = BALLS["size"]

    def label(x, y, z):
        away = [sum((a - b) ** 2 for a, b in zip((x, y, z), centre)) for centre in BALLS["centres"]]
        nearest = min(range(3), key=away.__getitem__)
        return nearest + 1 if away[nearest] < BALLS["radius"] ** 2 else 0

    samples = bytes(label(x, y, z) for z in range(nz) for y in range(ny) for x in range(nx))
    (folder / "balls.raw").write_bytes(samples)
    (folder / "balls.toml").write_text(
        f'file = "balls.raw"\nsize = [{nx}, {ny}, {nz}]\ntype = "u8"\nspacing = [1, 1, 1]\norigin = [0, 0, 0]\n'
    )
    smooth = ["--recipe", '{ kind = "surface-nets", smoothing = 8 }']
    chest = SAMPLES / "ct_labels.seg.nrrd"
    for number, (source, title, more) in enumerate(
        [
            (folder / "balls.toml", "three labels that meet", []),
            (folder / "balls.toml", "the same, smoothing = 8", smooth),
            (chest, "bones and lungs of a chest", [*smooth, "--only", "1,2,3,4,5,6"]),
        ]
    ):
        mesh, picture = folder / f"{number}.ply", folder / f"{number}.png"
        run(isostudy, "extract", "--labels", source, *more, "-o", mesh, "--picture", picture)
        yield Image.open(picture).convert("RGB"), title, triangles(mesh)


def montage(tiles, columns, size, picture):
    tiles = list(tiles)
    width, height = size[0] + GAP, size[1] + LABEL + GAP
    rows = -(-len(tiles) // columns)
    sheet = Image.new("RGB", (columns * width + GAP, rows * height + GAP), "white")
    draw = ImageDraw.Draw(sheet)
    large, small = ImageFont.truetype(FONT, 16), ImageFont.truetype(FONT, 13)
    for place, (tile, label, rest) in enumerate(tiles):
        x, y = GAP + place % columns * width, GAP + place // columns * height
        sheet.paste(tile.resize(size, Image.Resampling.LANCZOS), (x, y))
        draw.text((x + 2, y + size[1] + 3), label, "black", large)
        draw.text((x + 2, y + size[1] + 24), rest, "#444444", small)
    sheet = sheet.quantize(128, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    sheet.save(picture, optimize=True)
    print(picture)


def main():
    isostudy = sys.argv[1] if len(sys.argv) > 1 else "isostudy"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        pictures = {
            "six-methods": lambda to: montage(six_methods(isostudy, folder), 3, (320, 260), to),
            "surfaces": lambda to: montage(surfaces(isostudy, folder), 4, (280, 280), to),
            "cubes-methods": lambda to: montage(cubes_methods(isostudy, folder), 4, (280, 280), to),
            "labels": lambda to: montage(labels(isostudy, folder), 3, (300, 300), to),
            "edge-groups": lambda to: run(isostudy, "table", *TABLES, "--groups", "--figure", to),
        }
        for name in sys.argv[2:] or pictures:
            pictures[name](f"docs/{name}.png")


if __name__ == "__main__":
    main()
