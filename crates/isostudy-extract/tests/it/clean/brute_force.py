"""Counts pairs of triangles with a point in common that is no common vertex and lies on no common side, by rational numbers and by looking
at every pair. Reads a mesh a line, as JSON: positions, and triangles. Prints a count a line."""

import json
import sys
from fractions import Fraction
from itertools import combinations


def minus(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def extremes(p, q, corners, normal):
    """The ends of what a segment and a triangle have in common."""
    way = minus(q, p)
    here, there = (dot(normal, minus(end, corners[0])) for end in (p, q))
    if here * there > 0:
        return []
    # Shares of the way that are in the plane, then within each side.
    low, high = (Fraction(0), Fraction(1)) if here == there == 0 else (here / (here - there),) * 2
    for i in range(3):
        inward = cross(normal, minus(corners[(i + 1) % 3], corners[i]))
        start, slope = dot(inward, minus(p, corners[i])), dot(inward, way)
        if slope == 0:
            if start < 0:
                return []
        elif slope > 0:
            low = max(low, -start / slope)
        else:
            high = min(high, -start / slope)
    return [tuple(a + share * w for a, w in zip(p, way)) for share in {low, high}] if low <= high else []


def meet(one, other):
    """Whether two triangles have more in common than their common corners span."""
    common = set(one[0]) & set(other[0])
    for (corners, _), (into, normal) in ((one, other), (other, one)):
        for i in range(3):
            for point in extremes(corners[i], corners[(i + 1) % 3], into, normal):
                # What is in common is convex: its extreme points say all.
                if point not in common:
                    return True
    return False


def count(positions, triangles):
    exact = [tuple(map(Fraction, p)) for p in positions]
    made = []
    for t in triangles:
        corners = [exact[v] for v in t]
        normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
        if any(normal):
            rough = [[positions[v][axis] for v in t] for axis in range(3)]
            made.append(((corners, normal), [min(r) for r in rough], [max(r) for r in rough]))
    found = 0
    for (one, low, high), (other, low2, high2) in combinations(made, 2):
        if all(low[k] <= high2[k] and low2[k] <= high[k] for k in range(3)):
            found += meet(one, other)
    return found


for line in sys.stdin:
    mesh = json.loads(line)
    print(count(mesh["positions"], mesh["triangles"]))
