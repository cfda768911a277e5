//! Which tetrahedra are near a point: those whose boxes meet its bin.

use glam::DVec3;

use crate::grid::Grid;

/// The most bins along an axis.
const MOST_ALONG: f64 = 512.0;
/// The most entries of a tetrahedron, on average. Where boxes are much larger than the bins, bins are made larger.
const MOST_ENTRIES: u64 = 64;

/// Boxes of one size that fill the grid's, each with the tetrahedra that may be in it.
#[derive(Debug, Clone)]
pub(super) struct Bins {
    min: DVec3,
    /// Bins per length.
    per_length: DVec3,
    counts: [usize; 3],
    /// Where each bin's entries begin; one more for the end.
    starts: Vec<usize>,
    entries: Vec<u32>,
}

impl Bins {
    /// About a bin for each tetrahedron.
    pub(super) fn new(grid: &Grid, [min, max]: [DVec3; 2]) -> Self {
        let size = (max - min).to_array();
        let sides: Vec<f64> = size.into_iter().filter(|side| *side > 0.0).collect();
        // Root by root, since the product of three small sides may be none.
        let root = 1.0 / sides.len().max(1) as f64;
        let mean: f64 = sides.iter().map(|side| side.powf(root)).product();
        let mut edge = mean / (grid.tetrahedra().len() as f64).powf(root);
        loop {
            let counts = size.map(|side| (side / edge).ceil().clamp(1.0, MOST_ALONG) as usize);
            let per_length = DVec3::from_array([0, 1, 2].map(|axis| match size[axis] {
                side if side > 0.0 => counts[axis] as f64 / side,
                _ => 0.0,
            }));
            let mut bins = Self { min, per_length, counts, starts: Vec::new(), entries: Vec::new() };
            let boxes: Vec<[[usize; 3]; 2]> =
                grid.tetrahedra().iter().map(|of| bins.box_of(grid, *of)).collect();
            let along = |of: &[[usize; 3]; 2]| {
                (0..3).map(|axis| (of[1][axis] - of[0][axis] + 1) as u64).product::<u64>()
            };
            let needed: u64 = boxes.iter().map(along).sum();
            if needed <= MOST_ENTRIES * boxes.len() as u64 + 64 || counts == [1; 3] {
                bins.fill(&boxes);
                return bins;
            }
            edge *= 2.0;
        }
    }

    /// The tetrahedra that may be at a point; none beyond the box.
    pub(super) fn at(&self, p: DVec3) -> &[u32] {
        let at = (p - self.min) * self.per_length;
        let slack = 1e-3;
        let is_in = (0..3).all(|axis| at[axis] >= -slack && at[axis] <= self.counts[axis] as f64 + slack);
        if !is_in {
            return &[];
        }
        let bin = self.number(self.bin(p));
        &self.entries[self.starts[bin]..self.starts[bin + 1]]
    }

    fn bin(&self, p: DVec3) -> [usize; 3] {
        let at = (p - self.min) * self.per_length;
        [0, 1, 2].map(|axis| (at[axis].max(0.0) as usize).min(self.counts[axis] - 1))
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.counts[0] * (j + self.counts[1] * k)
    }

    /// The bins of the first and the last corner of a tetrahedron's box, which is grown by rounding.
    fn box_of(&self, grid: &Grid, of: [u32; 4]) -> [[usize; 3]; 2] {
        let [a, b, c, d] = of.map(|point| grid.point(point));
        let (low, high) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        let grown = 1e-5 * (high - low).max_element();
        [self.bin(low - grown), self.bin(high + grown)]
    }

    fn fill(&mut self, boxes: &[[[usize; 3]; 2]]) {
        let each = |of: &[[usize; 3]; 2]| {
            let [low, high] = *of;
            let rows = (low[2]..=high[2]).flat_map(move |k| (low[1]..=high[1]).map(move |j| [j, k]));
            rows.flat_map(move |[j, k]| (low[0]..=high[0]).map(move |i| [i, j, k]))
        };
        let mut starts = vec![0; self.counts.iter().product::<usize>() + 1];
        for of in boxes {
            each(of).for_each(|bin| starts[self.number(bin) + 1] += 1);
        }
        for bin in 1..starts.len() {
            starts[bin] += starts[bin - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![0; starts[starts.len() - 1]];
        for (tetrahedron, of) in (0..).zip(boxes) {
            for bin in each(of) {
                let place = &mut next[self.number(bin)];
                entries[*place] = tetrahedron;
                *place += 1;
            }
        }
        (self.starts, self.entries) = (starts, entries);
    }
}
