"""Open3D's isosurfaces: Flying Edges of the VTK that it is linked with, on one thread."""

import os
from time import perf_counter

os.environ.update(OMP_NUM_THREADS="1", VTK_SMP_BACKEND_IN_USE="Sequential")  # both are read when Open3D is loaded

import numpy as np
import open3d
from protocol import Extraction, serve


def extract(samples, request):
    begin = perf_counter()
    volume = open3d.core.Tensor.from_numpy(samples.reshape(request["size"][::-1]))
    converted = perf_counter() - begin
    begin = perf_counter()
    mesh = open3d.t.geometry.TriangleMesh.create_isosurfaces(volume, [request["isovalue"]])
    seconds = perf_counter() - begin
    begin = perf_counter()
    positions = mesh.vertex.positions.numpy() * np.array(request["spacing"]) + request["origin"]
    triangles = mesh.triangle.indices.numpy()
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


serve("Open3D isosurfaces", open3d.__version__, extract)
