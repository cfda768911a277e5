#!/usr/bin/env python3
"""Checks every wrong verdict of a recording once more, by code that shares nothing with the barometer's.

Usage: scripts/barometer/confirm.py RECORDING [WORKLOAD ENGINE]

Needs numpy and SciPy. The barometer kept each wrong mesh with its samples in RECORDING/wrong. This counts connected pieces by SciPy's graphs,
edges by sorting pairs of numbers, the volume by NumPy, and looks at where the mesh lies. Of random grids it counts the first that are wrong,
against samples that are refined 48-fold by linear interpolation: pieces by flood fill, the Euler characteristic by points, edges, squares
and cubes. With a workload and an engine it prints what it found. Else it writes RECORDING/confirmed.csv: a verdict is confirmed if every
kind of fault that the barometer found is found here too.
"""

import csv
import json
import sys
from pathlib import Path

import numpy as np
from scipy.ndimage import label
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree


def read_ply(path):
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode()
    vertices = int(header.split("element vertex ")[1].split()[0])
    faces = int(header.split("element face ")[1].split()[0])
    columns = header.split("element vertex")[1].split("element face")[0].count("property float")
    points = np.frombuffer(data, "<f4", vertices * columns, end).reshape(vertices, columns)[:, :3]
    corners = np.frombuffer(data, np.dtype([("n", "u1"), ("v", "<u4", 3)]), faces, end + vertices * columns * 4)["v"]
    return points.astype(float), corners.astype(np.int64)


def same_place(points, spacing):
    """How far apart two cells may compute one crossing, in single precision."""
    return max(1e-6 * spacing, 2 * np.abs(points).max(initial=0.0) * 2.0**-23)


def welded(points, corners, within):
    """Vertices that near to each other as one, by pairs of a k-d tree."""
    pairs = cKDTree(points).query_pairs(within, output_type="ndarray")
    count = len(points)
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, numbers = connected_components(graph, directed=False)
    _, first = np.unique(numbers, return_index=True)
    return points[first], numbers[corners]


def counted(points, corners):
    """What a mesh is, by its edges."""
    corners = corners[(corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])]
    used, corners = np.unique(corners, return_inverse=True)
    corners = corners.reshape(-1, 3)
    directed = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    edges, which, count = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True)
    forward = np.bincount(which.ravel(), directed[:, 0] < directed[:, 1], len(edges))
    graph = coo_matrix((np.ones(len(directed)), (directed[:, 0], directed[:, 1])), shape=(len(used), len(used)))
    pieces, _ = connected_components(graph, directed=False)
    open_edges = edges[count == 1]
    border = coo_matrix((np.ones(len(open_edges)), (open_edges[:, 0], open_edges[:, 1])), shape=(len(used), len(used)))
    loops = len(np.unique(connected_components(border, directed=False)[1][open_edges.ravel()])) if len(open_edges) else 0
    a, b, c = (points[used][corners[:, i]] for i in range(3))
    # Sheets at a vertex: pieces of the triangles round it, joined by edges.
    ends = np.repeat(np.arange(len(corners)), 3)
    fans = vertex_fans(corners, ends)
    return {
        "components": int(pieces),
        "euler": int(len(used) - len(edges) + len(corners)),
        "boundary": int(loops),
        "non-manifold": int((count > 2).sum() + fans),
        "misoriented": int(((count == 2) & (forward != 1)).sum()),
        "duplicates": int(len(corners) - len(np.unique(np.sort(corners, axis=1), axis=0))),
        "volume": float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6),
        "area": float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2),
    }, points[used], corners


def vertex_fans(corners, ends):
    """How many fans of triangles there are round vertices beyond the first of each."""
    # A node is a corner of a triangle; two of one vertex are joined if their triangles share an edge at it.
    keys = {}
    one, other = [], []
    for corner in range(3):
        for step in (1, 2):
            first, second = corners[:, corner], corners[:, (corner + step) % 3]
            for node, (v, w) in zip(3 * np.arange(len(corners)) + corner, zip(first.tolist(), second.tolist())):
                known = keys.setdefault((v, w), node)
                if known != node:
                    one.append(known)
                    other.append(node)
    count = 3 * len(corners)
    graph = coo_matrix((np.ones(len(one)), (one, other)), shape=(count, count))
    fans, _ = connected_components(graph, directed=False)
    return fans - len(np.unique(corners))


def place(points, about, samples):
    """Vertices beyond a cell of any crossing, crossings beyond two cells of any vertex, and the displacement of the whole, in cells."""
    spacing = np.array(about["spacing"])
    index = (points - about["origin"]) / spacing
    inside = samples >= about["isovalue"] if about["ties"] == "inside" else samples > about["isovalue"]
    crossings = []
    for axis in range(3):
        low, high = np.take(samples, range(samples.shape[axis] - 1), axis), np.take(samples, range(1, samples.shape[axis]), axis)
        crossed = np.take(inside, range(samples.shape[axis] - 1), axis) != np.take(inside, range(1, samples.shape[axis]), axis)
        at = np.argwhere(crossed).astype(float)
        with np.errstate(invalid="ignore", divide="ignore"):
            share = (about["isovalue"] - low[crossed]) / (high[crossed] - low[crossed])
        at[:, axis] += np.clip(np.nan_to_num(share, nan=0.5), 0, 1)
        crossings.append(at)
    crossings = np.concatenate(crossings)[:, ::-1]
    if not len(index) or not len(crossings):
        return {"far": len(index), "missed": len(crossings), "shifted": 0.0, "off": 0.0}
    near, which = cKDTree(crossings).query(index)
    reached, _ = cKDTree(index).query(crossings)
    # The mean step to the nearest crossing is not the displacement along the surface; across it, it is.
    gradient = np.stack(np.gradient(np.nan_to_num(samples)), axis=-1)[..., ::-1]
    cell = np.clip(np.rint(index[:, ::-1]).astype(int), 0, np.array(samples.shape) - 1)
    normal = -gradient[tuple(cell.T)]
    length = np.linalg.norm(normal, axis=1)
    normal, step = normal[length > 0] / length[length > 0, None], (index - crossings[which])[length > 0]
    along = np.einsum("ij,ij->i", normal, step)
    solved = np.linalg.lstsq(np.concatenate([normal, 0.03 * np.eye(3) * np.sqrt(len(normal))]), np.concatenate([along, np.zeros(3)]), rcond=None)[0]
    off = np.abs(along).mean() if len(along) else 0.0
    return {"far": int((near > 1.5).sum()), "missed": int((reached > 1.5).sum()), "shifted": float(np.linalg.norm(solved)), "off": float(off)}


def check(folder, name):
    """What is wrong with one kept mesh, by its own count."""
    about = json.loads((folder / f"{name}.json").read_text())
    samples = np.fromfile(folder / f"{name.split('.')[0]}.f32", "<f4").reshape(about["counts"][::-1]).astype(float)
    points, corners = read_ply(folder / f"{name}.ply")
    if about.get("soup"):
        points, corners = welded(points, corners, same_place(points, min(about["spacing"])))
    found, used, corners = counted(points, corners)
    found |= place(used, about, samples)
    truth = about["truth"]
    wrong = {}
    for key, expected in (("components", truth["components"]), ("euler", truth["euler"]), ("boundary", truth.get("boundary", 0))):
        if found[key] != expected:
            wrong[key] = (found[key], expected)
    for key in ("non-manifold", "misoriented", "duplicates", "far", "missed"):
        if found[key]:
            wrong[key] = (found[key], 0)
    for key in ("volume", "area"):
        if truth.get(key) and abs(found[key] - truth[key]) > truth["within"] * truth[key]:
            wrong[key] = (round(found[key], 4), truth[key])
    if found["shifted"] > (0.15 if about["smooth"] else 0.3):
        wrong["shifted"] = (round(found["shifted"], 3), 0)
    if about["smooth"] and found["off"] > 0.2:
        wrong["off"] = (round(found["off"], 3), 0)
    if found["volume"] < 0 and not truth.get("boundary"):
        wrong["inside-out"] = (1, 0)
    return found, wrong


def refined(samples, times):
    for axis in range(3):
        count = samples.shape[axis]
        at = np.arange((count - 1) * times + 1) / times
        low = np.minimum(at.astype(int), count - 2)
        share = (at - low).reshape([-1 if a == axis else 1 for a in range(3)])
        samples = np.take(samples, low, axis) * (1 - share) + np.take(samples, low + 1, axis) * share
    return samples


def solid_truth(samples):
    """Pieces and Euler characteristic of the surface round what is above 0, by flood fill and by counting cells of a finer grid."""
    i = refined(samples, 48) > 0
    edges = (i[1:] & i[:-1]).sum() + (i[:, 1:] & i[:, :-1]).sum() + (i[:, :, 1:] & i[:, :, :-1]).sum()
    xy = i[1:, 1:] & i[1:, :-1] & i[:-1, 1:] & i[:-1, :-1]
    xz = i[1:, :, 1:] & i[1:, :, :-1] & i[:-1, :, 1:] & i[:-1, :, :-1]
    yz = i[:, 1:, 1:] & i[:, 1:, :-1] & i[:, :-1, 1:] & i[:, :-1, :-1]
    cubes = (xy[:, :, 1:] & xy[:, :, :-1]).sum()
    euler = 2 * (int(i.sum()) - int(edges) + int(xy.sum() + xz.sum() + yz.sum()) - int(cubes))
    solids, holes = label(i)[1], label(~i, np.ones((3, 3, 3)))[1]
    return solids + holes - 1, euler


# Grids of random samples: how many samples they have along each side beside the layer between them, and how many wrong ones are checked.
GRID, CHECKED = 4, 5


def check_grids(recording, engine):
    """Whether the first grids that were found wrong are wrong."""
    folder = recording / "wrong" / "random-grids"
    about = json.loads((folder / f"{engine}.json").read_text())
    count, period = about["samples"], GRID + 1
    samples = np.fromfile(folder / "0.f32", "<f4").reshape([count] * 3).astype(float)
    points, corners = read_ply(folder / f"{engine}.ply")
    if about["soup"]:
        points, corners = welded(points, corners, same_place(points, 1.0))
    side = (count - 1) // period
    cell = np.clip((points[corners].mean(axis=1) / period).astype(int), 0, side - 1)
    grid_of = (cell[:, 2] * side + cell[:, 1]) * side + cell[:, 0]
    rows = []
    for grid in about["grids"][:CHECKED]:
        x, y, z = (period * (grid // side**axis % side) for axis in range(3))
        part = samples[z : z + period + 1, y : y + period + 1, x : x + period + 1]
        components, euler = solid_truth(part)
        found, _, _ = counted(points, corners[grid_of == grid])
        wrong = {key: (found[key], 0) for key in ("boundary", "non-manifold", "misoriented", "duplicates") if found[key]}
        for key, expected in (("components", components), ("euler", euler)):
            if found[key] != expected:
                wrong[key] = (found[key], expected)
        rows.append((grid, wrong))
    return rows


def main():
    if len(sys.argv) not in (2, 4) or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    recording = Path(sys.argv[1])
    if len(sys.argv) > 3 and sys.argv[2] == "random-grids":
        for grid, wrong in check_grids(recording, sys.argv[3]):
            print(f"grid {grid}:", ", ".join(f"{key} {a}, expected {b}" for key, (a, b) in wrong.items()) or "nothing wrong")
        return 0
    if len(sys.argv) > 3:
        for about in sorted((recording / "wrong" / sys.argv[2]).glob(f"*.{sys.argv[3]}.json")):
            found, wrong = check(about.parent, about.name.removesuffix(".json"))
            print(about.name.removesuffix(".json"), json.dumps(found))
            print("wrong:", ", ".join(f"{key} {a}, expected {b}" for key, (a, b) in wrong.items()) or "nothing")
        return 0
    rows = []
    with open(recording / "measurements.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["state"] != "wrong":
                continue
            kept = sorted((recording / "wrong" / row["workload"]).glob(f"*.{row['engine']}.json"))
            wrong, told = {}, set()
            for about in kept:
                told |= set(json.loads(about.read_text())["kinds"])
                wrong |= check(about.parent, about.name.removesuffix(".json"))[1]
            words = "; ".join(f"{key} {a}, expected {b}" for key, (a, b) in wrong.items())
            rows.append([row["workload"], row["engine"], "yes" if told and told <= set(wrong) else "no", words])
            print(*rows[-1], sep=": ", flush=True)
    with open(recording / "conformance.csv", newline="") as file:
        wrong_grids = {row["engine"] for row in csv.DictReader(file) if row["wrong"]}
    for about in sorted((recording / "wrong" / "random-grids").glob("*.json")):
        if about.stem not in wrong_grids:
            continue
        found = check_grids(recording, about.stem)
        words = "; ".join(f"grid {grid}: " + ", ".join(f"{key} {a}, expected {b}" for key, (a, b) in wrong.items()) for grid, wrong in found)
        rows.append(["random-grids", about.stem, "yes" if all(wrong for _, wrong in found) else "no", words])
        print(*rows[-1], sep=": ", flush=True)
    with open(recording / "confirmed.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([["workload", "engine", "confirmed", "found"], *rows])
    return int(any(row[2] == "no" for row in rows))


sys.exit(main())
