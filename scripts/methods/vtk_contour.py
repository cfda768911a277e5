"""VTK's contour filter, on one thread. On image data it runs vtkSynchronizedTemplates3D: marching cubes that goes from row to row.

It makes one vertex per edge crossing, so that no points are left to merge. A sample equal to the isovalue is inside there.
"""

from protocol import serve
from vtk_image import contouring, single_threaded
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkContourFilter

single_threaded()
serve("VTK contour filter", vtkVersion.GetVTKVersion(), contouring(vtkContourFilter), "vtkSynchronizedTemplates3D")
