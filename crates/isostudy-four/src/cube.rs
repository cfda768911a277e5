//! The unit cube in any number of dimensions: corners, edges, facets.

/// A cube whose corner `c` has the coordinate `c >> axis & 1` along each axis: x, y, z, then time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cube<const D: usize> {
    edges: Vec<Edge<D>>,
}

/// An edge of a cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge<const D: usize> {
    /// Its corners, the one with the smaller number first.
    pub corners: [u8; 2],
    /// The axis that it goes along.
    pub axis: u8,
    /// Twice the coordinates of its middle.
    pub(crate) middle: [i32; D],
}

impl<const D: usize> Cube<D> {
    /// The number of corners.
    pub const CORNERS: usize = 1 << D;

    /// The cube, with its edges in the order of their middles: by the last coordinate, then by the one before it. A step of the lattice
    /// does not change which of two middles comes first. So all cells agree about the order of the edges that they have in common.
    ///
    /// # Panics
    /// Unless `D` is 2, 3 or 4.
    pub fn new() -> Self {
        assert!((2..=4).contains(&D), "edges are numbered in 32 bits");
        let mut edges = Vec::new();
        for corner in 0..Self::CORNERS as u8 {
            for axis in (0..D as u8).filter(|axis| corner >> axis & 1 == 0) {
                let mut middle = doubled(corner);
                middle[usize::from(axis)] = 1;
                edges.push(Edge { corners: [corner, corner | 1 << axis], axis, middle });
            }
        }
        edges.sort_by_key(|edge| edge.middle.iter().rev().fold(0, |key, &x| 3 * key + x));
        Self { edges }
    }

    /// The edges, in the order that triangulations go by.
    pub fn edges(&self) -> &[Edge<D>] {
        &self.edges
    }

    /// The edges with one corner in the set and the other not, one bit each.
    pub fn crossed(&self, inside: u32) -> u32 {
        self.set(|edge| {
            let [a, b] = edge.corners.map(|c| inside >> c & 1);
            a != b
        })
    }

    /// The edges in the facet where the coordinate along an axis is 0 or 1, one bit each.
    pub fn facet(&self, axis: usize, side: usize) -> u32 {
        self.set(|edge| edge.middle[axis] == 2 * side as i32)
    }

    fn set(&self, is_in: impl Fn(&Edge<D>) -> bool) -> u32 {
        self.edges.iter().enumerate().fold(0, |set, (e, edge)| set | u32::from(is_in(edge)) << e)
    }
}

impl<const D: usize> Default for Cube<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// Twice the coordinates of a corner.
pub(crate) fn doubled<const D: usize>(corner: u8) -> [i32; D] {
    std::array::from_fn(|axis| 2 * i32::from(corner >> axis & 1))
}
