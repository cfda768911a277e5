//! Which samples cells need, beside those that sides need.

use super::grid::CubeGrid;
use crate::extraction::ExtractError;
use crate::sampling::bits::between;
use crate::sampling::rows::{Rows, before, next};
use crate::slabs::window::Window;
use crate::source::Sampler;

/// A few layers of samples and sides.
pub(crate) type Samples = Window;

/// What is sampled, and where.
#[derive(Clone, Copy)]
pub(crate) struct Sampling<'a> {
    pub(crate) grid: &'a CubeGrid<'a>,
    pub(crate) source: Sampler<'a>,
    pub(crate) isovalue: f32,
    /// Whether all corners of a crossed cell have samples, or the ends of crossed edges alone.
    pub(crate) all_corners: bool,
}

impl Sampling<'_> {
    /// Finds the sides of a layer, with as few samples as may be.
    ///
    /// # Errors
    /// [`ExtractError::Unread`].
    pub(crate) fn find_sides(self, samples: &mut Samples, layer: usize) -> Result<(), ExtractError> {
        samples.find_sides(self.grid, self.source, self.isovalue, layer)
    }

    /// Takes the samples of a layer that cells need and sides did not. The sides of the layers next to it are known.
    pub(crate) fn fill(self, samples: &mut Samples, layer: usize) {
        let Sampler::Field(field) = self.source else { return };
        let mut wanted = std::mem::take(&mut samples.wanted);
        for row in 0..self.grid.size[1] {
            let near = Near::new(self.grid, [row, layer], self.all_corners);
            if samples.is_uniform(near.rows()) {
                continue;
            }
            near.for_each_word(self.grid, &samples.sides, |word, needed| wanted[word] = needed);
            samples.take(self.grid, field, [row, layer], &wanted);
        }
        samples.wanted = wanted;
    }
}

/// The rows at a row whose sides say which of its samples cells need.
pub(crate) struct Near {
    around: [[usize; 2]; 9],
    count: usize,
    all_corners: bool,
}

impl Near {
    /// Of a row in a layer.
    pub(crate) fn new(grid: &CubeGrid, [row, layer]: [usize; 2], all_corners: bool) -> Self {
        let [_, ny, nz] = grid.size;
        let (rows, layers) =
            (row.saturating_sub(1)..ny.min(row + 2), layer.saturating_sub(1)..nz.min(layer + 2));
        let mut near = Self { around: [[row, layer]; 9], count: 1, all_corners };
        for [y, z] in layers.flat_map(|z| rows.clone().map(move |y| [y, z])) {
            let is_self = [y, z] == [row, layer];
            if !is_self && (all_corners || y == row || z == layer) {
                near.around[near.count] = [y, z];
                near.count += 1;
            }
        }
        near
    }

    pub(crate) fn rows(&self) -> &[[usize; 2]] {
        &self.around[..self.count]
    }

    /// Calls `visit` with each word of the row and the points of it that cells need: ends of crossed edges, or all corners of
    /// crossed cells.
    pub(crate) fn for_each_word(&self, grid: &CubeGrid, sides: &Rows, mut visit: impl FnMut(usize, u64)) {
        let lines = self.around.map(|[y, z]| sides.row(y, z));
        for word in 0..grid.words {
            let [mut any, mut all] = [lines[0][word]; 2];
            for (i, line) in lines[..self.count].iter().enumerate() {
                (any, all) = (any | line[word], all & line[word]);
                if i == 0 || self.all_corners {
                    let (next, before) = (next(line, word), before(line, word));
                    any |= next & grid.with_next(word) | before;
                    all &= (next | !grid.with_next(word)) & before;
                }
            }
            visit(word, any & !all & between(word, 0, grid.size[0]));
        }
    }
}
