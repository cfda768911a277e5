//! A disjoint-set forest, and with it the fans of triangles around every vertex.

use crate::connectivity::Connectivity;

/// A disjoint-set forest over `0..n`: the smaller root wins, paths are halved.
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

/// Joins the corners (`3 * triangle + k`) of one vertex whose triangles share an edge at it. What remains apart
/// are the fans: one around a manifold vertex, two where a bow-tie meets in a point. Triangles round a
/// non-manifold edge all belong to one fan.
pub(crate) fn corner_fans(connectivity: &Connectivity, triangles: &[[u32; 3]]) -> DisjointSets {
    let mut fans = DisjointSets::new(3 * triangles.len());
    for edge in connectivity.edges() {
        let first = edge[0].corners();
        for other in &edge[1..] {
            let corners = other.corners();
            let same_way = other.forward == edge[0].forward;
            fans.join(first[0], corners[usize::from(!same_way)]);
            fans.join(first[1], corners[usize::from(same_way)]);
        }
    }
    fans
}
