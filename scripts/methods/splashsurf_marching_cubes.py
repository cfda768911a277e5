"""splashsurf's marching cubes of a grid of densities, which is single-threaded.

It wants x as the slowest axis; samples are copied into that order before the clock starts. It takes one spacing: here that of cells.
"""

from importlib.metadata import version
from time import perf_counter

import numpy as np
import pysplashsurf
from protocol import Extraction, serve


def extract(samples, request):
    begin = perf_counter()
    volume = np.ascontiguousarray(samples.reshape(request["size"][::-1]).T)
    converted = perf_counter() - begin
    begin = perf_counter()
    mesh = pysplashsurf.marching_cubes(volume, iso_surface_threshold=request["isovalue"], cube_size=1.0)
    seconds = perf_counter() - begin
    begin = perf_counter()
    positions = mesh.vertices * np.array(request["spacing"]) + request["origin"]
    return Extraction(positions, mesh.triangles, seconds, converted + perf_counter() - begin)


serve("splashsurf marching cubes", version("pysplashsurf"), extract)
