//! Numbers that say what a complex of tetrahedra is, over the field of two elements.

use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The vertices, edges, triangles and tetrahedra of a complex.
pub(crate) struct Complex {
    pub(crate) cells: [BTreeSet<Vec<u32>>; 4],
}

impl Complex {
    pub(crate) fn of(tetrahedra: &[[u32; 4]]) -> Self {
        let mut cells: [BTreeSet<Vec<u32>>; 4] = Default::default();
        for tetrahedron in tetrahedra {
            let mut sorted = *tetrahedron;
            sorted.sort_unstable();
            for set in 1..16u32 {
                let cell: Vec<u32> = (0..4).filter(|i| set >> i & 1 != 0).map(|i| sorted[i]).collect();
                cells[cell.len() - 1].insert(cell);
            }
        }
        assert_eq!(cells[3].len(), tetrahedra.len(), "no tetrahedron comes twice");
        Self { cells }
    }

    pub(crate) fn euler_characteristic(&self) -> i64 {
        let [v, e, t, s] = self.cells.each_ref().map(|cells| cells.len() as i64);
        v - e + t - s
    }

    /// The Betti numbers: the ranks of what has no boundary, less those of what is one.
    pub(crate) fn betti(&self) -> [usize; 4] {
        let ranks = [0, self.rank(1), self.rank(2), self.rank(3), 0];
        [0, 1, 2, 3].map(|d| self.cells[d].len() - ranks[d] - ranks[d + 1])
    }

    /// The rank of the map from cells of a dimension to their sides, by elimination of columns.
    fn rank(&self, dimension: usize) -> usize {
        let number: HashMap<&Vec<u32>, usize> =
            self.cells[dimension - 1].iter().enumerate().map(|(n, cell)| (cell, n)).collect();
        let mut with_lowest: HashMap<usize, BTreeSet<usize>> = HashMap::new();
        let mut rank = 0;
        for cell in &self.cells[dimension] {
            let side = |i: usize| {
                let mut side = cell.clone();
                side.remove(i);
                number[&side]
            };
            let mut column: BTreeSet<usize> = (0..=dimension).map(side).collect();
            while let Some(&lowest) = column.last() {
                let Some(other) = with_lowest.get(&lowest) else {
                    with_lowest.insert(lowest, column);
                    rank += 1;
                    break;
                };
                for &row in other {
                    if !column.remove(&row) {
                        column.insert(row);
                    }
                }
            }
        }
        rank
    }
}

/// Triangles by their vertices, and how often each runs which way: once and once in a closed manifold that is orientated.
pub(crate) fn triangles(tetrahedra: &[[u32; 4]]) -> BTreeMap<[u32; 3], [u32; 2]> {
    let mut found: BTreeMap<[u32; 3], [u32; 2]> = BTreeMap::new();
    for &[a, b, c, d] in tetrahedra {
        for [a, b, c] in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            let mut sorted = [a, b, c];
            sorted.sort_unstable();
            let is_even = [[a, b, c], [b, c, a], [c, a, b]].contains(&sorted);
            found.entry(sorted).or_default()[usize::from(is_even)] += 1;
        }
    }
    found
}

/// Of each vertex, the triangles opposite of it: its link.
pub(crate) fn links(tetrahedra: &[[u32; 4]]) -> BTreeMap<u32, Vec<[u32; 3]>> {
    let mut links: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for &[a, b, c, d] in tetrahedra {
        for (apex, link) in [(a, [b, c, d]), (b, [a, d, c]), (c, [a, b, d]), (d, [a, c, b])] {
            links.entry(apex).or_default().push(link);
        }
    }
    links
}
