//! A whole table: the triangles of every pattern of signs of a cell, and whether they fit together.

use std::collections::BTreeMap;
use std::fmt;

use crate::cell::Cell;
use crate::hull_rule::{Label, Point};

/// The triangles of a cell by the set of its corners inside. Corners of triangles are edges of the cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    cell: Cell,
    entries: Vec<Vec<[u8; 3]>>,
}

/// Why triangles make no table. Entries are numbered by their corners inside, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableError {
    /// There is not an entry for each set of corners.
    Entries {
        /// As given.
        found: usize,
        /// Two to the number of corners.
        wanted: usize,
    },
    /// The corners of an entry's triangles are not the edges between inside and outside.
    Edges {
        /// Which entry.
        entry: usize,
    },
    /// A side of an entry's triangles is run twice the same way.
    Side {
        /// Which entry.
        entry: usize,
    },
    /// A triangle lies in a face, or the surface ends within the cell.
    Rim {
        /// Which entry.
        entry: usize,
    },
    /// Two entries whose corners in a face are on the same sides meet that face differently: neighbours would not fit.
    Face {
        /// Which entries.
        entries: [usize; 2],
        /// The face's corners, one bit each.
        corners: u32,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entries { found, wanted } => write!(f, "{found} entries; there must be {wanted}"),
            Self::Edges { entry } => {
                write!(
                    f,
                    "entry {entry}: triangles must have their corners on all crossed edges and on no other"
                )
            }
            Self::Side { entry } => write!(f, "entry {entry}: a side is run twice the same way"),
            Self::Rim { entry } => {
                write!(f, "entry {entry}: a triangle lies in a face, or the surface ends within the cell")
            }
            Self::Face { entries: [a, b], corners } => {
                write!(f, "entries {a} and {b} meet the face with the corners {corners:#b} differently")
            }
        }
    }
}

impl std::error::Error for TableError {}

/// How a face is met by entries with the same sides of its corners, and the first of them.
struct Met {
    arcs: Vec<[u8; 2]>,
    first: usize,
}

impl Table {
    /// The table of these entries.
    ///
    /// # Errors
    /// [`TableError`]: where a mesh made by it could have an end that the field has not.
    pub fn try_new(cell: Cell, entries: Vec<Vec<[u8; 3]>>) -> Result<Self, TableError> {
        let wanted = 1 << cell.corners().len();
        if entries.len() != wanted {
            return Err(TableError::Entries { found: entries.len(), wanted });
        }
        let mut arcs: BTreeMap<(usize, u32), Met> = BTreeMap::new();
        for (entry, triangles) in entries.iter().enumerate() {
            let is_edge = |e: u8| usize::from(e) < cell.edges().len();
            if !triangles.iter().flatten().all(|&e| is_edge(e)) {
                return Err(TableError::Edges { entry });
            }
            let used = triangles.iter().flatten().fold(0u64, |set, &e| set | 1 << e);
            if used != cell.crossed(entry as u32) {
                return Err(TableError::Edges { entry });
            }
            let mut sides: Vec<[u8; 2]> =
                triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            sides.sort_unstable();
            if sides.windows(2).any(|pair| pair[0] == pair[1]) || sides.iter().any(|[a, b]| a == b) {
                return Err(TableError::Side { entry });
            }
            let common = |edges: &[u8]| {
                edges.iter().fold(!0, |faces, &e| faces & cell.faces_at_edge()[usize::from(e)])
            };
            let rim: Vec<[u8; 2]> =
                sides.iter().copied().filter(|&[a, b]| sides.binary_search(&[b, a]).is_err()).collect();
            if triangles.iter().any(|t| common(t) != 0) || rim.iter().any(|side| common(side) == 0) {
                return Err(TableError::Rim { entry });
            }
            for (f, face) in cell.faces().iter().enumerate() {
                let corners = face.iter().fold(0, |set, &c| set | 1 << c);
                let found: Vec<[u8; 2]> =
                    rim.iter().copied().filter(|side| common(side) >> f & 1 != 0).collect();
                let met = || Met { arcs: found.clone(), first: entry };
                let known = arcs.entry((f, entry as u32 & corners)).or_insert_with(met);
                if known.arcs != found {
                    return Err(TableError::Face { entries: [known.first, entry], corners });
                }
            }
        }
        Ok(Self { cell, entries })
    }

    /// The table by the convex hull: of the cube, 836 triangles.
    pub fn by_hull(cell: Cell) -> Self {
        let corners = cell.corners().len();
        let entry = |inside: usize| {
            let label = |c: usize| if inside >> c & 1 != 0 { Label::Inside } else { Label::Outside };
            let patch = cell.hull_patch(&(0..corners).map(label).collect::<Vec<_>>());
            let edge = |point: Point| match point {
                Point::Edge(edge) => edge,
                Point::Corner(_) => unreachable!("no corner is on the surface"),
            };
            patch.into_iter().map(|triangle| triangle.map(edge)).collect()
        };
        let entries = (0..1 << corners).map(entry).collect();
        Self { cell, entries }
    }

    /// The cell.
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// The triangles of a set of corners inside, one bit each; their corners are numbers of the cell's edges.
    pub fn triangles(&self, inside: u32) -> &[[u8; 3]] {
        &self.entries[inside as usize]
    }

    /// All entries.
    pub fn entries(&self) -> &[Vec<[u8; 3]>] {
        &self.entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Triangulator;

    type Entries = Vec<Vec<[u8; 3]>>;

    fn entries(cell: &Cell, joined: u32) -> Entries {
        let triangulator = Triangulator::new(cell);
        let fans = |inside| {
            cell.loops(inside, joined).into_iter().flat_map(|p| triangulator.fan(&p).unwrap()).collect()
        };
        (0..1 << cell.corners().len()).map(fans).collect()
    }

    #[test]
    fn tables_by_rule_fit_together() {
        for cell in [Cell::cube(), Cell::tetrahedron(), Cell::pyramid(), Cell::wedge(), Cell::octahedron()] {
            for joined in [0, !0] {
                assert!(Table::try_new(cell.clone(), entries(&cell, joined)).is_ok());
            }
        }
        let hull = Table::by_hull(Cell::cube());
        assert_eq!(Table::try_new(Cell::cube(), hull.entries().to_vec()).as_ref(), Ok(&hull));
    }

    #[test]
    fn each_fault_is_found() {
        let cube = Cell::cube();
        let good = entries(&cube, 0);
        let check = |change: &dyn Fn(&mut Entries)| {
            let mut bad = good.clone();
            change(&mut bad);
            Table::try_new(cube.clone(), bad).unwrap_err()
        };
        assert_eq!(check(&|t| drop(t.pop())), TableError::Entries { found: 255, wanted: 256 });
        assert_eq!(check(&|t| t[1].clear()), TableError::Edges { entry: 1 });
        assert_eq!(check(&|t| t[1][0][0] = 99), TableError::Edges { entry: 1 });
        let twice = |t: &mut Entries| {
            let first = t[1][0];
            t[1].push(first);
        };
        assert_eq!(check(&twice), TableError::Side { entry: 1 });
        // A hole in a quad, all of whose crossings are still used.
        let quad = good.iter().position(|e| e.len() == 4).unwrap();
        let hole = (0..4)
            .map(|i| {
                check(&move |t: &mut Entries| {
                    t[quad].remove(i);
                })
            })
            .all(|error| matches!(error, TableError::Edges { .. } | TableError::Rim { .. }));
        assert!(hole);
        // One entry that joins what the others keep apart: the table with complements has holes.
        let joined = entries(&cube, !0);
        let other = (0..256).find(|&i| joined[i] != good[i]).unwrap();
        assert!(matches!(check(&|t| t[other] = joined[other].clone()), TableError::Face { .. }));
        // Turned over, it meets its neighbours the wrong way round.
        assert!(matches!(check(&|t| t[1][0].reverse()), TableError::Face { .. } | TableError::Rim { .. }));
    }
}
