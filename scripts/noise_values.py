"""Prints values of gradient noise and its sums, as `hex bits of the double` per line, for the tests of crate extract.

Written from the doc comments of `noise` and `Fractal`, not from their code: exact whole numbers and Python's doubles.

usage: python3 scripts/noise_values.py
"""

import math
import struct

MASK = (1 << 64) - 1
STEPS = [0xD1B54A32D192ED03, 0xABC98388FB8FAC03, 0x8CB92BA72F3D8DD7]
GOLDEN = 0x9E3779B97F4A7C15
GRADIENTS = [
    (1, 1, 0), (-1, 1, 0), (1, -1, 0), (-1, -1, 0),
    (1, 0, 1), (-1, 0, 1), (1, 0, -1), (-1, 0, -1),
    (0, 1, 1), (0, -1, 1), (0, 1, -1), (0, -1, -1),
]
SHIFT = (0.3819660112501051, 0.6180339887498949, 0.0)


def gradient(point, seed):
    h = (GOLDEN * (seed + 1) + sum(a * b for a, b in zip(STEPS, point))) & MASK
    h = ((h ^ (h >> 32)) * GOLDEN) & MASK
    h = ((h ^ (h >> 29)) * STEPS[0]) & MASK
    return GRADIENTS[((h >> 32) * 12) >> 32]


def fade(t):
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


def blend(a, b, weight):
    return a + (b - a) * weight


def noise(p, seed):
    base = [math.floor(v) for v in p]
    t = [v - b for v, b in zip(p, base)]

    def slant(*corner):
        g = gradient([b + c for b, c in zip(base, corner)], seed)
        return g[0] * (t[0] - corner[0]) + g[1] * (t[1] - corner[1]) + g[2] * (t[2] - corner[2])

    x, y, z = map(fade, t)

    def layer(k):
        return blend(blend(slant(0, 0, k), slant(1, 0, k), x), blend(slant(0, 1, k), slant(1, 1, k), x), y)

    return 0.9647 * blend(layer(0), layer(1), z)


def fractal(p, octaves, gain, seed, shape):
    weights = [1.0]
    for _ in range(octaves - 1):
        weights.append(weights[-1] * gain)
    total = 0.0
    for weight in weights:
        total += weight
    value, shift = 0.0, [0.0, 0.0, 0.0]
    for k, weight in enumerate(weights):
        n = noise([v * 2.0**k + s for v, s in zip(p, shift)], (seed + k) % 2**32)
        shaped = {"plain": n, "ridged": (1 - abs(n)) * (1 - abs(n)), "billowed": abs(n)}[shape]
        value += shaped * (weight / total)
        shift = [a + b for a, b in zip(shift, SHIFT)]
    return value


def show(value, *what):
    print(hex(struct.unpack("<Q", struct.pack("<d", value))[0]), value, *what)


for p, seed in [
    ((0.3, -1.7, 2.45), 0),
    ((12.5, 0.25, -3.125), 7),
    ((-1e-9, 0.5, 0.75), 2**32 - 1),
    ((1234567.875, -7654321.25, 0.5), 3),
    ((0.1, 0.2, 0.0), 1),
]:
    show(noise(p, seed), p, seed)
for shape, octaves, gain, seed in [("plain", 5, 0.5, 2), ("ridged", 4, 0.5, 9), ("billowed", 3, 0.4, 4294967290)]:
    show(fractal((0.3, -1.7, 2.45), octaves, gain, seed, shape), shape, octaves, gain, seed)
