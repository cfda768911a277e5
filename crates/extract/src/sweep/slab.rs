//! A slab of layers, streamed from the bottom up: sampled, then searched for vertices, then for triangles, each pass
//! as many layers behind the one before as a lattice edge can reach.

use std::ops::Range;
use std::time::{Duration, Instant};

use glam::Vec3;

use super::faces::{FaceTables, triangulate_layer};
use super::grid::Grid;
use super::points::{Placed, PointPass, Samples};
use super::records::Records;
use super::rule::ClusterRule;
use super::signs::Signs;
use super::source::Source;
use super::tiles::{TILE, Tile, Tiles};
use crate::field::SAFE;
use crate::placement::CrossingPlacer;
use crate::triangles::Triangulation;
use crate::{ExtractError, ScalarField};

/// Samples taken together near the surface.
const BATCH: usize = 4;

/// What all slabs of an extraction share.
pub(super) struct Job<'a, R> {
    pub(super) grid: &'a Grid,
    pub(super) tables: &'a FaceTables,
    pub(super) rule: &'a R,
    pub(super) source: Source<'a>,
    pub(super) isovalue: f32,
    pub(super) placer: Option<&'a CrossingPlacer<'a>>,
    /// Called with the number of layers sampled since the last call.
    pub(super) progress: &'a (dyn Fn(usize) + Sync),
}

/// Buffers of one thread, a few layers each, kept between slabs and between extractions.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    samples: Vec<f32>,
    signs: Signs,
    records: Records,
    tiles: Tiles,
    bits: Vec<u64>,
}

/// The surface in a slab.
///
/// Vertices are numbered from the lowest layer that the slab's triangles can touch, so that the numbers of the whole
/// surface are these plus a constant, in the layers above and below the slab too.
#[derive(Debug, Default)]
pub(super) struct Piece {
    /// Of the slab's own layers.
    pub(super) positions: Vec<Vec3>,
    /// Where the placer wants them.
    pub(super) targets: Vec<Vec3>,
    pub(super) surface: Triangulation,
    /// Vertices numbered in the layers below the slab.
    pub(super) below: u64,
    pub(super) crossing_ends: u64,
    /// Triangles that may touch a vertex below the slab, all before this one.
    pub(super) head: usize,
    /// Triangles that may touch a vertex above the slab, all from this one on.
    pub(super) tail: usize,
    pub(super) times: SlabTimes,
}

/// Time spent in the passes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SlabTimes {
    pub(super) sampling: Duration,
    pub(super) vertex: Duration,
    pub(super) geometry: Duration,
}

impl Workspace {
    /// Makes room; keeps what is large enough.
    pub(super) fn fit(
        &mut self,
        grid: &Grid,
        source: Source,
    ) -> Result<(), std::collections::TryReserveError> {
        if matches!(source, Source::Field(_)) {
            super::refill(&mut self.samples, grid.layer_len() * grid.slots(), 0.0)?;
            self.tiles.fit(grid)?;
        }
        self.signs.fit(grid)?;
        self.records.fit(grid)
    }
}

impl Piece {
    fn clear(&mut self) {
        self.positions.clear();
        self.targets.clear();
        self.surface.triangles.clear();
        let triangles = std::mem::take(&mut self.surface.triangles);
        self.surface = Triangulation { triangles, ..Triangulation::default() };
        (self.below, self.crossing_ends, self.head, self.tail) = (0, 0, 0, 0);
        self.times = SlabTimes::default();
    }
}

/// Extracts the layers `own`, vertices and triangles.
pub(super) fn sweep<R: ClusterRule>(
    job: &Job<R>,
    own: Range<usize>,
    workspace: &mut Workspace,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let Job { grid, isovalue, .. } = *job;
    let (reach, layers) = (grid.reach, grid.size[2]);
    let recorded = own.start.saturating_sub(reach)..layers.min(own.end + reach);
    let sampled = own.start.saturating_sub(2 * reach)..layers.min(own.end + 2 * reach);
    let out_of_memory = |_| ExtractError::NoMemoryForMesh;

    piece.clear();
    let mut placed = Placed::default();
    let mut last = Instant::now();
    let mut lap = || {
        let now = Instant::now();
        now - std::mem::replace(&mut last, now)
    };
    for step in sampled.start..own.end + 2 * reach {
        if sampled.contains(&step) {
            sample_layer(job, step, workspace);
            if own.contains(&step) {
                (job.progress)(1);
            }
        }
        piece.times.sampling += lap();

        if let Some(layer) = step.checked_sub(reach).filter(|layer| recorded.contains(layer)) {
            let samples = match job.source {
                Source::Samples(values) => Samples { values, slots: layers },
                Source::Field(_) => Samples { values: &workspace.samples, slots: grid.slots() },
            };
            let (signs, placer) = (&workspace.signs, job.placer);
            let pass = PointPass { grid, rule: job.rule, samples, signs, isovalue, placer };
            if layer == own.start {
                piece.below = placed.numbered;
            }
            if own.contains(&layer) {
                let seen = placed.crossing_ends;
                pass.layer(layer, &mut workspace.records, &mut placed, Some(&mut piece.positions))
                    .map_err(out_of_memory)?;
                piece.crossing_ends += placed.crossing_ends - seen;
            } else {
                pass.layer(layer, &mut workspace.records, &mut placed, None).map_err(out_of_memory)?;
            }
            if placed.numbered > u64::from(u32::MAX) {
                return Err(ExtractError::TooManyVertices { limit: u32::MAX });
            }
        }
        piece.times.vertex += lap();

        if let Some(layer) = step.checked_sub(2 * reach).filter(|layer| own.contains(layer)) {
            if layer + 2 * reach <= own.end {
                piece.tail = piece.surface.triangles.len();
            }
            triangulate_layer(grid, job.tables, R::TIES, &workspace.records, layer, &mut piece.surface)
                .map_err(out_of_memory)?;
            if layer < own.start + 2 * reach {
                piece.head = piece.surface.triangles.len();
            }
        }
        piece.times.geometry += lap();
    }
    piece.targets = placed.targets;
    Ok(())
}

/// Samples a layer, if the samples are not there already, and takes its signs.
fn sample_layer<R>(job: &Job<R>, layer: usize, workspace: &mut Workspace) {
    let grid = job.grid;
    let kind = grid.layout.kind(layer);
    let [points, rows] = grid.layout.used(kind);
    let [stride, _, layers] = grid.size;
    match job.source {
        Source::Samples(values) => {
            for row in 0..rows {
                let start = (layer % layers * grid.size[1] + row) * stride;
                workspace.signs.fill(row, layer, &values[start..start + points], job.isovalue);
            }
        }
        Source::Field(field) => {
            let (x, y, z) = (grid.coordinates.x(kind), grid.coordinates.y(kind), grid.coordinates.z()[layer]);
            workspace.tiles.turn_to(layer, grid, field, job.isovalue);
            for (row, &y) in y[..rows].iter().enumerate() {
                let start = (layer % grid.slots() * grid.size[1] + row) * stride;
                let values = &mut workspace.samples[start..start + points];
                let tiles = workspace.tiles.row(row);
                if tiles.iter().all(|tile| *tile == tiles[0]) && is_plain(tiles[0]) {
                    match tiles[0] {
                        Tile::Sampled { .. } => {
                            field.sample_row(&x[..points], y, z, values);
                            workspace.signs.fill(row, layer, values, job.isovalue);
                        }
                        side => workspace.signs.set_all(row, layer, side == Tile::Inside, points),
                    }
                    continue;
                }
                let (step, reach) = (grid.lattice.spacing(), grid.longest_edge);
                let line = SparseRow { field, isovalue: job.isovalue, step, reach, y, z };
                workspace.bits.clear();
                workspace.bits.resize(grid.words, 0);
                line.sample(tiles, &x[..points], values, &mut workspace.bits);
                workspace.signs.set(row, layer, &workspace.bits, points);
            }
        }
    }
}

/// Whether a row of such tiles is sampled in one go, or not at all.
fn is_plain(tile: Tile) -> bool {
    !matches!(tile, Tile::Sampled { slope, .. } if slope.is_finite())
}

/// A row of which some parts are known to be on one side.
struct SparseRow<'a> {
    field: &'a dyn ScalarField,
    isovalue: f32,
    step: f32,
    /// Of a lattice edge, in steps.
    reach: f32,
    y: f32,
    z: f32,
}

impl SparseRow<'_> {
    fn sample(&self, tiles: &[Tile], x: &[f32], values: &mut [f32], bits: &mut [u64]) {
        let mut tile = 0;
        while tile * TILE < x.len() {
            let first = tile * TILE;
            let (mut slope, mut before) = (0.0, None);
            while let Some(&Tile::Sampled { slope: here, known }) = tiles.get(tile) {
                slope = here.max(slope);
                before = before.or(Some(known));
                tile += 1;
            }
            if first == tile * TILE {
                if tiles[tile] == Tile::Inside {
                    set_bits(bits, first, x.len().min(first + TILE));
                }
                tile += 1;
            } else {
                self.run(first..x.len().min(tile * TILE), slope, before, x, values, bits);
            }
        }
    }

    /// Samples a run, leaving out points that are too far from the surface to be next to it. The slope is that of
    /// all tiles that the run goes through, which lie one beside the other; `before` is a value known nearby.
    fn run(
        &self,
        run: Range<usize>,
        slope: f32,
        mut before: Option<(Vec3, f32)>,
        x: &[f32],
        values: &mut [f32],
        bits: &mut [u64],
    ) {
        let Range { start: mut i, end } = run;
        // No bound leaves no point out.
        let steps_a_unit = 1.0 / (slope * self.step * SAFE);
        let mut batch = if slope.is_infinite() { end - i } else { 1 };
        while i < end {
            let points = i..end.min(i + batch);
            i = points.end;
            let values_of_points = &mut values[points.clone()];
            self.field.sample_row_after(&x[points.clone()], self.y, self.z, values_of_points, before);
            for point in points {
                bits[point / 64] |= u64::from(values[point] > self.isovalue) << (point % 64);
            }
            // How far the surface is at least, in steps. Points so near that no edge from them gets there have all
            // their neighbours on the same side. Not a number becomes 0.
            let value = values[i - 1];
            before = Some((Vec3::new(x[i - 1], self.y, self.z), value));
            let free = (value - self.isovalue).abs() * steps_a_unit - self.reach * (1.0 + 1e-3);
            let next = end.min(i + free as usize);
            if value > self.isovalue {
                set_bits(bits, i, next);
            }
            // Near the surface it takes them all: some at a time is quicker.
            batch = if next > i { 1 } else { BATCH };
            i = next;
        }
    }
}

fn set_bits(bits: &mut [u64], first: usize, end: usize) {
    for i in first..end {
        bits[i / 64] |= 1 << (i % 64);
    }
}
