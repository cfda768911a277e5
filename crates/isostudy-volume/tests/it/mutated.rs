//! Files damaged in every way: no panic, and what is read all the same is sound.

#[path = "../../../../tests/damage.rs"]
mod damage;

use crate::files::*;
use damage::damage;
use isostudy_volume::Problem;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// What breaks readers.
const TOKENS: [&[u8]; 26] = [
    b"\0",
    b"\n",
    b"\r\n",
    b"\n\n",
    b":",
    b"=",
    b":=",
    b"(",
    b")",
    b"none ",
    b"-1",
    b"0",
    b"nan",
    b"inf",
    b"1e400",
    b"99999999999999999999",
    b"4294967296 4294967296 4294967296",
    b"dimension: 4\n",
    b"sizes: 1 1 1\n",
    b"encoding: gzip\n",
    b"byte skip: -1\n",
    b"line skip: 18446744073709551615\n",
    b"data file: .\n",
    b"NDims = 4\n",
    b"HeaderSize = -1\n",
    b"CompressedData = True\n",
];

fn corpus() -> Vec<(&'static str, Vec<u8>)> {
    let mut files = Vec::new();
    for kind in ["u8", "i16", "f32", "f64"] {
        for (encoding, big_endian) in [("raw", true), ("gzip", false), ("hex", true), ("text", false)] {
            let data = encoded(&bytes(kind, big_endian), encoding, kind);
            let header = nrrd_header(kind, encoding, big_endian);
            files.push(("a.nrrd", [header.as_bytes(), b"\n", &data].concat()));
        }
        for (encoding, big_endian) in [("raw", false), ("zlib", true), ("text", false)] {
            let data = encoded(&bytes(kind, big_endian), encoding, kind);
            let header = meta_header(kind, encoding, big_endian);
            files.push(("a.mha", [header.as_bytes(), b"ElementDataFile = LOCAL\n", &data].concat()));
        }
        files.push((
            "a.toml",
            format!("size = [4, 3, 2]\ntype = '{kind}'\nspacing = [1, 2, 3]\nfile = 'a.data'\n").into(),
        ));
    }
    files
}

/// Up to four changes, of up to forty bytes.
pub(crate) fn mutate(bytes: &mut Vec<u8>, random: &mut Pcg64) {
    damage(bytes, &TOKENS, [4, 40], random);
}

fn run(rounds: u64, seed: u64) {
    let (folder, corpus) = (Folder::new(), corpus());
    folder.write("a.data", bytes("u8", false));
    let (mut read, mut refused, mut in_parts) = (0, 0, 0);
    for round in 0..rounds {
        let mut random = Pcg64::seed_from_u64(seed + round);
        let (name, mut bytes) = corpus[round as usize % corpus.len()].clone();
        mutate(&mut bytes, &mut random);
        folder.write(name, &bytes);
        let read_whole = isostudy_volume::read(&folder.path(name), 1 << 20);
        // What can be read in parts has the same samples, or the same fault.
        if let Ok(unread) = isostudy_volume::open(&folder.path(name))
            && unread.is_raw()
            && unread.memory_bytes() <= 1 << 20
        {
            in_parts += 1;
            match (unread.stored(), &read_whole) {
                (Ok(stored), Ok(volume)) => {
                    let mut values = vec![0.0; volume.values.len()];
                    stored.read_box([0; 3], volume.counts, &mut values).unwrap();
                    let is_same =
                        values.iter().map(|v| v.to_bits()).eq(volume.values.iter().map(|v| v.to_bits()));
                    assert!(is_same, "round {round} of {seed}");
                }
                (Err(of_parts), Err(of_whole)) => {
                    assert_eq!(of_parts.to_string(), of_whole.to_string(), "round {round} of {seed}");
                }
                (Ok(stored), Err(of_whole)) if matches!(*of_whole.problem, Problem::TooLarge { .. }) => {
                    let mut values = vec![0.0; stored.frame().counts.iter().product()];
                    let error = stored.read_box([0; 3], stored.frame().counts, &mut values).unwrap_err();
                    assert!(
                        matches!(*error.problem, Problem::TooLargeHere { .. }),
                        "round {round} of {seed}"
                    );
                }
                (parts, whole) => panic!("round {round} of {seed}: {parts:?}, {whole:?}"),
            }
        }
        match read_whole {
            Ok(volume) => {
                let [x, y, z] = volume.counts;
                assert_eq!(x * y * z, volume.values.len(), "round {round} of {seed}");
                assert!(x * y * z > 0 && volume.origin.iter().all(|v| v.is_finite()));
                assert!(volume.steps.as_flattened().iter().all(|v| v.is_finite()));
                read += 1;
            }
            Err(error) => {
                assert!(error.to_string().len() < 2000, "round {round} of {seed}: {error}");
                refused += 1;
            }
        }
    }
    assert!(read > rounds / 20 && refused > rounds / 20, "{read} read, {refused} refused");
    assert!(in_parts > rounds / 20, "{in_parts} in parts");
}

#[test]
fn damaged_files_are_refused_or_sound() {
    run(5_000, 1);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn many_more_damaged_files_are_refused_or_sound() {
    run(500_000, 1_000_000);
}
