"""Meshes put before a fixed camera, so that pictures of several meshes show the same place at the same scale.

`isostudy turntable MESH` frames each mesh by its own bounds, which differ from method to method, and looks at it from one height.
"""

import math
import struct


def read_ply(path):
    """Positions and triangles of a mesh that isostudy wrote: binary, with normals."""
    with open(path, "rb") as file:
        header, body = file.read().split(b"end_header\n", 1)
    words = [line.split() for line in header.splitlines()]
    vertices, faces = (next(int(w[2]) for w in words if w[:2] == [b"element", of]) for of in (b"vertex", b"face"))
    end = 24 * vertices
    positions = [values[:3] for values in struct.iter_unpack("<6f", body[:end])]
    return positions, [values[1:] for values in struct.iter_unpack("<B3I", body[end : end + 13 * faces])]


def pose(mesh, posed, middle, turn, tilt, half):
    """Writes `posed`, an OBJ: `mesh` with `middle` at the origin, turned by `turn` about z, and its top tilted towards the
    camera by `tilt` (radians). Its bounds are the cube from -`half` to `half`, whatever the mesh; the mesh must lie in it."""
    positions, triangles = read_ply(mesh)
    # Seen from above the camera of `isostudy turntable` stands at 45 degrees between x and y.
    toward = math.tau / 8
    lines = []
    for position in positions:
        x, y, z = (value - origin for value, origin in zip(position, middle))
        x, y = rotated(x, y, turn - toward)
        x, z = rotated(x, z, -tilt)
        x, y = rotated(x, y, toward)
        if max(abs(x), abs(y), abs(z)) > half:
            raise SystemExit(f"{mesh}: a vertex lies outside of the cube of {half}")
        lines.append(f"v {x:.6f} {y:.6f} {z:.6f}\n")
    lines += [f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles]
    # Two triangles without area at opposite corners of the cube: they are not drawn, and they are in the bounds.
    for corner in (-half, half):
        lines.append(f"v {corner} {corner} {corner}\nf -1 -1 -1\n")
    with open(posed, "w", encoding="utf-8") as file:
        file.writelines(lines)


def rotated(x, y, angle):
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)
