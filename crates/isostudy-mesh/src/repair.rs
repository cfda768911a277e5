//! What makes a scanned mesh a closed solid: unused vertices dropped, holes closed, outside facing out.

use std::error::Error;
use std::fmt;

use glam::DVec3;

use crate::TriangleMesh;
use crate::connectivity::{Connectivity, HalfEdge, is_proper};
use crate::corner_fans::{DisjointSets, corner_fans};

/// Why a hole cannot be closed.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum RepairError {
    /// An edge with three or more triangles has no inside to close.
    NonManifoldEdge {
        /// The vertices of the edge, the lower first.
        edge: [u32; 2],
        /// How many triangles meet there.
        triangles: usize,
    },
    /// Two triangles run an edge in the same direction, so that a loop along them has no direction.
    MisorientedEdge {
        /// The vertices of the edge, the lower first.
        edge: [u32; 2],
    },
    /// A triangle repeats a vertex.
    CollapsedTriangle {
        /// Its number.
        triangle: usize,
    },
}

impl fmt::Display for RepairError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonManifoldEdge { edge, triangles } => write!(
                f,
                "edge {}-{} has {triangles} triangles; holes can be closed where edges have one or two",
                edge[0], edge[1]
            ),
            Self::MisorientedEdge { edge } => {
                write!(f, "the two triangles at edge {}-{} face opposite ways", edge[0], edge[1])
            }
            Self::CollapsedTriangle { triangle } => write!(f, "triangle {triangle} repeats a vertex"),
        }
    }
}

impl Error for RepairError {}

/// The mesh without the vertices that no triangle refers to; order is kept, normals move along.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn drop_unused_vertices(mesh: &TriangleMesh) -> TriangleMesh {
    const UNUSED: u32 = u32::MAX;
    let mut moved_to = vec![UNUSED; mesh.positions.len()];
    for &v in mesh.triangles.iter().flatten() {
        moved_to[v as usize] = 0;
    }
    for (next, target) in moved_to.iter_mut().filter(|target| **target != UNUSED).enumerate() {
        *target = next as u32;
    }
    let kept = |values: &[glam::Vec3]| {
        values.iter().zip(&moved_to).filter(|(_, to)| **to != UNUSED).map(|(v, _)| *v).collect()
    };
    TriangleMesh {
        positions: kept(&mesh.positions),
        normals: kept(&mesh.normals),
        triangles: mesh.triangles.iter().map(|t| t.map(|v| moved_to[v as usize])).collect(),
    }
}

/// The component that each triangle belongs to, numbered from 0 as their first triangles come. Components are connected
/// through shared vertices.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn components(mesh: &TriangleMesh) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut joined = DisjointSets::new(mesh.positions.len());
    for &[a, b, c] in &mesh.triangles {
        joined.join(a, b);
        joined.join(a, c);
    }
    let mut numbers = vec![NONE; mesh.positions.len()];
    let mut count = 0;
    let mut number = |t: &[u32; 3]| {
        let number = &mut numbers[joined.root(t[0]) as usize];
        if *number == NONE {
            *number = count;
            count += 1;
        }
        *number
    };
    mesh.triangles.iter().map(&mut number).collect()
}

/// The mesh with every triangle turned round, normals with it.
pub fn flip(mesh: &TriangleMesh) -> TriangleMesh {
    TriangleMesh {
        positions: mesh.positions.clone(),
        normals: mesh.normals.iter().map(|&n| -n).collect(),
        triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    }
}

/// The boundary loops, each as its half-edges `[from, to]` in the direction of the triangles at them, chained end
/// to start. No loop passes a vertex twice: where two holes touch, each has its own.
///
/// # Errors
/// Where an edge has three triangles or two that disagree, or a triangle repeats a vertex.
pub fn boundary_loops(mesh: &TriangleMesh) -> Result<Vec<Vec<[u32; 2]>>, RepairError> {
    if let Some(triangle) = mesh.triangles.iter().position(|t| !is_proper(t)) {
        return Err(RepairError::CollapsedTriangle { triangle });
    }
    let connectivity = Connectivity::of(&mesh.triangles);
    let mut open: Vec<HalfEdge> = Vec::new();
    for edge in connectivity.edges() {
        match edge {
            [only] => open.push(*only),
            [a, b] if a.forward != b.forward => {}
            [a, _] => return Err(RepairError::MisorientedEdge { edge: a.ends() }),
            [a, ..] => {
                return Err(RepairError::NonManifoldEdge { edge: a.ends(), triangles: edge.len() });
            }
            [] => unreachable!("an edge has at least one half-edge"),
        }
    }
    // A fan on the boundary of such a mesh has one open half-edge in and one out.
    let mut fans = corner_fans(&connectivity, &mesh.triangles);
    let mut leaving = vec![None; 3 * mesh.triangles.len()];
    for (i, half_edge) in open.iter().enumerate() {
        leaving[fans.root(half_edge.corners()[0]) as usize] = Some(i);
    }
    let mut loops = Vec::new();
    for start in 0..open.len() {
        let mut chain = Vec::new();
        let mut at = start;
        // Taking the entry out marks the half-edge as walked.
        while let Some(i) = leaving[fans.root(open[at].corners()[0]) as usize].take() {
            chain.push(open[i].vertices());
            let end = fans.root(open[i].corners()[1]) as usize;
            match leaving[end] {
                Some(next) => at = next,
                None => break,
            }
        }
        split_at_repeats(chain, &mut loops);
    }
    Ok(loops)
}

/// Cuts a closed chain into loops that pass each vertex once: a vertex met again closes what lies between.
fn split_at_repeats(chain: Vec<[u32; 2]>, loops: &mut Vec<Vec<[u32; 2]>>) {
    let mut open: Vec<[u32; 2]> = Vec::new();
    for half_edge in chain {
        open.push(half_edge);
        if let Some(first) = open.iter().rposition(|earlier| earlier[0] == half_edge[1]) {
            loops.push(open.split_off(first));
        }
    }
}

/// The mesh with every boundary loop closed by a fan of triangles round one new vertex, the mean of the loop
/// weighted by edge length. Old vertices and triangles keep their numbers; normals are dropped.
///
/// Guaranteed: no boundary edge is left and no non-manifold edge, mis-oriented edge or fan is added, because
/// every new edge ends in a new vertex and no loop passes a vertex twice. Not guaranteed: that a fan over a strongly curved loop keeps clear of the
/// rest of the surface. Ear clipping would need no new vertex, but can make an edge that exists already.
///
/// # Errors
/// As [`boundary_loops`].
pub fn close_boundary_loops(mesh: &TriangleMesh) -> Result<TriangleMesh, RepairError> {
    let mut closed = TriangleMesh { normals: Vec::new(), ..mesh.clone() };
    for chain in boundary_loops(mesh)? {
        let hub = closed.positions.len() as u32;
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        for ends in &chain {
            let [a, b] = ends.map(|v| mesh.positions[v as usize].as_dvec3());
            let length = a.distance(b);
            sum += 0.5 * length * (a + b);
            weight += length;
        }
        let first = mesh.positions[chain[0][0] as usize].as_dvec3();
        let centre = if weight > 0.0 { sum / weight } else { first };
        closed.positions.push(centre.as_vec3());
        closed.triangles.extend(chain.iter().map(|&[from, to]| [to, from, hub]));
    }
    Ok(closed)
}

/// A solid from a scan: unused vertices dropped, holes closed, and all triangles turned round if the enclosed
/// volume is negative.
///
/// # Errors
/// As [`boundary_loops`].
pub fn closed_solid(mesh: &TriangleMesh) -> Result<TriangleMesh, RepairError> {
    let closed = close_boundary_loops(&drop_unused_vertices(mesh))?;
    Ok(if closed.volume() < 0.0 { flip(&closed) } else { closed })
}
