//! What a step is applied to, and what it leaves.

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;

/// A mesh after a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// The mesh, with vertex normals if it had some.
    pub mesh: TriangleMesh,
    /// Where a step could not do what was asked, in the order of steps.
    pub stopped: Vec<Stopped>,
}

/// Where a step could not do what was asked; the mesh is whole nevertheless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stopped {
    /// The step.
    pub step: &'static str,
    /// Triangles too many, or vertices that could not be removed.
    pub left: u64,
    /// What these are.
    pub what: &'static str,
    /// One of them: a vertex that could not be removed.
    pub at: Vec3,
}

impl std::fmt::Display for Stopped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { step, left, what, at } = self;
        write!(
            f,
            "{step}: stopped with {left} {what} that could not be removed without a change of topology or a fold, one at {at}"
        )
    }
}

/// A mesh, or a part of one that must fit its neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// A whole mesh.
    Whole,
    /// A chunk: vertices of its borders stay where they are.
    Chunk,
}
