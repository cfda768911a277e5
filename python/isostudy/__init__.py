"""Isosurfaces of NumPy arrays, what their meshes are worth, and what people say of them.

>>> import numpy as np, isostudy
>>> x, y, z = np.meshgrid(*3 * [np.linspace(-1.2, 1.2, 49, dtype=np.float32)], indexing="ij")
>>> mesh = isostudy.extract(1 - np.sqrt(x * x + y * y + z * z), spacing=0.05, origin=-1.2)
>>> isostudy.topology(mesh)["is_closed_manifold"]
True
>>> isostudy.verify(mesh, 1 - np.sqrt(x * x + y * y + z * z))["is_right"]
True

``analyse`` reads people's choices between two things each, and says which they liked more.

Inside is a value above the isovalue. Triangles are counter-clockwise seen from outside. The same array, method and
isovalue give the same bytes, on any number of threads.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from . import _isostudy
from ._isostudy import __version__

__all__ = ["Analysis", "Mesh", "Method", "analyse", "extract", "methods", "quality", "topology", "verify", "__version__"]


class Mesh:
    """A triangle mesh: three arrays that can be read, and not be changed.

    ``vertices`` has a row of three ``float32`` for each vertex, in the order of the array's axes. ``normals`` has as many rows, of
    unit length and outward; none if the mesh was made of arrays. ``faces`` has a row of three ``uint32`` for each triangle:
    the numbers of its vertices.
    """

    def __init__(self, vertices, faces):
        """A mesh of one's own arrays, which are copied.

        Raises ValueError if a row has not three numbers, or a face has a vertex that there is not.
        """
        vertices = np.ascontiguousarray(vertices, dtype=np.float32)
        faces = np.asarray(faces)
        if faces.size and (not np.issubdtype(faces.dtype, np.integer) or faces.min() < 0 or faces.max() >= 2**32):
            raise ValueError("faces must be whole numbers from 0 to 2**32 - 1")
        self._set(_isostudy.Mesh(vertices, np.ascontiguousarray(faces, dtype=np.uint32)))

    def _set(self, native):
        self._native = native
        # Views of the memory that the mesh was made in.
        self.vertices = np.asarray(native.vertices())
        self.normals = np.asarray(native.normals())
        self.faces = np.asarray(native.faces())

    @classmethod
    def _of(cls, native):
        mesh = cls.__new__(cls)
        mesh._set(native)
        return mesh

    @property
    def volume(self):
        """The volume inside, in the unit of the vertices to the third power."""
        return self._native.volume()

    def __repr__(self):
        return f"<isostudy.Mesh: {len(self.vertices)} vertices, {len(self.faces)} faces>"


class Method:
    """A method that has a name: ``id``, ``label``, ``source``, and whether each of its meshes ``is_manifold``."""

    def __init__(self, id, label, source, is_manifold):
        self.id, self.label, self.source, self.is_manifold = id, label, source, is_manifold

    def __repr__(self):
        return f"<isostudy.Method {self.id!r}: {self.label}>"


def methods():
    """All methods that have a name, as a list."""
    return [Method(*of) for of in _isostudy.methods()]


def _samples(array):
    """The array as float32 in C order. It is copied only if it is not."""
    array = np.asarray(array)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"samples of type {array.dtype}: they must be real numbers")
    return np.ascontiguousarray(array, dtype=np.float32)


def _three(name, value):
    """One number for all axes, or one for each."""
    numbers = np.broadcast_to(np.asarray(value, dtype=np.float64), 3) if np.ndim(value) == 0 else np.asarray(value)
    if np.shape(numbers) != (3,):
        raise ValueError(f"{name} = {value!r}: must be a number, or three of them")
    return [float(number) for number in numbers]


def extract(array, isovalue=0.0, method="mc33", *, spacing=1.0, origin=0.0, threads=0):
    """The surface where an array of three axes has the isovalue, as a Mesh.

    array: samples; ``array[i, j, k]`` lies at ``origin + (i, j, k) * spacing``. ``float32`` in C order is read where it is;
        anything else is copied. Do not write to it meanwhile.
    isovalue: inside is above.
    method: a name; ``methods()`` lists them.
    spacing, origin: a number, or three of them.
    threads: 0 takes all cores. Other threads of Python run meanwhile. The mesh does not depend on it.

    Raises ValueError for an argument that is not what it must be, MemoryError without memory.
    """
    spacing, origin = _three("spacing", spacing), _three("origin", origin)
    return Mesh._of(_isostudy.extract(_samples(array), isovalue, method, spacing, origin, threads))


def quality(mesh):
    """What the triangles are worth, as a dict.

    ``radius_ratio`` (1 is equilateral), ``edge_ratio``, ``min_angle_deg``, ``max_angle_deg`` and ``area`` are dicts with ``mean``, ``sd``,
    ``min``, ``median``, ``max`` and ``count``. ``triangles``, ``degenerate`` (those without area) and ``shortest_edge`` are numbers.
    """
    return _isostudy.quality(mesh._native)


def topology(mesh):
    """How the triangles hang together, as a dict of counts, with ``is_closed_manifold``."""
    return _isostudy.topology(mesh._native)


def verify(mesh, array, isovalue=0.0):
    """Whether a mesh has the topology of the array's trilinear interpolant, as a dict.

    ``is_right`` says it. ``found`` and ``expected`` have components, Euler characteristic, boundary loops and genus; ``findings`` names
    each difference with both numbers. Vertices count by their numbers, not by their places.
    """
    return _isostudy.verify(mesh._native, _samples(array), isovalue)


class Analysis(Mapping):
    """Tables about people's answers, by name: ``analysis["worths"]``.

    Each is a data frame of the library that the answers came in: pandas, polars or pyarrow. From another library it is an object that
    any library takes by Arrow (``__arrow_c_stream__``). ``found`` says in words what was found. ``read`` says how the frame was read,
    and names what was not taken as it stands. ``captions`` and ``notes`` have what is printed above and below each table.
    """

    def __init__(self, found, read, tables, of):
        self.found, self.read = found, read
        self.captions = {name: caption for name, caption, _, _ in tables}
        self.notes = {name: notes for name, _, notes, _ in tables}
        self._tables = {name: _as(of, table) for name, _, _, table in tables}

    def __getitem__(self, name):
        return self._tables[name]

    def __iter__(self):
        return iter(self._tables)

    def __len__(self):
        return len(self._tables)

    def __repr__(self):
        return f"<isostudy.Analysis of {', '.join(self)}>"


def _as(of, table):
    """The table as a frame of the library that `of` is of."""
    library = type(of).__module__.partition(".")[0]
    if library == "polars":
        import polars

        return polars.DataFrame(table)
    if library in ("pandas", "pyarrow"):
        # pandas gives and takes Arrow by pyarrow.
        import pyarrow

        return pyarrow.table(table).to_pandas() if library == "pandas" else pyarrow.table(table)
    return table


def analyse(frame, *, reference=None, shown_s=None, many=False):
    """Factors, tests and worths of answers to paired comparisons, as ``isostudy analyse FILE`` computes them.

    frame: a data frame of pandas (with pyarrow), polars or pyarrow, or whatever has ``__arrow_c_stream__``. A row is an answer:
        ``participant``, ``question``, ``left``, ``right``, and ``choice``, which is ``left``, ``none`` or ``right``. ``group``,
        ``object``, ``rt_ms``, ``count`` and others may be given; docs/answers.md lists them. Further columns are passed over.
    reference: the item whose worth is 0; otherwise the first by name.
    shown_s: how long a pair must be seen. Faster answers are named.
    many: count pairs alone, as is done beyond a million answers or a hundred items.

    The same answers give the same numbers, on any number of threads. Other threads of Python run meanwhile.

    Raises TypeError for what is no frame, ValueError for answers that cannot be read.
    """
    if not hasattr(frame, "__arrow_c_stream__"):
        raise TypeError(f"{type(frame).__name__} is no data frame: it has no __arrow_c_stream__")
    return Analysis(*_isostudy.analyse(frame, reference, shown_s, many), frame)
