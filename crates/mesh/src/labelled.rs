//! Meshes between labels: each triangle has a label on either side.

use std::collections::HashMap;
use std::io::{self, BufWriter, Write};

use crate::glb::write_labelled_glb;
use crate::normals::area_weighted_normals;
use crate::{MeshFormat, TriangleMesh};

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
    fn in_order(&self) -> Vec<usize> {
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

    /// Binary little-endian PLY as [`write_ply`](crate::write_ply), with the face properties `uint inside` and `uint outside`.
    fn write_ply(&self, output: impl Write) -> io::Result<()> {
        let mut out = BufWriter::new(output);
        write!(
            out,
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {}\nproperty list uchar uint vertex_indices\nproperty uint inside\nproperty uint outside\nend_header\n",
            self.mesh.positions.len(),
            self.mesh.triangles.len()
        )?;
        for value in self.mesh.positions.iter().flat_map(|p| p.to_array()) {
            out.write_all(&value.to_le_bytes())?;
        }
        for (triangle, sides) in self.mesh.triangles.iter().zip(&self.sides) {
            out.write_all(&[3])?;
            for number in triangle.iter().chain(sides) {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        out.flush()
    }

    /// Wavefront OBJ, a group `label_INSIDE_OUTSIDE` for each pair.
    fn write_obj(&self, output: impl Write) -> io::Result<()> {
        let mut out = BufWriter::new(output);
        for p in &self.mesh.positions {
            writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
        }
        let mut last = None;
        for t in self.in_order() {
            let pair @ [inside, outside] = self.sides[t];
            if last != Some(pair) {
                writeln!(out, "g label_{inside}_{outside}")?;
                last = Some(pair);
            }
            let [a, b, c] = self.mesh.triangles[t].map(|v| u64::from(v) + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
        out.flush()
    }
}

impl MeshFormat {
    /// Whether [`write_labelled`](Self::write_labelled) has a place for labels in this format.
    pub fn has_labels(self) -> bool {
        self != Self::Stl
    }

    /// Writes a mesh between labels in this format, labels included: PLY has them as face properties `inside` and `outside`, OBJ has a
    /// group `label_INSIDE_OUTSIDE` for each pair, and binary glTF a primitive with vertices, normals and `extras` of its own for each
    /// pair, and a material for each inside label.
    ///
    /// # Errors
    /// What the output reports, or the format cannot say, and [`io::ErrorKind::InvalidInput`] for STL.
    ///
    /// # Panics
    /// If there are not as many sides as triangles.
    pub fn write_labelled(self, labelled: &LabelledMesh, output: impl Write) -> io::Result<()> {
        assert_eq!(labelled.sides.len(), labelled.mesh.triangles.len(), "sides of triangles");
        match self {
            Self::Obj => labelled.write_obj(output),
            Self::Ply => labelled.write_ply(output),
            Self::Glb => write_labelled_glb(labelled, output),
            Self::Stl => {
                let what = "STL has no place for labels; .ply, .obj and .glb have";
                Err(io::Error::new(io::ErrorKind::InvalidInput, what))
            }
        }
    }
}
