//! PLY: all encodings and types, what is refused and where, and that what is written comes back.

use crate::shapes::*;
use isostudy_mesh::{PlyError, TriangleMesh, read_ply, write_ply};
use proptest::prelude::*;

const TYPES: [&str; 8] = ["char", "uint8", "short", "uint16", "int", "uint32", "float", "float64"];

fn bytes_of(kind: &str, value: f64, big_endian: bool) -> Vec<u8> {
    let mut bytes = match kind {
        "char" => (value as i8).to_le_bytes().to_vec(),
        "uint8" => (value as u8).to_le_bytes().to_vec(),
        "short" => (value as i16).to_le_bytes().to_vec(),
        "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" => (value as i32).to_le_bytes().to_vec(),
        "uint32" => (value as u32).to_le_bytes().to_vec(),
        "float" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if big_endian {
        bytes.reverse();
    }
    bytes
}

/// A square with an extra scalar, an extra list, an extra element and coordinates in an odd order.
fn square(format: &str, coordinate: &str, length: &str, index: &str) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nobj_info none\nelement vertex 4\nproperty {coordinate} z\n\
         property {coordinate} x\nproperty uchar red\nproperty {coordinate} y\nelement edge 2\n\
         property list {length} {index} ends\nelement face 1\nproperty double quality\n\
         property list {length} {index} vertex_indices\nend_header\n"
    )
    .into_bytes();
    let mut put = |kind: &str, value: f64| match format {
        "ascii" => file.extend(format!("{value}\r\n").bytes()),
        _ => file.extend(bytes_of(kind, value, format.contains("big"))),
    };
    for (x, y) in [(0., 0.), (7., 0.), (7., 7.), (0., 7.)] {
        for (kind, value) in [(coordinate, 3.), (coordinate, x), ("uint8", 255.), (coordinate, y)] {
            put(kind, value);
        }
    }
    for list in [vec![0., 1.], vec![]] {
        put(length, list.len() as f64);
        list.into_iter().for_each(|v| put(index, v));
    }
    put("float64", 0.5);
    put(length, 4.0);
    (0..4).for_each(|v| put(index, f64::from(v)));
    file
}

#[test]
fn every_encoding_and_type_reads_alike() {
    let want = mesh(&[[0., 0., 3.], [7., 0., 3.], [7., 7., 3.], [0., 7., 3.]], &[[0, 1, 2], [0, 2, 3]]);
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for coordinate in TYPES {
            for length in &TYPES[..6] {
                for index in &TYPES[..6] {
                    let got = read_ply(&square(format, coordinate, length, index)[..]);
                    assert_eq!(got.unwrap(), want, "{format} {coordinate} {length} {index}");
                }
            }
        }
    }
}

#[test]
fn every_cut_is_an_error_and_never_a_panic() {
    for format in ["ascii", "binary_little_endian"] {
        let whole = square(format, "float", "uint8", "int");
        // In text the last number may lose its line end.
        let shortest = whole.len() - if format == "ascii" { 2 } else { 0 };
        for end in 0..shortest {
            assert!(read_ply(&whole[..end]).is_err(), "{format} cut at {end}");
        }
    }
}

fn ascii(vertices: &str, faces: &str, body: &str) -> Result<TriangleMesh, PlyError> {
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list char int vertex_index\nend_header\n{body}"
    );
    read_ply(text.as_bytes())
}

#[test]
fn errors_name_the_place_and_the_value() {
    for (got, want) in [
        (
            ascii("1", "0", "0 nan 0"),
            "vertex 0, before byte 156: `y` is NaN, not a finite single-precision number",
        ),
        (
            ascii("1", "0", "0 0 1e39"),
            "vertex 0, before byte 159: `z` is inf, not a finite single-precision number",
        ),
        (ascii("1", "0", "0 0 x"), "vertex 0, byte 155: `x` is not a float"),
        (ascii("2", "0", "0 0 0 1"), "vertex 1 of 2: the file ends at byte 158"),
        (ascii("1", "1", "0 0 0 3 0 0 1"), "face 0: vertex 1 of 1"),
        (ascii("1", "1", "0 0 0 3 0 -1 0"), "face 0: vertex -1 of 1"),
        (ascii("1", "1", "0 0 0 2 0 0"), "face 0, before byte 158: 2 corners"),
        (ascii("1", "1", "0 0 0 -3 0 0"), "face 0, before byte 159: a list of -3 values"),
        (ascii("1", "1", "0 0 0 3 0 0.5 0"), "face 0, byte 161: `0.5` is not a int"),
        (ascii("-1", "1", ""), "header line 3: `-1` is not a count"),
        (read_ply(&b"solid"[..]), "header line 1: no line end within 4096 bytes, `end_header` is missing"),
        (read_ply(&b"solid\n"[..]), "header line 1: the file does not start with `ply`"),
        (read_ply(&b"ply\nformat ascii 2.0\n"[..]), "header line 2: cannot read `format ascii 2.0`"),
        (read_ply(&b"ply\nproperty int x\n"[..]), "header line 2: a property before any element"),
        (
            read_ply(&b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0"[..]),
            "element `vertex` lacks a scalar x, y or z",
        ),
        (
            read_ply(&b"ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_index\n"[..]),
            "header line 4: list `vertex_index` counts in floats",
        ),
        (
            read_ply(
                &b"ply\nformat ascii 1.0\nelement face 1\nproperty list int float vertex_index\nend_header\n"
                    [..],
            ),
            "element `face` lacks an integer list vertex_indices",
        ),
    ] {
        assert_eq!(got.unwrap_err().to_string(), want);
    }
}

#[test]
fn a_lying_header_allocates_nothing_and_ends_at_once() {
    let huge = "18446744073709551615";
    assert!(matches!(ascii(huge, huge, "0 0 0"), Err(PlyError::Truncated { row: 1, .. })));
    let binary = format!(
        "ply\nformat binary_little_endian 1.0\nelement nothing {huge}\nelement vertex {huge}\nproperty float x\n\
         property float y\nproperty float z\nend_header\n"
    );
    assert!(matches!(read_ply(binary.as_bytes()), Err(PlyError::Truncated { row: 0, .. })));
    let list = "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint char vertex_index\n\
                end_header\n\u{7f}\u{7f}\u{7f}\u{7f}\0\0\0";
    assert!(matches!(read_ply(list.as_bytes()), Err(PlyError::Truncated { row: 0, .. })));
}

#[test]
fn carriage_returns_change_nothing() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let want = read_ply(text.as_bytes()).unwrap();
    assert_eq!(want.triangles, [[0, 1, 2]]);
    for end in ["\r\n", "\r"] {
        assert_eq!(read_ply(text.replace('\n', end).as_bytes()).unwrap(), want);
    }
}

proptest! {
    #[test]
    fn any_finite_mesh_comes_back(
        positions in prop::collection::vec(prop::array::uniform3(any::<f32>().prop_filter("finite", |v| v.is_finite())), 1..30),
        picks in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 0..30),
        with_normals: bool,
    ) {
        let triangles: Vec<_> = picks.iter().map(|t| t.map(|i| i.index(positions.len()) as u32)).collect();
        let mut want = mesh(&positions, &triangles);
        if with_normals {
            want.normals = want.positions.iter().map(|p| -*p).collect();
        }
        let mut bytes = Vec::new();
        write_ply(&want, &mut bytes).unwrap();
        prop_assert_eq!(read_ply(&bytes[..]).unwrap(), want);
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = read_ply(&bytes[..]);
        let mut headed = b"ply\nformat binary_big_endian 1.0\nelement face 9\nproperty list short int vertex_index\n\
                           element vertex 3\nproperty float x\nproperty float y\nproperty double z\nend_header\n".to_vec();
        headed.extend(bytes);
        let _ = read_ply(&headed[..]);
    }

    /// One byte of a sound file changed: an error, or a mesh whose indices are in range.
    #[test]
    fn one_wrong_byte_never_panics(at in any::<prop::sample::Index>(), to: u8, ascii: bool) {
        let mut file = square(if ascii { "ascii" } else { "binary_little_endian" }, "float", "uint8", "int");
        let at = at.index(file.len());
        file[at] = to;
        if let Ok(mesh) = read_ply(&file[..]) {
            prop_assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
            prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
    }
}
