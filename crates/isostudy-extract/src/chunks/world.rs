//! What a chunk is a chunk of.

use std::fmt;

use super::settings::ChunkSettings;
use crate::lattice::BoxGrid;
use crate::lattice::endless::Grid;
use crate::method::Method;

/// What chunks have in common that fit each other: the grid, the method and the settings. The field is not part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct World {
    pub(super) place: Place,
    pub(super) method: Method,
    pub(super) settings: ChunkSettings,
    /// Of chunks that there are several levels of.
    pub(crate) levels: Option<OfLevels>,
}

/// One of several levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OfLevels {
    /// Of the grid.
    pub(crate) level: u32,
    /// Of transitions, in cells.
    pub(crate) width: f32,
}

/// Where the cells are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    Endless(Grid),
    Box(BoxGrid),
}

impl World {
    /// The grid, if it has no end.
    pub fn grid(&self) -> Option<&Grid> {
        match &self.place {
            Place::Endless(grid) => Some(grid),
            Place::Box(_) => None,
        }
    }

    /// The grid, if it is a box.
    pub fn box_grid(&self) -> Option<&BoxGrid> {
        match &self.place {
            Place::Endless(_) => None,
            Place::Box(grid) => Some(grid),
        }
    }

    /// The method.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// The settings.
    pub fn settings(&self) -> &ChunkSettings {
        &self.settings
    }

    /// The same for all chunks that weld: with levels, the world of the finest one.
    pub(super) fn of_finest(self) -> Self {
        let (Some(OfLevels { level, width }), Place::Endless(grid)) = (self.levels, self.place) else {
            return self;
        };
        Self { place: Place::Endless(grid.finer(level)), levels: Some(OfLevels { level: 0, width }), ..self }
    }

    /// The lowest corner of a cell.
    pub(super) fn position(&self, cell: [i32; 3]) -> [f64; 3] {
        match &self.place {
            Place::Endless(grid) => grid.position(cell),
            Place::Box(grid) => {
                let (min, spacing) = (grid.bounds.min.to_array(), f64::from(grid.spacing));
                [0, 1, 2].map(|axis| f64::from(min[axis]) + f64::from(cell[axis]) * spacing)
            }
        }
    }
}

impl fmt::Display for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Place::Endless(grid) => write!(f, "cells of {} from {:?}", grid.spacing(), grid.origin())?,
            Place::Box(BoxGrid { bounds, spacing }) => {
                let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
                write!(f, "cells of {spacing} in the box {min:?} to {max:?}")?;
            }
        }
        let ChunkSettings { isovalue, normals } = self.settings;
        write!(f, " with isovalue {isovalue} and normals {normals:?} by {:?}", self.method)?;
        match self.levels {
            Some(OfLevels { level, width }) => {
                write!(f, " at level {level} with transitions of {width} cells")
            }
            None => Ok(()),
        }
    }
}
