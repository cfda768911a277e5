"""PyMCubes: classic marching cubes (Lorensen & Cline 1987)."""

from importlib.metadata import version
from time import perf_counter

import mcubes
import numpy as np
from protocol import Extraction, serve


def extract(samples, request):
    # Its first axis is the slowest: z.
    volume = samples.reshape(request["size"][::-1])
    begin = perf_counter()
    positions, triangles = mcubes.marching_cubes(volume, request["isovalue"])
    seconds = perf_counter() - begin
    begin = perf_counter()
    # Exchanging x and z mirrors the surface, so its triangles are turned round.
    positions = (positions[:, ::-1] * np.array(request["spacing"]) + request["origin"]).astype(np.float32)
    return Extraction(positions, triangles[:, ::-1], seconds, perf_counter() - begin)


serve("PyMCubes", version("PyMCubes"), extract)
