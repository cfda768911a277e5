//! OBJ: what is read, what is refused and where, and that what is written comes back.

use crate::shapes::*;
use isostudy_mesh::{ObjError, TriangleMesh, read_obj, write_obj};
use proptest::prelude::*;

fn read(text: &str) -> Result<TriangleMesh, ObjError> {
    read_obj(text.as_bytes())
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_negative_indices_and_every_kind_of_corner() {
    let fan = vec![[0, 1, 2], [0, 2, 3]];
    for faces in [
        "f 1 2 3 4",
        "f -4 -3 -2 -1",
        "f 1/9 2/9 3/9 4/9",
        "vn 0 0 1\nf 1//1 2//1 3//-1 4//1",
        "f 1/ 2/ 3// 4",
    ] {
        let mesh = read(&format!("{SQUARE}{faces}")).unwrap();
        assert_eq!(mesh.triangles, fan, "{faces}");
    }
    let late = read(&format!("f 1 2 3 4 # ahead of its vertices\n{SQUARE}")).unwrap();
    assert_eq!(late.triangles, fan);
}

#[test]
fn all_line_ends_give_the_same_mesh() {
    let text = format!("# comment\no thing\n{SQUARE}s off\nusemtl x\nf 1 2 3\n");
    let want = read(&text).unwrap();
    assert_eq!(read(&text.replace('\n', "\r\n")).unwrap(), want);
    assert_eq!(read(&text.replace('\n', "\r")).unwrap(), want);
    let broken = format!("{SQUARE}f 1 2 x\n");
    for end in ["\n", "\r\n", "\r"] {
        let error = read(&broken.replace('\n', end)).unwrap_err();
        assert!(matches!(error, ObjError::NotACorner { line: 5, .. }), "{error}");
    }
}

#[test]
fn normals_are_kept_when_each_vertex_has_one() {
    let text = format!("{SQUARE}vn 0 0 1\nvn 0 1 0\nvn 0 0 1\n");
    let one = read(&format!("{text}f 1//1 2//2 3//1\nf 1//3 2//2 4//1")).unwrap();
    assert_eq!(one.normals.iter().map(|n| n.y).collect::<Vec<_>>(), [0.0, 1.0, 0.0, 0.0]);
    assert!(read(&format!("{text}f 1//1 2//2 3//1\nf 1//2 2//2 4//1")).unwrap().normals.is_empty());
    assert!(read(&format!("{text}f 1//1 2//2 3//1\nf 1 2 4")).unwrap().normals.is_empty());
}

#[test]
fn errors_name_the_line_and_the_value() {
    for (text, want) in [
        ("v 0 0", "line 1: `v` has 2 values, needs at least 3"),
        ("\nv 0 0 nan", "line 2: `nan` is not a finite single-precision number"),
        ("v 0 0 1e39", "line 1: `1e39` is not a finite single-precision number"),
        ("v 0 inf 0", "line 1: `inf` is not a finite single-precision number"),
        ("v 0 0 0\nf 1 1", "line 2: `f` has 2 values, needs at least 3"),
        ("v 0 0 0\nf 1 1 0", "line 2: index 0 is out of range, there are 1 vertices"),
        ("v 0 0 0\nf 1 1 -2", "line 2: index -2 is out of range, there are 1 vertices"),
        ("v 0 0 0\nf 1 1 2\nv 0 0 0\nf 1 1 3", "line 4: index 3 is out of range, there are 2 vertices"),
        ("v 0 0 0\nf 1//1 1//1 1//1", "line 2: index 1 is out of range, there are 0 normals"),
        ("v 0 0 0\nf 1 1 99999999999", "line 2: index 99999999999 is out of range, there are 1 vertices"),
        ("v 0 0 0\nf 1/1/1/1 1 1", "line 2: `1/1/1/1` is not a face corner"),
        ("v 0 0 0\nf 1/x 1 1", "line 2: `1/x` is not a face corner"),
    ] {
        assert_eq!(read(text).unwrap_err().to_string(), want);
    }
}

#[test]
fn written_meshes_come_back_bit_for_bit() {
    let mut icosahedron = icosahedron();
    for with_normals in [false, true] {
        if with_normals {
            icosahedron.normals =
                isostudy_mesh::normals::area_weighted_normals(&icosahedron.positions, &icosahedron.triangles);
        }
        let mut bytes = Vec::new();
        write_obj(&icosahedron, &mut bytes).unwrap();
        assert_eq!(read_obj(&bytes[..]).unwrap(), icosahedron);
    }
}

proptest! {
    #[test]
    fn any_finite_mesh_comes_back(
        positions in prop::collection::vec(prop::array::uniform3(any::<f32>().prop_filter("finite", |v| v.is_finite())), 1..30),
        picks in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 0..30),
    ) {
        let triangles: Vec<_> = picks.iter().map(|t| t.map(|i| i.index(positions.len()) as u32)).collect();
        let want = mesh(&positions, &triangles);
        let mut bytes = Vec::new();
        write_obj(&want, &mut bytes).unwrap();
        prop_assert_eq!(read_obj(&bytes[..]).unwrap(), want);
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = read_obj(&bytes[..]);
    }

    /// Noise in the words of the format gets further in.
    #[test]
    fn garbled_statements_never_panic_and_indices_stay_in_range(
        words in prop::collection::vec(
            prop::sample::select(vec!["v", "vn", "f", "1", "-1", "2//1", "-2/1/-1", "0.5", "0", "nan", "/", "1/", "#", "\n", "\n", "\r", "9e9", "-9223372036854775808", "4294967297"]), 0..80),
    ) {
        if let Ok(mesh) = read(&words.join(" ")) {
            prop_assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
            prop_assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len());
        }
    }
}
