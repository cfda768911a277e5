//! What is made of the cubes of a simple cubic lattice, one way or the other.

use crate::cubes::{
    self, Continued, Diagonals, EdgeMoves, Faces, Flat, Kept, Rule, continuation, extract_patches, snap,
};
use crate::duals::{self, Nets};
use crate::extraction::{ExtractError, Extraction};
use crate::slabs::Progress;
use crate::source::Request;
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
    patches: Vec<cubes::Workspace>,
    snapped: Vec<snap::Workspace>,
    nets: Vec<duals::Workspace>,
}

impl CubeStreamer {
    /// Extracts the cubes of a simple cubic lattice one way or the other.
    pub(crate) fn extract(
        &mut self,
        request: &Request,
        way: Way,
        progress: Option<&Progress>,
        trace: Option<&mut Trace>,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let Self { kept, patches, snapped, nets } = self;
        match way {
            Way::Patches(rule) => {
                extract_patches((kept, patches), request, rule, 0.0, progress, trace, extraction)
            }
            Way::Moved { rule, moves } => {
                extract_patches((kept, patches), request, rule, moves.pull, progress, trace, extraction)?;
                moves.apply(request, extraction)
            }
            Way::Snapped { gamma, flat } => {
                snap::extract((kept, snapped), request, gamma, flat, progress, trace, extraction)
            }
            Way::Nets(of) => duals::extract((kept, nets), request, of, progress, trace, extraction),
            Way::Continued(continued) => {
                let rule = Rule { faces: Faces::SeparateInside, diagonals: Diagonals::Fan };
                continuation::extract(request, continued, rule, progress, extraction)
            }
        }
    }
}
