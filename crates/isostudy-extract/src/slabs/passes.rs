//! How a slab is gone through: from the bottom up, by passes that follow each other.

use std::ops::Range;

use super::piece::Piece;
use crate::clock::Laps;
use crate::execution::control::Control;
use crate::extraction::ExtractError;

/// What a pass is timed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    Sampling,
    Vertex,
    Geometry,
}

/// A pass over layers of a slab, and of those round it that it needs to see. One call a layer: the loop is in the pass.
pub(crate) struct Pass<S> {
    pub(crate) stage: Stage,
    /// Layers that it stays behind the first pass.
    pub(crate) behind: usize,
    pub(crate) layers: Range<usize>,
    pub(crate) run: fn(&mut S, usize, &mut Piece) -> Result<(), ExtractError>,
}

/// Runs the passes, in their order at each step.
///
/// # Errors
/// [`ExtractError::Cancelled`], and those of the passes.
pub(crate) fn stream<S, const N: usize>(
    slab: &mut S,
    passes: [Pass<S>; N],
    control: Control,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let first = passes[0].layers.start;
    let end = passes.iter().map(|pass| pass.layers.end + pass.behind).max().unwrap_or(first);
    let mut laps = Laps::new();
    for step in first..end {
        if passes[0].layers.contains(&step) {
            control.check()?;
        }
        for pass in &passes {
            let Some(layer) = step.checked_sub(pass.behind).filter(|layer| pass.layers.contains(layer))
            else {
                continue;
            };
            (pass.run)(slab, layer, piece)?;
            let lap = laps.lap();
            match pass.stage {
                Stage::Sampling => piece.times.sampling += lap,
                Stage::Vertex => piece.times.vertex += lap,
                Stage::Geometry => piece.times.geometry += lap,
            }
        }
    }
    Ok(())
}
