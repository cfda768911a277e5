//! What can go wrong with chunks of several levels.

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt;

use crate::chunks::ChunkError;
use crate::lattice::CellBox;

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
    /// A width that is none.
    Width {
        /// As given.
        width: f32,
    },
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
    /// Samples in place of a field.
    NeedsField,
}

impl fmt::Display for LevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chunk(error) => error.fmt(f),
            Self::Method => f.write_str(
                "levels are for marching cubes, and for surface nets and dual contouring with one vertex a cell",
            ),
            Self::Width { width } => write!(f, "width = {width:?}: must be from 0 to 0.5, in cells"),
            Self::Level { level } => {
                write!(f, "level {level}: there are levels 0 to {COARSEST}, as far as cubes are finite in f32")
            }
            Self::Step { direction, levels: [of, neighbour] } => write!(
                f,
                "the neighbour in direction {direction:?} is of level {neighbour}, the chunk of level {of}: they may differ by \
                 one"
            ),
            Self::Finest => f.write_str("level 0 is the finest: it has no finer neighbours"),
            Self::Odd { cells } => write!(
                f,
                "cells {:?} to {:?} have a coarser neighbour: the numbers must be even",
                cells.start, cells.end
            ),
            Self::NeedsField => f.write_str("seams need samples of two levels: give a field"),
        }
    }
}

impl Error for LevelError {}

impl From<ChunkError> for LevelError {
    fn from(error: ChunkError) -> Self {
        Self::Chunk(error)
    }
}

impl From<TryReserveError> for LevelError {
    fn from(error: TryReserveError) -> Self {
        Self::Chunk(error.into())
    }
}
