"""VTK's Flying Edges (Schroeder, Maynard & Geveci 2015), on one thread. A sample equal to the isovalue is inside there."""

from protocol import serve
from vtk_image import contouring, single_threaded
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

single_threaded()
serve("VTK Flying Edges", vtkVersion.GetVTKVersion(), contouring(vtkFlyingEdges3D))
