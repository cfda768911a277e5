//! Binary glTF: the container and the document say the same as the mesh.

use crate::shapes::*;
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::{TriangleMesh, corner_normals, normals, weld, write_glb};
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

/// A cylinder whose rims are shared: in the file each corner has the normal of the cylinder's equation, outward on the side and along the
/// axis on the caps, and vertices at one place are one again by their positions alone.
#[test]
fn creases_are_split_vertices() {
    const STEPS: u32 = 24;
    let mut mesh = TriangleMesh { positions: vec![Vec3::NEG_Z, Vec3::Z], ..TriangleMesh::default() };
    for i in 0..STEPS {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / STEPS as f32).sin_cos();
        mesh.positions.extend([-1.0, 1.0].map(|z| Vec3::new(cos, sin, z)));
    }
    let at = |i: u32, top: u32| 2 + 2 * (i % STEPS) + top;
    for i in 0..STEPS {
        let [a, b, c, d] = [at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d], [0, b, a], [1, d, c]]);
    }
    mesh.normals = normals::area_weighted_normals(&mesh.positions, &mesh.triangles);
    let (document, buffer) = parts(&corner_normals(&mesh, 40.0).split(&mesh));
    let primitive = &document["meshes"][0]["primitives"][0];
    let vectors = |name: &str| -> Vec<Vec3> {
        let floats = values(&document, &buffer, &primitive["attributes"][name]);
        floats.chunks(3).map(|v| Vec3::from([0, 1, 2].map(|k| f32::from_le_bytes(v[k])))).collect()
    };
    let (positions, normals) = (vectors("POSITION"), vectors("NORMAL"));
    assert_eq!(positions.len() as u32, 2 + 4 * STEPS, "a vertex of a rim is there twice");
    let indices: Vec<usize> = values(&document, &buffer, &primitive["indices"])
        .into_iter()
        .map(|index| u32::from_le_bytes(index) as usize)
        .collect();
    for (corners, triangle) in indices.chunks(3).zip(&mesh.triangles) {
        let [a, b, c] = [0, 1, 2].map(|k| positions[corners[k]]);
        let is_cap = (b - a).cross(c - a).normalize().z.abs() > 0.5;
        for (&corner, &vertex) in corners.iter().zip(triangle) {
            let p = positions[corner];
            let want = if is_cap { Vec3::Z * p.z } else { Vec3::new(p.x, p.y, 0.0) };
            assert!(normals[corner].distance(want) < 1e-5, "{} is not {want}", normals[corner]);
            assert_eq!(p, mesh.positions[vertex as usize]);
        }
    }
    let triangles = indices.chunks(3).map(|t| [0, 1, 2].map(|k| t[k] as u32)).collect();
    let welded = weld(&TriangleMesh { positions, normals: Vec::new(), triangles });
    assert_eq!((welded.positions, welded.triangles), (mesh.positions, mesh.triangles));
}
