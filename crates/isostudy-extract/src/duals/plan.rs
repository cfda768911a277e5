//! Which vertices a cell has, and which of them serves each of its edges.

use std::collections::HashMap;
use std::sync::OnceLock;

use glam::{BVec4A, Vec3};
use isostudy_cells::Cell;

use super::region::Region;

/// Edges of a cube.
pub(super) const EDGES: usize = 12;
/// Faces of a cube: low and high along x, y and z.
const FACES: usize = 6;

/// The corners that the four edges along each axis begin at.
pub(super) const EDGE_STARTS: [[usize; 4]; 3] = [[0, 2, 4, 6], [0, 1, 4, 5], [0, 1, 2, 3]];

/// The edges whose crossings a vertex is the mean of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mean {
    /// One bit each.
    pub(super) set: u16,
    /// The same by axis, in the order of [`EDGE_STARTS`].
    pub(super) edges: [BVec4A; 3],
    /// How many there are.
    pub(super) count: f32,
    /// How many of them have the higher coordinate along each axis, not counting those along it.
    pub(super) at_high_ends: Vec3,
}

/// What a cell has one vertex for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum VertexPer {
    /// Itself.
    Cell,
    /// Each run of quadrilaterals along a loop of surface round it. But for cells at the box that is a loop.
    Run,
    /// Each loop of surface round it, with what is known of the loop.
    Loop,
}

/// A loop of surface round a cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Loop {
    /// The edges that it crosses, counter-clockwise seen from outside the surface.
    pub(super) edges: Vec<u8>,
    /// The edges without a quadrilateral, one bit each.
    pub(super) open: u16,
    /// The part of the cell that is the loop's own.
    pub(super) region: Region,
}

impl Loop {
    /// Of a cell that has one, all of whose edges have quadrilaterals.
    pub(super) fn whole() -> Self {
        Self { edges: Vec::new(), open: 0, region: Region::default() }
    }

    /// Whether its quadrilaterals are several runs, which have nothing but the vertex in common.
    pub(super) fn is_cut(&self) -> bool {
        let is_open = |edge: u8| self.open >> edge & 1 != 0;
        let ends = |i: usize| !is_open(self.edges[i]) && is_open(self.edges[(i + 1) % self.edges.len()]);
        (0..self.edges.len()).filter(|&i| ends(i)).count() > 1
    }
}

/// The vertices of a cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Plan {
    /// One for each vertex.
    pub(super) means: Vec<Mean>,
    /// The loop of each vertex, with a vertex [per loop](VertexPer::Loop).
    pub(super) loops: Vec<Loop>,
    /// The vertex of each edge that has a quadrilateral; 0 for others.
    of_edge: [u8; EDGES],
}

impl Plan {
    /// Which of the cell's vertices a crossed edge leads to.
    #[cfg(test)]
    fn of_edge(&self, edge: u8) -> u32 {
        u32::from(self.of_edge[usize::from(edge)])
    }
}

/// The plans of all cells there can be, but for those at the box.
pub(super) struct Table {
    cube: Cell,
    vertex_per: VertexPer,
    /// The corner that an edge begins at, and its axis.
    edges: [(u8, u8); EDGES],
    /// By axis and the corner that an edge begins at.
    numbers: [[u8; 8]; 3],
    /// The cell's number of each face: low and high along x, y and z.
    faces: [usize; FACES],
    /// By signs: the face on which one loop has all four crossings, if there is one.
    joinable: Vec<Option<u8>>,
    /// By number: seven times the signs, and the joined face or six for none.
    plans: Vec<Plan>,
}

impl Table {
    /// Made when it is first asked for.
    pub(super) fn get(vertex_per: VertexPer) -> &'static Self {
        static TABLES: [OnceLock<Table>; 3] = [const { OnceLock::new() }; 3];
        TABLES[vertex_per as usize].get_or_init(|| Self::new(vertex_per))
    }

    fn new(vertex_per: VertexPer) -> Self {
        let cube = Cell::cube();
        let edges = std::array::from_fn(|e| {
            let [low, high] = cube.edges()[e];
            (low, (low ^ high).trailing_zeros() as u8)
        });
        let mut numbers = [[0; 8]; 3];
        for (e, (corner, axis)) in edges.iter().enumerate() {
            numbers[usize::from(*axis)][usize::from(*corner)] = e as u8;
        }
        let faces = std::array::from_fn(|f| {
            let is_on = |corner: &u8| usize::from(corner >> (f / 2) & 1) == f % 2;
            cube.faces().iter().position(|face| face.iter().all(is_on)).expect("a cube has six faces")
        });
        let mut table =
            Self { cube, vertex_per, edges, numbers, faces, joinable: Vec::new(), plans: Vec::new() };
        table.joinable = (0..=255).map(|inside| table.find_joinable(inside)).collect();
        let of = |number: usize| {
            let (inside, face) = (number / (FACES + 1), number % (FACES + 1));
            table.plan(inside as u8, (face < FACES).then_some(face as u8), 0)
        };
        table.plans = (0..FIRST_MADE as usize).map(of).collect();
        table
    }

    fn find_joinable(&self, inside: u8) -> Option<u8> {
        let inside = u32::from(inside);
        let ambiguous = self.cube.ambiguous_faces(inside);
        let loops = self.cube.loops(inside, 0);
        let is_of_one_loop = |face: &usize| {
            let edges = &self.cube.face_edges()[self.faces[*face]];
            ambiguous >> self.faces[*face] & 1 != 0
                && loops.iter().any(|polygon| edges.iter().all(|edge| polygon.contains(edge)))
        };
        (0..FACES).find(is_of_one_loop).map(|face| face as u8)
    }

    /// The face on which a cell would join its inside corners if the cell on the other side of it did the same.
    #[inline]
    pub(super) fn joinable(&self, inside: u8) -> Option<u8> {
        if self.has_patches() { self.joinable[usize::from(inside)] } else { None }
    }

    /// Whether a cell has a vertex for each loop of surface in it.
    #[inline]
    pub(super) fn has_patches(&self) -> bool {
        self.vertex_per != VertexPer::Cell
    }

    /// Whether it says what loops its cells have. A build without the feature has no code for that.
    #[inline]
    pub(super) fn has_loops(&self) -> bool {
        cfg!(feature = "dual-contouring-clean") && self.vertex_per == VertexPer::Loop
    }

    /// The corner that an edge begins at, and its axis.
    pub(super) fn edge(&self, edge: u8) -> (u8, u8) {
        self.edges[usize::from(edge)]
    }

    /// The edge that begins at a corner along an axis.
    #[inline]
    pub(super) fn number(&self, corner: u8, axis: usize) -> u8 {
        self.numbers[axis][usize::from(corner)]
    }

    fn mean(&self, edges: &[u8]) -> Mean {
        let set = edges.iter().fold(0, |set, edge| set | 1 << edge);
        let mut at_high_ends = Vec3::ZERO;
        for &edge in edges {
            let (corner, along) = self.edge(edge);
            for axis in (0..3).filter(|&axis| axis != usize::from(along) && corner >> axis & 1 != 0) {
                at_high_ends[axis] += 1.0;
            }
        }
        let of_axis = |axis: usize| {
            let is_in = |corner: usize| edges.contains(&self.number(corner as u8, axis));
            BVec4A::from_array(EDGE_STARTS[axis].map(is_in))
        };
        Mean { set, edges: [0, 1, 2].map(of_axis), count: edges.len() as f32, at_high_ends }
    }

    /// The vertices of a cell by its inside corners, the face whose inside corners it joins, and its faces at the box, one bit each. Edges
    /// at the box have no quadrilateral; a loop that is cut there into several runs of quadrilaterals has a vertex for each.
    fn plan(&self, inside: u8, joined: Option<u8>, at_box: u8) -> Plan {
        let joined = joined.map_or(0, |face| 1 << self.faces[usize::from(face)]);
        let is_open = |edge: u8| {
            let (corner, axis) = self.edge(edge);
            let at = |face: usize| {
                at_box >> face & 1 != 0
                    && usize::from(axis) != face / 2
                    && usize::from(corner >> (face / 2) & 1) == face % 2
            };
            (0..FACES).any(at)
        };
        let loops = self.cube.loops(u32::from(inside), joined);
        let mut plan = Plan::default();
        if self.has_loops() {
            for (i, edges) in loops.iter().enumerate() {
                if edges.iter().all(|&edge| is_open(edge)) {
                    continue;
                }
                for &edge in edges {
                    plan.of_edge[usize::from(edge)] = plan.means.len() as u8;
                }
                let others =
                    loops.iter().enumerate().filter(|(other, _)| *other != i).map(|(_, other)| &other[..]);
                let open = edges.iter().filter(|&&edge| is_open(edge)).fold(0, |set, edge| set | 1 << edge);
                let region = Region::of(edges, others, |edge| self.edge(edge));
                plan.means.push(self.mean(edges));
                plan.loops.push(Loop { edges: edges.clone(), open, region });
            }
            return plan;
        }
        if !self.has_patches() {
            let crossed = loops.concat();
            if crossed.iter().any(|&edge| !is_open(edge)) {
                plan.means.push(self.mean(&crossed));
            }
            return plan;
        }
        for polygon in loops {
            let first = polygon.iter().position(|&edge| is_open(edge)).unwrap_or(0);
            let round = polygon.iter().cycle().skip(first).take(polygon.len());
            let mut goes_on = false;
            for &edge in round {
                if is_open(edge) {
                    goes_on = false;
                    continue;
                }
                if !goes_on {
                    plan.means.push(self.mean(&polygon));
                    goes_on = true;
                }
                plan.of_edge[usize::from(edge)] = plan.means.len() as u8 - 1;
            }
        }
        plan
    }
}

/// Which plan a vertex is of, and which of its vertices it is: what a trace keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Pattern(u32);

impl Pattern {
    pub(super) fn new(inside: u8, joined: Option<u8>, at_box: u8, vertex: usize) -> Self {
        let joined = u32::from(joined.unwrap_or(FACES as u8));
        Self(u32::from(inside) | joined << 8 | u32::from(at_box) << 11 | (vertex as u32) << 17)
    }

    /// As [`Plans::number`] takes them.
    pub(super) fn cell(self) -> (u8, Option<u8>, u8) {
        let joined = (self.0 >> 8 & 7) as u8;
        (self.0 as u8, (usize::from(joined) < FACES).then_some(joined), (self.0 >> 11 & 63) as u8)
    }

    /// The number of the vertex.
    pub(super) fn vertex(self) -> usize {
        (self.0 >> 17) as usize
    }
}

/// The plans that a thread has met, by number.
pub(super) struct Plans {
    pub(super) table: &'static Table,
    /// Of cells at the box.
    made: Vec<Plan>,
    known: HashMap<(u8, u8, u8), u32>,
}

impl Plans {
    pub(super) fn new(table: &'static Table) -> Self {
        Self { table, made: Vec::new(), known: HashMap::new() }
    }

    /// The number of a plan, as for [`Table::plan`].
    #[inline]
    pub(super) fn number(&mut self, inside: u8, joined: Option<u8>, at_box: u8) -> u32 {
        let face = joined.unwrap_or(FACES as u8);
        if at_box == 0 {
            return u32::from(inside) * (FACES as u32 + 1) + u32::from(face);
        }
        *self.known.entry((inside, face, at_box)).or_insert_with(|| {
            self.made.push(self.table.plan(inside, joined, at_box));
            FIRST_MADE + self.made.len() as u32 - 1
        })
    }

    #[inline]
    pub(super) fn at(&self, number: u32) -> &Plan {
        match number.checked_sub(FIRST_MADE) {
            Some(made) => &self.made[made as usize],
            None => &self.table.plans[number as usize],
        }
    }

    /// Which of a plan's vertices a crossed edge leads to.
    #[inline]
    pub(super) fn vertex(&self, number: u32, edge: u8) -> u32 {
        if !self.table.has_patches() {
            // There is one.
            return 0;
        }
        u32::from(self.at(number).of_edge[usize::from(edge)])
    }
}

/// Numbers of plans from here on are those of cells at the box.
const FIRST_MADE: u32 = 256 * (FACES as u32 + 1);

#[cfg(test)]
mod tests {
    use super::*;

    /// Patterns with so many patches: 2, 162, 82, 8, 2 (Nielson 2004); 36 have a face to join, one each.
    #[test]
    fn patterns_have_the_patches_that_are_known() {
        let table = Table::get(VertexPer::Run);
        let mut patches = [0; 5];
        (0..=255u8).for_each(|inside| patches[table.plan(inside, None, 0).means.len()] += 1);
        assert_eq!(patches, [2, 162, 82, 8, 2]);
        assert_eq!((0..=255).filter(|&inside| table.joinable(inside).is_some()).count(), 36);
        for inside in (0..=255u8).filter(|&inside| table.joinable(inside).is_some()) {
            assert_eq!(table.cube.ambiguous_faces(u32::from(inside)).count_ones(), 1);
            assert_eq!(table.plan(inside, table.joinable(inside), 0).means.len(), 2);
        }
        assert_eq!(
            (0..=255).filter(|&inside| Table::get(VertexPer::Cell).joinable(inside).is_some()).count(),
            0
        );
    }

    #[test]
    fn every_crossing_is_in_the_mean_of_its_edges_vertex() {
        for vertex_per in [VertexPer::Cell, VertexPer::Run, VertexPer::Loop] {
            let table = Table::get(vertex_per);
            for inside in 0..=255u8 {
                for at_box in [0, 1, 2, 5, 63] {
                    let plan = table.plan(inside, None, at_box);
                    for edge in 0..EDGES as u8 {
                        let (corner, axis) = table.edge(edge);
                        assert_eq!(table.number(corner, usize::from(axis)), edge);
                        let is_crossed = (inside >> corner ^ inside >> (corner | 1 << axis)) & 1 != 0;
                        if is_crossed && at_box == 0 {
                            assert!(plan.means[plan.of_edge(edge) as usize].set >> edge & 1 != 0);
                        }
                    }
                    assert!(at_box != 63 || plan.means.is_empty());
                }
            }
        }
    }

    /// Of the 4,096 patterns of two neighbours 18 have a face that both join, along each axis.
    #[test]
    fn eighteen_patterns_of_two_cells_join_their_face() {
        let table = Table::get(VertexPer::Run);
        for axis in 0..3 {
            let joined = |pattern: &u32| {
                // Three layers of four points along the axis.
                let inside = |first: u32| {
                    let corner = |c: u32| {
                        let along = c >> axis & 1;
                        let across = (c & ((1 << axis) - 1)) | (c >> (axis + 1)) << axis;
                        pattern >> (4 * (first + along) + across) & 1
                    };
                    (0..8).fold(0, |set, c| set | (corner(c) as u8) << c)
                };
                let [low, high] = [inside(0), inside(1)].map(|inside| table.joinable(inside));
                low == Some(2 * axis as u8 + 1) && high == Some(2 * axis as u8)
            };
            assert_eq!((0..4096).filter(joined).count(), 18);
        }
    }
}
