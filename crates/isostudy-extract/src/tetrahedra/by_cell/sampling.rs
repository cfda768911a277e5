//! Sampling pass: the sides of a layer, then which of its points have a crossing, and the samples there that no side
//! needed.

use std::collections::TryReserveError;

use super::grid::{CutGrid, LINES};
use crate::extraction::ExtractError;
use crate::sampling::bits::between;
use crate::sampling::in_sight::{State, Values};
use crate::sampling::rows::{Rows, shifted};
use crate::slabs::window::Window;
use crate::source::Sampler;

/// A word of zeros before each row: edges lead either way.
pub(super) type BitRows = Rows<1>;

/// A few layers of samples and sides.
#[derive(Debug, Default)]
pub(super) struct Samples {
    window: Window<1>,
    /// Points with a crossing.
    pub(super) active: BitRows,
}

/// What is sampled, and where.
#[derive(Clone, Copy)]
pub(super) struct Sampling<'a> {
    pub(super) grid: &'a CutGrid,
    pub(super) source: Sampler<'a>,
    pub(super) isovalue: f32,
}

impl Samples {
    /// Makes room; keeps what is large enough.
    pub(super) fn fit(&mut self, grid: &CutGrid, source: Sampler) -> Result<(), TryReserveError> {
        self.window.fit(grid, source, grid.slots())?;
        self.active.fit(grid.words, grid.size[1], grid.slots())
    }

    pub(super) fn values<'a>(&'a self, grid: &CutGrid, source: Sampler<'a>) -> Values<'a> {
        self.window.values(grid, source)
    }

    /// 1 inside. Columns without a point have any.
    pub(super) fn sides(&self) -> &BitRows {
        &self.window.sides
    }

    /// Finds the sides of a layer, with as few samples as may be.
    ///
    /// # Errors
    /// [`ExtractError::Unread`].
    pub(super) fn find_sides(
        &mut self,
        Sampling { grid, source, isovalue }: Sampling,
        layer: usize,
    ) -> Result<(), ExtractError> {
        // Bricks are of the corners of cubes; here a row may have columns without a point.
        let source = match source {
            Sampler::Given { values, .. } => Sampler::Given { values, bricks: None },
            other @ (Sampler::Field(_) | Sampler::Stored(_)) => other,
        };
        self.window.find_sides(grid, source, isovalue, layer)
    }

    /// Finds the points of a layer that have a crossing, and takes their samples. The sides of all neighbours are known.
    pub(super) fn find_crossings(&mut self, sampling: Sampling, layer: usize) {
        let Sampling { grid, source, .. } = sampling;
        for row in 0..grid.size[1] {
            let (window, active) = (&self.window, self.active.row_mut(row, layer));
            active.fill(0);
            let kind = grid.kind(row, layer);
            let here = window.state([row, layer]);
            let mut lines = [None; LINES];
            let mut is_uniform = here != State::Mixed;
            for i in (0..grid.lines.len()).filter(|i| kind.lines >> i & 1 != 0) {
                let line = grid.line(i, row, layer);
                is_uniform &= line.is_none_or(|line| window.state(line) == here);
                lines[i] = line.map(|[y, z]| window.sides.row(y, z));
            }
            if is_uniform {
                continue;
            }
            mark_crossings(grid, [row, layer], window.sides.row(row, layer), &lines, active);
            if let Sampler::Field(field) = source {
                self.window.take(grid, field, [row, layer], active);
            }
        }
    }
}

/// Sets the bits of points with a neighbour on the other side.
fn mark_crossings(
    grid: &CutGrid,
    [row, layer]: [usize; 2],
    here: &[u64],
    lines: &[Option<&[u64]>; LINES],
    active: &mut [u64],
) {
    let kind = grid.kind(row, layer);
    let nx = grid.size[0];
    for (direction, &[dx, _, _]) in grid.cut.steps.iter().enumerate() {
        let edges = kind.edges[direction];
        let Some(there) = lines[grid.line[direction]].filter(|_| edges != 0) else { continue };
        let dx = isize::from(dx);
        // The columns whose neighbours are there.
        let (first, end) = ((-dx).max(0) as usize, nx.saturating_sub(dx.max(0) as usize));
        for (word, active) in active.iter_mut().enumerate() {
            *active |= (here[word + 1] ^ shifted(there, word, dx)) & edges & between(word, first, end);
        }
    }
}
