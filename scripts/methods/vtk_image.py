"""What VTK's adapters need: samples as an image, a surface as arrays, one thread."""

from time import perf_counter

import numpy as np
from protocol import Extraction
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkImageData


def single_threaded():
    vtkSMPTools.SetBackend("Sequential")
    vtkSMPTools.Initialize(1)


def as_image(samples, request):
    """The image does not copy the samples, and they have to outlive it."""
    image = vtkImageData()
    image.SetDimensions(*request["size"])
    image.SetOrigin(*request["origin"])
    image.SetSpacing(*request["spacing"])
    image.GetPointData().SetScalars(numpy_to_vtk(samples, deep=False))
    return image


def surface(data):
    """Positions and triangles; copies, since the arrays go with the filter."""
    if data.GetNumberOfPolys() == 0:
        return np.empty((0, 3), np.float32), np.empty((0, 3), np.uint32)
    positions = vtk_to_numpy(data.GetPoints().GetData()).astype(np.float32)
    return positions, vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.uint32)


def contouring(kind):
    """An extraction by a filter of this kind, without normals, gradients and interpolated scalars."""

    def extract(samples, request):
        begin = perf_counter()
        image = as_image(samples, request)
        converted = perf_counter() - begin
        contour = kind()
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

    return extract
