//! Compact glTF, decoded as the standard says, is the mesh within its steps.

use crate::shapes::*;
use isostudy_mesh::glam::{DVec3, Vec3};
use isostudy_mesh::{
    CompactNumbers, Per, TriangleMesh, corner_normals, normals, write_compact_glb, write_glb,
};
use serde_json::Value;

/// The document and the buffer.
fn parts(bytes: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let length = word(12);
    assert_eq!((&bytes[16..20], length % 4), (&b"JSON"[..], 0));
    let document = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let rest = &bytes[20 + length..];
    if rest.is_empty() {
        return (document, Vec::new());
    }
    assert_eq!((word(20 + length), &rest[4..8], rest.len() % 4), (rest.len() - 8, &b"BIN\0"[..], 0));
    (document, rest[8..].to_vec())
}

fn written(mesh: &TriangleMesh, numbers: &[CompactNumbers<'_>]) -> (Value, Vec<u8>) {
    let mut bytes = Vec::new();
    write_compact_glb(mesh, &[], numbers, &mut bytes).unwrap();
    parts(&bytes)
}

/// What an accessor has, element by element, by the rules of glTF 2.0, section 3.6: strides, offsets, component types.
fn read(document: &Value, buffer: &[u8], accessor: &Value) -> Vec<Vec<i64>> {
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap() as usize;
    let view_bytes = &buffer[start..start + view["byteLength"].as_u64().unwrap() as usize];
    let width = if accessor["type"] == "VEC3" { 3 } else { 1 };
    let bytes = match accessor["componentType"].as_u64().unwrap() {
        5120 | 5121 => 1,
        5123 => 2,
        5125 => 4,
        other => panic!("{other}"),
    };
    assert_eq!(start % bytes, 0, "aligned");
    let stride = view["byteStride"].as_u64().map_or(bytes * width, |stride| stride as usize);
    let component = |at: usize| -> i64 {
        let of = &view_bytes[at..at + bytes];
        match accessor["componentType"].as_u64().unwrap() {
            5120 => i64::from(of[0] as i8),
            _ => of.iter().rev().fold(0, |sum, &byte| sum << 8 | i64::from(byte)),
        }
    };
    let element = |i: usize| (0..width).map(|k| component(i * stride + k * bytes)).collect();
    (0..accessor["count"].as_u64().unwrap() as usize).map(element).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| value[axis].as_f64().unwrap()))
}

/// Decodes positions, normals and triangles, and compares each with the mesh's.
fn assert_is(mesh: &TriangleMesh, document: &Value, buffer: &[u8]) {
    assert_eq!(document["extensionsRequired"][0], "KHR_mesh_quantization");
    assert_eq!(document["buffers"][0]["byteLength"].as_u64().unwrap(), buffer.len() as u64);
    let primitive = &document["meshes"][0]["primitives"][0];
    let indices: Vec<u32> =
        read(document, buffer, &primitive["indices"]).iter().map(|index| index[0] as u32).collect();
    assert_eq!(indices, mesh.triangles.as_flattened());

    let node = &document["nodes"][0];
    let (move_by, scale) = (vector(&node["translation"]), vector(&node["scale"]));
    assert!(scale.x == scale.y && scale.y == scale.z, "else normals would need another matrix");
    let bounds = mesh.bounds().unwrap();
    let quantum = f64::from(bounds.size().max_element()) / 65_535.0;
    let codes = read(document, buffer, &primitive["attributes"]["POSITION"]);
    assert_eq!(codes.len(), mesh.positions.len());
    for (code, position) in codes.iter().zip(&mesh.positions) {
        let found = move_by + DVec3::from_array([0, 1, 2].map(|k| code[k] as f64)) * scale;
        let off = (found - position.as_dvec3()).abs().max_element();
        assert!(off <= 0.5001 * quantum, "{position} became {found}");
    }
    let accessor = &document["accessors"][primitive["attributes"]["POSITION"].as_u64().unwrap() as usize];
    for axis in 0..3 {
        let along = || codes.iter().map(|code| code[axis]);
        assert_eq!(accessor["min"][axis].as_i64(), along().min());
        assert_eq!(accessor["max"][axis].as_i64(), along().max());
    }
    let Some(normal) = primitive["attributes"].get("NORMAL") else {
        return assert!(mesh.normals.is_empty());
    };
    assert_eq!(document["accessors"][normal.as_u64().unwrap() as usize]["normalized"], true);
    for (code, normal) in read(document, buffer, normal).iter().zip(&mesh.normals) {
        let found = DVec3::from_array([0, 1, 2].map(|k| code[k] as f64 / 127.0));
        assert!(
            (found - normal.as_dvec3()).abs().max_element() < 0.5 / 127.0 + 1e-6,
            "{normal} became {found}"
        );
    }
}

/// A list of numbers by its name, decoded.
fn numbers(document: &Value, buffer: &[u8], name: &str) -> (String, Vec<Option<f64>>) {
    let lists = document["meshes"][0]["extras"]["numbers"].as_array().unwrap();
    let list = lists.iter().find(|list| list["name"] == name).unwrap();
    let most = list["most"].as_f64().unwrap();
    let decoded = |code: &Vec<i64>| (code[0] < 255).then(|| most * (code[0] as f64 / 254.0).powi(2));
    let codes = read(document, buffer, &list["accessor"]);
    (list["per"].as_str().unwrap().to_owned(), codes.iter().map(decoded).collect())
}

#[test]
fn a_mesh_is_decoded_within_half_a_step() {
    let mut ring = torus(19, 8).transformed(|p| p * 0.3 + Vec3::new(5.0, -7.0, 0.01));
    for with_normals in [false, true] {
        if with_normals {
            ring.normals = normals::area_weighted_normals(&ring.positions, &ring.triangles);
        }
        let (document, buffer) = written(&ring, &[]);
        assert_is(&ring, &document, &buffer);
        assert_eq!(document["accessors"][0]["componentType"], 5123, "152 vertices need no more than 16 bits");
    }
}

#[test]
fn numbers_are_decoded_within_their_steps() {
    let ring = torus(11, 7);
    let of_triangles: Vec<Option<f64>> =
        (0..ring.triangles.len()).map(|t| (t % 5 != 3).then(|| 0.02 * (t as f64 / 154.0).powi(3))).collect();
    let of_vertices: Vec<Option<f64>> = (0..ring.positions.len()).map(|v| Some(v as f64)).collect();
    let (document, buffer) = written(
        &ring,
        &[
            CompactNumbers { name: "distance", per: Per::Triangle, values: &of_triangles },
            CompactNumbers { name: "normal_error", per: Per::Vertex, values: &of_vertices },
        ],
    );
    assert_is(&ring, &document, &buffer);
    for (name, per, wanted) in
        [("distance", "triangle", &of_triangles), ("normal_error", "vertex", &of_vertices)]
    {
        let (of_what, found) = numbers(&document, &buffer, name);
        assert_eq!((of_what.as_str(), found.len()), (per, wanted.len()));
        let most = wanted.iter().flatten().copied().fold(0.0, f64::max);
        for (found, wanted) in found.iter().zip(wanted) {
            assert_eq!(found.is_some(), wanted.is_some());
            let off = found.unwrap_or(0.0).sqrt() - wanted.unwrap_or(0.0).sqrt();
            assert!(off.abs() <= most.sqrt() / 508.0 + 1e-12, "{found:?} is not {wanted:?}");
        }
    }
    // All nought: there is no scale, and nothing is divided by it.
    let nought = vec![Some(0.0); ring.triangles.len()];
    let (document, buffer) =
        written(&ring, &[CompactNumbers { name: "distance", per: Per::Triangle, values: &nought }]);
    assert_eq!(numbers(&document, &buffer, "distance").1, nought);
}

/// 65,535 is no index of 16 bits: it restarts primitives.
#[test]
fn indices_have_as_many_bits_as_they_need() {
    for (vertices, bits) in [(65_535u32, 5123), (65_536, 5125)] {
        let positions = (0..vertices).map(|v| Vec3::new(v as f32, (v % 7) as f32, 0.0)).collect();
        let strip = TriangleMesh {
            positions,
            triangles: vec![[0, 1, 2], [vertices - 3, vertices - 2, vertices - 1]],
            ..TriangleMesh::default()
        };
        let (document, buffer) = written(&strip, &[]);
        assert_eq!(document["accessors"][0]["componentType"], bits);
        assert_is(&strip, &document, &buffer);
    }
}

#[test]
fn it_is_about_half_of_the_plain_file() {
    let mut ring = torus(60, 30);
    ring.normals = normals::area_weighted_normals(&ring.positions, &ring.triangles);
    let (mut plain, mut compact) = (Vec::new(), Vec::new());
    write_glb(&ring, &mut plain).unwrap();
    write_compact_glb(&ring, &[], &[], &mut compact).unwrap();
    assert!(compact.len() * 100 < plain.len() * 55, "{} of {}", compact.len(), plain.len());
}

#[test]
fn a_mesh_without_extent_or_triangles_is_written() {
    let point = mesh(&[[3.0, 4.0, 5.0]; 3], &[[0, 1, 2]]);
    let (document, buffer) = written(&point, &[]);
    assert_is(&point, &document, &buffer);
    let (document, buffer) = written(&mesh(&[[3.0, 4.0, 5.0]; 3], &[]), &[]);
    assert_eq!((document["scenes"][0].get("nodes"), buffer.len()), (None, 0));
    let mut one = cube();
    one.normals = vec![Vec3::ZERO; 8];
    let (document, buffer) = written(&one, &[]);
    let normals = read(&document, &buffer, &document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]);
    assert!(normals.iter().all(|normal| *normal == [0, 0, 127]), "a normal without direction is +z");
}

#[test]
fn what_cannot_be_said_is_refused() {
    let told = |mesh: &TriangleMesh, numbers: &[CompactNumbers<'_>]| {
        let error = write_compact_glb(mesh, &[], numbers, Vec::new()).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput);
        error.to_string()
    };
    let ball = icosahedron();
    let mut broken = ball.clone();
    broken.positions[4].y = f32::NAN;
    assert!(told(&broken, &[]).contains("vertex 4"));
    broken = ball.clone();
    broken.triangles[7][2] = 12;
    assert!(told(&broken, &[]).contains("triangle 7"));
    fn list<'a>(name: &'a str, values: &'a [Option<f64>]) -> [CompactNumbers<'a>; 1] {
        [CompactNumbers { name, per: Per::Triangle, values }]
    }
    assert!(told(&ball, &list("distance", &[Some(1.0)])).contains("1 numbers for 20 triangles"));
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let mut values = vec![Some(1.0); 20];
        values[9] = Some(bad);
        assert!(told(&ball, &list("distance", &values)).contains("distance"), "{bad}");
    }
    assert!(told(&ball, &list("dis\"tance", &[Some(1.0); 20])).contains("underscores"));
}

/// A box of the unit cube's sides: corners point along the axes from the copies, and away from the middle from what they are of.
#[test]
fn copies_have_creases_and_lead_back_to_smooth_normals() {
    let corner = |i: usize| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| bit as f32 - 0.5));
    let positions: Vec<Vec3> = (0..8).map(corner).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> =
        sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let normals = positions.iter().map(|p| p.normalize()).collect();
    let mesh = TriangleMesh { positions, normals, triangles };
    let made = corner_normals(&mesh, 40.0);
    let all = made.with_copies(&mesh);
    let angles = vec![Some(1.0); 8];
    let numbers = [CompactNumbers { name: "angle", per: Per::Vertex, values: &angles }];
    let mut bytes = Vec::new();
    write_compact_glb(&all, &made.copies, &numbers, &mut bytes).unwrap();
    let (document, buffer) = parts(&bytes);
    assert_is(&all, &document, &buffer);
    let primitive = &document["meshes"][0]["primitives"][0];
    let copies = read(&document, &buffer, &document["meshes"][0]["extras"]["copies"]["accessor"]);
    let normals = read(&document, &buffer, &primitive["attributes"]["NORMAL"]);
    assert_eq!((copies.len(), normals.len()), (24, 32));
    let indices = read(&document, &buffer, &primitive["indices"]);
    for (index, &vertex) in indices.iter().zip(mesh.triangles.as_flattened()) {
        let index = index[0] as usize;
        let along: Vec<i64> = normals[index].iter().map(|n| n.abs()).collect();
        assert_eq!(along.iter().filter(|n| **n == 127).count(), 1, "{along:?}");
        assert_eq!(along.iter().sum::<i64>(), 127, "{along:?}");
        let of = copies[index - 8][0] as u32;
        assert_eq!(of, vertex);
        let want = mesh.normals[of as usize].to_array().map(|n| (n * 127.0).round() as i64);
        assert_eq!(normals[of as usize], want);
    }
    let error = write_compact_glb(&all, &[0; 24], &numbers, Vec::new()).unwrap_err();
    assert_eq!(error.to_string(), "vertex 11 is no copy of 0");
    let error = write_compact_glb(&all, &[0; 33], &[], Vec::new()).unwrap_err();
    assert_eq!(error.to_string(), "33 copies among 32 vertices");
}
