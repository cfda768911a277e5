//! The edges of a mesh, each with the triangles at it.

/// One side of a triangle, as part of the edge between two vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct HalfEdge {
    low: u32,
    high: u32,
    triangle: u32,
    /// Which side: from corner `side` to corner `side + 1` (mod 3).
    side: u8,
    /// Whether the triangle runs it from the lower to the higher vertex.
    pub(crate) forward: bool,
}

impl HalfEdge {
    /// The vertices of its edge, the lower first.
    pub(crate) fn ends(self) -> [u32; 2] {
        [self.low, self.high]
    }

    /// Where it starts and ends, in the direction the triangle runs it.
    pub(crate) fn vertices(self) -> [u32; 2] {
        if self.forward { [self.low, self.high] } else { [self.high, self.low] }
    }

    /// The corners (`3 * triangle + k`) it starts and ends at.
    pub(crate) fn corners(self) -> [u32; 2] {
        let first = 3 * self.triangle;
        [first + u32::from(self.side), first + (u32::from(self.side) + 1) % 3]
    }
}

/// The half-edges of all triangles with three different vertices, sorted so that those of one edge lie together.
/// Triangles that repeat an index have no proper edges and are left out.
pub(crate) struct Connectivity {
    half_edges: Vec<HalfEdge>,
}

impl Connectivity {
    pub(crate) fn of(triangles: &[[u32; 3]]) -> Self {
        let mut half_edges = Vec::with_capacity(3 * triangles.len());
        for (t, corners) in triangles.iter().enumerate() {
            if !is_proper(corners) {
                continue;
            }
            for side in 0..3u8 {
                let (a, b) = (corners[usize::from(side)], corners[(usize::from(side) + 1) % 3]);
                half_edges.push(HalfEdge {
                    low: a.min(b),
                    high: a.max(b),
                    triangle: t as u32,
                    side,
                    forward: a < b,
                });
            }
        }
        half_edges.sort_unstable();
        Self { half_edges }
    }

    /// Every edge as the half-edges at it, ordered by its vertices, then by triangle.
    pub(crate) fn edges(&self) -> impl Iterator<Item = &[HalfEdge]> {
        self.half_edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high))
    }
}

/// Whether the three vertices differ.
pub(crate) fn is_proper(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}
