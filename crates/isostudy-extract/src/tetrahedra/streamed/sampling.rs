//! Sampling pass: the signs of a layer, and the samples at crossings that no sign needed.
//!
//! Given samples only have their signs taken, and so have those of a layer that was read. A field is called where its bounds leave the side of a point open; when
//! the signs of all neighbours are known, it is called again at the points with a crossing whose side did not need
//! their sample. All other points have none.

use std::collections::TryReserveError;
use std::convert::Infallible;

use super::crossings::{Crossings, Lines};
use super::grid::UniformGrid;
use super::points::Samples;
use super::signs::Signs;
use crate::memory::refill;
use crate::sampling::bits::set_range;
use crate::sampling::line::{All, Gaps, Line};
use crate::sampling::tiles::{Points, Span, Tile, Tiles};
use isostudy_field::StudyField;

/// What is called, and where.
#[derive(Clone, Copy)]
pub(super) struct FieldPass<'a> {
    pub(super) field: &'a dyn StudyField,
    pub(super) grid: &'a UniformGrid,
    pub(super) isovalue: f32,
    /// Whether samples are wanted at points without a crossing as well: then all are taken.
    pub(super) everywhere: bool,
}

/// A ring of layers of samples, and a bit for each that was taken.
#[derive(Debug, Default)]
pub(super) struct FieldSamples {
    values: Vec<f32>,
    taken: Vec<u64>,
    tiles: Tiles,
    slots: usize,
    gaps: Gaps,
}

/// The signs of a layer of samples that are all there.
pub(super) fn signs_of(
    grid: &UniformGrid,
    Samples { values, slots }: Samples,
    isovalue: f32,
    layer: usize,
    signs: &mut Signs,
) {
    let [points, rows] = grid.layout.used(grid.layout.kind(layer));
    let [stride, all_rows, _] = grid.size;
    for row in 0..rows {
        let start = (layer % slots * all_rows + row) * stride;
        signs.fill(row, layer, &values[start..start + points], isovalue);
    }
}

impl FieldSamples {
    pub(super) fn fit(&mut self, grid: &UniformGrid, slots: usize) -> Result<(), TryReserveError> {
        self.fit_values(grid, slots)?;
        refill(&mut self.taken, grid.words * grid.size[1] * slots, 0)?;
        self.gaps.fit(grid.size[0])?;
        self.tiles.fit(grid)
    }

    /// Makes room for the samples alone, of layers that are read as a whole.
    pub(super) fn fit_values(&mut self, grid: &UniformGrid, slots: usize) -> Result<(), TryReserveError> {
        self.slots = slots;
        refill(&mut self.values, grid.layer_len() * slots, 0.0)
    }

    /// The samples of a layer, to be read.
    pub(super) fn layer_mut(&mut self, grid: &UniformGrid, layer: usize) -> &mut [f32] {
        let length = grid.layer_len();
        &mut self.values[layer % self.slots * length..][..length]
    }

    pub(super) fn samples(&self) -> Samples<'_> {
        Samples { values: &self.values, slots: self.slots }
    }

    /// Finds the signs of a layer, with as few samples as may be.
    pub(super) fn find_signs(&mut self, pass: FieldPass, layer: usize, signs: &mut Signs) {
        let FieldPass { field, grid, isovalue, everywhere } = pass;
        let kind = grid.layout.kind(layer);
        let [points, rows] = grid.layout.used(kind);
        let (x, y, z) = (grid.coordinates.x(kind), grid.coordinates.y(kind), grid.coordinates.z()[layer]);
        if !everywhere {
            self.tiles.turn_to(layer, grid, field, isovalue);
        }
        for (row, &y) in y[..rows].iter().enumerate() {
            let place = layer % self.slots * grid.size[1] + row;
            let values = &mut self.values[place * grid.size[0]..][..points];
            let taken = &mut self.taken[place * grid.words..][..grid.words];
            if everywhere {
                field.sample_row(&x[..points], y, z, values);
                taken.fill(!0);
                signs.fill(row, layer, values, isovalue);
                continue;
            }
            let (spans, known) = self.tiles.row(row);
            match spans {
                [Span { tile: Tile::Unknown, .. }] => {
                    field.sample_row(&x[..points], y, z, values);
                    taken.fill(!0);
                    signs.fill(row, layer, values, isovalue);
                }
                [Span { tile: side @ (Tile::Outside | Tile::Inside), .. }] => {
                    taken.fill(0);
                    signs.set_all(row, layer, *side == Tile::Inside, points);
                }
                _ => {
                    taken.fill(0);
                    let (x, sides) = (&x[..points], signs.open(row, layer));
                    let mut line = Line { field, isovalue, columns: All, x, y, z, values, taken, sides };
                    line.sample(spans, known, grid.side(), take_all);
                    signs.close(row, layer, points);
                }
            }
        }
    }

    /// Takes the samples of a layer at points with a crossing that have none yet.
    pub(super) fn fill(&mut self, pass: FieldPass, layer: usize, signs: &Signs) {
        let FieldPass { field, grid, .. } = pass;
        let kind = grid.layout.kind(layer);
        let [points, rows] = grid.layout.used(kind);
        let (x, y, z) = (grid.coordinates.x(kind), grid.coordinates.y(kind), grid.coordinates.z()[layer]);
        let layers = grid.layers(kind, layer);
        let around = grid.neighbourhood(kind);
        let places = layers.map(|layer| layer % signs.slots * grid.size[1]);
        for (row, &y) in y[..rows].iter().enumerate() {
            let rows = grid.rows(kind, row, layer, &layers);
            let Some(lines) = Lines::new(signs, around, &rows, &places, points) else { continue };
            let place = layer % self.slots * grid.size[1] + row;
            let taken = &mut self.taken[place * grid.words..][..grid.words];
            let values = &mut self.values[place * grid.size[0]..][..points];
            self.gaps.clear();
            let Ok::<(), Infallible>(()) = lines.visit(grid, |Crossings { word, active, .. }| {
                self.gaps.note(word, active, &mut taken[word]);
                Ok(())
            });
            self.gaps.fill(field, x, y, z, values);
        }
    }
}

/// Takes the samples of columns from `first` up to `end`.
fn take_all(line: &mut Line<All>, first: usize, end: usize) {
    line.field.sample_row(&line.x[first..end], line.y, line.z, &mut line.values[first..end]);
    set_range(line.taken, first, end);
    for i in first..end {
        line.set_side(i, line.values[i] > line.isovalue);
    }
}
