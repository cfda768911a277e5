#!/usr/bin/env python3
"""Draws the pictures of docs/: tiles that isostudy rendered, one label each, and the figure of edge groups.

Usage: scripts/docs-pictures.py [ISOSTUDY [PICTURE...]]

ISOSTUDY is the command, `isostudy` if left out; PICTURE one of six-methods, surfaces, edge-groups, terrain, methods (a folder and a sheet),
methods-drops, methods-box, labels, finishing and scattered, all if left out.
Run it in the project's folder; it needs Pillow. surfaces and labels need `scripts/fetch-samples.sh` first.
"""

import json
import math
import struct
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from posed_mesh import pose, read_ply

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

# Of docs/methods.md and its pages: one terrain, so coarse that each triangle is seen, before one camera. Its walls are
# farther from the box than in the study: more than 0.3 of an edge, or snapmc draws them onto the box.
TERRAIN = {"study": "configs/terrain.toml", "object": "cl", "spacing": 1 / 11, "margin": 0.02}
POSE = {"middle": (0, 0, -0.1), "turn": math.tau * 0.75, "tilt": 0.2, "half": 1.5}
WHOLE = (0.21, 0.29, 0.79, 0.725)  # left, upper, right, lower, in shares of the picture
NEAR = (0.30, 0.29, 0.70, 0.59)
CLOSE = (0.33, 0.40, 0.53, 0.55)
TILE = (360, 270)
# All are as their counterparts look, but for this one.
PUBLISHED = ["bp-published"]
# Recipes without a name that the pages show: id, the method they are based on, the key that differs.
CHANGED = [
    ("nets-smoothed", "nets-manifold", "smoothing", 8),
]
# Of the picture in README.md.
IN_GAMES = ["mc", "mc33", "snapmc", "nets-manifold", "dc-in-cell", "si", "bi", "bi-relaxed"]
SHEET = [
    *("bu", "bi", "bc", "bi-relaxed"),
    *("su", "si", "mp", "fp"),
    *("mc", "mc-quality", "snapmc", "macet"),
    *("nets", "nets-smoothed", "dc", "dc-in-cell"),
]
# Of the figure of edge groups in docs/cubes.md.
TABLES = ["mc", "mc-edge-groups", "hull", "mc-quality", "su", "bu"]
# Two drops whose neck runs through the middle cell from corner to corner: there it is decided by more than signs.
DROPS = [
    *("--field", "((x-0.5)^2+(y+0.5)^2+(z-0.5)^2)*((x+0.5)^2+(y-0.5)^2+(z+0.5)^2) - 0.61"),
    *("--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--cells", "9"),
]
# A box that is turned against the axes about two of them.
BOX = [
    *("--field", "max(abs(0.8*x+0.6*y)-0.7, abs(0.8*(0.8*y-0.6*x)+0.6*z)-0.6, abs(0.8*z-0.6*(0.8*y-0.6*x))-0.5)"),
    *("--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--cells", "12"),
]

# Of docs/nets.md: three balls that meet, cut through the middle, on so many samples along x, y and z.
BALLS = {"size": (44, 20, 40), "radius": 11.3, "centres": [(13.7, 0, 14.2), (27.3, 0, 14.2), (20.5, 0, 25.9)]}

# Of docs/scattered.md: a lumpy ring, its scan without what lies round one place, and its triangles without every seventh.
RING = [
    *("--field", "sqrt((sqrt(x^2 + y^2) - 0.7)^2 + z^2) - 0.28 - 0.08*noise(x*4, y*4, z*4)"),
    "--bounds=-1.2,-1.2,-0.5,1.2,1.2,0.5",
]
HOLE = ((0.5, 0.55, 0.25), 0.3)  # centre, radius
RING_POSE = {"middle": (0, 0, 0), "turn": 0, "tilt": 0.5, "half": 1.6}
RING_SEEN = (0.22, 0.29, 0.78, 0.71)

# Of docs/finishing.md: a block with a dome, and the steps for it.
DOME = [
    *("--field", "min(max(abs(x)-0.73, abs(y)-0.53, abs(z)-0.33), sqrt(x^2 + y^2 + (z-0.3)^2) - 0.44)"),
    *("--bounds=-0.9,-0.9,-0.6,0.9,0.9,0.9", "--cells", "24", "--method", "mc"),
]
STEPS = ["", "coplanar:tolerance=0.001", "decimate:ratio=0.1", "re-tile:points=800"]
DOME_POSE = {"middle": (0, 0, 0.1), "turn": 0.5, "tilt": 0.5, "half": 1.2}
DOME_SEEN = (0.24, 0.27, 0.76, 0.66)

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


def turned(isostudy, folder, mesh, size, *look):
    """The first frame of the mesh's turntable."""
    turn = folder / "turned.gif"
    run(isostudy, "turntable", mesh, "-o", turn, "--frames", "1", "--size", str(size), *look)
    picture = Image.open(turn).convert("RGB")
    turn.unlink()
    return picture


def of_formula(isostudy, folder, methods, source, crop):
    """One formula by several methods, each with a label of its own."""
    for method, label in methods:
        mesh = folder / "formula.ply"
        run(isostudy, "extract", *source, "--method", method, "-o", mesh)
        picture = turned(isostudy, folder, mesh, 1000, "--look", "smooth-wireframe").crop(crop)
        yield picture, f"{method}: {label}", triangles(mesh)


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


def finishing(isostudy, folder):
    """A block with a dome by marching cubes, and after each step alone."""
    for step in STEPS:
        mesh, posed = folder / "finished.ply", folder / "posed.obj"
        run(isostudy, "extract", *DOME, *(["--finish", step] if step else []), "-o", mesh)
        pose(mesh, posed, **DOME_POSE)
        picture = part(turned(isostudy, folder, posed, 1000, "--look", "smooth-wireframe"), DOME_SEEN)
        name, _, settings = step.partition(":")
        yield picture, name or "mc", f"{triangles(mesh)}{settings and ', '}{settings}"


def scattered(isostudy, folder):
    """A scan with a hole and soup with holes, each beside the surface that is extracted."""
    whole, scan, dots, soup, surface = (folder / name for name in ("ring.ply", "scan.xyz", "dots.ply", "soup.ply", "of.ply"))
    run(isostudy, "extract", *RING, "--spacing", "0.08", "--method", "bi-relaxed", "-o", whole)
    positions, corners = read_ply(whole)
    kept = [(p, n) for p, n in zip(positions, normals(positions, corners)) if math.dist(p, HOLE[0]) > HOLE[1]]
    scan.write_text("".join(" ".join(f"{x:.6f}" for x in (*p, *n)) + "\n" for p, n in kept))
    octahedra = [
        [tuple(x + 0.016 * step for x, step in zip(p, corner)) for corner in ((sx, 0, 0), (0, sy, 0), (0, 0, sz))]
        for p, _ in kept
        for sx in (-1, 1)
        for sy in (-1, 1)
        for sz in (-1, 1)
    ]
    write_soup(dots, [t if octant in (7, 1, 2, 4) else t[::-1] for octant, t in zip([*range(8)] * len(kept), octahedra)])
    left = [[positions[v] for v in t] for number, t in enumerate(corners) if number % 7 != 3]
    write_soup(soup, left)
    fine = ["--bounds=-1.2,-1.2,-0.6,1.2,1.2,0.6", "--spacing", "0.05", "--method", "bi-relaxed", "-o", surface]

    def seen(mesh):
        posed = folder / "posed.obj"
        pose(mesh, posed, **RING_POSE)
        return part(turned(isostudy, folder, posed, 1200, "--look", "flat"), RING_SEEN)

    yield seen(dots), "a scan with a hole", f"{len(kept):,} points with normals"
    run(isostudy, "extract", "--points", scan, *fine)
    yield seen(surface), "its surface", f"{triangles(surface)}, closed"
    yield seen(soup), "soup without a seventh", f"{len(left):,} triangles of {len(corners):,}"
    run(isostudy, "extract", "--soup", soup, *fine)
    yield seen(surface), "its surface", f"{triangles(surface)}, closed"


def normals(positions, corners):
    """Of each vertex, the sum of its triangles' normals by area."""
    sums = [[0.0, 0.0, 0.0] for _ in positions]
    for t in corners:
        a, b, c = (positions[v] for v in t)
        u, v = ([q - p for p, q in zip(a, other)] for other in (b, c))
        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        for vertex in t:
            sums[vertex] = [x + y for x, y in zip(sums[vertex], normal)]
    return sums


def write_soup(path, corners):
    """Triangles, each with corners of its own, as posed_mesh.py reads a mesh."""
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {3 * len(corners)}\n"
    header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header += f"element face {len(corners)}\nproperty list uchar uint vertex_indices\nend_header\n"
    body = b"".join(struct.pack("<6f", *p, 0, 0, 0) for t in corners for p in t)
    faces = b"".join(struct.pack("<B3I", 3, 3 * t, 3 * t + 1, 3 * t + 2) for t in range(len(corners)))
    path.write_bytes(header.encode() + body + faces)


def drops(isostudy, folder):
    """Two drops with a neck, which not all methods find."""
    methods = [("mc", "apart"), ("mc33", "joined by a tube"), ("nets", "joined in a point"), ("nets-manifold", "apart")]
    return of_formula(isostudy, folder, methods, DROPS, (110, 160, 840, 890))


def boxes(isostudy, folder):
    """A box whose edges are cut off by all methods but one."""
    methods = [("mc", "crossings"), ("bi", "means"), ("nets", "means"), ("dc", "planes")]
    return of_formula(isostudy, folder, methods, BOX, (120, 120, 880, 880))


def terrain(isostudy, folder):
    """The terrain at the spacing of the study's animations, by eight of its methods."""
    study = tomllib.loads(Path(TERRAIN["study"]).read_text(encoding="utf-8"))
    labels = {method["id"]: method["label"] for method in study["methods"]}
    only = [word for method in IN_GAMES for word in ("--only", f"{TERRAIN['object']}_{method}")]
    run(isostudy, "extract", TERRAIN["study"], *only, "--allow-programs", "-o", folder / "games")
    for method in IN_GAMES:
        mesh, posed = folder / f"games/meshes/stimulus/{TERRAIN['object']}_{method}.ply", folder / "posed.obj"
        pose(mesh, posed, **POSE)
        near = part(turned(isostudy, folder, posed, 1400, "--look", "flat"), NEAR)
        yield near, f"{method}: {triangles(mesh)}", labels[method]


def as_toml(value):
    """The value as TOML in one line; what JSON writes, but for tables."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {as_toml(of)}" for key, of in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    return json.dumps(value)


def methods_shown(isostudy):
    """The methods that have a name, and those of CHANGED, by id: the name, its label, the key that differs, the recipe."""
    listed = json.loads(subprocess.run([isostudy, "methods", "--json"], check=True, capture_output=True).stdout)
    methods = {
        method["id"]: (method["id"], method["label"].removesuffix(", as published"), "", method["recipe"])
        for method in listed["methods"]
        if not method["id"].endswith("-published") or method["id"] in PUBLISHED
    }
    for changed, base, key, value in CHANGED:
        name, label, _, recipe = methods[base]
        methods[changed] = name, label, f"{key} = {as_toml(value)}", recipe | {key: value}
    return methods


def terrain_study(methods, file):
    """A study with the terrain alone, by all methods."""
    source = Path(TERRAIN["study"])
    study = tomllib.loads(source.read_text(encoding="utf-8"))
    terrain = next(found for found in study["objects"] if found["id"] == TERRAIN["object"])
    study = {key: study[key] for key in ("schema", "study", "limits", "turntable", "shading", "stimuli", "benchmark")}
    target = str((source.parent / study["benchmark"]["target"]).resolve())
    # Nothing is timed: what a study must say, and no more.
    must = {key: study["benchmark"][key] for key in ("warmup", "iterations", "short_iterations", "threads")}
    study["benchmark"] = must | {"target": target}
    study["comparisons"] = []
    field = terrain["field"] | {"margin": TERRAIN["margin"]}
    spacings = {key: TERRAIN["spacing"] for key in ("stimulus_spacing", "benchmark_spacing")}
    study["objects"] = [terrain | {"field": field} | spacings]
    study["methods"] = [{"id": of, "label": of, "recipe": recipe} for of, (*_, recipe) in methods.items()]
    file.write_text("".join(f"{key} = {as_toml(value)}\n" for key, value in study.items()), encoding="utf-8")


def part(picture, shares):
    """A part of a square picture, over a scale of colours or not."""
    return picture.crop(tuple(round(share * picture.width) for share in shares))


def of_methods(isostudy, folder):
    """One strip per method: the terrain with a frame round a place, and that place coloured by radius ratio over its scale. And
    a sheet with that place by the methods of SHEET."""
    methods = methods_shown(isostudy)
    study, results = folder / "terrain.toml", folder / "terrain"
    terrain_study(methods, study)
    run(isostudy, "extract", study, "-o", results)
    strips = Path("docs/methods")
    strips.mkdir(exist_ok=True)
    coloured = ["--colour", "quality", "--look", "smooth-wireframe"]
    # Pixels of the whole picture whose part is as large as a tile: edges of triangles then stay one pixel wide.
    close = round(TILE[0] / (CLOSE[2] - CLOSE[0]))
    scale, places, drawn = None, {}, {}
    for method, (name, label, key, _) in methods.items():
        mesh, posed = results / "meshes" / "stimulus" / f"{TERRAIN['object']}_{method}.ply", folder / "posed.obj"
        pose(mesh, posed, **POSE)
        whole = part(turned(isostudy, folder, posed, 1400, "--look", "smooth-wireframe"), WHOLE)
        place = part(turned(isostudy, folder, posed, close, *coloured), CLOSE)
        if scale is None:
            small = turned(isostudy, folder, posed, TILE[0], *coloured)
            scale = small.crop((0, TILE[0], TILE[0], small.height))
        places[method] = place, name, key or triangles(mesh)
        drawn[method] = strip(whole, place, scale, name, f"{label}\n{key}{key and ', '}{triangles(mesh)}")
    palette = common_palette(list(drawn.values()), scale)
    for method, picture in drawn.items():
        save(picture, strips / f"{method}.png", palette)
    save(montage([places[method] for method in SHEET], 4, (200, 150)), "docs/methods.png", palette)


def common_palette(pictures, scale):
    """A palette for pictures that stand on one page: equal colours stay equal. All colours of the scale are in it, since what is rare
    in the pictures, the dark end, is what they are to show."""
    width, height = pictures[0].size
    together = Image.new("RGB", (width, height * len(pictures)))
    for place, picture in enumerate(pictures):
        together.paste(picture, (0, place * height))
    row = next(y for y in range(scale.height) if len(set(scale.crop((0, y, scale.width, y + 1)).getdata())) > 20)
    of_scale = scale.crop((0, row, scale.width, row + 1)).quantize(40)
    background = pictures[0].getpixel((GAP + 2, GAP + 2))
    colours = of_scale.getpalette()[: 3 * 40] + together.quantize(84).getpalette()[: 3 * 84]
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours + [*background, 0, 0, 0, 255, 255, 255])
    return palette


def strip(whole, place, scale, label, rest):
    """Two tiles side by side, the label below the first, the scale of colours below the second."""
    width, height = TILE
    picture = Image.new("RGB", (2 * width + 3 * GAP, GAP + height + max(LABEL, scale.height)), "white")
    draw = ImageDraw.Draw(picture)
    picture.paste(whole.resize(TILE, Image.Resampling.LANCZOS), (GAP, GAP))
    left, upper, right, lower = WHOLE
    across, down = width / (right - left), height / (lower - upper)
    frame = [
        *(GAP + (CLOSE[0] - left) * across, GAP + (CLOSE[1] - upper) * down),
        *(GAP + (CLOSE[2] - left) * across, GAP + (CLOSE[3] - upper) * down),
    ]
    draw.rectangle(frame, outline="white", width=2)
    picture.paste(place.resize(TILE, Image.Resampling.LANCZOS), (2 * GAP + width, GAP))
    picture.paste(scale, (2 * GAP + width, GAP + height))
    write(draw, GAP, GAP + height, label, rest)
    return picture


def write(draw, x, y, label, rest):
    """A label, and a line or two in smaller letters, below a tile that ends at `y`."""
    draw.text((x + 2, y + 3), label, "black", ImageFont.truetype(FONT, 16))
    draw.text((x + 2, y + 24), rest, "#444444", ImageFont.truetype(FONT, 13))


def save(picture, file, palette=None):
    """As a PNG with the palette, or its own."""
    own = {"colors": 128, "method": Image.Quantize.MEDIANCUT} if palette is None else {"palette": palette}
    picture.quantize(**own, dither=Image.Dither.NONE).save(file, optimize=True)
    print(file)


def montage(tiles, columns, size):
    tiles = list(tiles)
    width, height = size[0] + GAP, size[1] + LABEL + GAP
    rows = -(-len(tiles) // columns)
    sheet = Image.new("RGB", (columns * width + GAP, rows * height + GAP), "white")
    draw = ImageDraw.Draw(sheet)
    for place, (tile, label, rest) in enumerate(tiles):
        x, y = GAP + place % columns * width, GAP + place // columns * height
        sheet.paste(tile.resize(size, Image.Resampling.LANCZOS), (x, y))
        write(draw, x, y + size[1], label, rest)
    return sheet


def main():
    isostudy = sys.argv[1] if len(sys.argv) > 1 else "isostudy"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        pictures = {
            "six-methods": lambda to: save(montage(six_methods(isostudy, folder), 3, (320, 260)), to),
            "surfaces": lambda to: save(montage(surfaces(isostudy, folder), 4, (280, 280)), to),
            "labels": lambda to: save(montage(labels(isostudy, folder), 3, (300, 300)), to),
            "finishing": lambda to: save(montage(finishing(isostudy, folder), 4, (300, 225)), to),
            "scattered": lambda to: save(montage(scattered(isostudy, folder), 4, (300, 225)), to),
            "edge-groups": lambda to: run(isostudy, "table", *TABLES, "--groups", "--figure", to),
            "terrain": lambda to: save(montage(terrain(isostudy, folder), 4, (250, 188)), to),
            "methods": lambda _: of_methods(isostudy, folder),
            "methods-drops": lambda to: save(montage(drops(isostudy, folder), 4, (280, 280)), to),
            "methods-box": lambda to: save(montage(boxes(isostudy, folder), 4, (280, 280)), to),
        }
        for name in sys.argv[2:] or pictures:
            pictures[name](f"docs/{name}.png")


if __name__ == "__main__":
    main()
