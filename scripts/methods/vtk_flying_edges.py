"""VTK's Flying Edges (Schroeder, Maynard & Geveci 2015), on one thread.

Without normals, gradients and interpolated scalars. A sample equal to the isovalue is inside there.
"""

from time import perf_counter

from protocol import Extraction, serve
from vtk_image import as_image, single_threaded, surface
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D


def extract(samples, request):
    begin = perf_counter()
    image = as_image(samples, request)
    converted = perf_counter() - begin
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, request["isovalue"])
    edges.ComputeNormalsOff()
    edges.ComputeGradientsOff()
    edges.ComputeScalarsOff()
    begin = perf_counter()
    edges.Update()
    seconds = perf_counter() - begin
    begin = perf_counter()
    positions, triangles = surface(edges.GetOutput())
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


single_threaded()
serve("VTK Flying Edges", vtkVersion.GetVTKVersion(), extract)
