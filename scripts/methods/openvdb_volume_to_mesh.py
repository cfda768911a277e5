"""OpenVDB's volumeToMesh, on one thread: a vertex at the mean of its cell's edge crossings, without normals.

It takes a sparse grid, which is made of the samples before the clock starts. Inside is below the isovalue: samples are negated. Beyond the
box is outside, so that it closes a surface there. Its quadrilaterals are cut after the clock stopped.
"""

import os
from time import perf_counter

os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # TBB starts as many threads as there are CPUs allowed

import numpy as np
import pyopenvdb
from protocol import Extraction, serve


def extract(samples, request):
    begin = perf_counter()
    grid = pyopenvdb.FloatGrid(float(-samples.min()))
    grid.copyFromArray(np.ascontiguousarray(-samples.reshape(request["size"][::-1]).T))
    converted = perf_counter() - begin
    begin = perf_counter()
    positions, quads = grid.convertToQuads(-request["isovalue"])
    seconds = perf_counter() - begin
    begin = perf_counter()
    positions = positions * np.array(request["spacing"]) + request["origin"]
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


serve("OpenVDB volumeToMesh", ".".join(map(str, pyopenvdb.LIBRARY_VERSION)), extract)
