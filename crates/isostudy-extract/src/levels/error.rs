//! What can go wrong with chunks of several levels.

use std::collections::TryReserveError;

use crate::chunks::ChunkError;
use crate::lattice::CellBox;
use crate::wording::in_words;

/// The coarsest level that there is.
pub(super) const COARSEST: u32 = 24;

/// Why a chunk of a level cannot be extracted.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LevelError {
    /// As for chunks of one level.
    Chunk(ChunkError),
    /// A method without levels.
    Method,
    /// A level that there is not.
    Level {
        /// As given.
        level: u32,
    },
    /// A neighbour whose level differs by more than one.
    Step {
        /// Where it is.
        direction: [i32; 3],
        /// The chunk's level, and the neighbour's.
        levels: [u32; 2],
    },
    /// A finer neighbour of a chunk of the finest level.
    Finest,
    /// A chunk that begins or ends in the middle of a coarser neighbour's cell.
    Odd {
        /// As given.
        cells: CellBox,
    },
    /// Samples of one level in place of a field.
    NeedsField,
    /// Samples that are not as many as their window has corners.
    Samples {
        /// The window's level.
        level: u32,
        /// How many there are.
        given: u64,
        /// How many corners there are.
        wanted: u64,
    },
    /// Samples that are in no window of the level, nor of a finer one.
    Missing {
        /// The level.
        level: u32,
        /// The box of cells that a window must have.
        cells: CellBox,
    },
    /// Two levels that have different samples in one place.
    Disagree {
        /// The finer one, and the coarser one.
        levels: [u32; 2],
        /// The corner, of the coarser grid.
        corner: [i32; 3],
        /// The sample of each.
        samples: [f32; 2],
    },
}

in_words! {
    LevelError {
        Self::Chunk(error) => "{error}";
        Self::Method =>
            "levels are for marching cubes, and for surface nets and dual contouring with one vertex a cell";
        Self::Level { level } =>
            "level {level}: there are levels 0 to {COARSEST}, as far as cubes are finite in f32";
        Self::Step { direction, levels } =>
            "the neighbour in direction {direction:?} is of level {}, the chunk of level {}: they may differ \
             by one",
            levels[1], levels[0];
        Self::Finest => "level 0 is the finest: it has no finer neighbours";
        Self::Odd { cells } =>
            "cells {:?} to {:?} have a coarser neighbour: the numbers must be even", cells.start, cells.end;
        Self::NeedsField =>
            "seams need samples of two levels: give a field, or windows of each level to extract_samples_into";
        Self::Samples { level, given, wanted } =>
            "{given} samples for a window of level {level} with {wanted} corners";
        Self::Missing { level, cells } =>
            "samples of level {level} are missing: of the cells {:?} to {:?}, or of a finer level there",
            cells.start, cells.end;
        Self::Disagree { levels, corner, samples } =>
            "corner {corner:?} of level {} has the sample {:?}, and {:?} in level {}: they must be one",
            levels[1], samples[1], samples[0], levels[0];
    }
    from { ChunkError => Self::Chunk }
}

impl From<TryReserveError> for LevelError {
    fn from(error: TryReserveError) -> Self {
        Self::Chunk(error.into())
    }
}
