#!/usr/bin/env python3
"""Prints the values that crates/isostudy-scattered/tests/it/splines.rs expects, by SciPy's RBFInterpolator.

Usage: scripts/scattered-values.py

It needs NumPy and SciPy. Points and values are made by arithmetic that is the same in Python and Rust, to the bit.
"""

import math

import numpy
import scipy
from scipy.interpolate import RBFInterpolator

STEPS = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)


def point(i):
    return [3.0 * ((i * step) % 1.0) + shift for step, shift in zip(STEPS, (10.0, -2.0, 0.5))]


def value(p):
    x, y, z = p[0] - 11.0, p[1] + 1.0, p[2] - 2.0
    return math.sqrt(x * x + y * y + z * z) + 0.25 * x * y - z * z * z / 8.0


print(f"// scripts/scattered-values.py: NumPy {numpy.__version__}, SciPy {scipy.__version__}.")
for points, kernel, smoothing in [(20, "linear", 0.0), (400, "linear", 0.0), (400, "linear", 0.5), (60, "cubic", 0.0), (400, "cubic", 0.0), (400, "cubic", 0.5)]:
    at = [point(i) for i in range(points)]
    spline = RBFInterpolator(at, [value(p) for p in at], kernel=kernel, degree=1, smoothing=smoothing)
    found = spline([point(1000 + 7 * i) for i in range(6)])
    kind = {"linear": "Biharmonic", "cubic": "Triharmonic"}[kernel]
    print(f"    ({points}, Kernel::{kind}, {smoothing}, [{', '.join(repr(float(x)) for x in found)}]),")
