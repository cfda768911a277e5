#!/usr/bin/env python3
"""Writes the four objects of configs/all.toml: grids of other cells than cubes, with a value on each point.

Usage: scripts/all-grids.py FOLDER

- ball.vtu: tetrahedra, their points off a lattice (VTK XML, text).
- ring.vtk: a curvilinear grid (VTK legacy, text).
- gyroid.vtk: hexahedra and wedges (VTK legacy, text); a gyroid within a ball, with a sharp edge where they meet.
- house.node, house.ele: tetrahedra (TetGen); a house with sharp edges, turned against the axes.

Values are positive inside. Each grid fills the box from -1 to 1 along each axis. The same files each time.
"""

import math
import random
import sys
from pathlib import Path

CELLS = 28
SIX = [(0, 1, 3, 7), (0, 1, 7, 5), (0, 2, 7, 3), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 7, 6)]
TETRAHEDRON, HEXAHEDRON, WEDGE = 10, 12, 13


def ball(x, y, z):
    return 0.75 - math.sqrt(x * x + y * y + z * z)


def ring(x, y, z):
    return 0.27 - math.hypot(math.hypot(x, y) - 0.6, z)


def gyroid(x, y, z):
    a, b, c = (5.0 * v for v in (x, y, z))
    wave = math.sin(a) * math.cos(b) + math.sin(b) * math.cos(c) + math.sin(c) * math.cos(a)
    return min(wave / 7.0 + 0.03, 0.85 - math.sqrt(x * x + y * y + z * z))


def house(x, y, z):
    u, v = 0.9 * x + 0.4359 * y, 0.9 * y - 0.4359 * x
    walls = min(0.6 - abs(u), 0.45 - abs(v), z + 0.6, 0.7 - z)
    return min(walls, (0.65 - z - abs(v)) / math.sqrt(2))


def lattice(move):
    """The points of a lattice of CELLS cells along each axis, x fastest, each moved within the box."""
    places = [2 * i / CELLS - 1 for i in range(CELLS + 1)]
    return [move(x, y, z) for z in places for y in places for x in places]


def corners():
    """The corners of each cell, numbered x + 2 y + 4 z."""
    side = CELLS + 1
    for z in range(CELLS):
        for y in range(CELLS):
            for x in range(CELLS):
                first = (z * side + y) * side + x
                yield (x + y + z) % 2, [first + (c & 1) + (c >> 1 & 1) * side + (c >> 2) * side * side for c in range(8)]


def scattered():
    chance = random.Random(1)
    off = 0.3 / CELLS

    def move(*place):
        return tuple(v if abs(v) == 1 else v + chance.uniform(-off, off) for v in place)

    return lattice(move)


def curved(x, y, z):
    """Lines of the grid bend within the box, and its faces stay."""
    bump = 0.06 * math.sin(math.pi * x) * math.sin(math.pi * y) * math.sin(math.pi * z)
    return tuple(v + sign * bump for v, sign in ((x, 1), (y, -1), (z, 1)))


def tetrahedra():
    return [[c[i] for i in of] for _, c in corners() for of in SIX]


def lines(rows):
    return "\n".join(" ".join(f"{v:.7g}" for v in row) for row in rows)


def vtu(path, points, value):
    cells = tetrahedra()
    array = '<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="ascii">\n{}\n</DataArray>'.format
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n<UnstructuredGrid>\n'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n'
        f'<PointData>\n{array("Float32", "value", 1, lines([value(*p)] for p in points))}\n</PointData>\n'
        f'<Points>\n{array("Float32", "Points", 3, lines(points))}\n</Points>\n<Cells>\n'
        f'{array("Int64", "connectivity", 1, lines(cells))}\n'
        f'{array("Int64", "offsets", 1, lines([4 * i] for i in range(1, len(cells) + 1)))}\n'
        f'{array("UInt8", "types", 1, lines([TETRAHEDRON] for _ in cells))}\n'
        "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )


def legacy(path, points, value, dataset, cells):
    path.write_text(
        f"# vtk DataFile Version 3.0\n{path.stem}\nASCII\nDATASET {dataset}\nPOINTS {len(points)} float\n{lines(points)}\n{cells}"
        f"POINT_DATA {len(points)}\nSCALARS value float 1\nLOOKUP_TABLE default\n{lines([value(*p)] for p in points)}\n"
    )


def mixed():
    """Cells by turns a hexahedron and two wedges, in VTK's order of corners."""
    cells = []
    for is_cut, (a, b, c, d, e, f, g, h) in corners():
        cells += [(WEDGE, [a, b, c, e, f, g]), (WEDGE, [b, d, c, f, h, g])] if is_cut else [(HEXAHEDRON, [a, b, d, c, e, f, h, g])]
    listed = lines([len(of), *of] for _, of in cells)
    return f"CELLS {len(cells)} {sum(len(of) + 1 for _, of in cells)}\n{listed}\nCELL_TYPES {len(cells)}\n{lines([kind] for kind, _ in cells)}\n"


def tetgen(folder, points, value):
    cells = tetrahedra()
    nodes = lines([i, *p, value(*p)] for i, p in enumerate(points))
    (folder / "house.node").write_text(f"{len(points)} 3 1 0\n{nodes}\n")
    (folder / "house.ele").write_text(f"{len(cells)} 4 0\n" + lines([i, *of] for i, of in enumerate(cells)) + "\n")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder, side = Path(sys.argv[1]), CELLS + 1
    folder.mkdir(parents=True, exist_ok=True)
    straight = lattice(lambda *place: place)
    vtu(folder / "ball.vtu", scattered(), ball)
    legacy(folder / "ring.vtk", lattice(curved), ring, f"STRUCTURED_GRID\nDIMENSIONS {side} {side} {side}", "")
    legacy(folder / "gyroid.vtk", straight, gyroid, "UNSTRUCTURED_GRID", mixed())
    tetgen(folder, straight, house)


if __name__ == "__main__":
    main()
