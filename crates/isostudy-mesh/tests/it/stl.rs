//! STL: both kinds, what is refused and where, welding, and that what is written comes back.

use crate::shapes::*;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{TriangleMesh, read_stl, write_stl};
use proptest::prelude::*;

fn binary(mesh: &TriangleMesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_stl(mesh, &mut bytes).unwrap();
    bytes
}

fn text(mesh: &TriangleMesh) -> String {
    let mut text = "solid made by hand\n".to_owned();
    for t in 0..mesh.triangles.len() {
        text += "facet normal 0 0 nan\n outer loop\n";
        for p in mesh.corners(t) {
            text += &format!("  vertex {:e} {} {}\n", p.x, p.y, p.z);
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid made by hand\n"
}

#[test]
fn both_kinds_weld_to_the_same_solid() {
    for solid in [tetrahedron(), cube(), icosahedron(), torus(7, 5)] {
        let got = read_stl(&binary(&solid)[..]).unwrap();
        assert!(topology(&got).is_closed_manifold());
        assert_eq!(
            (got.positions.len(), got.triangles.len()),
            (solid.positions.len(), solid.triangles.len())
        );
        for t in 0..solid.triangles.len() {
            assert_eq!(got.corners(t), solid.corners(t));
        }
        for end in ["\n", "\r\n", "\r"] {
            let text = text(&solid).replace('\n', end);
            assert_eq!(read_stl(text.as_bytes()).unwrap(), got);
            assert_eq!(read_stl(text.to_uppercase().as_bytes()).unwrap(), got);
        }
    }
}

#[test]
fn the_bytes_are_as_the_format_says() {
    let one = mesh(&[[0., 0., 0.], [2., 0., 0.], [0., 3., 0.]], &[[0, 1, 2]]);
    let bytes = binary(&one);
    assert_eq!(bytes.len(), 134);
    assert!(!bytes.starts_with(b"solid"));
    assert_eq!(bytes[80..84], 1u32.to_le_bytes());
    let numbers: Vec<f32> =
        bytes[84..132].chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(numbers, [0., 0., 1., 0., 0., 0., 2., 0., 0., 0., 3., 0.]);
}

#[test]
fn zero_and_minus_zero_are_one_place_and_thin_triangles_stay() {
    let split =
        mesh(&[[0., 0., 0.], [1., 0., 0.], [-0., 0., -0.], [0., 1., 0.]], &[[0, 1, 3], [2, 3, 1], [0, 2, 1]]);
    let welded = isostudy_mesh::weld(&split);
    assert_eq!(welded.positions.len(), 3);
    assert_eq!(welded.triangles, [[0, 1, 2], [0, 2, 1], [0, 0, 1]]);
}

/// Some programs start a binary file with `solid`.
#[test]
fn a_binary_file_may_be_titled_solid() {
    let mut bytes = binary(&cube());
    bytes[..22].copy_from_slice(b"solid facet normal 0 0");
    assert_eq!(read_stl(&bytes[..]).unwrap().triangles.len(), 12);
}

#[test]
fn errors_name_the_place_and_the_value() {
    let mut lying = binary(&cube());
    lying[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut not_a_number = binary(&cube());
    not_a_number[84 + 50 + 24 + 4..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let cut = &binary(&cube())[..683];
    let facet = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
    for (bytes, want) in [
        (&b""[..], "0 bytes; the shortest binary STL file has 84, and as text it lacks `solid` or `facet`"),
        (
            &lying,
            "684 bytes, but a binary STL file of 4294967295 triangles has 214748364834; and as text it lacks `solid` or `facet`",
        ),
        (
            cut,
            "683 bytes, but a binary STL file of 12 triangles has 684; and as text it lacks `solid` or `facet`",
        ),
        (&not_a_number, "triangle 1, corner 1: `y` is NaN, not a finite number"),
        (
            format!("{facet}vertex 0 nan 0").as_bytes(),
            "line 5: `nan` where a finite single-precision number belongs",
        ),
        (
            format!("{facet}vertex 0 0 1e39").as_bytes(),
            "line 5: `1e39` where a finite single-precision number belongs",
        ),
        (format!("{facet}endloop").as_bytes(), "line 5: `endloop` where `vertex`, three to a facet, belongs"),
        (
            format!("{facet}vertex 0 0").as_bytes(),
            "line 5: `` where a finite single-precision number belongs",
        ),
        (b"solid a\nfacet normal 0 0 up", "line 2: `up` where a number belongs"),
        (
            b"solid a\nendsolid a\ntriangle facet",
            "line 3: `triangle` where `solid`, `facet` or `endsolid` belongs",
        ),
    ] {
        assert_eq!(read_stl(bytes).unwrap_err().to_string(), want);
    }
}

proptest! {
    #[test]
    fn any_finite_triangles_come_back(
        corners in prop::collection::vec(prop::array::uniform3(any::<f32>().prop_filter("finite", |v| v.is_finite())), 0..60),
    ) {
        let triangles: Vec<_> = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let want = mesh(&corners, &triangles);
        let binary_read = read_stl(&binary(&want)[..]).unwrap();
        let text_read = read_stl(text(&want).as_bytes()).unwrap();
        for got in [binary_read, text_read] {
            prop_assert_eq!(got.triangles.len(), triangles.len());
            for t in 0..triangles.len() {
                prop_assert_eq!(got.corners(t), want.corners(t));
            }
        }
    }
}

/// What the input reports, once, also for those who walk along the sources.
#[test]
fn an_input_that_fails_is_said_once() {
    struct Broken;
    impl std::io::Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the wire is cut"))
        }
    }
    for format in
        [isostudy_mesh::MeshFormat::Obj, isostudy_mesh::MeshFormat::Ply, isostudy_mesh::MeshFormat::Stl]
    {
        let error = format.read(Broken).unwrap_err();
        let mut chain = error.to_string();
        let mut source = std::error::Error::source(&error);
        while let Some(next) = source {
            chain.push_str(&format!(": {next}"));
            source = next.source();
        }
        assert_eq!(chain, "the wire is cut");
    }
}
