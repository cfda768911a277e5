//! Marching cubes: the extractor for cubes that are not cut any further.
//!
//! Like [`crate::tetrahedra::streamed`] it streams: a few layers in memory, samples only where the field does not rule the surface out, slabs of
//! cells on several threads. A vertex is a crossing, numbered by the lower end of its lattice edge, then by axis; after them come
//! the few vertices in the cell whose lowest corner that point is. Triangles go cell by cell. Which triangles a cell has is a
//! [`patches::Patch`], made by rule from [`isostudy_cells`] at first use.

mod cells_pass;
pub(crate) mod continuation;
mod creased;
mod exact;
pub(crate) mod grid;
mod moved;
pub(crate) mod patched;
mod patches;
pub(crate) mod records;
mod rule;
pub(crate) mod sampling;
pub(crate) mod snap;
mod tubes;
mod tunnel;
pub(crate) mod vertices;

pub(crate) use continuation::Continued;
pub use continuation::{ContinuedCells, Seeds, SeedsError};
pub(crate) use creased::Creases;
pub(crate) use moved::EdgeMoves;
pub use rule::{Diagonals, Faces, Flat};

use isostudy_cells::{Cell, Table};

use self::grid::CubeGrid;
use self::patches::Patches;
use crate::extraction::ExtractError;
use crate::slabs::{Piece, Run, Streamed, in_slabs, out_of_memory};
use crate::source::Request;

/// What decides the triangles of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rule {
    pub(crate) faces: Faces,
    pub(crate) diagonals: Diagonals,
}

/// Whether a face's inside corners are one region of it, where they alternate with outside ones. `round` has the samples at its
/// corners in order, from an inside one on.
pub(crate) fn joins(faces: Faces, isovalue: f32, round: impl FnOnce() -> [f32; 4]) -> bool {
    match faces {
        Faces::SeparateInside => false,
        Faces::JoinInside => true,
        Faces::Decider | Faces::Trilinear => exact::is_joined(round(), isovalue),
    }
}

/// The table of a rule, where it is one of signs alone.
pub(crate) fn table(rule: Rule) -> Option<Table> {
    let entries = Patches::get(rule).by_signs(rule.faces)?;
    Some(Table::try_new(Cell::cube(), entries).expect("patches fit together"))
}

/// How many cells of a grid of samples have another patch by a rule's faces than the trilinear interpolant has.
pub(crate) fn cells_otherwise(rule: Rule, [nx, ny, nz]: [usize; 3], values: &[f32], isovalue: f32) -> u64 {
    let patches = Patches::get(rule);
    let mut count = 0;
    for z in 0..nz - 1 {
        for y in 0..ny - 1 {
            for x in 0..nx - 1 {
                let at = |c: usize| values[((z + (c >> 2)) * ny + y + (c >> 1 & 1)) * nx + x + (c & 1)];
                let inside = (0..8).fold(0, |set, c| set | u8::from(at(c) > isovalue) << c);
                if matches!(inside, 0 | 255) {
                    continue;
                }
                let by = |faces| patches.choose(faces, inside, isovalue, || std::array::from_fn(at));
                count += u64::from(by(rule.faces) != by(Faces::Trilinear));
            }
        }
    }
    count
}

/// What every way keeps from one surface to the next.
#[derive(Default)]
pub(crate) struct Kept {
    /// The coordinates of the grid's points along each axis.
    at: [Vec<f32>; 3],
    pieces: Vec<Piece>,
}

impl Kept {
    /// The grid of a request whose workspaces hold so many `times` what a lattice's layers do.
    pub(crate) fn grid<'a>(
        &mut self,
        request: &Request<'a>,
        times: u64,
    ) -> Result<CubeGrid<'a>, ExtractError> {
        let at = std::mem::take(&mut self.at);
        CubeGrid::within(request.lattice, at).map_err(|_| out_of_memory(request, times))
    }

    /// Streams the layers of cubes; see [`in_slabs`].
    pub(crate) fn stream<S: Streamed>(
        &mut self,
        of: &S,
        times: u64,
        workspaces: &mut Vec<S::Workspace>,
        run: Run,
    ) -> Result<(), ExtractError> {
        let Run { request, progress, trace, extraction } = run;
        let run = Run { request, progress, trace, extraction: &mut *extraction };
        in_slabs(of, request.lattice.cells()[2] as usize, times, workspaces, &mut self.pieces, run)?;
        extraction.counts.tetrahedra = None;
        Ok(())
    }

    /// Keeps the room of a grid that is not needed any more.
    pub(crate) fn keep(&mut self, grid: CubeGrid) {
        self.at = grid.at;
    }
}
