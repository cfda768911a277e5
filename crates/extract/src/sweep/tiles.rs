//! Which samples are needed: tiles of the lattice that cannot meet the surface are never sampled.
//!
//! A brick is a few layers, from side to side of the lattice; it is quartered down to tiles of four by four columns.
//! A part whose points and all their lattice neighbours are on one side of the isovalue has no crossing, so nobody
//! asks for its values, only for its side. The field says so itself ([`ScalarField::range`]). In the tiles that are
//! left, a row goes on from each sample by as many points as the field's slope there allows.

use std::ops::Range;

use glam::Vec3;
use mesh::Bounds;

use super::grid::Grid;
use crate::ScalarField;
use crate::lattice::Arrangement;

/// Columns and rows of a tile.
pub(super) const TILE: usize = 4;

/// What is known of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tile {
    Outside,
    Inside,
    /// To be sampled; the field changes by at most this much a unit of length in and around it.
    Sampled {
        slope: f32,
        /// A value in the middle of it.
        known: (Vec3, f32),
    },
}

/// The tiles of one brick.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    tiles: Vec<Tile>,
    columns: usize,
    brick: Option<usize>,
}

impl Tiles {
    pub(super) fn fit(&mut self, grid: &Grid) -> Result<(), std::collections::TryReserveError> {
        self.columns = grid.size[0].div_ceil(TILE);
        self.brick = None;
        super::refill(&mut self.tiles, self.columns * grid.size[1].div_ceil(TILE), Tile::Outside)
    }

    /// The tiles that a row goes through.
    pub(super) fn row(&self, row: usize) -> &[Tile] {
        let start = row / TILE * self.columns;
        &self.tiles[start..start + self.columns]
    }

    /// Makes the tiles those of the brick that `layer` is in.
    pub(super) fn turn_to(&mut self, layer: usize, grid: &Grid, field: &dyn ScalarField, isovalue: f32) {
        let depth = depth(grid);
        let brick = layer / depth;
        if self.brick == Some(brick) {
            return;
        }
        self.brick = Some(brick);
        let layers = brick * depth..(brick + 1) * depth;
        let whole = [0..grid.size[0].next_multiple_of(TILE), 0..grid.size[1].next_multiple_of(TILE)];
        let mut search =
            Search { grid, field, isovalue, layers, tiles: &mut self.tiles, columns: self.columns };
        search.part(whole, None);
    }
}

/// Layers of a brick: as high as a tile is wide.
fn depth(grid: &Grid) -> usize {
    match grid.lattice.arrangement() {
        Arrangement::BodyCentred => 2 * TILE,
        Arrangement::SimpleCubic => TILE,
    }
}

struct Search<'a> {
    grid: &'a Grid,
    field: &'a dyn ScalarField,
    isovalue: f32,
    layers: Range<usize>,
    tiles: &'a mut [Tile],
    columns: usize,
}

impl Search<'_> {
    /// Decides the tiles of a part of the brick, in columns and rows; `before` is a value from nearby.
    fn part(&mut self, [columns, rows]: [Range<usize>; 2], before: Option<(Vec3, f32)>) {
        let around = self.around([&columns, &rows, &self.layers]);
        let centre = (around.min + around.max) * 0.5;
        let value = self.field.sample_after(centre, before);
        let tile = match self.field.range(around, value) {
            Some((low, _)) if low > self.isovalue => Tile::Inside,
            Some((_, high)) if high <= self.isovalue => Tile::Outside,
            _ if columns.len() > TILE || rows.len() > TILE => {
                let halves = |range: &Range<usize>| {
                    let middle = range.start + (range.len() / 2).next_multiple_of(TILE);
                    [range.start..middle, middle..range.end]
                };
                for rows in halves(&rows) {
                    for columns in halves(&columns) {
                        if !rows.is_empty() && !columns.is_empty() {
                            self.part([columns, rows.clone()], Some((centre, value)));
                        }
                    }
                }
                return;
            }
            _ => Tile::Sampled {
                slope: self.field.slope(around).unwrap_or(f32::INFINITY),
                known: (centre, value),
            },
        };
        for row in rows.start / TILE..rows.end / TILE {
            let start = row * self.columns;
            self.tiles[start + columns.start / TILE..start + columns.end / TILE].fill(tile);
        }
    }

    /// The box of the points of a part and all their neighbours.
    fn around(&self, part: [&Range<usize>; 3]) -> Bounds {
        let lattice = &self.grid.lattice;
        // From the first to the last point, in cells; centres are half a cell lower than corners.
        let (low, high, layers_a_cell) = match lattice.arrangement() {
            Arrangement::BodyCentred => (-0.5, -1.0, 2.0),
            Arrangement::SimpleCubic => (0.0, -1.0, 1.0),
        };
        let first =
            Vec3::new(part[0].start as f32, part[1].start as f32, part[2].start as f32 / layers_a_cell);
        let last = Vec3::new(part[0].end as f32, part[1].end as f32, part[2].end as f32 / layers_a_cell);
        let at = |cells: Vec3| lattice.bounds().min + cells * lattice.spacing();
        // A neighbour is at most one cell away along each axis; a little more for rounding.
        let reach = 1.0 + 1e-3;
        Bounds { min: at(first + (low - reach)), max: at(last + (high + reach)) }
    }
}
