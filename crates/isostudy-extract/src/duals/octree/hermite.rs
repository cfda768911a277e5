//! What is known of a surface: the cells that it crosses, and its crossings with normals.

use std::ops::Range;

use glam::DVec3;
use isostudy_cells::Cell;

use super::super::tangents::{Tangent, tangent};
use crate::cubes::grid::CubeGrid;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::ExtractError;
use crate::memory::{filled, push, with_room};
use crate::sampling::level::Level;
use crate::source::Request;
use crate::surface::trace::Trace;

/// A cell of the uniform net that has a vertex.
pub(super) struct Leaf {
    /// Its place along the octree's curve: bits of x, y and z by turns.
    pub(super) code: u128,
    pub(super) cell: [usize; 3],
    /// Its vertices.
    pub(super) vertices: Range<u32>,
    /// Its corners that are inside, one bit each.
    pub(super) inside: u8,
    /// Whether it has one vertex, for one patch that leaves no face a choice, and lies off the box.
    pub(super) is_regular: bool,
}

/// What is known of the surface: leaves along the octree's curve, and the crossings of regular ones.
pub(super) struct Hermite {
    pub(super) leaves: Vec<Leaf>,
    /// Numbers of crossed edges, ascending: three times that of the point that they begin at, and the axis.
    edges: Vec<u64>,
    /// Of each of these edges.
    tangents: Vec<Tangent>,
    cube: Cell,
    /// By inside corners: whether one loop of surface leaves no face a choice.
    pub(super) regular: Vec<bool>,
}

impl Hermite {
    pub(super) fn of(
        request: &Request,
        level: Level,
        grid: &CubeGrid,
        trace: &Trace,
    ) -> Result<Self, ExtractError> {
        let threads = request.control.threads;
        let cube = Cell::cube();
        let regular = (0..256)
            .map(|inside| cube.ambiguous_faces(inside) == 0 && cube.loops(inside, 0).len() == 1)
            .collect();
        let mut hermite =
            Self { leaves: leaves(grid, trace)?, edges: Vec::new(), tangents: Vec::new(), cube, regular };
        let mut points: Vec<u64> = with_room(8 * hermite.leaves.len())?;
        points.extend(
            hermite.leaves.iter().flat_map(|leaf| (0..8).map(|c| point_number(grid, corner(leaf.cell, c)))),
        );
        points.sort_unstable();
        points.dedup();
        let mut values = filled(points.len(), 0.0)?;
        request.control.check()?;
        for_each_on_threads(threads, &mut values, |i, value| {
            *value = level.field.sample(grid.position(point_of(grid, points[i])));
        })?;
        let value =
            |place| values[points.binary_search(&point_number(grid, place)).expect("a corner of a leaf")];
        for leaf in &mut hermite.leaves {
            let is_inside = |c: u8| value(corner(leaf.cell, c)) > level.isovalue;
            leaf.inside = (0..8).fold(0, |set, c| set | u8::from(is_inside(c)) << c);
            leaf.is_regular &= hermite.regular[usize::from(leaf.inside)];
        }
        let mut edges = Vec::new();
        for leaf in hermite.leaves.iter().filter(|leaf| leaf.is_regular) {
            for edge in hermite.crossed(grid, leaf) {
                push(&mut edges, edge)?;
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let mut tangents = filled(edges.len(), (DVec3::ZERO, None))?;
        request.control.check()?;
        for_each_on_threads(threads, &mut tangents, |i, found| {
            let (from, axis) = (point_of(grid, edges[i] / 3), (edges[i] % 3) as usize);
            let mut to = from;
            to[axis] += 1;
            *found = tangent(level, grid, from, axis, [value(from), value(to)]);
        })?;
        (hermite.edges, hermite.tangents) = (edges, tangents);
        Ok(hermite)
    }

    /// The numbers of a leaf's crossed edges.
    fn crossed(&self, grid: &CubeGrid, leaf: &Leaf) -> impl Iterator<Item = u64> {
        let crossed = self.cube.crossed(u32::from(leaf.inside));
        let edges = self.cube.edges().iter().enumerate().filter(move |(e, _)| crossed >> e & 1 != 0);
        edges.map(|(_, [low, high])| {
            3 * point_number(grid, corner(leaf.cell, *low)) + u64::from((low ^ high).trailing_zeros())
        })
    }

    /// The crossing of an edge of a regular leaf.
    pub(super) fn tangent(&self, edge: u64) -> Tangent {
        self.tangents[self.edges.binary_search(&edge).expect("an edge of a regular leaf")]
    }

    /// The crossings of some leaves, each once, in the order of their edges' numbers.
    pub(super) fn crossings(&self, grid: &CubeGrid, leaves: Range<usize>) -> Vec<Tangent> {
        let mut edges: Vec<u64> =
            self.leaves[leaves].iter().flat_map(|leaf| self.crossed(grid, leaf)).collect();
        edges.sort_unstable();
        edges.dedup();
        edges.iter().map(|&edge| self.tangent(edge)).collect()
    }
}

/// The cells that have vertices, along the octree's curve, without what samples say of them.
fn leaves(grid: &CubeGrid, trace: &Trace) -> Result<Vec<Leaf>, ExtractError> {
    let origin = grid.lattice.origin();
    let mut leaves: Vec<Leaf> = Vec::new();
    for (v, key) in trace.keys.iter().enumerate() {
        let cell = key.cell();
        let cell = [0, 1, 2].map(|axis| cell[axis].wrapping_sub(origin[axis]) as usize);
        if let Some(last) = leaves.last_mut().filter(|last| last.cell == cell) {
            (last.is_regular, last.vertices.end) = (false, v as u32 + 1);
            continue;
        }
        let is_regular = (0..3).all(|axis| 0 < cell[axis] && cell[axis] + 2 < grid.size[axis]);
        push(
            &mut leaves,
            Leaf { code: code(cell), cell, vertices: v as u32..v as u32 + 1, inside: 0, is_regular },
        )?;
    }
    leaves.sort_unstable_by_key(|leaf| leaf.code);
    Ok(leaves)
}

/// Bits of x, y and z by turns.
fn code(cell: [usize; 3]) -> u128 {
    let bit = |i: u32, axis: usize| (cell[axis] as u128 >> i & 1) << (3 * i + axis as u32);
    (0..32).flat_map(|i| (0..3).map(move |axis| bit(i, axis))).fold(0, |code, bit| code | bit)
}

fn corner(cell: [usize; 3], c: u8) -> [usize; 3] {
    [0, 1, 2].map(|axis| cell[axis] + usize::from(c >> axis & 1))
}

pub(super) fn point_number(grid: &CubeGrid, [x, y, z]: [usize; 3]) -> u64 {
    let [nx, ny, _] = grid.size;
    ((z * ny + y) * nx + x) as u64
}

fn point_of(grid: &CubeGrid, number: u64) -> [usize; 3] {
    let ([nx, ny, _], number) = (grid.size, number as usize);
    [number % nx, number / nx % ny, number / nx / ny]
}
