//! The points and the crossings in a plane of a grid: of the fine grid in the side of a coarse chunk.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_field::StudyField;

use crate::chunks::Chunk;
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;
use crate::memory::refill;

const NONE: u32 = u32::MAX;

/// What is known of a rectangle of squares in a plane across an axis. Places in it are along the next axis, then the one after
/// that, in cyclic order.
#[derive(Debug, Default)]
pub(super) struct Plane {
    across: usize,
    /// The lowest point.
    start: [i32; 3],
    /// Squares along both axes.
    size: [usize; 2],
    /// By the point that an edge begins at, the vertex on it.
    vertices: [Vec<u32>; 2],
    /// Of each point.
    inside: Vec<bool>,
}

/// Some cells of a grid along a side: one thick.
pub(super) fn layer(across: usize, at: i32, [low, high]: [[i32; 3]; 2]) -> CellBox {
    let (mut start, mut end) = (low, high);
    (start[across], end[across]) = (at, at.saturating_add(1));
    CellBox { start, end }
}

impl Plane {
    /// Reads the lower side of a [layer] of cells that was extracted. The side of one point is asked of the field; those of the others
    /// follow from the crossings between.
    pub(super) fn read(
        &mut self,
        across: usize,
        chunk: &Chunk,
        (field, isovalue): (&dyn StudyField, f32),
        grid: &Grid,
    ) -> Result<(), TryReserveError> {
        let cells = chunk.cells;
        let axes = [(across + 1) % 3, (across + 2) % 3];
        (self.across, self.start, self.size) =
            (across, cells.start, axes.map(|axis| cells.size()[axis] as usize));
        let [nu, nv] = self.size;
        for vertices in &mut self.vertices {
            vertices.clear();
            refill(vertices, (nu + 1) * (nv + 1), NONE)?;
        }
        for (v, key) in chunk.keys.iter().enumerate() {
            let point = key.stored();
            let along = axes.iter().position(|&axis| axis == key.direction());
            let place = axes.map(|axis| (point[axis] - i64::from(cells.start[axis])) as usize);
            if let Some(along) = along
                && point[across] == i64::from(cells.start[across])
                && place[0] <= nu
                && place[1] <= nv
            {
                let i = self.place(place);
                self.vertices[along][i] = v as u32;
            }
        }
        self.inside.clear();
        refill(&mut self.inside, (nu + 1) * (nv + 1), false)?;
        self.inside[0] = field.sample(Vec3::from(point(grid, cells.start))) > isovalue;
        for v in 0..=nv {
            for u in 0..=nu {
                let (along, before) = match [u, v] {
                    [0, 0] => continue,
                    [0, _] => (1, [0, v - 1]),
                    _ => (0, [u - 1, v]),
                };
                let before = self.place(before);
                let i = self.place([u, v]);
                self.inside[i] = self.inside[before] != (self.vertices[along][before] != NONE);
            }
        }
        Ok(())
    }

    fn place(&self, [u, v]: [usize; 2]) -> usize {
        v * (self.size[0] + 1) + u
    }

    pub(super) fn is_inside(&self, place: [usize; 2]) -> bool {
        self.inside[self.place(place)]
    }

    /// The vertex on the edge that begins at a place, along the first axis or the second.
    pub(super) fn vertex(&self, place: [usize; 2], along: usize) -> Option<u32> {
        Some(self.vertices[along][self.place(place)]).filter(|&v| v != NONE)
    }

    /// The grid's corner at a place.
    pub(super) fn corner(&self, place: [usize; 2]) -> [i32; 3] {
        let mut corner = self.start;
        for (i, n) in place.into_iter().enumerate() {
            corner[(self.across + 1 + i) % 3] += n as i32;
        }
        corner
    }
}

/// Where a grid's corner is, as fields are asked.
pub(super) fn point(grid: &Grid, corner: [i32; 3]) -> [f32; 3] {
    grid.position(corner).map(|c| c as f32)
}
