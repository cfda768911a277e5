//! Binary glTF: the container and the document say the same as the mesh.

use crate::shapes::*;
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::{TriangleMesh, normals, write_glb};
use serde_json::{Value, json};

fn word(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// The document and the binary chunk.
fn parts(mesh: &TriangleMesh) -> (Value, Vec<u8>) {
    let mut bytes = Vec::new();
    write_glb(mesh, &mut bytes).unwrap();
    assert_eq!((&bytes[..4], word(&bytes, 4), word(&bytes, 8)), (&b"glTF"[..], 2, bytes.len()));
    let length = word(&bytes, 12);
    assert_eq!((&bytes[16..20], length % 4), (&b"JSON"[..], 0));
    let document = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let rest = &bytes[20 + length..];
    if rest.is_empty() {
        return (document, Vec::new());
    }
    assert_eq!((word(rest, 0), &rest[4..8]), (rest.len() - 8, &b"BIN\0"[..]));
    (document, rest[8..].to_vec())
}

/// The four-byte values of an accessor.
fn values(document: &Value, buffer: &[u8], accessor: &Value) -> Vec<[u8; 4]> {
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
    let length = view["byteLength"].as_u64().unwrap() as usize;
    let width = if accessor["type"] == "VEC3" { 3 } else { 1 };
    assert_eq!(length as u64, accessor["count"].as_u64().unwrap() * width * 4);
    buffer[start..start + length].chunks(4).map(|b| b.try_into().unwrap()).collect()
}

#[test]
fn accessors_hold_the_mesh() {
    let mut ball = icosahedron();
    for with_normals in [false, true] {
        if with_normals {
            ball.normals = normals::area_weighted_normals(&ball.positions, &ball.triangles);
        }
        let (document, buffer) = parts(&ball);
        assert_eq!(document["asset"]["version"], "2.0");
        assert_eq!(document["buffers"], json!([{ "byteLength": buffer.len() }]));
        let primitive = &document["meshes"][0]["primitives"][0];
        let floats = |accessor: &Value| {
            values(&document, &buffer, accessor).into_iter().map(f32::from_le_bytes).collect::<Vec<_>>()
        };
        let flat = |vectors: &[Vec3]| vectors.iter().flat_map(|v| v.to_array()).collect::<Vec<_>>();
        assert_eq!(floats(&primitive["attributes"]["POSITION"]), flat(&ball.positions));
        let indices = values(&document, &buffer, &primitive["indices"]);
        assert_eq!(
            indices.into_iter().map(u32::from_le_bytes).collect::<Vec<_>>(),
            ball.triangles.as_flattened()
        );
        assert_eq!(primitive["attributes"].get("NORMAL").is_some(), with_normals);
        if with_normals {
            assert_eq!(floats(&primitive["attributes"]["NORMAL"]), flat(&ball.normals));
        }
        let position = &document["accessors"][1];
        let g = (1.0 + 5f32.sqrt()) / 2.0;
        for (key, sign) in [("min", -1.0), ("max", 1.0)] {
            for k in 0..3 {
                assert_eq!(position[key][k].as_f64().unwrap() as f32, sign * g);
            }
        }
    }
}

#[test]
fn a_normal_without_direction_is_given_one() {
    let mut one = mesh(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 2]]);
    one.normals = vec![Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::NAN];
    let (document, buffer) = parts(&one);
    let normals = values(&document, &buffer, &json!(2));
    let normals: Vec<f32> = normals.into_iter().map(f32::from_le_bytes).collect();
    assert_eq!(normals, [0., 0., 1., 1., 0., 0., 0., 0., 1.]);
}

#[test]
fn an_empty_mesh_is_an_empty_scene() {
    let (document, buffer) = parts(&TriangleMesh::default());
    assert_eq!(document["scenes"], json!([{}]));
    assert!(document.get("meshes").is_none() && buffer.is_empty());
}

#[test]
fn what_gltf_cannot_say_is_refused() {
    let infinite = mesh(&[[0., 0., 0.], [1., f32::INFINITY, 0.], [0., 1., 0.]], &[[0, 1, 2]]);
    let beyond = mesh(&[[0.; 3]; 3], &[[0, 1, 3]]);
    for (mesh, want) in [
        (infinite, "vertex 1 is at [1, inf, 0], which glTF cannot say"),
        (beyond, "triangle 0 refers to a vertex beyond the last of 3"),
    ] {
        assert_eq!(write_glb(&mesh, Vec::new()).unwrap_err().to_string(), want);
    }
}
