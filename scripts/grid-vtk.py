#!/usr/bin/env python3
"""Holds isostudy's grids against VTK: what both read, where both put vertices, and how long both take.

Usage: scripts/grid-vtk.py [--time] EXAMPLE
       scripts/grid-vtk.py --fixtures FOLDER

EXAMPLE is the program of examples/grid_to_ply.rs, which Cargo builds:
cargo build --release -p isostudy-grid --example grid_to_ply
It takes Python with NumPy and VTK (pip install vtk; since 9.7 it joins equal points). VTK writes two grids in every way that it knows, with coordinates that texts have
exactly. Then it is printed

- how many files there are of each grid, and how many different meshes isostudy makes of them: there must be one;
- whether its vertices are those of vtkContourGrid and vtkContour3DLinearGrid;
- the Euler characteristic of its mesh, and crossed edges - crossed triangles + crossed tetrahedra.

With --time, a grid of 1,053,696 tetrahedra is extracted by all three, the best of seven times each.
With --fixtures it writes the small files of crates/isostudy-grid/tests/it/vtk, and the places of vtkContourGrid's vertices on them.
It ends with 1 if anything differs.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

ARRAY = "a value"


def with_array(grid, values, name=ARRAY):
    array = numpy_to_vtk(values, deep=1)
    array.SetName(name)
    grid.GetPointData().AddArray(array)
    grid.GetPointData().SetActiveScalars(ARRAY)
    return grid


def points_of(places):
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(places), deep=1))
    return points


def rounded(numbers, parts=64):
    """In 64ths or the like, of which texts have all digits."""
    return (np.round(numbers * parts) / parts).astype(np.float32)


def tetrahedra(count):
    """Delaunay tetrahedra of random points, with the distance to a sphere, a vector, and values on cells."""
    places = np.unique(rounded(np.random.default_rng(3).uniform(-1, 1, (count, 3))), axis=0)
    cloud = vtk.vtkPolyData()
    cloud.SetPoints(points_of(places))
    delaunay = vtk.vtkDelaunay3D()
    delaunay.SetInputData(cloud)
    delaunay.Update()
    grid = delaunay.GetOutput()
    places = vtk_to_numpy(grid.GetPoints().GetData())
    with_array(grid, places, "velocity")
    on_cells = numpy_to_vtk(np.arange(grid.GetNumberOfCells(), dtype=np.float64), deep=1)
    on_cells.SetName("on cells")
    grid.GetCellData().AddArray(on_cells)
    return with_array(grid, rounded(1 - np.sqrt((places**2).sum(1))))


def curvilinear():
    """A quarter of a pipe, which leans."""
    nx, ny, nz = 9, 8, 7
    i, j, k = np.meshgrid(np.arange(nx), np.arange(ny), np.arange(nz), indexing="ij")
    radius, angle = 1 + i / (nx - 1), 2 * j / (ny - 1)
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle), k / (nz - 1) + 0.1 * radius], -1)
    places = rounded(places.transpose(2, 1, 0, 3).reshape(-1, 3), 16)
    grid = vtk.vtkStructuredGrid()
    grid.SetDimensions(nx, ny, nz)
    grid.SetPoints(points_of(places))
    return with_array(grid, rounded(np.sin(3 * places[:, 0]) + places[:, 1] * places[:, 2], 16))


def unstructured(grid):
    append = vtk.vtkAppendFilter()
    append.AddInputData(grid)
    append.Update()
    return append.GetOutput()


def write_all(grid, folder, name):
    """The grid in every way that VTK writes it."""
    is_curved = isinstance(grid, vtk.vtkStructuredGrid)
    xml, ending = (
        (vtk.vtkXMLStructuredGridWriter, "vts") if is_curved else (vtk.vtkXMLUnstructuredGridWriter, "vtu")
    )
    files = []
    for mode in ["Ascii", "Binary", "Appended"]:
        for compressor in ["None", "ZLib"]:
            for is_base64 in [0, 1] if mode == "Appended" else [0]:
                for header in ["UInt32", "UInt64"]:
                    for order in ["Little", "Big"]:
                        writer = xml()
                        getattr(writer, "SetDataModeTo" + mode)()
                        getattr(writer, "SetCompressorTypeTo" + compressor)()
                        getattr(writer, f"SetHeaderTypeTo{header}")()
                        getattr(writer, f"SetByteOrderTo{order}Endian")()
                        writer.SetEncodeAppendedData(is_base64)
                        writer.SetBlockSize(4096)
                        files.append((writer, f"{name}_{mode}_{compressor}_{is_base64}_{header}_{order}.{ending}"))
    for version in [42, 51]:
        for is_binary in [0, 1]:
            writer = vtk.vtkStructuredGridWriter() if is_curved else vtk.vtkUnstructuredGridWriter()
            writer.SetFileVersion(version)
            writer.SetFileType(vtk.VTK_BINARY if is_binary else vtk.VTK_ASCII)
            files.append((writer, f"{name}_{version}_{is_binary}_{ending}.vtk"))
    for writer, file in files:
        writer.SetInputData(grid)
        writer.SetFileName(str(folder / file))
        assert writer.Write(), file
    return [folder / file for _, file in files]


def write_tetgen(grid, folder, name):
    places = vtk_to_numpy(grid.GetPoints().GetData())
    values = vtk_to_numpy(grid.GetPointData().GetArray(ARRAY))
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    lines = [f"{len(places)} 3 1 0"]
    lines += [" ".join(map(repr, [i + 1, *map(float, at), float(value)])) for i, (at, value) in enumerate(zip(places, values))]
    (folder / f"{name}.node").write_text("\n".join(lines) + "\n")
    lines = [f"{len(cells)} 4 0"]
    lines += [" ".join(str(number) for number in [i + 1, *(cell + 1)]) for i, cell in enumerate(cells)]
    (folder / f"{name}.ele").write_text("\n".join(lines) + "\n")
    return [folder / f"{name}.node", folder / f"{name}.ele"]


def extract(example, file, isovalue, out):
    array = "1" if file.suffix in (".node", ".ele") else ARRAY
    done = subprocess.run([example, file, array, str(isovalue), out], check=True, capture_output=True, text=True)
    return done.stdout.strip()


def read_ply(path):
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    faces = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(mesh.GetPoints().GetData()), faces


def contour(filter_type, grid, isovalue):
    made = filter_type()
    made.SetInputData(grid)
    made.SetValue(0, isovalue)
    started = time.perf_counter()
    made.Update()
    return made.GetOutput(), time.perf_counter() - started


def places_of(points):
    """Different places, to the rounding of single precision."""
    return {tuple(place) for place in np.round(np.asarray(points, np.float64), 5) + 0.0}


def crossed_faces(cells, inside):
    """Crossed edges, triangles and tetrahedra."""
    counts = []
    for corners in [[(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)], [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)], [(0, 1, 2, 3)]]:
        faces = np.unique(np.sort(np.concatenate([cells[:, list(of)] for of in corners]), axis=1), axis=0)
        side = inside[faces]
        counts.append(int((side.any(1) & ~side.all(1)).sum()))
    return counts


def euler(faces):
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    return len(np.unique(faces)) - len(edges) + len(faces)


def check(example, folder):
    is_good = True
    tets, pipe = tetrahedra(400), curvilinear()
    for name, grid, isovalue, files in [
        ("tetrahedra", tets, 0.105, write_all(tets, folder, "t") + write_tetgen(tets, folder, "t")),
        ("curvilinear", pipe, 0.405, write_all(pipe, folder, "c") + write_all(unstructured(pipe), folder, "u")),
    ]:
        meshes = set()
        for file in files:
            extract(example, file, isovalue, folder / "out.ply")
            meshes.add((folder / "out.ply").read_bytes())
        print(f"{name}: {len(files)} files, {len(meshes)} mesh")
        is_good &= len(meshes) == 1
        places, faces = read_ply(folder / "out.ply")
        ours = places_of(places)
        for filter_type in [vtk.vtkContourGrid, vtk.vtkContour3DLinearGrid]:
            if name == "curvilinear":
                # VTK has vertices on the edges of hexahedra alone; ours has those and more.
                grid = unstructured(pipe)
            theirs = places_of(vtk_to_numpy(contour(filter_type, grid, isovalue)[0].GetPoints().GetData()))
            missing, beyond = len(theirs - ours), len(ours - theirs)
            print(f"  {filter_type.__name__}: {len(theirs)} places, {missing} not ours; {beyond} of ours not there")
            is_good &= missing == 0 and (name == "curvilinear" or beyond == 0)
        if name == "tetrahedra":
            cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
            inside = vtk_to_numpy(grid.GetPointData().GetArray(ARRAY)) > np.float64(isovalue)
            edges, triangles, solids = crossed_faces(cells, inside)
            print(
                f"  Euler characteristic {euler(faces)} = {edges} - {triangles} + {solids} = {edges - triangles + solids};"
                f" {len(places)} vertices, {len(faces)} triangles"
            )
            is_good &= euler(faces) == edges - triangles + solids and len(places) == edges
    return is_good


def times(example, folder):
    """A gyroid in 56 cubes along each side, six tetrahedra in each."""
    n = 57
    axis = np.arange(n, dtype=np.int64)
    i, j, k = (a.ravel() for a in np.meshgrid(axis[:-1], axis[:-1], axis[:-1], indexing="ij"))
    corner = lambda x, y, z: (i + x) + n * ((j + y) + n * (k + z))
    paths = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    cells = []
    for path in paths:
        at, chain = [0, 0, 0], [corner(0, 0, 0)]
        for step in path:
            at[step] = 1
            chain.append(corner(*at))
        cells.append(np.stack(chain, 1))
    cells = np.concatenate(cells)
    z, y, x = np.meshgrid(*[np.linspace(0, 6 * np.pi, n)] * 3, indexing="ij")
    places = np.stack([x, y, z], -1).reshape(-1, 3).astype(np.float32)
    values = (np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)).ravel().astype(np.float32)
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points_of(places))
    array = vtk.vtkCellArray()
    offsets = np.arange(0, 4 * len(cells) + 1, 4, dtype=np.int64)
    array.SetData(numpy_to_vtk(offsets, deep=1, array_type=vtk.VTK_ID_TYPE), numpy_to_vtk(cells.ravel(), deep=1, array_type=vtk.VTK_ID_TYPE))
    grid.SetCells(vtk.VTK_TETRA, array)
    with_array(grid, values)
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(str(folder / "large.vtu"))
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    writer.Write()
    print("isostudy:", extract(example, folder / "large.vtu", 0.1, folder / "out.ply"))
    vtk.vtkSMPTools.Initialize(1)
    for filter_type in [vtk.vtkContour3DLinearGrid, vtk.vtkContourGrid]:
        best = min(contour(filter_type, grid, 0.1)[1] for _ in range(7))
        made = contour(filter_type, grid, 0.1)[0]
        print(f"{filter_type.__name__}: {made.GetNumberOfPoints()} vertices, {made.GetNumberOfCells()} triangles in {1e3 * best:.1f} ms")


def mixed():
    """A hexahedron with a pyramid, a wedge, a voxel and a tetrahedron at it, and a triangle and a line, which have no volume."""
    grid = vtk.vtkUnstructuredGrid()
    places = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    places += [[0.5, 0.5, 2], [2, 0, 0.5], [2, 1, 0.5], [0, -1, 0], [1, -1, 0], [0, -1, 1], [1, -1, 1], [2, 0.5, 1.5]]
    places = np.array(places, np.float64)
    grid.SetPoints(points_of(places))
    for kind, of in [
        (vtk.VTK_HEXAHEDRON, [0, 1, 2, 3, 4, 5, 6, 7]),
        (vtk.VTK_PYRAMID, [4, 5, 6, 7, 8]),
        (vtk.VTK_WEDGE, [1, 9, 5, 2, 10, 6]),
        (vtk.VTK_VOXEL, [11, 12, 0, 1, 13, 14, 4, 5]),
        (vtk.VTK_TRIANGLE, [0, 1, 2]),
        (vtk.VTK_TETRA, [5, 6, 8, 15]),
        (vtk.VTK_LINE, [0, 6]),
    ]:
        grid.InsertNextCell(kind, len(of), of)
    return with_array(grid, np.array([0.25 * x + 0.5 * y + z for x, y, z in places]))


def write_fixtures(folder):
    """Some of what `write_all` writes, of twelve points and of mixed cells."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = ["Ascii_None_0_UInt32_Little", "Binary_None_0_UInt64_Big", "Binary_ZLib_0_UInt32_Little"]
    kept += ["Appended_ZLib_0_UInt64_Little", "Appended_None_1_UInt32_Little", "42_1", "51_0", "42_0", "51_1"]
    few, all_kinds = tetrahedra(24), mixed()
    with tempfile.TemporaryDirectory() as all_files:
        for name, grid in [("few", few), ("mixed", all_kinds)]:
            for file in write_all(grid, Path(all_files), name):
                if any(f"{name}_{way}" in file.name for way in kept):
                    (folder / file.name).write_bytes(file.read_bytes())
        for file in write_tetgen(few, folder, "few"):
            print(file)
    places = vtk_to_numpy(contour(vtk.vtkContourGrid, few, 0.105)[0].GetPoints().GetData())
    (folder / "few_places.txt").write_text("".join(f"{x} {y} {z}\n" for x, y, z in sorted(places.tolist())))


def main():
    if sys.argv[1:2] == ["--fixtures"] and len(sys.argv) == 3:
        return write_fixtures(Path(sys.argv[2]))
    arguments = [argument for argument in sys.argv[1:] if argument != "--time"]
    if len(arguments) != 1:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        if "--time" in sys.argv:
            times(arguments[0], Path(folder))
        elif not check(arguments[0], Path(folder)):
            sys.exit(1)


if __name__ == "__main__":
    main()
