//! How the triangles of a mesh hang together, and every way in which that is wrong.

use crate::TriangleMesh;
use crate::connectivity::{Connectivity, is_proper};
use crate::corner_fans::{DisjointSets, corner_fans};

/// Counts of what a mesh is made of and of its faults. Indices decide, coordinates do not: two vertices at the
/// same place are two vertices, and self-intersections go unseen ([`self_intersections`](crate::self_intersections) counts them).
///
/// Triangles that repeat an index are counted in `collapsed_triangles` and nowhere else.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TopologyReport {
    /// Vertices that a triangle refers to.
    pub vertices: u64,
    /// Vertices that none refers to.
    pub unused_vertices: u64,
    /// Edges, each pair of joined vertices once.
    pub edges: u64,
    /// Triangles with three different vertices.
    pub triangles: u64,
    /// Triangles that repeat an index.
    pub collapsed_triangles: u64,
    /// Edges with one triangle.
    pub boundary_edges: u64,
    /// Edges with more than two triangles.
    pub non_manifold_edges: u64,
    /// Edges whose two triangles run them in the same direction, so that one of them faces the wrong way.
    pub misoriented_edges: u64,
    /// Fans of edge-connected triangles beyond the first, summed over the vertices: 1 for a bow-tie. Triangles
    /// round a non-manifold edge count as one fan.
    pub non_manifold_vertices: u64,
    /// Triangles on three vertices that an earlier triangle has already, whichever way they face: the number of
    /// coincident pairs when no three coincide.
    pub duplicate_faces: u64,
    /// Pairs of coincident triangles that face opposite ways: fins without volume. Also counted as duplicates.
    pub folded_faces: u64,
    /// Sets of triangles that are connected through shared vertices.
    pub components: u64,
    /// Vertices - edges + triangles: 2 for each closed surface of a ball's topology, 0 for a torus.
    pub euler_characteristic: i64,
    /// Closed chains of boundary edges. Two holes that touch in a vertex are one loop, which passes it
    /// twice; [`crate::repair::boundary_loops`] tells them apart.
    pub boundary_loops: u64,
}

impl TopologyReport {
    /// Whether every edge has two triangles that face the same way and every vertex one fan, with at least one
    /// triangle and no fins: a closed, oriented surface without singular points.
    pub fn is_closed_manifold(&self) -> bool {
        self.triangles > 0
            && [
                self.collapsed_triangles,
                self.boundary_edges,
                self.non_manifold_edges,
                self.misoriented_edges,
                self.non_manifold_vertices,
                self.duplicate_faces,
            ] == [0; 6]
    }
}

/// Counts what `mesh` is made of. Sorting the edges dominates: O(n log n).
///
/// # Panics
/// If a triangle's index is out of range, or there are more than 2^32 / 3 triangles.
pub fn topology(mesh: &TriangleMesh) -> TopologyReport {
    let triangles = &mesh.triangles;
    assert!(triangles.len() <= (u32::MAX / 3) as usize, "corners are numbered in 32 bits");
    let proper = triangles.iter().filter(|t| is_proper(t)).count();
    let mut report = TopologyReport {
        triangles: proper as u64,
        collapsed_triangles: (triangles.len() - proper) as u64,
        ..TopologyReport::default()
    };
    let connectivity = Connectivity::of(triangles);
    count_edges(&connectivity, &mut report);
    count_vertices(mesh, &mut report);
    count_fans(&connectivity, triangles, &mut report);
    count_coincident(triangles, &mut report);
    report.euler_characteristic = report.vertices as i64 - report.edges as i64 + report.triangles as i64;
    report
}

/// The ends of an edge with one triangle, of the first triangle that has one; `None` if there is no such edge.
///
/// # Panics
/// As [`topology`].
pub fn first_boundary_edge(mesh: &TriangleMesh) -> Option<[glam::Vec3; 2]> {
    let triangles = &mesh.triangles;
    assert!(triangles.len() <= (u32::MAX / 3) as usize, "corners are numbered in 32 bits");
    let connectivity = Connectivity::of(triangles);
    let open = connectivity.edges().filter(|edge| edge.len() == 1).map(|edge| edge[0].corners());
    let [from, to] = open.min()?;
    Some(
        [from, to].map(|corner| mesh.positions[triangles[corner as usize / 3][corner as usize % 3] as usize]),
    )
}

fn count_edges(connectivity: &Connectivity, report: &mut TopologyReport) {
    for edge in connectivity.edges() {
        report.edges += 1;
        match edge {
            [_] => report.boundary_edges += 1,
            [a, b] => report.misoriented_edges += u64::from(a.forward == b.forward),
            _ => report.non_manifold_edges += 1,
        }
    }
}

fn count_vertices(mesh: &TriangleMesh, report: &mut TopologyReport) {
    let mut used = vec![false; mesh.positions.len()];
    let mut joined = DisjointSets::new(mesh.positions.len());
    for &[a, b, c] in mesh.triangles.iter().filter(|t| is_proper(t)) {
        for v in [a, b, c] {
            used[v as usize] = true;
        }
        joined.join(a, b);
        joined.join(a, c);
    }
    for (v, _) in used.iter().enumerate().filter(|(_, used)| **used) {
        report.vertices += 1;
        report.components += u64::from(joined.root(v as u32) == v as u32);
    }
    report.unused_vertices = used.len() as u64 - report.vertices;
}

/// Fans beyond the first, and loops: boundary edges are neighbours when they end in the same fan.
fn count_fans(connectivity: &Connectivity, triangles: &[[u32; 3]], report: &mut TopologyReport) {
    let mut fans = corner_fans(connectivity, triangles);
    let mut loops = DisjointSets::new(3 * triangles.len());
    let mut open_fans = Vec::new();
    for edge in connectivity.edges().filter(|edge| edge.len() == 1) {
        let [start, end] = edge[0].corners().map(|corner| fans.root(corner));
        loops.join(start, end);
        open_fans.push(start);
    }
    let proper_fans = (0..3 * triangles.len() as u32)
        .filter(|&corner| is_proper(&triangles[corner as usize / 3]) && fans.root(corner) == corner)
        .count() as u64;
    report.non_manifold_vertices = proper_fans - report.vertices;
    let mut roots: Vec<u32> = open_fans.into_iter().map(|fan| loops.root(fan)).collect();
    roots.sort_unstable();
    roots.dedup();
    report.boundary_loops = roots.len() as u64;
}

fn count_coincident(triangles: &[[u32; 3]], report: &mut TopologyReport) {
    let mut faces: Vec<([u32; 3], bool)> =
        triangles.iter().filter(|t| is_proper(t)).map(|&t| without_orientation(t)).collect();
    faces.sort_unstable();
    for same in faces.chunk_by(|a, b| a.0 == b.0) {
        report.duplicate_faces += same.len() as u64 - 1;
        let even = same.iter().filter(|face| face.1).count();
        report.folded_faces += even.min(same.len() - even) as u64;
    }
}

/// The sorted vertices, and whether sorting was an even permutation.
fn without_orientation([a, b, c]: [u32; 3]) -> ([u32; 3], bool) {
    let mut sorted = [a, b, c];
    sorted.sort_unstable();
    let even = sorted == [a, b, c] || sorted == [b, c, a] || sorted == [c, a, b];
    (sorted, even)
}
