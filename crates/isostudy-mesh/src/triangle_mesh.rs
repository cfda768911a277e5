//! The indexed triangle mesh that every stage shares.

use glam::{DVec3, Vec3};

/// An indexed triangle mesh with optional vertex normals.
///
/// Corners are counter-clockwise seen from outside: the cross product of the first two edges points away from
/// the solid. Lengths are in the unit of the scalar field's coordinates. Nothing is promised about topology;
/// [`crate::topology`] says what a mesh has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriangleMesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals, outward; empty, or one a vertex.
    pub normals: Vec<Vec3>,
    /// Three indices into `positions` a triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The extent along each axis.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// The box with every face moved outward.
    pub fn grown(&self, by: f32) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// The edge of the cubes of which so many fit along the longest side.
    pub fn spacing_of_cells(&self, cells: u32) -> f32 {
        self.size().max_element() / cells as f32
    }
}

impl TriangleMesh {
    /// The three corner positions of triangle `t`.
    ///
    /// # Panics
    /// If `t` or one of its indices is out of range.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// The smallest box that holds every vertex, or `None` for a mesh without vertices.
    pub fn bounds(&self) -> Option<Bounds> {
        let first = *self.positions.first()?;
        let (min, max) =
            self.positions.iter().fold((first, first), |(min, max), &p| (min.min(p), max.max(p)));
        Some(Bounds { min, max })
    }

    /// The smallest box that holds every triangle, or `None` for a mesh without triangles. Vertices that no triangle uses
    /// may lie anywhere.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn surface_bounds(&self) -> Option<Bounds> {
        let mut corners = self.triangles.iter().flatten().map(|&v| self.positions[v as usize]);
        let first = corners.next()?;
        let (min, max) = corners.fold((first, first), |(min, max), p| (min.min(p), max.max(p)));
        Some(Bounds { min, max })
    }

    /// Total surface area, summed in double precision.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| self.double_area_vector(t).length() * 0.5).sum()
    }

    /// Enclosed volume by the divergence theorem; positive when triangles face outward.
    /// Meaningful only for a closed mesh.
    pub fn volume(&self) -> f64 {
        (0..self.triangles.len())
            .map(|t| {
                let [a, b, c] = self.corners(t).map(|p| p.as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    /// The mesh with every vertex moved by `place`; without normals, which a map need not keep.
    /// A map that mirrors must be followed by [`crate::repair::flip`].
    pub fn transformed(&self, place: impl Fn(Vec3) -> Vec3) -> Self {
        Self {
            positions: self.positions.iter().map(|&p| place(p)).collect(),
            normals: Vec::new(),
            triangles: self.triangles.clone(),
        }
    }

    fn double_area_vector(&self, t: usize) -> DVec3 {
        let [a, b, c] = self.corners(t).map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    }
}
