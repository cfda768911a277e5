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
    /// Of the grid, where there are several.
    pub(crate) level: Option<u32>,
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
        let (Some(level), Place::Endless(grid)) = (self.level, self.place) else {
            return self;
        };
        Self { place: Place::Endless(grid.finer(level)), level: Some(0), ..self }
    }

    /// Of chunks of a level, whose grid is given.
    pub(crate) fn of_level(grid: Grid, method: Method, settings: ChunkSettings, level: u32) -> Self {
        Self { place: Place::Endless(grid), method, settings, level: Some(level) }
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
        let ChunkSettings { isovalue, normals, relative, keys } = self.settings;
        write!(f, " with isovalue {isovalue} and normals {normals:?} by {:?}", self.method)?;
        if relative {
            f.write_str(" relative to each chunk")?;
        }
        if !keys {
            f.write_str(" without keys")?;
        }
        match self.level {
            Some(level) => write!(f, " at level {level}"),
            None => Ok(()),
        }
    }
}
