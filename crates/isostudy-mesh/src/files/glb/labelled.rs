//! Binary glTF of a mesh between labels: a primitive for each pair.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use glam::Vec3;

use super::container::{begin, check};
use super::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_INT, write_normal};
use crate::{LabelledMesh, TriangleMesh};

/// What of a turn the hue of a label is from that of the label before: neighbours differ, and none comes back soon.
const TURN: f64 = 0.618_033_988_749_894_9;

/// Writes a scene with one mesh. Each pair of labels is a primitive with its own vertices and normals, `"extras":{"inside":5,"outside":2}`,
/// and the material of its inside label. As [`write_glb`](super::write_glb) otherwise.
///
/// # Errors
/// As there.
pub(crate) fn write_labelled_glb(labelled: &LabelledMesh, output: impl Write) -> io::Result<()> {
    check(&labelled.mesh)?;
    let parts = labelled.parts();
    let bytes: u64 = parts.iter().map(|(_, part)| Bytes::of(part).all()).sum();
    let mut out = BufWriter::new(output);
    begin(&mut out, document(&parts, bytes), bytes)?;
    for (_, part) in &parts {
        for index in part.triangles.iter().flatten() {
            out.write_all(&index.to_le_bytes())?;
        }
        for value in part.positions.iter().flat_map(|p| p.to_array()) {
            out.write_all(&value.to_le_bytes())?;
        }
        for &normal in &part.normals {
            write_normal(normal, &mut out)?;
        }
    }
    out.flush()
}

/// Of a part: its indices, then its positions, then as many bytes of normals.
struct Bytes {
    indices: u64,
    vectors: u64,
}

impl Bytes {
    fn of(part: &TriangleMesh) -> Self {
        Self { indices: 12 * part.triangles.len() as u64, vectors: 12 * part.positions.len() as u64 }
    }

    fn all(&self) -> u64 {
        self.indices + 2 * self.vectors
    }
}

/// The JSON. It holds numbers and fixed words only, so nothing in it needs escaping.
fn document(parts: &[([u32; 2], TriangleMesh)], bytes: u64) -> String {
    let mut json = String::from(r#"{"asset":{"version":"2.0","generator":"isostudy"},"scene":0,"#);
    if parts.is_empty() {
        json += r#""scenes":[{}]}"#;
        return json;
    }
    // Pairs are in the order of their inside labels.
    let mut labels: Vec<u32> = parts.iter().map(|([inside, _], _)| *inside).collect();
    labels.dedup();
    let [mut primitives, mut accessors, mut views] = [const { Vec::new() }; 3];
    let mut start = 0;
    for ([inside, outside], part) in parts {
        let material = labels.partition_point(|label| label < inside);
        let first = accessors.len();
        primitives.push(format!(
            r#"{{"attributes":{{"POSITION":{},"NORMAL":{}}},"indices":{first},"material":{material},"extras":{{"inside":{inside},"outside":{outside}}}}}"#,
            first + 1,
            first + 2
        ));
        let bounds = part.bounds().expect("a pair has triangles");
        let array = |v: Vec3| format!("[{},{},{}]", v.x, v.y, v.z);
        let (low, high) = (array(bounds.min), array(bounds.max));
        let [vertices, corners] = [part.positions.len(), 3 * part.triangles.len()];
        let accessor = |number: usize, kind, count, rest: String| {
            format!(r#"{{"bufferView":{number},"componentType":{kind},"count":{count},{rest}}}"#)
        };
        accessors.push(accessor(first, UNSIGNED_INT, corners, r#""type":"SCALAR""#.into()));
        let bounded = format!(r#""type":"VEC3","min":{low},"max":{high}"#);
        accessors.push(accessor(first + 1, FLOAT, vertices, bounded));
        accessors.push(accessor(first + 2, FLOAT, vertices, r#""type":"VEC3""#.into()));
        let Bytes { indices, vectors } = Bytes::of(part);
        for (length, target) in
            [(indices, ELEMENT_ARRAY_BUFFER), (vectors, ARRAY_BUFFER), (vectors, ARRAY_BUFFER)]
        {
            views.push(format!(
                r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length},"target":{target}}}"#
            ));
            start += length;
        }
    }
    let materials: Vec<String> = labels.iter().map(|&label| material(label)).collect();
    let _ = write!(
        json,
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"materials":[{}],"meshes":[{{"primitives":[{}]}}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{bytes}}}]}}"#,
        materials.join(","),
        primitives.join(","),
        accessors.join(","),
        views.join(",")
    );
    json
}

/// Two sided, so that an open surface has a back; in a colour by the label.
fn material(label: u32) -> String {
    let hue = (f64::from(label) * TURN).fract() * 6.0;
    let part = |shift: f64| {
        let away = ((hue + shift) % 6.0 - 3.0).abs() - 1.0;
        (100.0 * (0.25 + 0.6 * away.clamp(0.0, 1.0))).round() / 100.0
    };
    let [red, green, blue] = [0.0, 4.0, 2.0].map(part);
    format!(
        r#"{{"name":"label {label}","doubleSided":true,"pbrMetallicRoughness":{{"baseColorFactor":[{red},{green},{blue},1],"metallicFactor":0}}}}"#
    )
}
