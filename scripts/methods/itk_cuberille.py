"""ITK's cuberille: faces of the voxels inside, cut into triangles, with vertices projected onto the surface, on one thread.

A vertex is projected until its value is near the isovalue. ITK's own bound, 0.5, would leave vertices of most fields where they are: here
it is a hundredth of the mean step from one sample to the next, over the range of all. A sample equal to the isovalue is inside there.
"""

from importlib.metadata import version
from time import perf_counter

import itk
import numpy as np
from protocol import Extraction, serve


def extract(samples, request):
    begin = perf_counter()
    image = itk.image_view_from_array(samples.reshape(request["size"][::-1]))
    image.SetOrigin(request["origin"])
    image.SetSpacing(request["spacing"])
    converted = perf_counter() - begin
    cuberille = itk.CuberilleImageToMeshFilter.New(image)
    cuberille.SetIsoSurfaceValue(request["isovalue"])
    cuberille.SetProjectVertexSurfaceDistanceThreshold(float(np.ptp(samples[np.isfinite(samples)])) / max(request["size"]) / 100)
    begin = perf_counter()
    cuberille.Update()
    seconds = perf_counter() - begin
    begin = perf_counter()
    mesh = itk.dict_from_mesh(cuberille.GetOutput())
    positions = mesh["points"].reshape(-1, 3)
    triangles = mesh["cells"].reshape(-1, 5)[:, 2:]
    return Extraction(positions, triangles, seconds, converted + perf_counter() - begin)


itk.MultiThreaderBase.SetGlobalMaximumNumberOfThreads(1)
serve("ITK cuberille", version("itk-cuberille"), extract)
