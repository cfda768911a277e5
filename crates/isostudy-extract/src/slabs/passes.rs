//! How a slab is gone through: from the bottom up, by passes that follow each other.

use std::ops::Range;

use super::piece::{Piece, Vertices};
use super::{LayerDone, Streamed};
use crate::clock::Laps;
use crate::extraction::ExtractError;
use crate::source::Request;

/// What a pass is timed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    Sampling,
    Vertex,
    Geometry,
}

/// What a pass does in one layer.
type InLayer<S> = fn(&S, &mut Slab<<S as Streamed>::Workspace>, usize) -> Result<(), ExtractError>;

/// A pass over layers of a slab, and of those round it that it needs to see. One call a layer: the loop is in the pass.
pub(crate) struct Pass<S: Streamed> {
    pub(crate) stage: Stage,
    /// Layers that it stays behind the first pass.
    pub(crate) behind: usize,
    pub(crate) layers: Range<usize>,
    pub(crate) run: InLayer<S>,
}

/// A slab on its way.
pub(crate) struct Slab<'a, W> {
    /// The layers whose triangles are its own.
    pub(crate) own: Range<usize>,
    pub(crate) workspace: &'a mut W,
    pub(crate) vertices: Vertices,
    /// What it gives; its vertices once all passes are through.
    pub(crate) piece: &'a mut Piece,
    /// To be called with each of its own layers that is done.
    pub(crate) layer_done: &'a LayerDone<'a>,
}

impl<W> Slab<'_, W> {
    /// Runs the passes, in their order at each step.
    ///
    /// # Errors
    /// [`ExtractError::Cancelled`], [`ExtractError::TooManyVertices`], and those of the passes.
    pub(super) fn stream<S: Streamed<Workspace = W>>(
        mut self,
        of: &S,
        request: &Request,
    ) -> Result<(), ExtractError> {
        let passes = of.passes(self.own.clone());
        let passes = passes.as_ref();
        let first = passes[0].layers.start;
        let end = passes.iter().map(|pass| pass.layers.end + pass.behind).max().unwrap_or(first);
        let mut laps = Laps::new();
        for step in first..end {
            if passes[0].layers.contains(&step) {
                request.control.check()?;
            }
            for pass in passes {
                let Some(layer) = step.checked_sub(pass.behind).filter(|layer| pass.layers.contains(layer))
                else {
                    continue;
                };
                (pass.run)(of, &mut self, layer)?;
                self.vertices.check(request.most_vertices)?;
                let (lap, times) = (laps.lap(), &mut self.piece.times);
                match pass.stage {
                    Stage::Sampling => times.sampling += lap,
                    Stage::Vertex => times.vertex += lap,
                    Stage::Geometry => times.geometry += lap,
                }
            }
        }
        of.end(&mut self);
        self.vertices.give_to(self.piece);
        Ok(())
    }
}
