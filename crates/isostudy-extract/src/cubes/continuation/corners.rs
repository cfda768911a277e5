//! The corners of cubes, sampled when they are first asked for.

use std::collections::TryReserveError;

use super::Map;
use crate::cubes::grid::CubeGrid;
use crate::cubes::vertices::corner_of;
use crate::source::Sampler;

/// Samples by place. Of a field each is taken once.
pub(super) struct Corners<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    source: Sampler<'a>,
    pub(super) isovalue: f32,
    taken: Map<f32>,
}

impl<'a> Corners<'a> {
    pub(super) fn new(grid: &'a CubeGrid<'a>, source: Sampler<'a>, isovalue: f32) -> Self {
        Self { grid, source, isovalue, taken: Map::default() }
    }

    /// Cells along each axis.
    pub(super) fn cells(&self) -> [usize; 3] {
        self.grid.size.map(|n| n - 1)
    }

    /// The number of a point, and of the cell that begins there: its place in storage order.
    pub(super) fn number(&self, [x, y, z]: [usize; 3]) -> u64 {
        let [nx, ny, _] = self.grid.size;
        ((z * ny + y) * nx + x) as u64
    }

    /// The place of a number.
    pub(super) fn place(&self, number: u64) -> [usize; 3] {
        let ([nx, ny, _], number) = (self.grid.size, number as usize);
        [number % nx, number / nx % ny, number / nx / ny]
    }

    /// Whether a point is inside.
    pub(super) fn is_inside(&mut self, place: [usize; 3]) -> Result<bool, TryReserveError> {
        let value = match self.source {
            Sampler::Given { .. } => self.value(place),
            Sampler::Field(field) => {
                let number = self.number(place);
                match self.taken.get(&number) {
                    Some(&value) => value,
                    None => {
                        self.taken.try_reserve(1)?;
                        let value = field.sample(self.grid.position(place));
                        self.taken.insert(number, value);
                        value
                    }
                }
            }
        };
        Ok(value > self.isovalue)
    }

    /// The corners of a cell that are inside, as bits.
    pub(super) fn inside(&mut self, cell: [usize; 3]) -> Result<u8, TryReserveError> {
        let mut inside = 0;
        for corner in 0..8 {
            inside |= u8::from(self.is_inside(corner_of(cell, corner))?) << corner;
        }
        Ok(inside)
    }

    /// The sample of a point that was asked for before.
    pub(super) fn value(&self, place: [usize; 3]) -> f32 {
        let number = self.number(place);
        match self.source {
            Sampler::Given { values, .. } => values[number as usize],
            Sampler::Field(_) => self.taken[&number],
        }
    }
}
