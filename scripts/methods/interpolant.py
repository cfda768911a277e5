"""The trilinear interpolant of samples, for libraries that take a function: of many points at once, in cells from the first sample.

Beyond the box it has the values at the box. The time of all calls is added up in `seconds`.
"""

from time import perf_counter

import numpy as np


class Trilinear:
    def __init__(self, samples, size):
        self.samples, self.size = samples.astype(np.float64), np.array(size)
        self.last, self.seconds = self.size - 1, 0.0

    def __call__(self, points):
        begin = perf_counter()
        points = np.clip(points, 0, self.last)
        cells = np.minimum(points.astype(np.int64), self.last - 1)
        (x, y, z), (_, row, layer) = (points - cells).T, np.cumprod([1, *self.size[:2]])
        corner, rows = cells @ [1, row, layer], []
        for n in (corner, corner + row, corner + layer, corner + row + layer):
            rows.append(self.samples[n] + (self.samples[n + 1] - self.samples[n]) * x)
        low, high = rows[0] + (rows[1] - rows[0]) * y, rows[2] + (rows[3] - rows[2]) * y
        values = low + (high - low) * z
        self.seconds += perf_counter() - begin
        return values

    def crossings(self, isovalue):
        """Points on the surface: one on each grid edge that joins a sample above the isovalue with one that is not."""
        begin, steps, found = perf_counter(), np.cumprod([1, *self.size[:2]]), []
        for axis in range(3):
            starts = np.moveaxis(np.arange(len(self.samples)).reshape(self.size[::-1]), 2 - axis, 0)[:-1].ravel()
            starts = starts[(self.samples[starts] > isovalue) != (self.samples[starts + steps[axis]] > isovalue)]
            low, high = self.samples[starts], self.samples[starts + steps[axis]]
            points = np.stack([starts // step % n for step, n in zip(steps, self.size)], axis=1).astype(np.float64)
            points[:, axis] += (isovalue - low) / (high - low)
            found.append(points)
        self.seconds += perf_counter() - begin
        return np.concatenate(found)
