//! What is made of the cubes of a simple cubic lattice, one way or the other.

use crate::cubes::{
    Continued, Creases, Diagonals, EdgeMoves, Faces, Flat, Kept, Rule, continuation, patched, snap,
};
use crate::duals::{self, Nets};
use crate::extraction::ExtractError;
use crate::slabs::Run;
use crate::surface::trace::Trace;

/// What is made of the cubes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Way {
    /// Patches of crossings.
    Patches(Rule),
    /// Patches of crossings that are moved.
    Moved {
        /// What decides the patches.
        rule: Rule,
        /// How they are moved.
        moves: EdgeMoves,
    },
    /// Patches of crossings, with vertices where the surface has creases.
    Creased {
        /// What decides the patches.
        rule: Rule,
        /// What counts as a crease.
        creases: Creases,
    },
    /// Patches of crossings and of points that crossings were drawn to.
    Snapped {
        /// How near to a point a crossing must be, in lengths of its edge.
        gamma: f32,
        /// What faces between cells get.
        flat: Flat,
    },
    /// The dual of patches: vertices in cells.
    Nets(Nets),
    /// Patches of crossings, in those cubes that are reached from seeds.
    Continued(Continued),
}

/// An extractor's buffers, kept from one surface to the next.
#[derive(Default)]
pub(crate) struct CubeStreamer {
    kept: Kept,
    patches: Vec<patched::Workspace>,
    snapped: Vec<snap::Workspace>,
    nets: Vec<duals::Workspace>,
}

impl CubeStreamer {
    /// Extracts the cubes of a simple cubic lattice one way or the other.
    pub(crate) fn extract(&mut self, way: Way, run: Run) -> Result<(), ExtractError> {
        let Self { kept, patches, snapped, nets } = self;
        match way {
            Way::Patches(rule) => patched::extract((kept, patches), rule, 0.0, run),
            Way::Moved { rule, moves } => {
                let Run { request, progress, trace, extraction } = run;
                let run = Run { request, progress, trace, extraction: &mut *extraction };
                patched::extract((kept, patches), rule, moves.pull, run)?;
                moves.apply(request, extraction)
            }
            Way::Creased { rule, creases } => {
                // The trace says which edge a vertex is of, and which cell a triangle.
                let mut own = Trace::default();
                let Run { request, progress, trace, extraction } = run;
                let trace = trace.unwrap_or(&mut own);
                let run = Run { request, progress, trace: Some(&mut *trace), extraction: &mut *extraction };
                patched::extract((kept, patches), rule, 0.0, run)?;
                creases.apply(request, trace, extraction)
            }
            Way::Snapped { gamma, flat } => snap::extract((kept, snapped), gamma, flat, run),
            Way::Nets(of) => duals::extract((kept, nets), of, run),
            Way::Continued(continued) => {
                let rule = Rule { faces: Faces::SeparateInside, diagonals: Diagonals::Fan };
                continuation::extract(continued, rule, run)
            }
        }
    }
}
