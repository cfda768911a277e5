//! Continuation: from cube to cube across the faces that the surface crosses, beginning at seeds (Wyvill, McPheeters & Wyvill 1986;
//! Bloomenthal 1988, 1994).
//!
//! Only how cubes are visited is new. Their corners are the points of the simple cubic lattice, a sample that equals the isovalue is
//! outside, and triangles are those of [`super::patches`], or those of [`crate::lattice::tetrahedra`] in each of six tetrahedra. Visited cubes are put
//! into storage order before anything is made of them, so the mesh depends on which they are and not on the way.

mod corners;
mod seeds;
mod surface;
mod visit;

pub use seeds::{ContinuedCells, Seeds, SeedsError};

use std::collections::{HashMap, TryReserveError};
use std::hash::{BuildHasherDefault, Hasher};

use self::corners::Corners;
use self::surface::Surface;
use super::grid::CubeGrid;
use super::{Rule, vertices::Placer};
use crate::clock::Moment;
use crate::extraction::{Counts, ExtractError, StageTimes};
use crate::slabs::Run;
use crate::source::Request;
use crate::surface::normals::vertex_normals;
use crate::surface::triangulation::Triangulation;

/// Which cubes are visited, and what is made of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Continued {
    pub(crate) cells: ContinuedCells,
    pub(crate) seeds: Seeds,
    /// Cells from one line of the search for seeds to the next, where none are given.
    pub(crate) search: u32,
}

/// Visits, then makes vertices and triangles, on the thread that calls.
pub(crate) fn extract(
    continued: Continued,
    rule: Rule,
    Run { request, progress, extraction, .. }: Run,
) -> Result<(), ExtractError> {
    let Request { source, lattice, settings, control, most_vertices, start, .. } = *request;
    let out_of_memory = |_: TryReserveError| ExtractError::NoMemoryForMesh;
    let grid = &CubeGrid::new(lattice).map_err(out_of_memory)?;
    let mut corners = Corners::new(grid, source, settings.isovalue);
    let mut times = StageTimes { allocation: start.elapsed(), ..StageTimes::default() };

    let visiting = Moment::now();
    let seeds = seeds::cells(&continued, &mut corners)?;
    let cells = visit::reached(&seeds, &mut corners, control)?;
    times.sampling = visiting.elapsed();

    let placing = Moment::now();
    let placer = Placer::new(lattice, settings, None);
    let surface = Surface::new(grid, &corners, &placer, rule, continued.cells, &cells);
    let numbered = surface.numbered().map_err(out_of_memory)?;
    if numbered.len() as u64 > u64::from(most_vertices) {
        return Err(ExtractError::TooManyVertices { limit: most_vertices });
    }
    control.check()?;
    let mesh = &mut extraction.mesh;
    mesh.positions = numbered.positions(&surface).map_err(out_of_memory)?;
    times.vertex = placing.elapsed();

    let joining = Moment::now();
    mesh.triangles = numbered.triangles(&surface).map_err(out_of_memory)?;
    times.geometry = joining.elapsed();

    let making_normals = Moment::now();
    mesh.normals = vertex_normals(&mesh.positions, &mesh.triangles).map_err(out_of_memory)?;
    times.normals = making_normals.elapsed();

    let looked_into = Triangulation { cells_visited: cells.len() as u64, ..Triangulation::default() };
    extraction.times = times;
    extraction.counts = Counts::of(lattice, mesh, &looked_into, numbered.crossings());
    extraction.counts.tetrahedra = None;
    let layers = lattice.cells()[2] as usize;
    if let Some(progress) = progress {
        progress(layers, layers);
    }
    if let Some(progress) = control.progress {
        progress(layers, layers);
    }
    Ok(())
}

/// A map by numbers of points or edges. Its order is never asked for.
type Map<V> = HashMap<u64, V, BuildHasherDefault<Mixer>>;

/// One multiplication: the numbers are near one another and all different.
#[derive(Debug, Clone, Copy, Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(self.0 ^ u64::from(byte)));
    }

    fn write_u64(&mut self, number: u64) {
        self.0 = number.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(26);
    }
}
