"""Extracts an isosurface with one library, as often as asked; started by the `peers` program.

usage: worker.py LIBRARY FIELDS, with FIELDS a shared library that has the fields.

A request is a line of JSON: samples (a file of 32-bit floats, x fastest), size, origin, spacing, and mesh (a file to write, or
null). A reply is a line of JSON: extraction_s, callback_s (0 where the library takes an array), or failed. Samples are read
before the clock starts; positions are written as 32-bit floats and triangles as 32-bit integers after it stopped.
"""

import ctypes
import json
import sys
from time import perf_counter

import numpy as np


def vtk_flying_edges():
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

    vtk.vtkSMPTools.Initialize(1)

    def extract(samples, request):
        image = vtk.vtkImageData()
        image.SetDimensions(*request["size"])
        image.SetOrigin(*request["origin"])
        image.SetSpacing(*[request["spacing"]] * 3)
        image.GetPointData().SetScalars(numpy_to_vtk(samples, deep=False))
        begin = perf_counter()
        filter = vtk.vtkFlyingEdges3D()
        filter.SetInputData(image)
        filter.SetValue(0, 0.0)
        filter.ComputeNormalsOff()
        filter.ComputeGradientsOff()
        filter.ComputeScalarsOff()
        filter.Update()
        seconds = perf_counter() - begin
        surface = filter.GetOutput()
        positions = vtk_to_numpy(surface.GetPoints().GetData())
        triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return seconds, 0.0, positions, triangles

    return extract, f"VTK {vtk.vtkVersion.GetVTKVersion()} vtkFlyingEdges3D"


def skimage_marching_cubes():
    import skimage
    from skimage.measure import marching_cubes

    def extract(samples, request):
        x, y, z = request["size"]
        volume = samples.reshape(z, y, x)
        begin = perf_counter()
        positions, triangles, _, _ = marching_cubes(volume, 0.0)
        seconds = perf_counter() - begin
        return seconds, 0.0, positions[:, ::-1] * request["spacing"] + request["origin"], triangles

    return extract, f"scikit-image {skimage.__version__} marching_cubes (Lewiner); normals included"


def manifold_level_set():
    from importlib.metadata import version

    from manifold3d import Manifold

    def extract(samples, request):
        # Its body-centred lattice has samples between those of the grid, so it is given the field: trilinear in the samples
        # would be another surface. The field's own time is taken from inside.
        field, spent = getattr(FIELDS, f"peer_field_{request['field']}"), 0.0
        field.argtypes, field.restype = [ctypes.c_float] * 3, ctypes.c_float

        def timed(x, y, z):
            nonlocal spent
            begin = perf_counter()
            value = field(x, y, z)
            spent += perf_counter() - begin
            return value

        low = request["origin"]
        high = [l + request["spacing"] * (n - 1) for l, n in zip(low, request["size"])]
        begin = perf_counter()
        solid = Manifold.level_set(timed, [*low, *high], request["spacing"])
        seconds = perf_counter() - begin
        surface = solid.to_mesh()
        return seconds - spent, spent, surface.vert_properties[:, :3], surface.tri_verts

    return extract, f"manifold3d {version('manifold3d')} level_set; calls the field through Python, sample by sample: the calls are in its time, which says little of the library"


FIELDS = ctypes.CDLL(sys.argv[2])
PEERS = {"vtk": vtk_flying_edges, "scikit-image": skimage_marching_cubes, "manifold3d": manifold_level_set}


def say(reply):
    print(json.dumps(reply), flush=True)


def main():
    try:
        extract, name = PEERS[sys.argv[1]]()
    except ImportError as error:
        say({"failed": str(error)})
        return
    say({"ready": name})
    for line in sys.stdin:
        request = json.loads(line)
        samples = np.fromfile(request["samples"], dtype=np.float32)
        seconds, callback, positions, triangles = extract(samples, request)
        if request["mesh"]:
            with open(request["mesh"], "wb") as file:
                np.array([len(positions), len(triangles)], dtype=np.uint64).tofile(file)
                np.ascontiguousarray(positions, dtype=np.float32).tofile(file)
                np.ascontiguousarray(triangles, dtype=np.uint32).tofile(file)
        say({"extraction_s": seconds, "callback_s": callback})


main()
