//! Vertices by place: a grid of cells, each with a list.

use glam::DVec3;
use isostudy_mesh::Bounds;

/// The most cells; with more, cells are larger.
const MOST_CELLS: f64 = (1 << 22) as f64;
const NONE: u32 = u32::MAX;

pub(crate) struct Near {
    min: DVec3,
    cell: f64,
    counts: [usize; 3],
    heads: Vec<u32>,
    next: Vec<u32>,
}

impl Near {
    pub(crate) fn new(bounds: Bounds, edge: f64) -> Self {
        let size = bounds.size().as_dvec3();
        let cell = edge.max((size.element_product() / MOST_CELLS).cbrt());
        let counts = (size / cell).to_array().map(|n| n.ceil() as usize + 1);
        Self {
            min: bounds.min.as_dvec3(),
            cell,
            counts,
            heads: vec![NONE; counts.iter().product()],
            next: Vec::new(),
        }
    }

    /// Vertices are inserted in the order of their numbers.
    pub(crate) fn insert(&mut self, v: u32, p: DVec3) {
        let cell = self.index(self.cell_of(p));
        self.next.push(std::mem::replace(&mut self.heads[cell], v));
    }

    /// Takes a vertex out.
    pub(crate) fn remove(&mut self, v: u32, p: DVec3) {
        let cell = self.index(self.cell_of(p));
        let after = self.next[v as usize];
        if self.heads[cell] == v {
            self.heads[cell] = after;
            return;
        }
        let mut at = self.heads[cell];
        while at != NONE {
            if self.next[at as usize] == v {
                self.next[at as usize] = after;
                return;
            }
            at = self.next[at as usize];
        }
    }

    /// Calls for each vertex of the cells within `radius` of `p`, some of which are farther.
    pub(crate) fn each(&self, p: DVec3, radius: f64, mut call: impl FnMut(u32)) {
        let (low, high) = (self.cell_of(p - radius), self.cell_of(p + radius));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let mut at = self.heads[self.index([x, y, z])];
                    while at != NONE {
                        call(at);
                        at = self.next[at as usize];
                    }
                }
            }
        }
    }

    fn cell_of(&self, p: DVec3) -> [usize; 3] {
        let at = ((p - self.min) / self.cell).to_array();
        // Casts of what is negative give 0.
        [0, 1, 2].map(|axis| (at[axis] as usize).min(self.counts[axis] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }
}
