//! Where in the lattice a mesh comes from.

use std::collections::TryReserveError;

use crate::duals::Pattern;
use crate::lattice::{Arrangement, Part, cell_of_stored};

/// Which crossings of a lattice a vertex stands for: the sample point that they are nearest to, and the first lattice edge
/// at that point among them.
///
/// Keys are those of the whole lattice, whatever box of it was extracted. Two vertices with one key are one vertex, with
/// the same bits. Keys are in the order in which [`extract`](crate::by_lattice::extract) numbers vertices, unless edges are
/// collapsed; the key of a vertex that others were collapsed into is its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VertexKey(u128);

/// Bits for a direction: at most 32 of them, and as many for vertices that seams add.
const DIRECTION_BITS: u32 = 6;
/// Bits for a place among stored points along an axis: of half cells, with numbers of 32 bits and some to spare.
const PLACE_BITS: u32 = 34;
/// Added to places, so that none is negative.
const BIAS: i64 = 1 << (PLACE_BITS - 1);
/// Above the place, two bits for the arrangement; above these, the level.
const LEVEL_SHIFT: u32 = DIRECTION_BITS + 3 * PLACE_BITS + 2;

/// Numbers below this are the axes of lattice edges that begin at the point, where vertices are crossings; from it on, of vertices in a cell.
pub(crate) const IN_CELL: usize = 3;
/// From here on, numbers of vertices that seams of marching cubes put into sides: four for each axis of the edge in whose middle they begin.
const IN_SIDES: usize = 32;

impl VertexKey {
    /// Of a vertex in a side of coarse cells, on the line that begins in the middle of an edge of theirs and leads across it, up or down.
    /// `edge` is where that begins.
    pub(crate) fn in_side(edge: [i64; 3], along: usize, across: usize, is_up: bool) -> Self {
        let way = 2 * usize::from(across != (along + 1) % 3) + usize::from(is_up);
        Self::new(Arrangement::SimpleCubic, edge, IN_SIDES + 4 * along + way)
    }

    /// The lowest and the highest of the corners that the vertex lies between, where vertices of cubes are crossings.
    pub(crate) fn ends_of_crossing(self) -> [[i32; 3]; 2] {
        let low = self.cell();
        let (mut from, mut to) = (low, low);
        match self.direction() {
            axis @ 0..IN_CELL => to[axis] = to[axis].saturating_add(1),
            number @ IN_SIDES.. => {
                let (along, way) = ((number - IN_SIDES) / 4, (number - IN_SIDES) % 4);
                let across = (along + 1 + way / 2) % 3;
                to[along] = to[along].saturating_add(1);
                match way % 2 {
                    0 => from[across] = from[across].saturating_sub(1),
                    _ => to[across] = to[across].saturating_add(1),
                }
            }
            _ => to = to.map(|i| i.saturating_add(1)),
        }
        [from, to]
    }

    /// Of a stored point of the whole lattice.
    pub(crate) fn new(arrangement: Arrangement, [x, y, z]: [i64; 3], direction: usize) -> Self {
        let place = |key: u128, i: i64| key << PLACE_BITS | (i + BIAS) as u128;
        let key = [z, y, x].into_iter().fold(arrangement as u128, place);
        Self(key << DIRECTION_BITS | direction as u128)
    }

    /// The stored point.
    pub(crate) fn stored(self) -> [i64; 3] {
        let place = |n: u32| {
            let bits = self.0 >> (DIRECTION_BITS + n * PLACE_BITS);
            (bits as i64 & ((1 << PLACE_BITS) - 1)) - BIAS
        };
        [place(0), place(1), place(2)]
    }

    /// The cell that the sample point counts as its own: the one it is the centre, the lowest corner or a lower face's
    /// centre of. On the upper sides of a lattice's box that is one beyond it.
    pub fn cell(self) -> [i32; 3] {
        let arrangement = Arrangement::ALL[(self.0 >> (DIRECTION_BITS + 3 * PLACE_BITS)) as usize & 3];
        cell_of_stored(arrangement, self.stored()).map(|i| i as i32)
    }

    /// The same so many cells farther along each axis.
    pub(crate) fn moved(self, cells: [i64; 3]) -> Self {
        let arrangement = Arrangement::ALL[(self.0 >> (DIRECTION_BITS + 3 * PLACE_BITS)) as usize & 3];
        let stored = match arrangement {
            Arrangement::BodyCentred => [1, 1, 2],
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [1; 3],
            Arrangement::FaceCentred => [2; 3],
        };
        let from = self.stored();
        let to = [0, 1, 2].map(|axis| from[axis] + stored[axis] * cells[axis]);
        Self::new(arrangement, to, self.direction()).at_level(self.level())
    }

    /// The direction of the first lattice edge, or beyond them the number of a vertex in the cell.
    pub(crate) fn direction(self) -> usize {
        (self.0 & ((1 << DIRECTION_BITS) - 1)) as usize
    }

    /// The same so many points farther along x, of a lattice that stores one point for each cell.
    #[inline]
    pub(crate) fn along_x(self, points: usize) -> Self {
        Self(self.0 + ((points as u128) << DIRECTION_BITS))
    }

    /// The same with the number of another vertex of its point, where it had number 0.
    #[inline]
    pub(crate) fn numbered(self, number: usize) -> Self {
        Self(self.0 | number as u128)
    }

    /// The same in the grid of a level.
    pub(crate) fn at_level(self, level: u32) -> Self {
        Self(self.0 & ((1 << LEVEL_SHIFT) - 1) | u128::from(level) << LEVEL_SHIFT)
    }

    /// The level whose grid the vertex is of: 0 but for chunks of a [`LevelExtractor`](crate::LevelExtractor).
    pub fn level(self) -> u32 {
        (self.0 >> LEVEL_SHIFT) as u32
    }

    /// The key as a number: for a hash table of one's own, or a file.
    pub fn number(self) -> u128 {
        self.0
    }
}

/// Where each vertex and each triangle of a mesh came from, before edges are collapsed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    pub(crate) keys: Vec<VertexKey>,
    /// Of vertices that stand for loops of surface, which; none of others.
    pub(crate) patterns: Vec<Pattern>,
    /// Numbers of cells in the part that was extracted, or of all.
    pub(crate) cells: Vec<u32>,
    /// The part, where nothing but it was extracted.
    pub(crate) part: Option<Part>,
    /// Whether there are vertices that the part has not.
    pub(crate) has_spare: bool,
}

impl Trace {
    /// Gives the `number` of a cell to all triangles that have none yet.
    #[inline]
    pub(crate) fn close_cell(&mut self, number: u32, triangles: usize) -> Result<(), TryReserveError> {
        let more = triangles - self.cells.len();
        self.cells.try_reserve(more)?;
        // Mostly two, for which `resize` takes longer.
        (0..more).for_each(|_| self.cells.push(number));
        Ok(())
    }

    /// Takes over what another one has.
    pub(crate) fn append(&mut self, other: &mut Self) -> Result<(), TryReserveError> {
        self.keys.try_reserve(other.keys.len())?;
        self.cells.try_reserve(other.cells.len())?;
        self.keys.append(&mut other.keys);
        self.cells.append(&mut other.cells);
        self.patterns.try_reserve(other.patterns.len())?;
        self.patterns.append(&mut other.patterns);
        self.has_spare |= other.has_spare;
        Ok(())
    }

    /// Empty, of a part or of all.
    pub(crate) fn start(&mut self, part: Option<Part>) {
        self.keys.clear();
        self.cells.clear();
        self.patterns.clear();
        (self.part, self.has_spare) = (part, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_says_where_its_point_is() {
        let ends = [i64::from(i32::MIN) * 2, -7, 0, 5, i64::from(i32::MAX) * 2 + 2];
        for arrangement in Arrangement::ALL {
            for (x, (y, z)) in ends.into_iter().zip(ends.into_iter().rev().zip(ends)) {
                for direction in [0, 13, 25] {
                    let key = VertexKey::new(arrangement, [x, y, z], direction);
                    assert_eq!(key.stored(), [x, y, z], "{arrangement}");
                }
            }
        }
        let key = |place, direction| VertexKey::new(Arrangement::SimpleCubic, place, direction);
        assert_eq!(key([-3, 4, -5], 3).cell(), [-3, 4, -5]);
        assert!(key([9, 9, -1], 13) < key([-9, -9, 0], 0) && key([9, -1, 0], 13) < key([-9, 0, 0], 0));
        assert!(key([-1, 0, 0], 13) < key([0, 0, 0], 0) && key([0, 0, 0], 0) < key([0, 0, 0], 1));
        let tagged = key([-3, 4, -5], 13).at_level(31);
        assert_eq!((tagged.stored(), tagged.direction(), tagged.level()), ([-3, 4, -5], 13, 31));
        assert_eq!((tagged.cell(), tagged.at_level(0)), ([-3, 4, -5], key([-3, 4, -5], 13)));
        // The centre of a body-centred cell, and its lowest corner.
        let centred = |place| VertexKey::new(Arrangement::BodyCentred, place, 0).cell();
        assert_eq!(centred([0, 0, 0]), [-1; 3]);
        assert_eq!(centred([0, 0, 1]), [0; 3]);
        assert_eq!(centred([-3, -3, -7]), [-3, -3, -4]);
        for arrangement in Arrangement::ALL {
            let key = VertexKey::new(arrangement, [-3, 4, -5], 9).at_level(2);
            let moved = key.moved([5, -6, 7]);
            assert_eq!(
                moved.cell(),
                [0, 1, 2].map(|axis| key.cell()[axis] + [5, -6, 7][axis]),
                "{arrangement}"
            );
            assert_eq!((moved.direction(), moved.level(), moved.moved([-5, 6, -7])), (9, 2, key));
        }
    }
}
