//! Patches of cells, by table, on the vertices of a lattice.

use rayon::prelude::*;

use crate::crossings::{Crossings, Level};
use crate::table::Table;

/// Samples of a cell's corners in one frame.
const CORNERS: usize = 8;

/// The triangles of a frame, cell by cell, the first axis fastest.
pub(crate) fn triangles(counts: [usize; 3], level: Level, vertices: &Crossings) -> Vec<[u32; 3]> {
    let table = Table::<3>::get();
    each_layer(counts, |cells| {
        let mut made = Vec::new();
        for start in cells {
            let corners = corners(counts, start);
            let vertex = |e: u8| {
                let edge = &table.cube().edges()[usize::from(e)];
                vertices.vertex(corners[usize::from(edge.corners[0])], edge.axis)
            };
            made.extend(table.entry(inside(level, &corners)).iter().map(|simplex| simplex.map(vertex)));
        }
        made
    })
}

/// The tetrahedra between two frames, cell by cell, the first axis fastest. Vertices are those of the frames, and those between them.
pub(crate) fn tetrahedra(
    counts: [usize; 3],
    levels: [Level; 2],
    within: [&Crossings; 2],
    between: &Crossings,
) -> Vec<[u32; 4]> {
    let table = Table::<4>::get();
    each_layer(counts, |cells| {
        let mut made = Vec::new();
        for start in cells {
            let corners = corners(counts, start);
            let vertex = |e: u8| {
                let edge = &table.cube().edges()[usize::from(e)];
                let corner = usize::from(edge.corners[0]);
                let sample = corners[corner % CORNERS];
                match edge.axis {
                    3 => between.vertex(sample, 0),
                    axis => within[corner / CORNERS].vertex(sample, axis),
                }
            };
            let [before, after] = levels.map(|level| inside(level, &corners));
            let entry = table.entry(before | after << CORNERS);
            made.extend(entry.iter().map(|simplex| simplex.map(vertex)));
        }
        made
    })
}

/// How many tetrahedra there are between two frames.
pub(crate) fn count_tetrahedra(counts: [usize; 3], levels: [Level; 2]) -> u64 {
    let table = Table::<4>::get();
    let count = |start: usize| {
        let corners = corners(counts, start);
        let [before, after] = levels.map(|level| inside(level, &corners));
        table.entry(before | after << CORNERS).len() as u64
    };
    each_layer(counts, |cells| vec![cells.map(count).sum::<u64>()]).iter().sum()
}

/// What is made of each layer of cells, put together in order. Cells are the samples that they begin at.
fn each_layer<T: Send>(
    counts: [usize; 3],
    make: impl Fn(&mut dyn Iterator<Item = usize>) -> Vec<T> + Sync,
) -> Vec<T> {
    let layers: Vec<Vec<T>> = (0..counts[2] - 1)
        .into_par_iter()
        .map(|z| {
            let row = |y: usize| {
                let start = (z * counts[1] + y) * counts[0];
                start..start + counts[0] - 1
            };
            make(&mut (0..counts[1] - 1).flat_map(row))
        })
        .collect();
    let mut all = Vec::with_capacity(layers.iter().map(Vec::len).sum());
    layers.into_iter().for_each(|layer| all.extend(layer));
    all
}

/// The samples at the corners of a cell.
fn corners(counts: [usize; 3], start: usize) -> [usize; CORNERS] {
    std::array::from_fn(|c| start + (c & 1) + counts[0] * ((c >> 1 & 1) + counts[1] * (c >> 2)))
}

fn inside(level: Level, corners: &[usize; CORNERS]) -> u32 {
    corners.iter().enumerate().fold(0, |set, (c, &sample)| set | u32::from(level.is_inside(sample)) << c)
}
