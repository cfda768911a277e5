"""libigl's marching cubes. It takes the position of each sample too, and both as 64-bit floats, which are made before the clock starts.

Inside is below the isovalue: samples are negated.
"""

from importlib.metadata import version
from time import perf_counter

import igl
import numpy as np
from protocol import Extraction, serve


def extract(samples, request):
    begin = perf_counter()
    axes = [low + step * np.arange(n) for low, step, n in zip(request["origin"], request["spacing"], request["size"])]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    values = -samples.astype(np.float64)
    converted = perf_counter() - begin
    begin = perf_counter()
    positions, triangles, _ = igl.marching_cubes(values, points, *request["size"], -request["isovalue"])
    return Extraction(positions, triangles, perf_counter() - begin, converted)


serve("libigl marching cubes", version("libigl"), extract)
