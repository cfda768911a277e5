"""Subgrid marching tetrahedra (Baktash, Gillespie & Crane 2026), bound to one CPU. It reads a file of tetrahedra and edge crossings.

Both are made before the clock starts: six tetrahedra for each cell that the surface crosses, and one crossing at most per edge, as samples
have no more. It tells its own time. It cannot know the outside: triangles are turned by the ends of their edges after the clock stopped.
"""

import os
import tempfile
from time import perf_counter

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # it starts as many threads as there are CPUs

import numpy as np
import subgrid_marching
from protocol import Extraction, serve
from tetrahedra import crossed_tetrahedra


def extract(samples, request):
    begin = perf_counter()
    points, inside, tetrahedra, edges, crossings = crossed_tetrahedra(samples, request["size"], request["isovalue"])
    arrays = {"tets": tetrahedra, "edges": edges, "isect_offsets": np.arange(len(edges) + 1)}
    arrays = {name: array.astype(np.int32) for name, array in arrays.items()}
    with tempfile.NamedTemporaryFile(suffix=".npz") as file:
        np.savez(file, vertices=points, isect_ts=crossings, **arrays)
        file.flush()
        found = subgrid_marching.primal_from_npz(file.name)
    seconds = found.isect_time + found.construction_time + found.assembly_time
    low, high = found.signatures[:, :2].T  # the ends of each vertex's edge; the triangle of their middles faces as its own does
    corners, triangles = points[low] + points[high], found.face_vertices.reshape(-1, 3)
    outwards = (points[high] - points[low]) * np.where(inside[low], 1, -1)[:, None]
    p, q, r = corners[triangles].swapaxes(0, 1)
    turned = (np.cross(q - p, r - p) * outwards[triangles[:, 0]]).sum(axis=1) < 0
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    positions = found.vertices * np.array(request["spacing"]) + request["origin"]
    return Extraction(positions, triangles, seconds, perf_counter() - begin - seconds)


serve("subgrid marching tetrahedra", subgrid_marching.__version__, extract, "one crossing per edge: marching tetrahedra")
