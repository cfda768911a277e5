//! Which samples are needed to tell sides: tiles of the lattice that lie on one side of the isovalue take none.
//!
//! A brick is a few layers, from side to side of the lattice; it is quartered down to tiles of two by two columns.
//! The field says whether a part can be on both sides ([`ScalarField::range`]). In the tiles that are left, each
//! sample tells the side of the points around it as far as the field's slope there allows.

use std::collections::TryReserveError;
use std::ops::Range;

use glam::Vec3;
use mesh::Bounds;

use super::grid::Grid;
use crate::lattice::{PointKind, Uniform};
use field::SAFE;
use field::ScalarField;

/// Columns and rows of a tile, and cells in the height of a brick.
pub(super) const TILE: usize = 2;

/// What is known of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Tile {
    #[default]
    Outside,
    Inside,
    /// Perhaps both; the field's slope is known.
    Mixed,
    /// Nothing.
    Unknown,
}

/// Neighbouring tiles of one kind.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    pub(crate) tile: Tile,
    pub(crate) first: u32,
    pub(crate) end: u32,
}

/// A value, and what it says about points nearby.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Known {
    pub(crate) at: Vec3,
    pub(crate) value: f32,
    /// At most how fast the field changes from here on.
    pub(crate) slope: f32,
}

impl Known {
    /// Up to this distance, squared, no point is on the other side; negative or `NaN` if there is none such.
    #[inline]
    pub(crate) fn squared_reach(&self, isovalue: f32) -> f32 {
        // What a field may be off by rounding: 1e-5 of either value, of which the other is at most
        // |value| + |value - isovalue|.
        let slack = (self.value.abs() + isovalue.abs()) * 4e-5;
        // And both places may be off by 1e-6 of their largest coordinates.
        let astray = self.at.abs().max_element() * 3e-6;
        let reach = ((self.value - isovalue).abs() - slack) / (self.slope * SAFE) - astray;
        reach * reach.abs()
    }

    /// The known value for the field, if there is one.
    pub(crate) fn hint(&self) -> Option<(Vec3, f32)> {
        (!self.value.is_nan()).then_some((self.at, self.value))
    }
}

/// The tiles of one brick.
#[derive(Debug, Default)]
pub(super) struct Tiles {
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
    pub(super) fn fit(&mut self, grid: &Grid) -> Result<(), TryReserveError> {
        let [columns, rows] = [grid.size[0], grid.size[1]].map(|points| points.div_ceil(TILE));
        self.columns = columns;
        self.brick = None;
        super::refill(&mut self.tiles, columns * rows, Tile::Outside)?;
        super::refill(&mut self.known, columns * rows, Known::default())?;
        self.spans.clear();
        self.spans.try_reserve_exact(columns * rows)?;
        super::refill(&mut self.starts, rows + 1, 0)
    }

    /// The spans that a row of points goes through, and what is known of its mixed tiles.
    pub(super) fn row(&self, row: usize) -> (&[Span], &[Known]) {
        let row = row / TILE;
        let known = &self.known[row * self.columns..(row + 1) * self.columns];
        (&self.spans[self.starts[row]..self.starts[row + 1]], known)
    }

    /// Makes the tiles those of the brick that `layer` is in.
    pub(super) fn turn_to(&mut self, layer: usize, grid: &Grid, field: &dyn ScalarField, isovalue: f32) {
        let depth = match grid.lattice.arrangement().expect_uniform() {
            Uniform::BodyCentred => 2 * TILE,
            Uniform::SimpleCubic => TILE,
        };
        let brick = layer / depth;
        if self.brick == Some(brick) {
            return;
        }
        self.brick = Some(brick);
        let layers = brick * depth..grid.size[2].min((brick + 1) * depth);
        let whole = [grid.size[0], grid.size[1]].map(|points| 0..points.next_multiple_of(TILE));
        let Self { tiles, known, columns, .. } = self;
        Search { grid, field, isovalue, layers, tiles, known, columns: *columns }.part(whole, None);
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
    grid: &'a Grid,
    field: &'a dyn ScalarField,
    isovalue: f32,
    layers: Range<usize>,
    tiles: &'a mut [Tile],
    known: &'a mut [Known],
    columns: usize,
}

impl Search<'_> {
    /// Decides the tiles of a part of the brick, in columns and rows; `before` is a value from nearby.
    fn part(&mut self, [columns, rows]: [Range<usize>; 2], before: Option<(Vec3, f32)>) {
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
            _ if columns.len() > TILE || rows.len() > TILE => {
                for rows in halves(&rows) {
                    for columns in halves(&columns) {
                        if !rows.is_empty() && !columns.is_empty() {
                            self.part([columns, rows.clone()], known);
                        }
                    }
                }
                return;
            }
            _ => match self.field.slope(self.with_gaps(bounds)) {
                Some(slope) => {
                    let at = rows.start / TILE * self.columns + columns.start / TILE;
                    self.known[at] = Known { at: centre, value, slope };
                    Tile::Mixed
                }
                None => Tile::Unknown,
            },
        };
        for row in rows.start / TILE..rows.end / TILE {
            let start = row * self.columns;
            self.tiles[start + columns.start / TILE..start + columns.end / TILE].fill(tile);
        }
    }

    /// The box of the points of a part.
    fn bounds(&self, columns: &Range<usize>, rows: &Range<usize>) -> Bounds {
        let (size, coordinates) = (self.grid.size, &self.grid.coordinates);
        // Centres are half a cell lower than corners.
        let lowest = match self.grid.lattice.arrangement().expect_uniform() {
            Uniform::BodyCentred => PointKind::Centre,
            Uniform::SimpleCubic => PointKind::Corner,
        };
        let highest = PointKind::Corner;
        let last = |range: &Range<usize>, size: usize| range.end.min(size) - 1;
        let (x, y, z) = (last(columns, size[0]), last(rows, size[1]), last(&self.layers, size[2]));
        let low = [
            coordinates.x(lowest)[columns.start],
            coordinates.y(lowest)[rows.start],
            coordinates.z()[self.layers.start],
        ];
        let high = [coordinates.x(highest)[x], coordinates.y(highest)[y], coordinates.z()[z]];
        Bounds { min: low.into(), max: high.into() }
    }

    /// So wide that the boxes of tiles side by side meet.
    fn with_gaps(&self, Bounds { min, max }: Bounds) -> Bounds {
        let gap = Vec3::X * self.grid.lattice.spacing();
        Bounds { min: min - gap, max: max + gap }
    }
}

fn halves(range: &Range<usize>) -> [Range<usize>; 2] {
    let middle = range.start + (range.len() / 2).next_multiple_of(TILE);
    [range.start..middle, middle..range.end]
}
