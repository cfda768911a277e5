//! What the vertex stage leaves at every sample point for the geometry stage.

use crate::lattice::{DIRECTIONS, DirectionSet};

/// The crossing and the vertices of the edges round every sample point.
///
/// An edge is seen from both its ends. Its crossing is recorded at both; its vertex at the end it is nearer to, or
/// at both when it is in the middle. Zeros mean "nothing", so that fresh pages from the operating system will do
/// and pages far from the surface are never touched.
#[derive(Debug)]
pub(crate) struct EdgeTable {
    /// Edges that cross the surface.
    crossing: Vec<DirectionSet>,
    /// One more than the vertex number; 0 is none.
    vertices: Vec<[u32; DIRECTIONS]>,
}

impl EdgeTable {
    pub(crate) fn new(points: usize) -> Self {
        Self { crossing: vec![0; points], vertices: vec![[0; DIRECTIONS]; points] }
    }

    /// The edges at `point` that cross the surface.
    pub(crate) fn crossing(&self, point: usize) -> DirectionSet {
        self.crossing[point]
    }

    pub(crate) fn set_crossing(&mut self, point: usize, crossing: DirectionSet) {
        self.crossing[point] = crossing;
    }

    /// Gives the edge at `point` in `direction` its vertex.
    pub(crate) fn set_vertex(&mut self, point: usize, direction: usize, vertex: u32) {
        self.vertices[point][direction] = vertex.wrapping_add(1);
    }

    /// The vertex of the edge at `point` in `direction`, if it belongs to this end.
    #[cfg(test)]
    pub(crate) fn vertex_here(&self, point: usize, direction: usize) -> Option<u32> {
        self.vertices[point][direction].checked_sub(1)
    }

    /// The vertex of a crossing edge, seen from the end `point` in `direction`, or else from its other end.
    ///
    /// # Panics
    /// If neither end has a vertex: the caller asked for an edge that does not cross.
    pub(crate) fn vertex(&self, point: usize, direction: u8, far: usize, back: u8) -> u32 {
        let here = self.vertices[point][direction as usize];
        let stored = if here != 0 { here } else { self.vertices[far][back as usize] };
        stored.checked_sub(1).expect("a crossing edge has a vertex at one of its ends")
    }
}
