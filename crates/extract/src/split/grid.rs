//! What the passes need to know about the lattice, worked out once.

use std::collections::TryReserveError;

use glam::Vec3;
use mesh::Bounds;

use super::cut::{Cut, CutEdge, Directions, Step};
use crate::lattice::{Border, Lattice};
use crate::memory::collected;
use crate::tiles::Points;

/// The points of a word in even and in odd columns.
const EVEN: u64 = 0x5555_5555_5555_5555;
const ODD: u64 = !EVEN;
/// Directions of lattice edges, at most.
const DIRECTIONS: usize = Directions::BITS as usize;
/// Rows that the neighbours of a point lie in, at most.
pub(super) const LINES: usize = 13;
/// Points of a cube, at most.
pub(super) const CORNERS: usize = 15;

/// The lattice as the passes see it.
pub(super) struct Grid<'a> {
    pub(super) lattice: &'a Lattice,
    border: Border,
    pub(super) cut: Cut,
    /// Points a row, rows a layer, layers, as stored.
    pub(super) size: [usize; 3],
    /// Words of bits a row.
    pub(super) words: usize,
    pub(super) coordinates: Coordinates,
    /// The columns that have points, by [`RowKind::columns`].
    pub(super) columns: [Vec<f32>; 2],
    /// By parity of the row and of the layer, in the window.
    kinds: [RowKind; 4],
    /// Rows and layers from a point to its neighbours, and by direction which of them it is.
    pub(super) lines: Vec<[isize; 2]>,
    pub(super) line: [usize; DIRECTIONS],
    /// By parity of the cell, in the window.
    pub(super) tetrahedra: [Vec<Tetrahedron>; 2],
    /// The columns in which cells start, as the bits of a word.
    pub(super) lowest_corners: u64,
}

/// What rows have in common whose numbers, and those of whose layers, are even or odd alike.
#[derive(Debug, Clone)]
pub(super) struct RowKind {
    /// The first column with a point, and from one to the next. The others belong to no tetrahedron.
    pub(super) columns: [usize; 2],
    /// The same as the bits of a word.
    pub(super) used: u64,
    /// By direction, the points of a word that have that edge.
    pub(super) edges: [u64; DIRECTIONS],
    /// By parity of the column.
    pub(super) edges_of: [Directions; 2],
    /// The lines that an edge leads to, one bit each.
    pub(super) lines: u32,
}

/// As [`super::cut::CutTetrahedron`], with the numbers of its corners among [`Cut::corners`].
#[derive(Debug)]
pub(super) struct Tetrahedron {
    pub(super) corners: [u8; 4],
    /// From and to are corners of the cube.
    pub(super) edges: [CutEdge; 6],
}

/// Where stored points are, along each axis.
#[derive(Debug)]
pub(super) struct Coordinates {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl Coordinates {
    /// `min + n * spacing`, `n` whole or half: one rounding of the product and one of the sum. With a border on the box,
    /// none beyond it.
    pub(super) fn new(lattice: &Lattice, cut: &Cut, border: Border) -> Result<Self, TryReserveError> {
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
            collected((0..grid[axis] as usize).map(move |i| at(i as u32)))
        };
        Ok(Self { x: axis(0)?, y: axis(1)?, z: axis(2)? })
    }

    pub(super) fn at(&self, [x, y, z]: [usize; 3]) -> Vec3 {
        Vec3::new(self.x[x], self.y[y], self.z[z])
    }
}

impl<'a> Grid<'a> {
    pub(super) fn new(lattice: &'a Lattice, border: Border) -> Result<Self, TryReserveError> {
        let cut = Cut::of(lattice.arrangement());
        let size = lattice.stored_grid().map(|n| n as usize);
        let coordinates = Coordinates::new(lattice, &cut, border)?;
        let (mut lines, mut line) = (vec![[0, 0]], [0; DIRECTIONS]);
        for (direction, &[_, rows, layers]) in cut.steps.iter().enumerate() {
            let away = [rows, layers].map(isize::from);
            line[direction] = lines.iter().position(|&known| known == away).unwrap_or(lines.len());
            if line[direction] == lines.len() {
                lines.push(away);
            }
        }
        assert!(lines.len() <= LINES && cut.corners.len() <= CORNERS, "tables are large enough");
        let first = lattice.first_stored().map(|i| i as usize);
        let kinds = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[y, z]| RowKind::new(&cut, first, [y, z], &line));
        let steps = cut.steps_a_cell;
        let odd = if steps == 1 { Vec::new() } else { every_second(&coordinates.x, 1)? };
        let even = if steps == 1 { Vec::new() } else { every_second(&coordinates.x, 0)? };
        let parity = lattice.origin().iter().sum::<u32>() as usize;
        let tetrahedra = [0, 1].map(|cell| {
            let of_cell = &cut.tetrahedra[(parity + cell) % 2];
            let number = |corner: Step| {
                cut.corners.iter().position(|&c| c == corner).expect("a point of the cube") as u8
            };
            let tetrahedron = |t: &super::cut::CutTetrahedron| {
                let corners = t.corners.map(number);
                let edges = t.edges.map(|edge| CutEdge {
                    from: corners[usize::from(edge.from)],
                    to: corners[usize::from(edge.to)],
                    ..edge
                });
                Tetrahedron { corners, edges }
            };
            of_cell.iter().map(tetrahedron).collect()
        });
        Ok(Self {
            lattice,
            border,
            size,
            words: size[0].div_ceil(64),
            coordinates,
            columns: [even, odd],
            kinds,
            lines,
            line,
            tetrahedra,
            lowest_corners: if steps == 1 { !0 } else { EVEN },
            cut,
        })
    }

    /// From a point to its neighbour: as far as the spacing says, `regular`, or less where the border cuts cells off.
    pub(super) fn way(&self, place: [usize; 3], direction: usize, regular: Vec3) -> Vec3 {
        let first = self.lattice.first_stored().map(|i| i as usize);
        let is_regular = self.border == Border::BeyondBox
            || (0..3).all(|axis| {
                let (low, end) = self.lattice.regular_points(axis);
                (low..end).contains(&((place[axis] + first[axis]) / self.cut.steps_a_cell))
            });
        if is_regular {
            return regular;
        }
        let step = self.cut.steps[direction];
        let there = [0, 1, 2].map(|axis| place[axis].strict_add_signed(isize::from(step[axis])));
        self.coordinates.at(there) - self.coordinates.at(place)
    }

    /// No neighbour is more layers, rows or columns away.
    pub(super) fn reach(&self) -> usize {
        self.cut.steps_a_cell
    }

    /// Layers of sides and samples in sight: those ahead, whose samples nobody has asked for yet, and all neighbours of
    /// the layer in which vertices are placed.
    pub(super) fn slots(&self) -> usize {
        3 * self.reach() + 1
    }

    pub(super) fn kind(&self, row: usize, layer: usize) -> &RowKind {
        &self.kinds[row % 2 + 2 * (layer % 2)]
    }

    /// The row and the layer of a line round a row, if the lattice has it.
    pub(super) fn line(&self, line: usize, row: usize, layer: usize) -> Option<[usize; 2]> {
        let [rows, layers] = self.lines[line];
        let (y, z) = (row.wrapping_add_signed(rows), layer.wrapping_add_signed(layers));
        (y < self.size[1] && z < self.size[2]).then_some([y, z])
    }
}

/// Columns, rows and layers of a tile for each of a cell.
const TILE: usize = 2;

impl Points for Grid<'_> {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn side(&self) -> usize {
        TILE * self.cut.steps_a_cell
    }

    fn depth(&self) -> usize {
        self.side()
    }

    fn spacing(&self) -> f32 {
        self.lattice.spacing()
    }

    fn bounds(&self, columns: [usize; 2], rows: [usize; 2], layers: [usize; 2]) -> Bounds {
        let [min, max] = [0, 1].map(|end| self.coordinates.at([columns[end], rows[end], layers[end]]));
        Bounds { min, max }
    }
}

fn every_second(values: &[f32], first: usize) -> Result<Vec<f32>, TryReserveError> {
    collected(values[first..].iter().copied().step_by(2))
}

impl RowKind {
    fn new(cut: &Cut, first: [usize; 3], [y, z]: [usize; 2], line: &[usize; DIRECTIONS]) -> Self {
        let edges_of = [0, 1].map(|x| cut.edges_of[cut.class([x + first[0], y + first[1], z + first[2]])]);
        let columns_of = |has: &dyn Fn(Directions) -> bool| {
            (if has(edges_of[0]) { EVEN } else { 0 }) | (if has(edges_of[1]) { ODD } else { 0 })
        };
        let mut lines = 0;
        for direction in (0..DIRECTIONS).filter(|d| (edges_of[0] | edges_of[1]) >> d & 1 != 0) {
            lines |= 1 << line[direction];
        }
        let used = columns_of(&|edges| edges != 0);
        let columns = match used {
            EVEN => [0, 2],
            ODD => [1, 2],
            _ => [0, 1],
        };
        let edges = std::array::from_fn(|d| columns_of(&|edges| edges >> d & 1 != 0));
        Self { columns, used, edges, edges_of, lines }
    }
}
