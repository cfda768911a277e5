//! What the passes need to know about the lattice, worked out once.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_mesh::Bounds;

use super::cut::{Cut, CutEdge, Directions, Step};
use crate::lattice::{Border, Lattice};
use crate::sampling::line::Every;
use crate::sampling::tiles::Points;
use crate::slabs::window::PointRows;

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
#[derive(Debug)]
pub(super) struct CutGrid {
    pub(super) lattice: Lattice,
    border: Border,
    pub(super) cut: &'static Cut,
    /// Points a row, rows a layer, layers, as stored.
    pub(super) size: [usize; 3],
    /// Words of bits a row.
    pub(super) words: usize,
    /// Where stored points are, along each axis.
    at: [Vec<f32>; 3],
    /// The columns that have points, by [`RowKind::columns`].
    pub(super) columns: [Vec<f32>; 2],
    /// By parity of the row and of the layer, in the window.
    kinds: [RowKind; 4],
    /// Rows and layers from a point to its neighbours, and by direction which of them it is.
    pub(super) lines: Vec<[isize; 2]>,
    pub(super) line: [usize; DIRECTIONS],
    /// Of the window's first cell.
    parity: usize,
    /// By parity of the cell.
    tetrahedra: [Vec<Tetrahedron>; 2],
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

impl CutGrid {
    pub(super) fn new(lattice: &Lattice, border: Border) -> Result<Self, TryReserveError> {
        let cut = Cut::get(lattice.arrangement());
        let (mut lines, mut line) = (vec![[0, 0]], [0; DIRECTIONS]);
        for (direction, &[_, rows, layers]) in cut.steps.iter().enumerate() {
            let away = [rows, layers].map(isize::from);
            line[direction] = lines.iter().position(|&known| known == away).unwrap_or(lines.len());
            if line[direction] == lines.len() {
                lines.push(away);
            }
        }
        assert!(lines.len() <= LINES && cut.corners.len() <= CORNERS, "tables are large enough");
        let tetrahedra = [0, 1].map(|parity| {
            let of_cell = &cut.tetrahedra[parity];
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
        let first = lattice.first_stored();
        let kinds = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[y, z]| RowKind::new(cut, first, [y, z], &line));
        let mut grid = Self {
            lattice: lattice.clone(),
            border,
            size: [0; 3],
            words: 0,
            at: Default::default(),
            columns: [Vec::new(), Vec::new()],
            kinds,
            lines,
            line,
            parity: 0,
            tetrahedra,
            lowest_corners: if cut.steps_a_cell == 1 { !0 } else { EVEN },
            cut,
        };
        grid.refit(lattice, border)?;
        Ok(grid)
    }

    /// Makes it that of another lattice of the same arrangement. What is large enough stays.
    pub(super) fn refit(&mut self, lattice: &Lattice, border: Border) -> Result<(), TryReserveError> {
        (self.lattice, self.border) = (lattice.clone(), border);
        self.size = lattice.stored_grid().map(|n| n as usize);
        self.words = self.size[0].div_ceil(64);
        lattice.refit_in_line(border, &mut self.at)?;
        if self.cut.steps_a_cell > 1 {
            for (first, columns) in self.columns.iter_mut().enumerate() {
                columns.clear();
                columns.try_reserve_exact(self.size[0])?;
                columns.extend(self.at[0][first..].iter().step_by(2));
            }
        }
        let first = lattice.first_stored();
        self.kinds =
            [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[y, z]| RowKind::new(self.cut, first, [y, z], &self.line));
        self.parity = lattice.origin().into_iter().map(i64::from).sum::<i64>().rem_euclid(2) as usize;
        Ok(())
    }

    /// The tetrahedra of a cell of the window.
    pub(super) fn tetrahedra(&self, cell: [usize; 3]) -> &[Tetrahedron] {
        &self.tetrahedra[(self.parity + cell.iter().sum::<usize>()) % 2]
    }

    /// From a point to its neighbour: as far as the spacing says, `regular`, or less where the border cuts cells off.
    pub(super) fn way(&self, place: [usize; 3], direction: usize, regular: Vec3) -> Vec3 {
        let is_regular = is_regular(&self.lattice, self.cut, self.border, place);
        if is_regular {
            return regular;
        }
        let step = self.cut.steps[direction];
        let there = [0, 1, 2].map(|axis| {
            place[axis].checked_add_signed(isize::from(step[axis])).expect("a point of the lattice")
        });
        self.position(there) - self.position(place)
    }

    pub(super) fn position(&self, place: [usize; 3]) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| self.at[axis][place[axis]]))
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

impl Points for CutGrid {
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
        let [min, max] = [0, 1].map(|end| self.position([columns[end], rows[end], layers[end]]));
        Bounds { min, max }
    }
}

/// Whether all lattice edges of a stored point are as long as the spacing says.
pub(super) fn is_regular(lattice: &Lattice, cut: &Cut, border: Border, place: [usize; 3]) -> bool {
    let stored = lattice.stored(place);
    (0..3).all(|axis| match lattice.regular_points(axis, border) {
        Some((low, end)) => (low..end).contains(&(stored[axis] / cut.steps_a_cell as i64)),
        None => true,
    })
}

impl RowKind {
    fn new(cut: &Cut, first: [i64; 3], [y, z]: [i64; 2], line: &[usize; DIRECTIONS]) -> Self {
        let edges_of =
            [0, 1].map(|x: i64| cut.edges_of[cut.class([x + first[0], y + first[1], z + first[2]])]);
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

impl PointRows for CutGrid {
    type Columns = Every;

    fn words(&self) -> usize {
        self.words
    }

    fn at(&self, axis: usize) -> &[f32] {
        &self.at[axis]
    }

    fn columns(&self, row: usize, layer: usize) -> (Every, &[f32], u64) {
        let RowKind { columns: [offset, step], used, .. } = *self.kind(row, layer);
        let x = if step == 1 { &self.at[0] } else { &self.columns[offset] };
        (Every { offset, step }, x, used)
    }
}
