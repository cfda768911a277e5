//! Why a chunk cannot be extracted.

use std::collections::TryReserveError;

use super::settled::MOST_EXTRA;
use crate::extraction::ExtractError;
use crate::lattice::{CellBox, LatticeError};
use crate::method::MethodError;
use crate::settings::Placement;
use crate::wording::in_words;

/// Why a chunk cannot be extracted.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ChunkError {
    /// The settings or the samples are not valid, there is no memory, or somebody cancelled it.
    Extract(ExtractError),
    /// A box without a cell, or with cells that there are not.
    Cells {
        /// What was given.
        given: CellBox,
        /// All cells.
        whole: CellBox,
    },
    /// The samples of a box that does not contain the window.
    Window {
        /// What was given.
        given: CellBox,
        /// What is looked at.
        wanted: CellBox,
    },
    /// [`Source::Samples`](crate::Source::Samples), all of them, of a grid without an end.
    EndlessSamples,
    /// Edge collapse in a grid without an end: a piece of surface may have none either.
    EndlessCollapse,
    /// [`Normals::Field`](crate::Normals::Field) of samples.
    NormalsNeedField,
    /// [`Normals::Samples`](crate::Normals::Samples) of a field, of several levels, or by a method that has none.
    NormalsNeedSamples,
    /// Positions relative to a chunk in a box.
    RelativeInBox,
    /// Chunks of several levels without [keys](crate::ChunkSettings::keys).
    LevelsNeedKeys,
    /// A setting of the method is out of its range.
    Settings(MethodError),
    /// A method without chunks.
    Method,
    /// [`Positions::Accumulated`](crate::Positions::Accumulated): a position depends on all before it.
    Accumulated,
    /// Vertices where chunks have none: refined crossings, weights by curvature, or moves after edges were collapsed.
    Placement {
        /// What was given.
        placement: Placement,
        /// What was given.
        refine_crossings: bool,
    },
    /// Whether a vertex may move depends on others more than 64 cells away.
    Unsettled,
}

in_words! {
    ChunkError {
        Self::Extract(error) => "{error}";
        Self::Cells { given, whole } =>
            "cells {:?} to {:?} are not a box of the cells {:?} to {:?}",
            given.start, given.end, whole.start, whole.end;
        Self::Window { given, wanted } =>
            "samples of the cells {:?} to {:?}, where those of {:?} to {:?} are looked at",
            given.start, given.end, wanted.start, wanted.end;
        Self::EndlessSamples => "a grid without an end has no last sample: give a Source::Window";
        Self::EndlessCollapse => "edge collapse needs a box";
        Self::NormalsNeedField => "samples have no gradient between them: Normals::Field needs a field";
        Self::NormalsNeedSamples =>
            "Normals::Samples is for chunks of one level and of samples, by marching cubes without a placement or \
             surface nets without smoothing";
        Self::RelativeInBox => "positions relative to a chunk are for a grid without an end";
        Self::LevelsNeedKeys => "chunks of several levels find their seams by keys: ChunkSettings::keys must be true";
        Self::Settings(error) => "{error}";
        Self::Method => "this method makes no chunks";
        Self::Accumulated => "chunks need indexed positions";
        Self::Placement { placement, refine_crossings } =>
            "chunks have vertices at the mean of interpolated crossings, projected or relaxed, without edge \
             collapse; not {placement:?}{}",
            if *refine_crossings { " with refined crossings" } else { "" };
        Self::Unsettled => "whether vertices may move depends on others more than {MOST_EXTRA} cells away";
    }
    from { ExtractError => Self::Extract, MethodError => Self::Settings }
}

impl From<TryReserveError> for ChunkError {
    fn from(error: TryReserveError) -> Self {
        Self::Extract(error.into())
    }
}

impl From<LatticeError> for ChunkError {
    fn from(error: LatticeError) -> Self {
        Self::Extract(error.into())
    }
}
