//! Files damaged in every way: no panic, no memory beyond the file's size, and what is read all the same is sound.

use crate::shapes::*;
use isostudy_mesh::{MeshFormat, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// What breaks readers.
const TOKENS: [&[u8]; 28] = [
    b"\0",
    b"\n",
    b"\r",
    b" ",
    b"-1",
    b"0",
    b"1e39",
    b"nan",
    b"inf",
    b"99999999999999999999",
    b"4294967295",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\x00\x00\xc0\x7f",
    b"solid",
    b"endsolid",
    b"facet normal 0 0 0",
    b"vertex",
    b"f 1 2 3",
    b"f -1 -2 -3",
    b"v ",
    b"/",
    b"#",
    b"element vertex 18446744073709551615\n",
    b"property list uchar int vertex_indices\n",
    b"property double x\n",
    b"format binary_big_endian 1.0\n",
    b"end_header\n",
];

/// Sound files of every format.
fn corpus() -> Vec<(MeshFormat, Vec<u8>)> {
    let mut files = Vec::new();
    for solid in [tetrahedron(), cube(), torus(4, 3)] {
        for format in [MeshFormat::Obj, MeshFormat::Ply, MeshFormat::Stl] {
            let mut bytes = Vec::new();
            format.write(&solid, &mut bytes).unwrap();
            files.push((format, bytes));
        }
        files.push((MeshFormat::Stl, stl_text(&solid).into_bytes()));
        files.push((MeshFormat::Ply, ply_text(&solid).into_bytes()));
    }
    files
}

fn stl_text(mesh: &TriangleMesh) -> String {
    let facets = (0..mesh.triangles.len()).map(|t| {
        let [a, b, c] = mesh.corners(t).map(|p| format!("vertex {} {} {}\n", p.x, p.y, p.z));
        format!("facet normal 0 0 0\nouter loop\n{a}{b}{c}endloop\nendfacet\n")
    });
    format!("solid\n{}endsolid\n", facets.collect::<String>())
}

fn ply_text(mesh: &TriangleMesh) -> String {
    let rows: String = mesh.positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    let faces: String = mesh.triangles.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n{rows}{faces}",
        mesh.positions.len(),
        mesh.triangles.len()
    )
}

/// Changes a few places of some bytes.
fn mutate(bytes: &mut Vec<u8>, others: &[(MeshFormat, Vec<u8>)], random: &mut Pcg64) {
    for _ in 0..random.random_range(1..=5) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..=60)).min(bytes.len());
        match random.random_range(0..8) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            1 if at < bytes.len() => bytes[at] = random.random(),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let token = TOKENS[random.random_range(0..TOKENS.len())];
                drop(bytes.splice(at..at, token.iter().copied()));
            }
            4 => {
                let token = TOKENS[random.random_range(0..TOKENS.len())];
                let end = (at + token.len()).min(bytes.len());
                drop(bytes.splice(at..end, token.iter().copied()));
            }
            5 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            6 => bytes.truncate(at),
            _ => {
                let from = &others[random.random_range(0..others.len())].1;
                let start = random.random_range(0..from.len());
                let end = (start + 60).min(from.len());
                drop(bytes.splice(at..at, from[start..end].iter().copied()));
            }
        }
    }
}

/// An OBJ face of two-byte corners makes a triangle a corner, which is the most that any format makes of a byte.
fn is_sound(mesh: &TriangleMesh, bytes: usize) -> bool {
    let in_range = mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len());
    let has_normals = mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len();
    let finite = mesh.positions.iter().all(|p| p.is_finite());
    in_range && has_normals && finite && mesh.positions.len() + mesh.triangles.len() <= bytes
}

fn run(rounds: u64, seed: u64) {
    let corpus = corpus();
    let (mut read, mut refused) = (0, 0);
    for round in 0..rounds {
        let mut random = Pcg64::seed_from_u64(seed + round);
        let (format, mut bytes) = corpus[round as usize % corpus.len()].clone();
        mutate(&mut bytes, &corpus, &mut random);
        // Now and then as another format.
        let format =
            if random.random_range(0..8) == 0 { MeshFormat::ALL[random.random_range(0..3)] } else { format };
        match format.read(&bytes[..]) {
            Ok(mesh) => {
                assert!(is_sound(&mesh, bytes.len()), "round {round} of {seed}");
                read += 1;
            }
            Err(error) => {
                assert!(error.to_string().len() < 300, "round {round} of {seed}: {error}");
                refused += 1;
            }
        }
    }
    assert!(read > rounds / 20 && refused > rounds / 20, "{read} read, {refused} refused");
}

#[test]
fn damaged_files_are_refused_or_sound() {
    run(30_000, 1);
}

#[test]
#[ignore = "ten seconds: run by make test-long"]
fn a_million_damaged_files_are_refused_or_sound() {
    run(1_000_000, 1_000_000);
}
