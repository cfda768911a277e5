#!/usr/bin/env python3
"""Writes a ball as a large volume of bytes, to try how a volume is read that does not fit into memory.

Usage: scripts/ball-volume.py SIDE RADIUS FILE.nrrd

The volume has SIDE samples along each axis. A sample is 127.5 at RADIUS from a point near the middle, and 8 more for each step inwards,
from 0 to 255. The file has a hole where all samples are 0, so on most file systems it takes the room of the ball alone.
"""

import sys

SLOPE = 8


def row(length, centre, squared, radius):
    """The bytes of a row whose distance from the centre, squared, is given."""

    def sample(x):
        away = ((x - centre) ** 2 + squared) ** 0.5
        return min(255, max(0, int(127.5 + SLOPE * (radius - away) + 0.5)))

    # Only near the surface it takes a root for each sample.
    inner, outer = (max(0.0, (radius + off) ** 2 - squared) ** 0.5 for off in (-16.5, 16.5))
    first, end = max(0, int(centre - outer)), min(length, int(centre + outer) + 2)
    low, high = int(centre - inner) + 1, int(centre + inner)
    if inner < 2 or low >= high:
        return first, bytes(map(sample, range(first, end)))
    return first, bytes(map(sample, range(first, low))) + b"\xff" * (high - low) + bytes(map(sample, range(high, end)))


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    side, radius, path = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
    centre = [side / 2 + off for off in (0.25, -0.5, 0.125)]
    header = f"NRRD0004\ntype: uchar\ndimension: 3\nsizes: {side} {side} {side}\nencoding: raw\n\n".encode()
    with open(path, "wb") as file:
        file.write(header)
        file.truncate(len(header) + side**3)
        for z in range(side):
            for y in range(side):
                squared = (y - centre[1]) ** 2 + (z - centre[2]) ** 2
                if squared < (radius + 16.5) ** 2:
                    first, samples = row(side, centre[0], squared, radius)
                    file.seek(len(header) + (z * side + y) * side + first)
                    file.write(samples)


if __name__ == "__main__":
    main()
