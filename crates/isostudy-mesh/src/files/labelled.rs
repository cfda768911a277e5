//! Files of meshes between labels.

use std::io::{self, BufWriter, Write};

use super::format::MeshFormat;
use super::glb::write_labelled_glb;
use crate::LabelledMesh;

impl LabelledMesh {
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
