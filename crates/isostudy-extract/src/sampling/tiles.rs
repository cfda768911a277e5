//! Which samples are needed to tell sides: tiles of the lattice that lie on one side of the isovalue take none.
//!
//! A brick is a few layers, from side to side of the lattice; it is quartered down to tiles of two by two cells.
//! The field says whether a part can be on both sides ([`StudyField::range`]). In the tiles that are left, each
//! sample tells the side of the points around it as far as the field's slope there allows.

use std::collections::TryReserveError;
use std::ops::Range;

use glam::Vec3;
use isostudy_field::{SAFE, StudyField};
use isostudy_mesh::Bounds;

use crate::memory::refill;

/// Stored points, as tiles need them.
pub(crate) trait Points {
    /// Points a row, rows a layer, layers.
    fn size(&self) -> [usize; 3];
    /// Columns and rows of a tile.
    fn side(&self) -> usize;
    /// Layers of a brick.
    fn depth(&self) -> usize;
    /// The distance from cell to cell.
    fn spacing(&self) -> f32;
    /// The box of the points in some columns, rows and layers, each `[first, last]`.
    fn bounds(&self, columns: [usize; 2], rows: [usize; 2], layers: [usize; 2]) -> Bounds;
}

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
pub(crate) struct Tiles {
    /// Points along a side.
    side: usize,
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
    pub(crate) fn fit(&mut self, points: &impl Points) -> Result<(), TryReserveError> {
        self.side = points.side();
        let [columns, rows, _] = points.size().map(|points| points.div_ceil(self.side));
        self.columns = columns;
        self.brick = None;
        refill(&mut self.tiles, columns * rows, Tile::Outside)?;
        refill(&mut self.known, columns * rows, Known::default())?;
        self.spans.clear();
        self.spans.try_reserve_exact(columns * rows)?;
        refill(&mut self.starts, rows + 1, 0)
    }

    /// The spans that a row of points goes through, and what is known of its mixed tiles.
    pub(crate) fn row(&self, row: usize) -> (&[Span], &[Known]) {
        let row = row / self.side;
        let known = &self.known[row * self.columns..(row + 1) * self.columns];
        (&self.spans[self.starts[row]..self.starts[row + 1]], known)
    }

    /// Makes the tiles those of the brick that `layer` is in.
    pub(crate) fn turn_to(
        &mut self,
        layer: usize,
        points: &impl Points,
        field: &dyn StudyField,
        isovalue: f32,
    ) {
        let depth = points.depth();
        let brick = layer / depth;
        if self.brick == Some(brick) {
            return;
        }
        self.brick = Some(brick);
        let [columns, rows, layers] = points.size();
        let layers = [brick * depth, layers.min((brick + 1) * depth) - 1];
        let whole = [columns, rows].map(|points| 0..points.next_multiple_of(self.side));
        Search { points, field, isovalue, layers, tiles: self }.part(whole, None);
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

struct Search<'a, P> {
    points: &'a P,
    field: &'a dyn StudyField,
    isovalue: f32,
    /// The first and the last.
    layers: [usize; 2],
    tiles: &'a mut Tiles,
}

impl<P: Points> Search<'_, P> {
    /// Decides the tiles of a part of the brick, in columns and rows; `before` is a value from nearby.
    fn part(&mut self, [columns, rows]: [Range<usize>; 2], before: Option<(Vec3, f32)>) {
        let side = self.tiles.side;
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
                    let at = rows.start / side * self.tiles.columns + columns.start / side;
                    self.tiles.known[at] = Known { at: centre, value, slope };
                    Tile::Mixed
                }
                None => Tile::Unknown,
            },
        };
        for row in rows.start / side..rows.end / side {
            let start = row * self.tiles.columns;
            self.tiles.tiles[start + columns.start / side..start + columns.end / side].fill(tile);
        }
    }

    /// The box of the points of a part.
    fn bounds(&self, columns: &Range<usize>, rows: &Range<usize>) -> Bounds {
        let size = self.points.size();
        let within = |range: &Range<usize>, size: usize| [range.start, range.end.min(size) - 1];
        self.points.bounds(within(columns, size[0]), within(rows, size[1]), self.layers)
    }

    /// So wide that the boxes of tiles side by side meet.
    fn with_gaps(&self, Bounds { min, max }: Bounds) -> Bounds {
        let gap = Vec3::X * self.points.spacing();
        Bounds { min: min - gap, max: max + gap }
    }
}

fn halves(range: &Range<usize>, side: usize) -> [Range<usize>; 2] {
    let middle = range.start + (range.len() / 2).next_multiple_of(side);
    [range.start..middle, middle..range.end]
}
