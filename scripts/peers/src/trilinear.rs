//! The trilinear interpolant of a request's samples, in cells, for crates that call a function.

use crate::request::Request;

pub(crate) struct Trilinear<'a> {
    samples: &'a [f32],
    size: [usize; 3],
    isovalue: f64,
}

impl<'a> Trilinear<'a> {
    pub(crate) fn new(request: &Request, samples: &'a [f32]) -> Self {
        Self { samples, size: request.size.map(|n| n as usize), isovalue: request.isovalue }
    }

    /// The isovalue less a sample: negative inside.
    fn at(&self, [i, j, k]: [usize; 3]) -> f64 {
        self.isovalue - f64::from(self.samples[(k * self.size[1] + j) * self.size[0] + i])
    }

    /// The isovalue less the interpolated sample: negative inside. Beyond the samples, the outermost are repeated.
    pub(crate) fn value(&self, p: [f64; 3]) -> f64 {
        let (mut cell, mut part) = ([0; 3], [0.0; 3]);
        for a in 0..3 {
            let at = p[a].clamp(0.0, (self.size[a] - 1) as f64);
            cell[a] = (at as usize).min(self.size[a] - 2);
            part[a] = at - cell[a] as f64;
        }
        let [i, j, k] = cell;
        let between = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        let row = |j, k| between(self.at([i, j, k]), self.at([i + 1, j, k]), part[0]);
        let plane = |k| between(row(j, k), row(j + 1, k), part[1]);
        between(plane(k), plane(k + 1), part[2])
    }

    /// Where the surface crosses the grid's edges.
    pub(crate) fn crossings(&self) -> Vec<[f64; 3]> {
        let [nx, ny, nz] = self.size;
        let mut found = Vec::new();
        for cell in (0..nx * ny * nz).map(|n| [n % nx, n / nx % ny, n / nx / ny]) {
            for axis in 0..3 {
                let mut next = cell;
                next[axis] += 1;
                if next[axis] == self.size[axis] {
                    continue;
                }
                let (a, b) = (self.at(cell), self.at(next));
                if (a < 0.0) != (b < 0.0) {
                    let mut p = cell.map(|x| x as f64);
                    p[axis] += a / (a - b);
                    found.push(p);
                }
            }
        }
        found
    }
}
