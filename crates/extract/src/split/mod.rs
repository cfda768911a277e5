//! The extractor for cubes that are cut into tetrahedra each by itself, where points differ in their lattice edges.
//!
//! All samples of the lattice are in memory. Every crossing is a vertex: numbered in storage order of the points that
//! they are nearest to, then by direction; triangles go cell by cell.

mod cut;
mod points;
#[cfg(test)]
mod tests;

use std::time::Instant;

use glam::Vec3;
use mesh::TriangleMesh;
use rayon::prelude::*;

use self::cut::Cut;
use self::points::Points;
use crate::extraction::{Counts, ExtractError, Extraction, StageTimes};
use crate::lattice::{Border, Lattice};
use crate::level::Level;
use crate::memory::filled;
use crate::normals::vertex_normals;
use crate::placement;
use crate::sampling::on_threads;
use crate::settings::{Execution, ExtractSettings};
use crate::sweep::Source;
use crate::tetrahedra::{CASES, Case};
use crate::trace::Trace;
use crate::triangles::Triangulation;

/// Two in each of 24 tetrahedra.
const MOST_TRIANGLES_A_CELL: usize = 48;

/// The stages in order, timed and counted. At most `most_vertices` may come of it. The trace, if there is one, is that
/// before edges are collapsed.
pub(crate) fn extract(
    source: Source,
    lattice: &Lattice,
    settings: &ExtractSettings,
    execution: &Execution,
    most_vertices: u32,
    mut trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let start = Instant::now();
    let mut last = start;
    let mut lap = || {
        let now = Instant::now();
        now - std::mem::replace(&mut last, now)
    };
    let cut = Cut::of(lattice.arrangement());
    let out_of_memory = |_| ExtractError::OutOfMemory { bytes: lattice.memory_bytes() };
    let coordinates = Coordinates::new(lattice, &cut, Border::of(settings)).map_err(out_of_memory)?;
    let mut called = Vec::new();
    let mut points = Points::new(lattice, &cut).map_err(out_of_memory)?;
    if matches!(source, Source::Field(_)) {
        called = filled(points.len(), 0.0).map_err(out_of_memory)?;
    }
    let allocation = lap();

    let samples = match source {
        Source::Field(field) => {
            let [nx, ny, nz] = points.grid();
            let layer = |(z, values): (usize, &mut [f32])| {
                for (y, row) in values.chunks_exact_mut(nx).enumerate() {
                    field.sample_row(&coordinates.x, coordinates.y[y], coordinates.z[z], row);
                }
            };
            match execution.threads {
                1 => called.chunks_exact_mut(nx * ny).enumerate().for_each(layer),
                _ => on_threads(execution, nz, || {
                    called.par_chunks_exact_mut(nx * ny).enumerate().for_each(layer);
                })?,
            }
            called.as_slice()
        }
        Source::Samples(samples) => samples,
    };
    points.find_sides(samples, settings.isovalue);
    let sampling = lap();

    let level = match source {
        Source::Field(field) => {
            Some(Level { field, isovalue: settings.isovalue, spacing: lattice.spacing() })
        }
        Source::Samples(_) => None,
    };
    if let Some(trace) = trace.as_deref_mut() {
        trace.clear();
    }
    let keys = trace.as_deref_mut().map(|trace| &mut trace.keys);
    let mut vertices = points.place(samples, &coordinates, settings, level, most_vertices, keys)?;
    let vertex = lap();

    let mut surface = triangulate(lattice, &cut, &points, trace)?;
    let collapsing = placement::finish(
        level,
        lattice,
        settings,
        execution,
        &vertices.targets,
        &mut vertices.positions,
        &mut surface,
    )?;
    let clustering = collapsing.unwrap_or_default();
    let geometry = lap() - clustering;

    let positions = vertices.positions;
    let normals = vertex_normals(&positions, &surface.triangles)?;
    extraction.mesh = TriangleMesh { positions, normals, triangles: std::mem::take(&mut surface.triangles) };
    extraction.times = StageTimes { allocation, sampling, vertex, geometry, clustering, normals: lap() };
    extraction.counts = Counts::of(lattice, &extraction.mesh, &surface, vertices.crossings);
    Ok(())
}

/// Where stored points are, along each axis.
struct Coordinates {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Coordinates {
    /// `min + n * spacing`, `n` whole or half: one rounding of the product and one of the sum. With a border on the box,
    /// none beyond it.
    fn new(lattice: &Lattice, cut: &Cut, border: Border) -> Result<Self, std::collections::TryReserveError> {
        let (min, first) = (lattice.bounds().min.to_array(), lattice.first_stored());
        let grid = lattice.stored_grid();
        let axis = |axis: usize| {
            let step = 1.0 / cut.steps_a_cell as f32;
            let at = move |i: u32| match border {
                Border::BeyondBox => min[axis] + ((first[axis] + i) as f32 * step) * lattice.spacing(),
                Border::OnBox => {
                    let halves = i64::from(first[axis] + i) * 2 / cut.steps_a_cell as i64;
                    lattice.coordinate_on_box(axis, halves)
                }
            };
            crate::memory::collected((0..grid[axis] as usize).map(move |i| at(i as u32)))
        };
        Ok(Self { x: axis(0)?, y: axis(1)?, z: axis(2)? })
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> Vec3 {
        Vec3::new(self.x[x], self.y[y], self.z[z])
    }
}

/// Walks the cells in storage order and skips those whose points are all on one side.
fn triangulate(
    lattice: &Lattice,
    cut: &Cut,
    points: &Points,
    mut trace: Option<&mut Trace>,
) -> Result<Triangulation, ExtractError> {
    let mut result = Triangulation::default();
    let [nx, ny, nz] = lattice.cells().map(|n| n as usize);
    let probes = cut.corners.iter().map(|&corner| points.step(corner)).collect::<Vec<_>>();
    // By parity of the cell: of the corners of each tetrahedron, steps in storage from the cell's lowest corner.
    let steps = cut.tetrahedra.each_ref().map(|of_cell| {
        of_cell.iter().map(|tetrahedron| tetrahedron.corners.map(|c| points.step(c))).collect::<Vec<_>>()
    });
    let origin = lattice.origin().iter().sum::<u32>() as usize;
    for (z, y) in (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y))) {
        for x in 0..nx {
            let lowest = points.index([x, y, z].map(|i| i * cut.steps_a_cell));
            let inside = probes.iter().filter(|&&step| points.is_inside(lowest + step)).count();
            if inside == 0 || inside == probes.len() {
                continue;
            }
            result.triangles.try_reserve(MOST_TRIANGLES_A_CELL)?;
            let parity = (origin + x + y + z) % 2;
            for (tetrahedron, steps) in cut.tetrahedra[parity].iter().zip(&steps[parity]) {
                result.tetrahedra_evaluated += 1;
                let corners = steps.map(|step| lowest + step);
                let case = (0..4).fold(0, |case, i| case | usize::from(points.is_inside(corners[i])) << i);
                if CASES[case] != Case::Empty {
                    result.add(CASES[case], |edge| {
                        let edge = &tetrahedron.edges[usize::from(edge)];
                        let (from, to) = (corners[usize::from(edge.from)], corners[usize::from(edge.to)]);
                        points.vertex(from, edge.direction, to, edge.back)
                    });
                }
            }
            if let Some(trace) = trace.as_deref_mut() {
                trace.close_cell(lattice, [x, y, z], result.triangles.len())?;
            }
        }
    }
    Ok(result)
}
