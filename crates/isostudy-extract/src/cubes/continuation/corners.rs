//! The corners of cubes, sampled when they are first asked for.

use super::Map;
use crate::cubes::grid::CubeGrid;
use crate::cubes::vertices::corner_of;
use crate::extraction::ExtractError;
use crate::source::Sampler;

/// Samples by place. Of a field each is taken once, and of stored samples each is read once.
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
    ///
    /// # Errors
    /// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Unread`].
    pub(super) fn is_inside(&mut self, place: [usize; 3]) -> Result<bool, ExtractError> {
        let number = self.number(place);
        if matches!(self.source, Sampler::Given { .. }) || self.taken.contains_key(&number) {
            return Ok(self.value(place) > self.isovalue);
        }
        let value = match self.source {
            Sampler::Given { values, .. } => values[number as usize],
            Sampler::Field(field) => field.sample(self.grid.position(place)),
            Sampler::Stored(samples) => {
                let mut value = [0.0];
                samples.read_box(place, [1; 3], &mut value).map_err(ExtractError::Unread)?;
                value[0]
            }
        };
        self.taken.try_reserve(1)?;
        self.taken.insert(number, value);
        Ok(value > self.isovalue)
    }

    /// The corners of a cell that are inside, as bits.
    ///
    /// # Errors
    /// The same.
    pub(super) fn inside(&mut self, cell: [usize; 3]) -> Result<u8, ExtractError> {
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
            Sampler::Field(_) | Sampler::Stored(_) => self.taken[&number],
        }
    }
}
