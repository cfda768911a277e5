#!/usr/bin/env python3
"""The angles that warp clustering can make, computed once more and apart from the Rust tests.

    scripts/warp-angles.py [SHARE_LONG SHARE_SHORT]

It takes one tetrahedron of the body-centred lattice. Each corner has a side, and stays or moves along one of its fourteen edges by
less than that edge's share. Crossings between corners that stay lie beyond both shares. A population of such tetrahedra is driven to
the worst angle with a fixed seed. Printed are the smallest and the largest dihedral angle of tetrahedra without a quadrilateral, and
the smallest and the largest angle of the surface's triangles, whichever way quadrilaterals are cut.
"""

import itertools
import sys

import numpy as np

LONG, SHORT = (float(a) for a in sys.argv[1:3]) if len(sys.argv) > 2 else (0.24999, 0.359)
CORNERS = np.array([[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, -1, 1]], float)
# The first way leads nowhere.
WAYS = np.array(
    [[0, 0, 0]]
    + [[s * 2 * (a == b) for b in range(3)] for a in range(3) for s in (1, -1)]
    + list(itertools.product((1, -1), repeat=3)),
    float,
)
REACH = np.where((WAYS == 0).any(axis=1), LONG, SHORT)
PAIRS = list(itertools.combinations(range(4), 2))
# By corner and way, the corner of the tetrahedron that it leads to, or -1.
LEADS = np.full((4, 15), -1)
for i, w in itertools.product(range(4), range(1, 15)):
    for j in range(4):
        if (CORNERS[i] + WAYS[w] == CORNERS[j]).all():
            LEADS[i, w] = j
EDGE = np.zeros((4, 4))
for i, j in itertools.permutations(range(4), 2):
    EDGE[i, j] = LONG if (CORNERS[i] - CORNERS[j] == 0).any() else SHORT


def drawn(rng, n):
    """Sides, ways, and shares: of the moves, then of the cuts of the six edges, all from 0 to 1."""
    shares = rng.random((n, 10))
    end = rng.random((n, 10))
    return [rng.integers(0, 2, (n, 4)), rng.integers(0, 15, (n, 4)), np.where(end < 0.3, 0.0, np.where(end < 0.6, 1.0, shares))]


def angle(u, v):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v), axis=-1), (u * v).sum(-1)))


def tetrahedron(sides, ways, shares):
    """Where the corners go and the edges are cut, whether a corner moved, and whether it can come to be."""
    at = CORNERS + WAYS[ways] * (shares[:, :4] * REACH[ways])[..., None]
    moved = ways > 0
    valid = np.ones(len(sides), bool)
    for i in range(4):
        target = LEADS[i, ways[:, i]]
        other = np.take_along_axis(sides, np.maximum(target, 0)[:, None], 1)[:, 0]
        valid &= (target < 0) | (other != sides[:, i])
        for j in range(4):
            valid &= ~((target == j) & (LEADS[j, ways[:, j]] == i))
    cuts = np.zeros((len(sides), 4, 4, 3))
    for e, (i, j) in enumerate(PAIRS):
        share = EDGE[i, j] + (1 - 2 * EDGE[i, j]) * shares[:, 4 + e]
        cuts[:, i, j] = cuts[:, j, i] = at[:, i] + (at[:, j] - at[:, i]) * share[:, None]
    return at, cuts, moved, valid


def dihedral(population):
    """Both extremes of each tetrahedron; not a number where there is none, or one with a quadrilateral."""
    sides, *_ = population
    at, cuts, moved, valid = tetrahedron(*population)
    inside, outside = (sides == 1) & ~moved, (sides == 0) & ~moved
    one = inside.sum(1) == 1
    valid &= one | ((inside.sum(1) > 0) & (outside.sum(1) == 0))
    apex = inside.argmax(1)
    rows = np.arange(len(at))
    at = np.where(outside[..., None], cuts[rows, apex], at)
    angles = []
    for i, j in PAIRS:
        k, l = (c for c in range(4) if c not in (i, j))
        along = at[:, j] - at[:, i]
        across = lambda c: np.cross(along, at[:, c] - at[:, i])
        angles.append(angle(across(k), across(l)))
    angles = np.where(valid, np.stack(angles), np.nan)
    return angles.min(0), angles.max(0)


def plane(population):
    """The same of the triangles of the surface."""
    sides, *_ = population
    at, cuts, moved, valid = tetrahedron(*population)
    n = len(at)
    least, most = np.full(n, np.nan), np.full(n, np.nan)
    state = np.where(moved, 2, sides)
    for pattern in itertools.product(range(3), repeat=4):
        rows = (state == pattern).all(1) & valid
        zero, inside, outside = ([c for c in range(4) if pattern[c] == s] for s in (2, 1, 0))
        points = [at[rows, c] for c in zero] + [cuts[rows, p, q] for p in inside for q in outside]
        if not inside or len(points) < 3 or not rows.any():
            continue
        ways = [(0, 1, 2)] if len(points) == 3 else list(itertools.combinations(range(4), 3))
        angles = [
            angle(points[w[(i + 1) % 3]] - points[w[i]], points[w[(i + 2) % 3]] - points[w[i]])
            for w in ways
            for i in range(3)
        ]
        least[rows], most[rows] = np.min(angles, 0), np.max(angles, 0)
    return least, most


def driven(angles, end, seed, size=20_000, rounds=250):
    rng = np.random.default_rng(seed)
    badness = lambda population: np.nan_to_num((-1, 1)[end] * angles(population)[end], nan=-1e9)
    now = drawn(rng, size)
    bad = badness(now)
    for step in range(rounds):
        # The worse half has children, which differ from it in few numbers, by ever less.
        order = np.argsort(-bad)[: size // 2]
        parents = [part[order] for part in now]
        fresh = drawn(rng, size // 2)
        chosen = [rng.random(part.shape) < 0.15 for part in parents]
        children = [np.where(c, f, p) for c, f, p in zip(chosen, fresh, parents)]
        step_by = rng.normal(0, 0.3 * 0.97**step, children[2].shape) * (rng.random(children[2].shape) < 0.3)
        children[2] = np.clip(children[2] + step_by, 0, 1)
        now = [np.concatenate(pair) for pair in zip(parents, children)]
        bad = np.concatenate([bad[order], badness(children)])
    return (-1, 1)[end] * bad.max()


for name, angles in (("dihedral", dihedral), ("surface", plane)):
    ends = [(min, max)[end](driven(angles, end, seed) for seed in (1, 2, 3)) for end in (0, 1)]
    print(f"{name} angles at ({LONG}, {SHORT}): {ends[0]:.4f} to {ends[1]:.4f} degrees")
