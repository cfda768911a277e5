//! Meshes between labels: what each format says of them, and the boundary of one label.

use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{LabelledMesh, MeshFormat, TriangleMesh, read_obj, read_ply};
use serde_json::Value;

/// Two tetrahedra with a face in common, labels 7 above and 4 below, in 0. The face is counter-clockwise seen from below, from 4.
fn two() -> LabelledMesh {
    let positions = vec![Vec3::X, Vec3::Y, Vec3::NEG_ONE.with_z(0.0), Vec3::Z, Vec3::NEG_Z];
    let (above, below) = ([7, 0], [4, 0]);
    let triangles = vec![[0, 1, 3], [0, 2, 1], [0, 2, 4], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4]];
    let sides = vec![above, [7, 4], below, above, above, below, below];
    LabelledMesh { mesh: TriangleMesh { positions, triangles, normals: Vec::new() }, sides }
}

fn bytes(format: MeshFormat, labelled: &LabelledMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    format.write_labelled(labelled, &mut bytes).unwrap();
    bytes
}

#[test]
fn the_boundary_of_a_label_is_closed_and_faces_away_from_it() {
    let two = two();
    assert_eq!(two.pairs(), [[4, 0], [7, 0], [7, 4]]);
    // The base has area 3/2, and each tetrahedron height 1.
    for label in [4, 7] {
        let boundary = two.boundary_of(label);
        assert_eq!((boundary.positions.len(), boundary.triangles.len()), (4, 4));
        assert!(topology(&boundary).is_closed_manifold(), "{label}");
        assert!((boundary.volume() - 0.5).abs() < 1e-6, "{label}: {}", boundary.volume());
    }
    let outside = two.boundary_of(0);
    assert_eq!(outside.triangles.len(), 6);
    assert!((outside.volume() + 1.0).abs() < 1e-6, "seen from outside");
    assert!(two.boundary_of(5).triangles.is_empty());
}

#[test]
fn polygon_files_have_a_label_for_each_side() {
    let two = two();
    let file = bytes(MeshFormat::Ply, &two);
    assert_eq!(read_ply(file.as_slice()).unwrap(), two.mesh);
    let header = file.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let text = std::str::from_utf8(&file[..header]).unwrap();
    assert!(
        text.contains("vertex_indices\nproperty uint inside\nproperty uint outside\nend_header"),
        "{text}"
    );
    let faces = file[header + 12 * 5..].chunks_exact(1 + 12 + 8);
    let sides: Vec<[u32; 2]> = faces
        .map(|face| [13, 17].map(|at| u32::from_le_bytes(face[at..at + 4].try_into().unwrap())))
        .collect();
    assert_eq!(sides, two.sides);
}

#[test]
fn object_files_have_a_group_for_each_pair() {
    let two = two();
    let file = String::from_utf8(bytes(MeshFormat::Obj, &two)).unwrap();
    let lines: Vec<&str> = file.lines().skip(5).collect();
    let want = [
        "g label_4_0",
        "f 1 3 5",
        "f 2 1 5",
        "f 3 2 5",
        "g label_7_0",
        "f 1 2 4",
        "f 2 3 4",
        "f 3 1 4",
        "g label_7_4",
        "f 1 3 2",
    ];
    assert_eq!(lines, want);
    assert_eq!(read_obj(file.as_bytes()).unwrap().positions, two.mesh.positions);
}

/// A primitive for each pair, whose accessors hold its triangles with their own vertices, and materials by inside labels.
#[test]
fn gltf_has_a_primitive_for_each_pair() {
    let two = two();
    let file = bytes(MeshFormat::Glb, &two);
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    let length = word(12);
    assert_eq!((&file[..4], word(8), length % 4), (&b"glTF"[..], file.len(), 0));
    let document: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    let buffer = &file[28 + length..];
    assert_eq!(document["buffers"][0]["byteLength"], buffer.len());
    let of = |accessor: &Value| {
        let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        let words = buffer[start..start + length].chunks(4).map(|b| b.try_into().unwrap());
        let width = if accessor["type"] == "VEC3" { 3 } else { 1 };
        assert_eq!(length as u64, 4 * width * accessor["count"].as_u64().unwrap());
        words.collect::<Vec<[u8; 4]>>()
    };
    let mut used = 0;
    let primitives = document["meshes"][0]["primitives"].as_array().unwrap();
    for (primitive, pair) in primitives.iter().zip(two.pairs()) {
        assert_eq!(primitive["extras"]["inside"], pair[0]);
        assert_eq!(primitive["extras"]["outside"], pair[1]);
        let material = &document["materials"][primitive["material"].as_u64().unwrap() as usize];
        assert_eq!(material["name"], format!("label {}", pair[0]));
        let indices: Vec<usize> =
            of(&primitive["indices"]).into_iter().map(|b| u32::from_le_bytes(b) as usize).collect();
        let vectors = |key: &str| -> Vec<Vec3> {
            let numbers: Vec<f32> =
                of(&primitive["attributes"][key]).into_iter().map(f32::from_le_bytes).collect();
            numbers.chunks(3).map(Vec3::from_slice).collect()
        };
        let (positions, normals) = (vectors("POSITION"), vectors("NORMAL"));
        used += positions.len();
        let places: Vec<Vec3> = indices.iter().map(|&v| positions[v]).collect();
        let of_pair = two.mesh.triangles.iter().zip(&two.sides).filter(|(_, sides)| **sides == pair);
        let want: Vec<Vec3> = of_pair.flat_map(|(t, _)| t.map(|v| two.mesh.positions[v as usize])).collect();
        assert_eq!(places, want, "{pair:?}");
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
        if pair == [7, 4] {
            assert!(
                normals.iter().all(|n| n.distance(Vec3::NEG_Z) < 1e-6),
                "its own, not the mean of all: {normals:?}"
            );
        }
    }
    assert_eq!((primitives.len(), used), (3, 4 + 4 + 3));
    assert_eq!(two.apart().mesh.positions.len(), used);
    assert_eq!(two.apart().boundary_of(7).triangles.len(), 4);
}

#[test]
fn what_has_no_place_for_labels_says_so() {
    let error = MeshFormat::Stl.write_labelled(&two(), Vec::new()).unwrap_err();
    assert!(error.to_string().contains("no place for labels"), "{error}");
    assert!(MeshFormat::ALL.iter().all(|format| format.has_labels() == (*format != MeshFormat::Stl)));
    // A mesh without triangles is a file all the same.
    let empty = LabelledMesh::default();
    for format in [MeshFormat::Ply, MeshFormat::Obj, MeshFormat::Glb] {
        assert_eq!(bytes(format, &empty).is_empty(), format == MeshFormat::Obj);
    }
    let mut infinite = two();
    infinite.mesh.positions[1] = Vec3::INFINITY;
    assert!(MeshFormat::Glb.write_labelled(&infinite, Vec::new()).is_err());
}
