//! Which samples are needed to tell sides: tiles of the lattice that lie on one side of the isovalue take none.
//!
//! As in [`crate::sweep`], on a grid of points that are all in line: a brick is as many layers as a tile has rows, from
//! side to side of the lattice, and is quartered down to tiles.

use std::collections::TryReserveError;
use std::ops::Range;

use glam::Vec3;
use mesh::Bounds;

use super::grid::Grid;
use crate::memory::{filled, with_room};
use crate::sweep::{Known, Span, Tile};
use field::ScalarField;

/// Columns, rows and layers of a tile for each of a cell.
pub(crate) const TILE: usize = 2;

/// The tiles of one brick.
pub(super) struct Tiles {
    /// Points along a side.
    pub(super) side: usize,
    tiles: Vec<Tile>,
    /// By tile, where it is mixed.
    known: Vec<Known>,
    columns: usize,
    /// Row after row of tiles.
    spans: Vec<Span>,
    /// Where each row's spans start; one more than there are rows.
    starts: Vec<usize>,
    brick: Option<usize>,
}

impl Tiles {
    pub(super) fn new(grid: &Grid) -> Result<Self, TryReserveError> {
        let side = TILE * grid.cut.steps_a_cell;
        let [columns, rows] = [grid.size[0], grid.size[1]].map(|points| points.div_ceil(side));
        Ok(Self {
            side,
            tiles: filled(columns * rows, Tile::Outside)?,
            known: filled(columns * rows, Known::default())?,
            columns,
            spans: with_room(columns * rows)?,
            starts: filled(rows + 1, 0)?,
            brick: None,
        })
    }

    /// The spans that a row of points goes through, and what is known of its mixed tiles.
    pub(super) fn row(&self, row: usize) -> (&[Span], &[Known]) {
        let row = row / self.side;
        let known = &self.known[row * self.columns..(row + 1) * self.columns];
        (&self.spans[self.starts[row]..self.starts[row + 1]], known)
    }

    /// Makes the tiles those of the brick that `layer` is in.
    pub(super) fn turn_to(&mut self, layer: usize, grid: &Grid, field: &dyn ScalarField, isovalue: f32) {
        let brick = layer / self.side;
        if self.brick == Some(brick) {
            return;
        }
        self.brick = Some(brick);
        let layers = brick * self.side..grid.size[2].min((brick + 1) * self.side);
        let whole = [grid.size[0], grid.size[1]].map(|points| 0..points.next_multiple_of(self.side));
        let Self { tiles, known, columns, side, .. } = self;
        Search { grid, field, isovalue, layers, tiles, known, columns: *columns, side: *side }
            .part(whole, None);
        self.find_spans();
    }

    fn find_spans(&mut self) {
        self.spans.clear();
        for (row, tiles) in self.tiles.chunks_exact(self.columns).enumerate() {
            let mut first = 0;
            for span in tiles.chunk_by(|a, b| a == b) {
                let end = first + span.len() as u32;
                self.spans.push(Span { tile: span[0], first, end });
                first = end;
            }
            self.starts[row + 1] = self.spans.len();
        }
    }
}

struct Search<'a> {
    grid: &'a Grid<'a>,
    field: &'a dyn ScalarField,
    isovalue: f32,
    layers: Range<usize>,
    tiles: &'a mut [Tile],
    known: &'a mut [Known],
    columns: usize,
    side: usize,
}

impl Search<'_> {
    /// Decides the tiles of a part of the brick, in columns and rows; `before` is a value from nearby.
    fn part(&mut self, [columns, rows]: [Range<usize>; 2], before: Option<(Vec3, f32)>) {
        let side = self.side;
        let bounds = self.bounds(&columns, &rows);
        let centre = (bounds.min + bounds.max) * 0.5;
        // Some fields can tell without a value, and a field without bounds need not be asked for one.
        let mut value = f32::NAN;
        let mut range = self.field.range(bounds, value);
        if range.is_some_and(|(low, high)| low.is_nan() || high.is_nan()) {
            value = self.field.sample_after(centre, before);
            range = self.field.range(bounds, value);
        }
        let known = if value.is_nan() { before } else { Some((centre, value)) };
        let tile = match range {
            Some((low, _)) if low > self.isovalue => Tile::Inside,
            Some((_, high)) if high <= self.isovalue => Tile::Outside,
            _ if columns.len() > side || rows.len() > side => {
                for rows in halves(&rows, side) {
                    for columns in halves(&columns, side) {
                        if !rows.is_empty() && !columns.is_empty() {
                            self.part([columns, rows.clone()], known);
                        }
                    }
                }
                return;
            }
            _ => match self.field.slope(self.with_gaps(bounds)) {
                Some(slope) => {
                    let at = rows.start / side * self.columns + columns.start / side;
                    self.known[at] = Known { at: centre, value, slope };
                    Tile::Mixed
                }
                None => Tile::Unknown,
            },
        };
        for row in rows.start / side..rows.end / side {
            let start = row * self.columns;
            self.tiles[start + columns.start / side..start + columns.end / side].fill(tile);
        }
    }

    /// The box of the points of a part.
    fn bounds(&self, columns: &Range<usize>, rows: &Range<usize>) -> Bounds {
        let at = |axis: usize, values: &[f32], range: &Range<usize>| {
            (values[range.start], values[range.end.min(self.grid.size[axis]) - 1])
        };
        let places = &self.grid.coordinates;
        let (x, y) = (at(0, &places.x, columns), at(1, &places.y, rows));
        let z = at(2, &places.z, &self.layers);
        Bounds { min: Vec3::new(x.0, y.0, z.0), max: Vec3::new(x.1, y.1, z.1) }
    }

    /// So wide that the boxes of tiles side by side meet.
    fn with_gaps(&self, Bounds { min, max }: Bounds) -> Bounds {
        let gap = Vec3::X * self.grid.lattice.spacing();
        Bounds { min: min - gap, max: max + gap }
    }
}

fn halves(range: &Range<usize>, side: usize) -> [Range<usize>; 2] {
    let middle = range.start + (range.len() / 2).next_multiple_of(side);
    [range.start..middle, middle..range.end]
}
