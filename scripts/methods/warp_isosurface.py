"""Warp's isosurfaces, on the CPU and one thread: `marching-cubes` or `surface-nets`.

Its kernels are compiled before it says that it is ready. Inside is below the isovalue: samples are negated before the clock starts. The
vertices of its surface nets lie at the mean of their cell's edge crossings.
"""

import sys
import tempfile
from time import perf_counter

import numpy as np
import warp
from protocol import Extraction, serve
from warp.geometry import IsoSurfaceMarchingCubes, IsoSurfaceNets

METHOD = {"marching-cubes": IsoSurfaceMarchingCubes, "surface-nets": IsoSurfaceNets}[sys.argv[1]]


def extract(samples, request):
    begin = perf_counter()
    field = warp.array(-samples.reshape(request["size"][::-1]), dtype=float, device="cpu")
    converted = perf_counter() - begin
    begin = perf_counter()
    positions, triangles = METHOD.extract(field, -request["isovalue"])
    seconds = perf_counter() - begin
    begin = perf_counter()
    # Its first axis is z. Exchanging x and z mirrors the surface, so its triangles are turned round.
    positions = positions.numpy()[:, ::-1] * np.array(request["spacing"]) + request["origin"]
    triangles = triangles.numpy().reshape(-1, 3)[:, ::-1]
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


warp.config.log_level, warp.config.kernel_cache_dir = warp.LOG_WARNING, tempfile.gettempdir()
corner = np.array([0, 0, 0, 0, 0, 0, 0, 1], np.float32)
extract(corner, {"size": [2, 2, 2], "origin": [0, 0, 0], "spacing": [1, 1, 1], "isovalue": 0.5})
serve(f"Warp {sys.argv[1].replace('-', ' ')}", warp.__version__, extract)
