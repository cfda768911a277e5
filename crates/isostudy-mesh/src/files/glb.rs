//! Binary glTF 2.0 (Khronos 2021), out only.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use glam::Vec3;

use crate::TriangleMesh;

mod compact;
mod container;
mod labelled;

pub use compact::{CompactNumbers, Per, write_compact_glb};
pub(crate) use labelled::write_labelled_glb;

/// How far from one a normal's length may be.
const UNIT: f32 = 1e-3;

/// Writes a mesh as a binary glTF file: one scene, one node, one mesh, 32-bit indices, single-precision positions, and
/// normals when there is one a vertex.
///
/// Coordinates are written as they are. glTF takes +y for up and metres for units: a viewer shows a model that has +z
/// up lying on its back. glTF wants normals of unit length, so one that has no direction becomes +z. A mesh without
/// triangles is a file with an empty scene.
///
/// # Errors
/// What the output reports, and [`io::ErrorKind::InvalidInput`] where glTF has no words: a position that is not finite,
/// an index out of range, or more than 4 GiB.
pub fn write_glb(mesh: &TriangleMesh, output: impl Write) -> io::Result<()> {
    container::check(mesh)?;
    let layout = Layout::of(mesh);
    let mut out = BufWriter::new(output);
    container::begin(&mut out, document(mesh, &layout), layout.bytes)?;
    if layout.bytes > 0 {
        for index in mesh.triangles.iter().flatten() {
            out.write_all(&index.to_le_bytes())?;
        }
        for value in mesh.positions.iter().flat_map(|p| p.to_array()) {
            out.write_all(&value.to_le_bytes())?;
        }
        for &normal in mesh.normals.iter().filter(|_| layout.with_normals) {
            write_normal(normal, &mut out)?;
        }
    }
    out.flush()
}

/// Writes a normal, of unit length.
fn write_normal(normal: Vec3, out: &mut impl Write) -> io::Result<()> {
    let is_unit = (normal.length() - 1.0).abs() <= UNIT;
    for value in if is_unit { normal } else { normal.normalize_or(Vec3::Z) }.to_array() {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

/// Indices, then positions, then normals. All are made of four bytes, so nothing needs padding.
struct Layout {
    index_bytes: u64,
    vector_bytes: u64,
    with_normals: bool,
    bytes: u64,
}

impl Layout {
    fn of(mesh: &TriangleMesh) -> Self {
        if mesh.triangles.is_empty() {
            return Self { index_bytes: 0, vector_bytes: 0, with_normals: false, bytes: 0 };
        }
        let index_bytes = 12 * mesh.triangles.len() as u64;
        let vector_bytes = 12 * mesh.positions.len() as u64;
        let with_normals = mesh.normals.len() == mesh.positions.len();
        let bytes = index_bytes + vector_bytes * (1 + u64::from(with_normals));
        Self { index_bytes, vector_bytes, with_normals, bytes }
    }
}

const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The JSON. It holds numbers and fixed words only, so nothing in it needs escaping.
fn document(mesh: &TriangleMesh, layout: &Layout) -> String {
    let mut json = String::from(r#"{"asset":{"version":"2.0","generator":"isostudy"},"scene":0,"#);
    let Some(bounds) = mesh.bounds().filter(|_| layout.bytes > 0) else {
        json += r#""scenes":[{}]}"#;
        return json;
    };
    let normal = if layout.with_normals { r#","NORMAL":2"# } else { "" };
    let [vertices, corners] = [mesh.positions.len(), 3 * mesh.triangles.len()];
    let array = |v: Vec3| format!("[{},{},{}]", v.x, v.y, v.z);
    let (low, high) = (array(bounds.min), array(bounds.max));
    // Two sided, so that an open surface has a back.
    let _ = write!(
        json,
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"materials":[{{"doubleSided":true,"pbrMetallicRoughness":{{"metallicFactor":0}}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":1{normal}}},"indices":0,"material":0}}]}}],"accessors":[{{"bufferView":0,"componentType":{UNSIGNED_INT},"count":{corners},"type":"SCALAR"}},{{"bufferView":1,"componentType":{FLOAT},"count":{vertices},"type":"VEC3","min":{low},"max":{high}}}"#,
    );
    if layout.with_normals {
        let _ =
            write!(json, r#",{{"bufferView":2,"componentType":{FLOAT},"count":{vertices},"type":"VEC3"}}"#);
    }
    let Layout { index_bytes, vector_bytes, bytes, .. } = layout;
    let _ = write!(
        json,
        r#"],"bufferViews":[{{"buffer":0,"byteLength":{index_bytes},"target":{ELEMENT_ARRAY_BUFFER}}},{{"buffer":0,"byteOffset":{index_bytes},"byteLength":{vector_bytes},"target":{ARRAY_BUFFER}}}"#,
    );
    if layout.with_normals {
        let start = index_bytes + vector_bytes;
        let _ = write!(
            json,
            r#",{{"buffer":0,"byteOffset":{start},"byteLength":{vector_bytes},"target":{ARRAY_BUFFER}}}"#
        );
    }
    let _ = write!(json, r#"],"buffers":[{{"byteLength":{bytes}}}]}}"#);
    json
}
