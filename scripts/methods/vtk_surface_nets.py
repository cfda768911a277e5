"""VTK's Surface Nets (Gibson 1998; Schroeder, Tsalikis, Halle & Frisken 2024), on one thread.

They take labels, not samples: 1 inside and 0 outside, which is made before the clock starts. Vertices are smoothed within their
cells as VTK does unless told otherwise; where the isovalue lies between two samples is lost.
"""

from time import perf_counter

import numpy as np
from protocol import Extraction, serve
from vtk_image import as_image, single_threaded, surface
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D


def extract(samples, request):
    begin = perf_counter()
    image = as_image((samples > request["isovalue"]).astype(np.uint8), request)
    converted = perf_counter() - begin
    nets = vtkSurfaceNets3D()
    nets.SetInputData(image)
    nets.SetValue(0, 1)
    nets.SetOutputMeshTypeToTriangles()
    begin = perf_counter()
    nets.Update()
    seconds = perf_counter() - begin
    begin = perf_counter()
    positions, triangles = surface(nets.GetOutput())
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


single_threaded()
serve("VTK Surface Nets", vtkVersion.GetVTKVersion(), extract, "of labels; smoothing is in its time")
