//! Files damaged in every way: no panic, and what is read all the same is sound.

#[path = "../../../../tests/damage.rs"]
mod damage;

use damage::damage;
use std::sync::Arc;

use isostudy_field::StudyField;
use isostudy_grid::GridField;
use isostudy_mesh::Bounds;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::files::{LIMIT, Written, all};

/// What breaks readers.
const TOKENS: [&[u8]; 30] = [
    b"\0",
    b"\n",
    b"\r\n",
    b"#",
    b"_",
    b"<",
    b"/>",
    b"<!--",
    b"<DataArray>",
    b"</Piece>",
    b"<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>",
    b"<AppendedData encoding=\"raw\">_",
    b" offset=\"18446744073709551615\"",
    b" format=\"appended\"",
    b"\"UInt64\"",
    b"\"BigEndian\"",
    b"=",
    b"&#0;",
    b"-1",
    b"0",
    b"nan",
    b"inf",
    b"1e400",
    b"99999999999999999999",
    b"4294967296",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"METADATA\n",
    b"DIMENSIONS 65536 65536 65536\n",
    b"DATASET STRUCTURED_GRID\n",
    b"FIELD f 99\n",
];

/// A reader's files: each with its name, its array and its bytes. TetGen's second file is kept beside.
type Corpus = Vec<(&'static str, &'static str, Vec<u8>)>;

fn corpus(reader: &str) -> Corpus {
    let mut files = Corpus::new();
    for grid in ["few", "mixed"] {
        for (path, array) in all(grid) {
            let name = match path.extension().unwrap().to_str().unwrap() {
                "vtu" => "a.vtu",
                "vtk" => "a.vtk",
                "node" => "a.node",
                _ => "a.ele",
            };
            files.push((name, array, std::fs::read(path).unwrap()));
        }
    }
    let points: String = (0..27).map(|i| format!("{} {} {} ", i % 3, i / 3 % 3, i / 9)).collect();
    let values: String = (0..27).map(|i| format!("{} ", i % 7)).collect();
    let vts = format!(
        "<VTKFile type=\"StructuredGrid\"><StructuredGrid><Piece Extent=\"0 2 0 2 0 2\"><PointData>\
         <DataArray type=\"Float32\" Name=\"a value\" format=\"ascii\">{values}</DataArray></PointData><Points>\
         <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points>\
         </Piece></StructuredGrid></VTKFile>"
    );
    files.push(("a.vts", "a value", vts.into_bytes()));
    let structured = format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 3 3 3\nPOINTS 27 float\n{points}\nPOINT_DATA 27\n\
         SCALARS a%20value float\nLOOKUP_TABLE default\n{values}\n"
    );
    files.push(("a.vtk", "a value", structured.into_bytes()));
    files.retain(|(name, ..)| match reader {
        "tetgen" => ["a.node", "a.ele"].contains(name),
        ending => name.ends_with(ending),
    });
    files
}

fn run(reader: &str, rounds: u64, seed: u64) {
    let corpus = corpus(reader);
    let (mut read, mut refused) = (0, 0);
    for round in 0..rounds {
        let mut random = Pcg64::seed_from_u64(seed + round);
        let (name, array, mut bytes) = corpus[round as usize % corpus.len()].clone();
        damage(&mut bytes, &TOKENS, [2, 40], &mut random);
        let file = Written::new(name, &bytes);
        if reader == "tetgen" {
            let (other, _, text) = corpus.iter().find(|(other, ..)| *other != name).unwrap();
            file.beside(other, text);
        }
        match isostudy_grid::read(&file.path(), Some(array), LIMIT) {
            Ok(grid) => {
                let count = grid.points().len();
                assert_eq!(grid.values().len(), count, "round {round} of {seed}");
                assert!(grid.tetrahedra().iter().flatten().all(|&point| (point as usize) < count));
                let surface = grid.extract(0.105);
                assert!(surface.mesh.positions.iter().all(|p| p.is_finite()), "round {round} of {seed}");
                assert!(
                    surface.mesh.triangles.iter().flatten().all(|&v| (v as usize) < surface.crossings.len())
                );
                let odd = grid.oddities();
                assert!(odd.without_value <= grid.tetrahedra().len() as u64);
                if let Ok(field) = GridField::try_new(Arc::new(grid)) {
                    let Bounds { min, max } = field.bounds();
                    for share in [0.0, 0.3, 0.5, 1.5] {
                        let p = min + share * (max - min);
                        assert!(
                            field.sample(p).to_bits() == field.sample(p).to_bits(),
                            "round {round} of {seed}"
                        );
                    }
                }
                read += 1;
            }
            Err(error) => {
                assert!(error.to_string().len() < 1000, "round {round} of {seed}: {error}");
                refused += 1;
            }
        }
    }
    // Of texts most damages are found.
    assert!(read > rounds / 50 && refused > rounds / 20, "{read} read, {refused} refused");
}

#[test]
fn damaged_vtu_files_are_refused_or_sound() {
    run("vtu", 5_000, 1);
}

#[test]
fn damaged_vts_files_are_refused_or_sound() {
    run("vts", 5_000, 10_001);
}

#[test]
fn damaged_legacy_files_are_refused_or_sound() {
    run("vtk", 5_000, 20_001);
}

#[test]
fn damaged_tetgen_files_are_refused_or_sound() {
    run("tetgen", 5_000, 30_001);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn many_more_damaged_files_are_refused_or_sound() {
    for reader in ["vtu", "vts", "vtk", "tetgen"] {
        run(reader, 100_000, 1_000_000);
    }
}
