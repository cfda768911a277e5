//! Coarse cells some of whose sides and edges finer neighbours divide, with what is to be known of each kind.

use isostudy_cells::{Cell, Triangulator};

use super::neighbours::Neighbours;
use crate::lattice::CellBox;

/// Points of a cell: its corners and the middles between them, x fastest.
const POINTS: usize = 27;
const NONE: u8 = u8::MAX;

/// Which sides and edges are divided, as [`Cell::divided`] numbers them.
pub(super) type Division = (u8, u16);

/// The middle of a side or an edge, or a corner, by its offset from the cell's lowest corner in fine cells.
pub(super) fn point(offset: [i64; 3]) -> usize {
    (offset[0] + 3 * offset[1] + 9 * offset[2]) as usize
}

/// How the cells of a chunk are divided, by where they are in it.
pub(super) struct Divisions {
    cells: CellBox,
    /// By [`place`](Self::place); `None` where the neighbours divide nothing.
    by_place: [Option<Division>; 64],
}

impl Divisions {
    pub(super) fn new(cells: CellBox, neighbours: &Neighbours) -> Self {
        let by_place = std::array::from_fn(|place| {
            let is_at = |axis: usize, way: i32| place >> (2 * axis) >> usize::from(way > 0) & 1 != 0;
            let is_at_all =
                |direction: [i32; 3]| (0..3).all(|axis| direction[axis] == 0 || is_at(axis, direction[axis]));
            let (mut sides, mut edges) = (0, 0);
            for direction in neighbours.dividing().filter(|&direction| is_at_all(direction)) {
                let upper = |axis: usize| usize::from(direction[axis] > 0);
                match (0..3).find(|&axis| direction[axis] == 0 && is_edge(direction)) {
                    Some(axis) => {
                        edges |= 1 << (4 * axis + upper((axis + 1) % 3) + 2 * upper((axis + 2) % 3));
                    }
                    None => {
                        let axis = (0..3).find(|&axis| direction[axis] != 0).unwrap_or(0);
                        sides |= 1 << (2 * axis + upper(axis));
                    }
                }
            }
            (sides != 0 || edges != 0).then_some((sides, edges))
        });
        Self { cells, by_place }
    }

    /// At which sides of the chunk a cell is, two bits an axis.
    fn place(&self, cell: [i32; 3]) -> usize {
        let is = |is_it: bool, bit: usize| usize::from(is_it) << bit;
        (0..3).fold(0, |set, axis| {
            let (start, end) = (self.cells.start[axis], self.cells.end[axis]);
            set | is(cell[axis] == start, 2 * axis) | is(cell[axis] + 1 == end, 2 * axis + 1)
        })
    }

    /// How a cell is divided, if it is.
    pub(super) fn of(&self, cell: [i32; 3]) -> Option<Division> {
        self.by_place[self.place(cell)]
    }
}

fn is_edge(direction: [i32; 3]) -> bool {
    direction.iter().filter(|&&d| d != 0).count() == 2
}

/// A divided cell.
#[derive(Debug)]
pub(super) struct Divided {
    pub(super) cell: Cell,
    pub(super) triangulator: Triangulator,
    /// By the point that an edge begins at, then by axis.
    edge_at: [[u8; 3]; POINTS],
    /// Edges that lead from the lowest corner to each point: a point that is known, one that is not yet, and the edge between.
    pub(super) path: Vec<[u8; 3]>,
    /// The divided sides that each edge lies in, one bit each.
    pub(super) sides_at_edge: Vec<u8>,
    /// The side of each face.
    side_of_face: Vec<u8>,
    /// Of each edge, the middle of the divided edge that it is one half of.
    middle_of: Vec<Option<u8>>,
}

impl Divided {
    pub(super) fn new((sides, edges): Division) -> Self {
        let cell = Cell::divided(sides, edges);
        let place = |c: u8| cell.corners()[usize::from(c)];
        let mut edge_at = [[NONE; 3]; POINTS];
        for (e, &[low, high]) in cell.edges().iter().enumerate() {
            let axis =
                (0..3).find(|&axis| place(low)[axis] != place(high)[axis]).expect("edges have a length");
            edge_at[usize::from(low)][axis] = e as u8;
        }
        let (mut known, mut path) = (1_u32, Vec::new());
        loop {
            let is_new = |&&[a, b]: &&[u8; 2]| (known >> a ^ known >> b) & 1 != 0;
            let Some(e) = cell.edges().iter().position(|ends| is_new(&ends)) else { break };
            let [a, b] = cell.edges()[e];
            let [from, to] = if known >> a & 1 != 0 { [a, b] } else { [b, a] };
            path.push([from, to, e as u8]);
            known |= 1 << to;
        }
        let sides_at = |&[a, b]: &[u8; 2]| {
            let is_in = |side: usize| {
                let at = 2 * (side as i32 % 2);
                [a, b].iter().all(|&c| place(c)[side / 2] == at)
            };
            (0..6).filter(|&side| sides >> side & 1 != 0 && is_in(side)).fold(0, |set, side| set | 1 << side)
        };
        let sides_at_edge = cell.edges().iter().map(sides_at).collect();
        let squares = |side: u8| if sides >> side & 1 != 0 { 4 } else { 1 };
        let side_of_face = (0..6).flat_map(|side| std::iter::repeat_n(side, squares(side))).collect();
        let is_middle = |&c: &u8| place(c).iter().filter(|&&i| i == 1).count() == 1;
        let is_corner = |c: &u8| !place(*c).contains(&1);
        let middle_of =
            |ends: &[u8; 2]| ends.iter().copied().find(is_middle).filter(|_| ends.iter().any(is_corner));
        let middle_of = cell.edges().iter().map(middle_of).collect();
        Self {
            triangulator: Triangulator::new(&cell),
            edge_at,
            path,
            sides_at_edge,
            side_of_face,
            middle_of,
            cell,
        }
    }

    /// The point in the middle of a face's side.
    pub(super) fn middle_of_side(&self, face: u8) -> u8 {
        let side = self.side_of_face[usize::from(face)];
        let mut middle = [1; 3];
        middle[usize::from(side / 2)] = i64::from(2 * (side % 2));
        point(middle) as u8
    }

    /// The middle of the divided edge that these two are the halves of.
    pub(super) fn middle_between(&self, a: u8, b: u8) -> Option<u8> {
        let [a, b] = [a, b].map(|edge| self.middle_of[usize::from(edge)]);
        a.filter(|_| a == b)
    }

    /// The edge that begins at a point, along an axis: a part of one that is divided, or one that is not.
    pub(super) fn edge(&self, point: usize, along: usize, is_part: bool) -> Option<u8> {
        let edge = self.edge_at[point][along];
        let [low, high] = *self.cell.edges().get(usize::from(edge))?;
        let length =
            self.cell.corners()[usize::from(high)][along] - self.cell.corners()[usize::from(low)][along];
        ((length == 1) == is_part).then_some(edge)
    }
}
