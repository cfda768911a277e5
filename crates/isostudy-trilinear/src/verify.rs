//! A mesh held against the samples it was made of.

use std::fmt;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::topology as mesh_topology;

use crate::grid::{Component, Surface, topology};
use crate::mesh_components::components;
use crate::samples::{Samples, SamplesError, Ties};

/// What a mesh is, what it should be, and where the two differ.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Verdict {
    /// Of the mesh.
    pub found: Summary,
    /// Of the trilinear level set.
    pub expected: Summary,
    /// Cells whose surface has a tunnel: those that most programs get wrong.
    pub tunnel_cells: u64,
    /// Everything that is wrong; nothing if the mesh is right.
    pub findings: Vec<Finding>,
}

/// How a surface hangs together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Summary {
    /// Connected pieces.
    pub components: u64,
    /// Summed over them.
    pub euler_characteristic: i64,
    /// Curves in which the surface ends.
    pub boundary_loops: u64,
    /// Handles, summed over the pieces: the tunnels of the surface.
    pub genus: i64,
}

/// One thing that is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// What.
    pub fault: Fault,
    /// How much of it the mesh has.
    pub found: i64,
    /// How much it should have.
    pub expected: i64,
}

/// What can be wrong with a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Fault {
    /// Triangles that repeat a vertex.
    CollapsedTriangles,
    /// Edges with more than two triangles.
    NonManifoldEdges,
    /// Edges whose triangles face different ways.
    MisorientedEdges,
    /// Fans of triangles round a vertex beyond the first.
    NonManifoldVertices,
    /// Triangles on the vertices of another.
    DuplicateTriangles,
    /// Closed chains of edges with one triangle: holes, or ends at the faces of the volume.
    BoundaryLoops,
    /// Connected pieces.
    Components,
    /// The Euler characteristic.
    EulerCharacteristic,
    /// Tunnels.
    Tunnels,
    /// Pieces of the mesh that no piece of the surface is like: the sums are right and the pieces are not.
    UnlikeComponents,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::CollapsedTriangles => "triangles that repeat a vertex",
            Self::NonManifoldEdges => "edges with more than two triangles",
            Self::MisorientedEdges => "edges whose triangles face different ways",
            Self::NonManifoldVertices => "vertices where several sheets meet",
            Self::DuplicateTriangles => "triangles on the vertices of another",
            Self::BoundaryLoops => "boundary loops",
            Self::Components => "components",
            Self::EulerCharacteristic => "Euler characteristic",
            Self::Tunnels => "tunnels",
            Self::UnlikeComponents => "components unlike any of the surface",
        })
    }
}

impl Verdict {
    /// Whether nothing is wrong.
    pub fn is_right(&self) -> bool {
        self.findings.is_empty()
    }
}

impl Summary {
    fn of(components: &[Component]) -> Self {
        Self {
            components: components.len() as u64,
            euler_characteristic: components.iter().map(|component| component.euler_characteristic).sum(),
            boundary_loops: components.iter().map(|component| component.boundary_loops).sum(),
            genus: components.iter().map(Component::genus).sum(),
        }
    }
}

/// Holds a mesh against the trilinear level set of samples.
///
/// Vertices count by their numbers, not by their places: a file in which every triangle has vertices of its own is welded first
/// ([`isostudy_mesh::weld`]). The surface ends at the faces of the grid; a mesh of a volume that was padded, so that it closes there, is held
/// against the padded samples.
///
/// # Errors
/// [`SamplesError::Isovalue`].
///
/// # Panics
/// If a triangle's index is out of range.
pub fn verify(
    mesh: &TriangleMesh,
    samples: &Samples,
    isovalue: f32,
    ties: Ties,
) -> Result<Verdict, SamplesError> {
    let Surface { components: wanted, tunnel_cells, .. } = topology(samples, isovalue, ties)?;
    let report = mesh_topology(mesh);
    let are = components(mesh);
    let (found, expected) = (Summary::of(&are), Summary::of(&wanted));
    let counts = [
        (Fault::CollapsedTriangles, report.collapsed_triangles as i64, 0),
        (Fault::NonManifoldEdges, report.non_manifold_edges as i64, 0),
        (Fault::MisorientedEdges, report.misoriented_edges as i64, 0),
        (Fault::NonManifoldVertices, report.non_manifold_vertices as i64, 0),
        (Fault::DuplicateTriangles, report.duplicate_faces as i64, 0),
        (Fault::BoundaryLoops, found.boundary_loops as i64, expected.boundary_loops as i64),
        (Fault::Components, found.components as i64, expected.components as i64),
        (Fault::EulerCharacteristic, found.euler_characteristic, expected.euler_characteristic),
        (Fault::Tunnels, found.genus, expected.genus),
    ];
    let mut findings: Vec<Finding> = counts
        .into_iter()
        .filter(|(_, found, expected)| found != expected)
        .map(|(fault, found, expected)| Finding { fault, found, expected })
        .collect();
    if findings.is_empty() {
        let unlike = unlike(are, wanted);
        if unlike > 0 {
            findings.push(Finding { fault: Fault::UnlikeComponents, found: unlike, expected: 0 });
        }
    }
    Ok(Verdict { found, expected, tunnel_cells, findings })
}

/// How many of the first have no partner of the same kind in the second.
fn unlike(mut are: Vec<Component>, mut wanted: Vec<Component>) -> i64 {
    are.sort_unstable();
    wanted.sort_unstable();
    let mut partners = wanted.into_iter().peekable();
    are.into_iter()
        .filter(|component| {
            while partners.next_if(|partner| partner < component).is_some() {}
            partners.next_if_eq(component).is_none()
        })
        .count() as i64
}
