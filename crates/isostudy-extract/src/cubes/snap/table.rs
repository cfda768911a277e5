//! The patches of cells with corners inside, outside and on the surface: 6,561, by the hull rule.

use std::sync::OnceLock;

use isostudy_cells::{Cell, Label, Point};

/// Where a corner of a patch's triangle is: below this on that edge, from this on at a corner.
pub(super) const CORNER: u8 = 12;
/// The most triangles of a patch.
pub(super) const MOST_TRIANGLES: usize = 6;
const LABELS: [Label; 3] = [Label::Outside, Label::On, Label::Inside];
const ENTRIES: usize = 6561;

/// The surface in a cell.
#[derive(Debug)]
pub(super) struct Patch {
    pub(super) triangles: Vec<[u8; 3]>,
    /// The edges that triangles have corners on.
    pub(super) edges: Vec<u8>,
    /// The corners that triangles have, one bit each.
    pub(super) corners: u8,
    /// Of a patch that lies in a face, the axis that the face is across, and whether it is the far one.
    pub(super) face: Option<(usize, bool)>,
}

/// The patches, each made when it is first met.
pub(super) struct Table {
    cube: Cell,
    entries: Vec<OnceLock<Patch>>,
    edges: [(u8, u8); 12],
}

impl Table {
    pub(super) fn get() -> &'static Self {
        static TABLE: OnceLock<Table> = OnceLock::new();
        TABLE.get_or_init(|| {
            let cube = Cell::cube();
            let edges = std::array::from_fn(|e| {
                let [low, high] = cube.edges()[e];
                (low, (low ^ high).trailing_zeros() as u8)
            });
            Table { cube, entries: (0..ENTRIES).map(|_| OnceLock::new()).collect(), edges }
        })
    }

    /// The number of an entry by its corners inside and on the surface, one bit each.
    #[inline]
    pub(super) fn number(inside: u8, on: u8) -> u16 {
        2 * THREES[usize::from(inside)] + THREES[usize::from(on)]
    }

    #[inline]
    pub(super) fn at(&self, number: u16) -> &Patch {
        self.entries[usize::from(number)].get_or_init(|| self.patch(number))
    }

    /// The corner that an edge begins at, and its axis.
    #[inline]
    pub(super) fn edge(&self, edge: u8) -> (u8, u8) {
        self.edges[usize::from(edge)]
    }

    fn patch(&self, number: u16) -> Patch {
        let labels: Vec<Label> = (0..8).map(|c| LABELS[usize::from(number) / 3usize.pow(c) % 3]).collect();
        let code = |point: Point| match point {
            Point::Edge(edge) => edge,
            Point::Corner(corner) => CORNER + corner,
        };
        let triangles: Vec<[u8; 3]> =
            self.cube.hull_patch(&labels).into_iter().map(|triangle| triangle.map(code)).collect();
        let mut edges: Vec<u8> = triangles.iter().flatten().copied().filter(|&code| code < CORNER).collect();
        edges.sort_unstable();
        edges.dedup();
        let corners = triangles
            .iter()
            .flatten()
            .filter_map(|code| code.checked_sub(CORNER))
            .fold(0, |set, c| set | 1 << c);
        let is_flat = !triangles.is_empty() && edges.is_empty() && !labels.contains(&Label::Inside);
        let face = (0..3).flat_map(|axis| [(axis, false), (axis, true)]).find(|&(axis, is_far)| {
            (0..8).all(|c| labels[c] == Label::Outside || (c >> axis & 1 != 0) == is_far)
        });
        Patch { triangles, edges, corners, face: face.filter(|_| is_flat) }
    }
}

/// Powers of three summed over the bits of a number.
static THREES: [u16; 256] = {
    let mut sums = [0; 256];
    let mut set = 1;
    while set < 256 {
        sums[set] = sums[set & (set - 1)] + 3u16.pow(set.trailing_zeros());
        set += 1;
    }
    sums
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_patches_are_those_of_the_labels() {
        let table = Table::get();
        let (mut triangles, mut flat) = (0, 0);
        for inside in 0..=255u8 {
            for on in (0..=255u8).filter(|on| on & inside == 0) {
                let labels: Vec<Label> = (0..8)
                    .map(|c| match (inside >> c & 1, on >> c & 1) {
                        (1, _) => Label::Inside,
                        (_, 1) => Label::On,
                        _ => Label::Outside,
                    })
                    .collect();
                let patch = table.at(Table::number(inside, on));
                assert_eq!(patch.triangles.len(), table.cube.hull_patch(&labels).len());
                assert!(patch.corners & !on == 0 && patch.triangles.len() <= MOST_TRIANGLES);
                triangles += patch.triangles.len();
                flat += usize::from(patch.face.is_some());
            }
        }
        assert_eq!((triangles, flat), (14_512, 30));
    }
}
