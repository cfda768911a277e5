"""ferreus_rmt: regularised marching tetrahedra (Treece, Prager & Gee 1999) that follow the surface, on one thread.

It takes a function, not samples: their trilinear interpolant, whose time is taken off and told as `callback_s`. Its lattice is
body-centred, with one cell of the grid for its resolution. It starts from a point on each grid edge that the surface crosses.
Inside is below the isovalue: values are negated. It works in cells, so that spacings may differ.
"""

import os
from importlib.metadata import version
from time import perf_counter

os.environ["RAYON_NUM_THREADS"] = "1"

import ferreus_rmt
import numpy as np
from interpolant import Trilinear
from protocol import Extraction, serve


def extract(samples, request):
    values = Trilinear(samples, request["size"])
    points = values.crossings(request["isovalue"])
    before, box = values.seconds, np.array([0.0, 0.0, 0.0, *values.last])
    begin = perf_counter()
    mesh = ferreus_rmt.build_isosurface(points, box, 1.0, -request["isovalue"], lambda points: -values(points))
    seconds = perf_counter() - begin - (values.seconds - before)
    begin = perf_counter()
    positions = mesh.vertices * np.array(request["spacing"]) + request["origin"]
    return Extraction(positions, mesh.facets, seconds, values.seconds + perf_counter() - begin)


serve("ferreus_rmt", version("ferreus_rmt"), extract, "it calls the samples' trilinear interpolant, which is not in its time")
