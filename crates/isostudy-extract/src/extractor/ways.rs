//! What is made of the cubes of a simple cubic lattice, one way or the other.

#[cfg(feature = "cubical-marching-squares")]
use crate::cubes::Creases;
#[cfg(feature = "macet")]
use crate::cubes::EdgeMoves;
use crate::cubes::Kept;
#[cfg(any(feature = "_patches", feature = "continuation"))]
use crate::cubes::Rule;
#[cfg(feature = "_patches")]
use crate::cubes::patched;
#[cfg(feature = "continuation")]
use crate::cubes::{Continued, Diagonals, Faces, continuation};
#[cfg(feature = "snap-cubes")]
use crate::cubes::{Flat, snap};
#[cfg(feature = "_duals")]
use crate::duals::{self, Nets};
use crate::extraction::ExtractError;
use crate::slabs::Run;
#[cfg(feature = "cubical-marching-squares")]
use crate::surface::trace::Trace;

/// What is made of the cubes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Way {
    #[cfg(feature = "cubes")]
    /// Patches of crossings.
    Patches(Rule),
    #[cfg(feature = "macet")]
    /// Patches of crossings that are moved.
    Moved {
        /// What decides the patches.
        rule: Rule,
        /// How they are moved.
        moves: EdgeMoves,
    },
    #[cfg(feature = "cubical-marching-squares")]
    /// Patches of crossings, with vertices where the surface has creases.
    Creased {
        /// What decides the patches.
        rule: Rule,
        /// What counts as a crease.
        creases: Creases,
    },
    #[cfg(feature = "snap-cubes")]
    /// Patches of crossings and of points that crossings were drawn to.
    Snapped {
        /// How near to a point a crossing must be, in lengths of its edge.
        gamma: f32,
        /// What faces between cells get.
        flat: Flat,
    },
    #[cfg(feature = "_duals")]
    /// The dual of patches: vertices in cells.
    Nets(Nets),
    #[cfg(feature = "continuation")]
    /// Patches of crossings, in those cubes that are reached from seeds.
    Continued(Continued),
}

/// An extractor's buffers, kept from one surface to the next.
#[derive(Default)]
pub(crate) struct CubeStreamer {
    kept: Kept,
    #[cfg(feature = "_patches")]
    patches: Vec<patched::Workspace>,
    #[cfg(feature = "snap-cubes")]
    snapped: Vec<snap::Workspace>,
    #[cfg(feature = "_duals")]
    nets: Vec<duals::Workspace>,
    #[cfg(feature = "dual-contouring-clean")]
    clean: duals::CleanBuffers,
}

impl CubeStreamer {
    /// Extracts the cubes of a simple cubic lattice one way or the other.
    pub(crate) fn extract(&mut self, way: Way, run: Run) -> Result<(), ExtractError> {
        let kept = &mut self.kept;
        match way {
            #[cfg(feature = "cubes")]
            Way::Patches(rule) => patched::extract((kept, &mut self.patches), rule, 0.0, run),
            #[cfg(feature = "macet")]
            Way::Moved { rule, moves } => {
                let Run { request, progress, trace, extraction } = run;
                let run = Run { request, progress, trace, extraction: &mut *extraction };
                patched::extract((kept, &mut self.patches), rule, moves.pull, run)?;
                moves.apply(request, extraction)
            }
            #[cfg(feature = "cubical-marching-squares")]
            Way::Creased { rule, creases } => {
                // The trace says which edge a vertex is of, and which cell a triangle.
                let mut own = Trace::default();
                let Run { request, progress, trace, extraction } = run;
                let trace = trace.unwrap_or(&mut own);
                let run = Run { request, progress, trace: Some(&mut *trace), extraction: &mut *extraction };
                patched::extract((kept, &mut self.patches), rule, 0.0, run)?;
                creases.apply(request, trace, extraction)
            }
            #[cfg(feature = "snap-cubes")]
            Way::Snapped { gamma, flat } => snap::extract((kept, &mut self.snapped), gamma, flat, run),
            #[cfg(feature = "_duals")]
            Way::Nets(of) => duals::extract(
                (kept, &mut self.nets),
                #[cfg(feature = "dual-contouring-clean")]
                &mut self.clean,
                of,
                run,
            ),
            #[cfg(feature = "continuation")]
            Way::Continued(continued) => {
                let rule = Rule { faces: Faces::SeparateInside, diagonals: Diagonals::Fan };
                continuation::extract(continued, rule, run)
            }
        }
    }
}
