from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypedDict

import numpy as np
import numpy.typing as npt

__version__: str

class Mesh:
    vertices: npt.NDArray[np.float32]
    normals: npt.NDArray[np.float32]
    faces: npt.NDArray[np.uint32]
    def __init__(self, vertices: npt.ArrayLike, faces: npt.ArrayLike) -> None: ...
    @property
    def volume(self) -> float: ...

class Method:
    id: str
    label: str
    source: str
    is_manifold: bool

class Distribution(TypedDict):
    mean: float
    sd: float
    min: float
    median: float
    max: float
    count: int

class Quality(TypedDict):
    triangles: int
    degenerate: int
    shortest_edge: float
    radius_ratio: Distribution
    edge_ratio: Distribution
    min_angle_deg: Distribution
    max_angle_deg: Distribution
    area: Distribution

class Topology(TypedDict):
    vertices: int
    unused_vertices: int
    edges: int
    triangles: int
    boundary_edges: int
    non_manifold_edges: int
    non_manifold_vertices: int
    misoriented_edges: int
    components: int
    boundary_loops: int
    euler_characteristic: int
    is_closed_manifold: bool

class Summary(TypedDict):
    components: int
    euler_characteristic: int
    boundary_loops: int
    genus: int

class Verdict(TypedDict):
    is_right: bool
    found: Summary
    expected: Summary
    tunnel_cells: int
    findings: list[tuple[str, int, int]]

def methods() -> list[Method]: ...
def extract(
    array: npt.ArrayLike,
    isovalue: float = ...,
    method: str = ...,
    *,
    spacing: float | Sequence[float] = ...,
    origin: float | Sequence[float] = ...,
    threads: int = ...,
) -> Mesh: ...
def quality(mesh: Mesh) -> Quality: ...
def topology(mesh: Mesh) -> Topology: ...
def verify(mesh: Mesh, array: npt.ArrayLike, isovalue: float = ...) -> Verdict: ...

class _Frame(Protocol):
    def __arrow_c_stream__(self, requested_schema: object | None = ...) -> object: ...

class Analysis(Mapping[str, Any]):
    found: str | None
    read: str
    captions: dict[str, str]
    notes: dict[str, list[str]]

def analyse(frame: _Frame, *, reference: str | None = ..., shown_s: float | None = ..., many: bool = ...) -> Analysis: ...
