//! Triangles, one after the other.

use crate::lattice::tetrahedra::Case;
use crate::surface::trace::Trace;

/// Triangles, and how many there would have been.
#[derive(Debug, Default)]
pub(crate) struct Triangulation {
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Cells that were not skipped.
    pub(crate) cells_visited: u64,
    /// Their tetrahedra.
    pub(crate) tetrahedra_evaluated: u64,
    /// Triangles left out because two corners are the same vertex.
    pub(crate) discarded: u64,
    /// The same as the original counts them: two whenever the second and third corner coincide, even in a
    /// tetrahedron that has one triangle only (Costen 2026).
    pub(crate) discarded_as_published: u64,
    /// The cell of each triangle, where that is asked for.
    pub(crate) trace: Option<Trace>,
}

impl Triangulation {
    pub(crate) fn add(&mut self, case: Case, vertex: impl Fn(u8) -> u32) {
        match case {
            Case::Empty => {}
            Case::Triangle(edges) => {
                let triangle = edges.map(vertex);
                let [_, q1, q2] = triangle;
                self.discarded_as_published += u64::from(q1 == q2);
                self.keep_or_discard(triangle);
            }
            Case::Quad(edges) => {
                let [q0, q1, q2, q3] = edges.map(vertex);
                self.keep_or_discard([q0, q1, q2]);
                self.keep_or_discard([q3, q2, q1]);
            }
        }
    }

    fn keep_or_discard(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            self.discarded += 1;
            self.discarded_as_published += 1;
        } else {
            self.triangles.push(triangle);
        }
    }
}
