//! Meshes between labels: each triangle has a label on either side.

use std::collections::HashMap;

use crate::TriangleMesh;
use crate::normals::area_weighted_normals;

/// Triangles that lie between two labels each, as the boundaries of a segmented volume do. A vertex may be of several boundaries.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LabelledMesh {
    /// Triangles are counter-clockwise seen from their outside label. There are no vertex normals: a vertex of several boundaries would
    /// need one for each.
    pub mesh: TriangleMesh,
    /// The label inside and the label outside, for each triangle.
    pub sides: Vec<[u32; 2]>,
}

impl LabelledMesh {
    /// The pairs of labels that have triangles between them, inside and outside, in ascending order.
    pub fn pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs = self.sides.clone();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// The boundary of a label: all triangles that have it on one side, turned to face away from it. Vertices are numbered as they come.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn boundary_of(&self, label: u32) -> TriangleMesh {
        let of = self.mesh.triangles.iter().zip(&self.sides);
        self.part(of.filter_map(|(&[a, b, c], &[inside, outside])| match label {
            _ if label == inside => Some([a, b, c]),
            _ if label == outside => Some([a, c, b]),
            _ => None,
        }))
    }

    /// The same surface with vertices of their own for each pair, and their normals; by ascending pairs. So a vertex at which several
    /// boundaries meet is there several times.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn apart(&self) -> Self {
        let mut whole = Self::default();
        for (pair, part) in self.parts() {
            let first = whole.mesh.positions.len() as u32;
            whole.mesh.positions.extend(&part.positions);
            whole.mesh.normals.extend(&part.normals);
            whole.mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|v| first + v)));
            whole.sides.resize(whole.mesh.triangles.len(), pair);
        }
        whole
    }

    /// The boundary of each pair by itself, with normals; by ascending pairs.
    pub(crate) fn parts(&self) -> Vec<([u32; 2], TriangleMesh)> {
        let mut order = self.in_order();
        let mut parts = Vec::new();
        while let Some(&first) = order.first() {
            let pair = self.sides[first];
            let end = order.partition_point(|&t| self.sides[t] <= pair);
            let rest = order.split_off(end);
            let mut part = self.part(order.iter().map(|&t| self.mesh.triangles[t]));
            part.normals = area_weighted_normals(&part.positions, &part.triangles);
            parts.push((pair, part));
            order = rest;
        }
        parts
    }

    /// Triangles by pairs, and as they come within one.
    pub(crate) fn in_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.sides.len()).collect();
        order.sort_by_key(|&t| self.sides[t]);
        order
    }

    /// Some triangles, with the vertices that they use.
    fn part(&self, triangles: impl Iterator<Item = [u32; 3]>) -> TriangleMesh {
        let mut numbers = HashMap::new();
        let mut part = TriangleMesh::default();
        for triangle in triangles {
            let triangle = triangle.map(|v| {
                *numbers.entry(v).or_insert_with(|| {
                    part.positions.push(self.mesh.positions[v as usize]);
                    part.positions.len() as u32 - 1
                })
            });
            part.triangles.push(triangle);
        }
        part
    }
}
