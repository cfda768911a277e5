"""VTK's contour filter, on one thread. On image data it runs vtkSynchronizedTemplates3D: marching cubes that goes from row to row.

Without normals, gradients and interpolated scalars. It makes one vertex per edge crossing, so that no points are left to merge.
A sample equal to the isovalue is inside there.
"""

from time import perf_counter

from protocol import Extraction, serve
from vtk_image import as_image, single_threaded, surface
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkContourFilter


def extract(samples, request):
    begin = perf_counter()
    image = as_image(samples, request)
    converted = perf_counter() - begin
    contour = vtkContourFilter()
    contour.SetInputData(image)
    contour.SetValue(0, request["isovalue"])
    contour.ComputeNormalsOff()
    contour.ComputeGradientsOff()
    contour.ComputeScalarsOff()
    begin = perf_counter()
    contour.Update()
    seconds = perf_counter() - begin
    begin = perf_counter()
    positions, triangles = surface(contour.GetOutput())
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


single_threaded()
serve("VTK contour filter", vtkVersion.GetVTKVersion(), extract, "vtkSynchronizedTemplates3D")
