//! Triangle pass: the tetrahedra of the cells whose base points lie in one layer.
//!
//! Where the near crossings of each corner are one vertex, which is nearly everywhere, and every crossing has one
//! owner, a tetrahedron's triangles follow from its corners' sides and its edges' owners alone: a table of 1,024
//! entries names the corners whose vertices they join, and leaves out triangles that would join a vertex with itself.
//! Most triangles are never made.

use super::grid::UniformGrid;
use super::records::{Record, Records};
use crate::lattice::DIRECTIONS;
use crate::lattice::tetrahedra::MOST_TRIANGLES_A_CELL;
use crate::lattice::tetrahedra::{CASES, Case, EDGES, Tetrahedron, belongs_to_an_earlier_cell};
use crate::surface::triangulation::Triangulation;
use crate::tetrahedra::ties::Ties;

/// The triangles of a tetrahedron whose corners have one vertex each, in 32 bits so that the table is small: six bits
/// a triangle, two a corner; then how many are kept, how many discarded, and how many the original would count.
#[derive(Debug, Clone, Copy, Default)]
struct Faces(u32);

const KEPT: u32 = 12;
const DISCARDED: u32 = 14;
const AS_PUBLISHED: u32 = 16;

/// Corners and edges of a tetrahedron as bit numbers.
#[derive(Debug, Clone, Copy)]
struct Plan {
    corners: [u8; 3],
    /// From corner 1 to 2 and 3, and from 2 to 3.
    directions: [u8; 3],
}

/// What does not change from cell to cell.
#[derive(Debug)]
pub(super) struct FaceTables {
    /// By sides of the corners (4 bits) and owners of the edges (6 bits, set for the lower corner).
    faces: Box<[Faces; 1024]>,
    /// The tetrahedra of a cell away from the lower faces of the box, in order.
    plans: Vec<Plan>,
    /// Which of them are cut, by the crossing edges of the base point.
    cut: Box<[u16; 1 << DIRECTIONS]>,
    /// Neighbours of the base point that those tetrahedra have.
    corners: Vec<u8>,
}

impl FaceTables {
    pub(super) fn new(grid: &UniformGrid) -> Self {
        let arrangement = grid.lattice.arrangement();
        let tetrahedra: Vec<&Tetrahedron> = grid
            .spokes
            .iter()
            .filter(|spoke| !belongs_to_an_earlier_cell(arrangement, spoke, [1; 3]))
            .flat_map(|spoke| &spoke.ring)
            .collect();
        let between =
            |a: u8, b: u8| grid.directions.between(a, b).expect("corners of a tetrahedron are neighbours");
        let plans: Vec<Plan> = tetrahedra
            .iter()
            .map(|tetrahedron| {
                let [a, b, c] = tetrahedron.corners;
                Plan { corners: [a, b, c], directions: [between(a, b), between(a, c), between(b, c)] }
            })
            .collect();
        let mut cut = Box::new([0; 1 << DIRECTIONS]);
        for (crossing, cut) in cut.iter_mut().enumerate() {
            for (i, plan) in plans.iter().enumerate() {
                let is_cut = plan.corners.iter().any(|&d| crossing >> d & 1 != 0);
                *cut |= u16::from(is_cut) << i;
            }
        }
        let mut corners: Vec<u8> = plans.iter().flat_map(|plan| plan.corners).collect();
        corners.sort_unstable();
        corners.dedup();
        Self { faces: Box::new(std::array::from_fn(Faces::new)), plans, cut, corners }
    }
}

impl Faces {
    /// Edges that the surface does not cross have no owner; their bits are not looked at.
    fn new(key: usize) -> Self {
        let owner = |edge: u8| {
            let (from, to) = EDGES[edge as usize];
            if key >> (4 + edge) & 1 != 0 { from } else { to }
        };
        let mut faces = Self::default();
        let mut add = |triangle: [u8; 3]| {
            let [a, b, c] = triangle;
            if a == b || b == c || c == a {
                faces.0 += 1 << DISCARDED | 1 << AS_PUBLISHED;
            } else {
                let corners = u32::from(a) | u32::from(b) << 2 | u32::from(c) << 4;
                faces.0 |= corners << (6 * faces.kept());
                faces.0 += 1 << KEPT;
            }
        };
        match CASES[key & 15] {
            Case::Empty => {}
            Case::Triangle(edges) => {
                let triangle = edges.map(owner);
                add(triangle);
                faces.0 += u32::from(triangle[1] == triangle[2]) << AS_PUBLISHED;
            }
            Case::Quad(edges) => {
                let [q0, q1, q2, q3] = edges.map(owner);
                add([q0, q1, q2]);
                add([q3, q2, q1]);
            }
        }
        faces
    }

    #[inline(always)]
    fn kept(self) -> u32 {
        self.0 >> KEPT & 3
    }

    /// A triangle of them, with the corners' vertices.
    #[inline(always)]
    fn triangle(self, i: u32, vertices: &[u32; 4]) -> [u32; 3] {
        let corners = self.0 >> (6 * i);
        [corners, corners >> 2, corners >> 4].map(|corner| vertices[(corner & 3) as usize])
    }
}

/// Makes the triangles of the cells with base points in `layer`, row by row.
pub(super) fn triangulate_layer(
    grid: &UniformGrid,
    tables: &FaceTables,
    ties: Ties,
    records: &Records,
    layer: usize,
    result: &mut Triangulation,
) -> Result<(), std::collections::TryReserveError> {
    let Some(z) = grid.cells_of(layer) else { return Ok(()) };
    let [cells_x, cells_y, _] = grid.lattice.cells().map(|n| n as usize);
    for y in 0..cells_y {
        let row = y + grid.base_offset;
        let active = records.active(row, layer);
        if active.iter().all(|&word| word == 0) {
            continue;
        }
        let pass = CellRow::new(grid, tables, ties, records, row, layer);
        for (word, &bits) in active.iter().enumerate() {
            let mut left = bits;
            // By word, as the vertices are.
            result.triangles.try_reserve(MOST_TRIANGLES_A_CELL * bits.count_ones() as usize)?;
            while left != 0 {
                let column = 64 * word + left.trailing_zeros() as usize;
                left &= left - 1;
                let Some(x) = column.checked_sub(grid.base_offset).filter(|&x| x < cells_x) else { continue };
                pass.cell([x, y, z], column, result);
                if let Some(trace) = &mut result.trace {
                    trace.close_cell(grid.lattice.cell_number([x, y, z]), result.triangles.len())?;
                }
            }
        }
    }
    Ok(())
}

/// A row of base points and the rows of their neighbours.
struct CellRow<'a> {
    grid: &'a UniformGrid,
    tables: &'a FaceTables,
    ties: Ties,
    records: &'a Records,
    base: usize,
    /// By direction, with two to spare.
    neighbours: [usize; 16],
    layers: [usize; 16],
    layer: usize,
}

impl<'a> CellRow<'a> {
    fn new(
        grid: &'a UniformGrid,
        tables: &'a FaceTables,
        ties: Ties,
        records: &'a Records,
        row: usize,
        layer: usize,
    ) -> Self {
        let kind = grid.layout.base_kind();
        let around = grid.neighbourhood(kind);
        let layers = grid.layers(kind, layer);
        let lines = grid.rows(kind, row, layer, &layers).map(|(line, row)| [row, layers[line]]);
        let direction = |d: usize| d % DIRECTIONS;
        let neighbours = std::array::from_fn(|d| {
            let d = direction(d);
            let [row, layer] = lines[around.line[d]];
            records.row_start(row, layer).wrapping_add_signed(around.shift[d])
        });
        let layers = std::array::from_fn(|d| lines[around.line[direction(d)]][1]);
        Self { grid, tables, ties, records, base: records.row_start(row, layer), neighbours, layers, layer }
    }

    #[inline]
    fn cell(&self, cell: [usize; 3], column: usize, result: &mut Triangulation) {
        let base = self.records.at(self.base + column);
        if base.crossing() & self.grid.deciding == 0 {
            return;
        }
        result.cells_visited += 1;
        let mut corners = [Record::default(); 16];
        let mut all = base;
        for &d in &self.tables.corners {
            let record = self.records.at(self.neighbours[usize::from(d) & 15].wrapping_add(column));
            corners[d as usize & 15] = record;
            all = all.or(record);
        }
        let is_lowest = self.grid.base_offset != 0 && (cell[0] == 0 || cell[1] == 0 || cell[2] == 0);
        // The table asks one end of an edge alone.
        if is_lowest || self.ties == Ties::BothEnds || !all.is_one() {
            return self.general(cell, column, base, result);
        }
        result.tetrahedra_evaluated += self.tables.plans.len() as u64;
        let sides = if base.inside() { !base.crossing() } else { base.crossing() };
        let side = |d: u8| usize::from(sides >> d & 1);
        let mut cut = self.tables.cut[usize::from(base.crossing()) % self.tables.cut.len()];
        while cut != 0 {
            let plan = &self.tables.plans[cut.trailing_zeros() as usize];
            cut &= cut - 1;
            let [a, b, c] = plan.corners;
            let [ab, ac, bc] = plan.directions;
            let (at_a, at_b, at_c) =
                (corners[a as usize & 15], corners[b as usize & 15], corners[c as usize & 15]);
            let key = usize::from(base.inside())
                | side(a) << 1
                | side(b) << 2
                | side(c) << 3
                | base.owns(a) << 4
                | base.owns(b) << 5
                | base.owns(c) << 6
                | at_a.owns(ab) << 7
                | at_a.owns(ac) << 8
                | at_b.owns(bc) << 9;
            let faces = self.tables.faces[key % 1024];
            result.discarded += u64::from(faces.0 >> DISCARDED & 3);
            result.discarded_as_published += u64::from(faces.0 >> AS_PUBLISHED);
            if faces.kept() == 0 {
                continue;
            }
            let vertices = [base.first(), at_a.first(), at_b.first(), at_c.first()];
            result.triangles.push(faces.triangle(0, &vertices));
            if faces.kept() == 2 {
                result.triangles.push(faces.triangle(1, &vertices));
            }
        }
    }

    /// Any cell, edge by edge.
    #[inline(never)]
    fn general(&self, cell: [usize; 3], column: usize, base: Record, result: &mut Triangulation) {
        let sides = if base.inside() { !base.crossing() } else { base.crossing() };
        for spoke in &self.grid.spokes {
            if belongs_to_an_earlier_cell(self.grid.lattice.arrangement(), spoke, cell) {
                continue;
            }
            for tetrahedron in &spoke.ring {
                result.tetrahedra_evaluated += 1;
                let [a, b, c] = tetrahedron.corners.map(|d| usize::from(sides >> d & 1));
                let case = CASES[usize::from(base.inside()) | a << 1 | b << 2 | c << 3];
                if case == Case::Empty {
                    continue;
                }
                let record = |corner: u8| match corner {
                    0 => (base, self.layer),
                    _ => {
                        let d = usize::from(tetrahedron.corners[usize::from(corner) - 1]);
                        (self.records.at(self.neighbours[d].wrapping_add(column)), self.layers[d])
                    }
                };
                result.add(case, |edge| {
                    let edge = &tetrahedron.edges[usize::from(edge)];
                    let (from, layer) = record(edge.from);
                    if from.owns(edge.direction) != 0 {
                        return self.records.vertex(from, layer, edge.direction);
                    }
                    let (to, layer) = record(edge.to);
                    self.records.vertex(to, layer, edge.back)
                });
            }
        }
    }
}
