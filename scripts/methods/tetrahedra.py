"""The cells of a grid that a surface crosses, as six tetrahedra each, and the crossings of their edges, in cells from the first sample."""

from itertools import combinations, permutations

import numpy as np


def crossed_tetrahedra(samples, size, isovalue):
    """Points, whether each is inside, tetrahedra of four points each, the edges that are crossed, and where along each, from 0 to 1."""
    steps, inside = np.cumprod([1, *size[:2]]), samples > isovalue
    cells = np.arange(len(samples)).reshape(size[::-1])[:-1, :-1, :-1].ravel()
    corners = sum(inside[cells + np.array(n) @ steps].astype(int) for n in np.ndindex(2, 2, 2))
    cells = cells[(corners > 0) & (corners < 8)]
    # Six ways lead along three edges of a cell from its first corner to its last, one per tetrahedron; neighbours cut faces alike.
    tetrahedra = np.concatenate([np.stack([cells, cells + a, cells + a + b, cells + sum(steps)], 1) for a, b in permutations(steps, 2)])
    pairs = np.concatenate([tetrahedra[:, ends] for ends in combinations(range(4), 2)])
    pairs = np.unique(pairs[inside[pairs[:, 0]] != inside[pairs[:, 1]]] @ [len(samples), 1])
    low, high = edges = np.divmod(pairs, len(samples))
    values = np.nan_to_num(samples.astype(np.float64), nan=-1e38, neginf=-1e38, posinf=1e38)
    points = np.stack(np.unravel_index(np.arange(len(samples)), size, order="F"), axis=1).astype(np.float64)
    return points, inside, tetrahedra, np.stack(edges, axis=1), (isovalue - values[low]) / (values[high] - values[low])
