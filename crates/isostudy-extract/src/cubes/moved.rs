//! Vertices that are taken from near the middles of their edges to the surface, square to it: what Macet is for.

#[cfg(test)]
mod tests;

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use crate::clock::Moment;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::{ExtractError, Extraction};
use crate::memory::copied;
use crate::placement::FieldTargets;
use crate::placement::Moves;
use crate::settings::Placement;
use crate::source::Request;
use crate::surface::normals::vertex_normals;

/// How vertices go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EdgeMoves {
    /// How far a vertex begins from its crossing, on the way to the middle of its edge: 0 to 1.
    pub(crate) pull: f32,
    /// How many times along the gradient and along the tangent plane, by turns.
    pub(crate) steps: u32,
    /// The share of the way in the tangent plane.
    pub(crate) share: f32,
}

impl EdgeMoves {
    /// Moves the vertices of an extraction that was made with the pull. Triangles are those of the table throughout: a vertex whose
    /// step would turn one over waits for the next.
    ///
    /// # Errors
    /// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`].
    pub(crate) fn apply(self, request: &Request, extraction: &mut Extraction) -> Result<(), ExtractError> {
        let Some(level) = request.level() else { return Ok(()) };
        let (start, threads) = (Moment::now(), request.control.threads);
        let bounds = request.lattice.bounds();
        let TriangleMesh { positions, normals, triangles } = &mut extraction.mesh;
        let origins = copied(positions)?;
        let mut moves = Moves::start(positions)?;
        let mut found = FieldTargets::default();
        let mut project = |moves: &mut Moves, positions: &mut Vec<Vec3>| -> Result<(), ExtractError> {
            let targets = found.find(&level, &bounds, Placement::Projected, threads, positions, triangles)?;
            Ok(moves.advance(positions, targets, triangles, &bounds)?)
        };
        for _ in 0..self.steps {
            project(&mut moves, positions)?;
            let mut targets = copied(positions)?;
            for_each_on_threads(threads, &mut targets, |v, target| {
                let way = origins[v] - *target;
                if let Some(normal) = level.normal(*target) {
                    let there = *target + (way - normal * way.dot(normal)) * self.share;
                    *target = there.clamp(bounds.min, bounds.max);
                }
            })?;
            moves.advance(positions, &targets, triangles, &bounds)?;
        }
        project(&mut moves, positions)?;
        project(&mut moves, positions)?;
        *normals = vertex_normals(positions, triangles).map_err(|_| ExtractError::NoMemoryForMesh)?;
        extraction.times.vertex += start.elapsed();
        Ok(())
    }
}
