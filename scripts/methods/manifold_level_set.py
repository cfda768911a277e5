"""manifold3d's level set, on a body-centred lattice.

It takes a function, not samples, and its lattice has points between those of the grid: there the samples are interpolated, trilinearly,
which is another surface than the field's own. The function is called through Python, sample by sample. Its own time is taken
off and told as `callback_s`; that of the calls cannot be, so that the time says little of the library.
"""

from importlib.metadata import version
from time import perf_counter

from manifold3d import Manifold
from protocol import Extraction, serve


def extract(samples, request):
    begin = perf_counter()
    (nx, ny, nz), (x0, y0, z0), isovalue = request["size"], request["origin"], request["isovalue"]
    spacing = request["spacing"][0]
    if max(request["spacing"]) - min(request["spacing"]) > 1e-6 * spacing:
        raise ValueError(f"it takes one spacing, not {request['spacing']}")
    values, layer = samples.tolist(), nx * ny
    spent = perf_counter() - begin

    def trilinear(x, y, z):
        nonlocal spent
        begin = perf_counter()
        x, y, z = (x - x0) / spacing, (y - y0) / spacing, (z - z0) / spacing
        i, j, k = min(max(int(x), 0), nx - 2), min(max(int(y), 0), ny - 2), min(max(int(z), 0), nz - 2)
        x, y, z = min(max(x - i, 0.0), 1.0), min(max(y - j, 0.0), 1.0), min(max(z - k, 0.0), 1.0)
        rows = []
        for n in (i + nx * j + layer * k, i + nx * (j + 1) + layer * k):
            for n in (n, n + layer):
                rows.append(values[n] + (values[n + 1] - values[n]) * x)
        low, high = rows[0] + (rows[2] - rows[0]) * y, rows[1] + (rows[3] - rows[1]) * y
        value = low + (high - low) * z - isovalue
        spent += perf_counter() - begin
        return value

    far = [low + spacing * (n - 1) for low, n in zip(request["origin"], request["size"])]
    before, begin = spent, perf_counter()
    solid = Manifold.level_set(trilinear, [x0, y0, z0, *far], spacing)
    seconds = perf_counter() - begin - (spent - before)
    begin = perf_counter()
    surface = solid.to_mesh()
    positions, triangles = surface.vert_properties[:, :3], surface.tri_verts
    return Extraction(positions, triangles, seconds, spent + perf_counter() - begin)


serve("manifold3d level set", version("manifold3d"), extract, "it calls the samples' interpolation through Python, which is in its time")
