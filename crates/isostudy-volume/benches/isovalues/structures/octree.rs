//! The octree of ranges that branches on need.

use super::memory::with_room;
use super::scan::add_active;
use super::spans::{NONE, Span, holds, union, with};
use isostudy_extract::active::{ActiveCells, ActiveError, GridSamples};

/// An octree of ranges over 2 x 2 x 2 cells (Wilhelms & Van Gelder 1992). It branches on need: a level has half as many nodes along each
/// axis as the one below, rounded up, so that it has about one node for seven cells whatever the sizes are. Ranges lie level by
/// level and row by row; a node's place says where its children are.
#[derive(Debug, Clone)]
pub(crate) struct Octree<'a> {
    samples: GridSamples<'a>,
    /// From the lowest, whose nodes have cells, to the root.
    levels: Vec<Level>,
}

#[derive(Debug, Clone)]
struct Level {
    counts: [usize; 3],
    spans: Vec<Span>,
}

impl<'a> Octree<'a> {
    /// Reads all samples.
    ///
    /// # Errors
    /// [`ActiveError::OutOfMemory`].
    pub(crate) fn try_new(samples: GridSamples<'a>) -> Result<Self, ActiveError> {
        let [nx, ny, _] = samples.counts();
        // Three samples along each axis, of which the last are the next node's too.
        let of_samples = |at: [usize; 3]| with(NONE, samples.values()[(at[2] * ny + at[1]) * nx + at[0]]);
        let mut levels = vec![Level::over(samples.counts(), samples.cells(), 3, of_samples)?];
        while let Some(below) = levels.last().filter(|level| level.counts != [1; 3]) {
            let above = Level::over(below.counts, below.counts, 2, |at| below.at(at))?;
            levels.push(above);
        }
        Ok(Self { samples, levels })
    }

    /// How many nodes it has.
    pub(crate) fn nodes(&self) -> usize {
        self.levels.iter().map(|level| level.spans.len()).sum()
    }

    fn visit(&self, level: usize, node: [usize; 3], isovalue: f32, cells: &mut Vec<u32>) {
        if !holds(self.levels[level].at(node), isovalue) {
            return;
        }
        let below = match level.checked_sub(1) {
            Some(below) => self.levels[below].counts,
            None => self.samples.cells(),
        };
        let [x, y, z] = [0, 1, 2].map(|k| 2 * node[k]..below[k].min(2 * node[k] + 2));
        if level == 0 {
            return add_active(self.samples, isovalue, [x, y, z], cells);
        }
        for k in z {
            for j in y.clone() {
                for i in x.clone() {
                    self.visit(level - 1, [i, j, k], isovalue, cells);
                }
            }
        }
    }
}

impl Level {
    /// Nodes over twice as many `parts` along each axis, each of so many things of which there are `below`.
    fn over(
        below: [usize; 3],
        parts: [usize; 3],
        wide: usize,
        of: impl Fn([usize; 3]) -> Span,
    ) -> Result<Self, ActiveError> {
        let counts = parts.map(|n| n.div_ceil(2));
        let mut spans = with_room(counts.iter().product())?;
        let range = |k: usize, i: usize| 2 * i..below[k].min(2 * i + wide);
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let mut span = NONE;
                    for k in range(2, z) {
                        for j in range(1, y) {
                            span = range(0, x).fold(span, |span, i| union(span, of([i, j, k])));
                        }
                    }
                    spans.push(span);
                }
            }
        }
        Ok(Self { counts, spans })
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> Span {
        self.spans[(z * self.counts[1] + y) * self.counts[0] + x]
    }
}

impl ActiveCells for Octree<'_> {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        self.visit(self.levels.len() - 1, [0; 3], isovalue, cells);
    }

    fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of::<Span>() * level.spans.capacity()).sum()
    }
}
