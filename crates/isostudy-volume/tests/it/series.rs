//! Series of volumes in one file with four axes: read in every order, and damaged in every way.

use isostudy_volume::{NO_LIMIT, Problem, UnreadSeries, VolumeSeries, open_series};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::files::*;
use crate::mutated::mutate;

/// Sizes 2, 3, 2 and two frames: as many samples as the volumes have.
fn header(kind: &str, encoding: &str, big_endian: bool, fields: &str) -> String {
    format!(
        "NRRD0004\n# a series, made by hand, with two frames of two by three by two samples\ntype: {}\ndimension: 4\n\
         content: numbers that fit every type\nendian: {}\nencoding: {encoding}\n{fields}key:=value: of no field, and long\n",
        nrrd_type(kind),
        if big_endian { "big" } else { "little" },
    )
}

const LAST: &str = "sizes: 2 3 2 2\nspacings: 1 2 3 0.5\n";
const FIRST: &str = "sizes: 2 2 3 2\nspace: left-posterior-superior\n\
    space directions: none (1,0,0) (0,2,0) (0,0,3)\nspace origin: (7,8,9)\n";
const SECOND: &str = "sizes: 2 2 3 2\nkinds: space time space space\n";

fn write(folder: &Folder, kind: &str, encoding: &str, fields: &str) {
    let head = header(kind, encoding, true, fields);
    let data = encoded(&bytes(kind, true), encoding, kind);
    folder.write("a.nrrd", [head.as_bytes(), b"\n", &data].concat());
}

fn read(folder: &Folder) -> VolumeSeries {
    open_series(&folder.path("a.nrrd")).and_then(|unread| unread.read(NO_LIMIT)).unwrap()
}

#[test]
fn the_axis_of_frames_may_be_any() {
    let folder = Folder::new();
    for kind in TYPES {
        let all = values(kind);
        let every = |step: usize, from: usize, run: usize| -> Vec<f32> {
            all.chunks(step).flat_map(|chunk| chunk[from..from + run].to_vec()).collect()
        };
        for encoding in ["raw", "gzip", "hex", "text"] {
            write(&folder, kind, encoding, LAST);
            let series = read(&folder);
            assert_eq!(series.counts, [2, 3, 2]);
            assert_eq!(series.steps, [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]);
            assert_eq!(series.frames, [all[..12].to_vec(), all[12..].to_vec()]);

            write(&folder, kind, encoding, FIRST);
            let series = read(&folder);
            assert_eq!((series.counts, series.origin), ([2, 3, 2], [7.0, 8.0, 9.0]));
            assert_eq!(series.frames, [every(2, 0, 1), every(2, 1, 1)]);

            write(&folder, kind, encoding, SECOND);
            assert_eq!(read(&folder).frames, [every(4, 0, 2), every(4, 2, 2)]);
        }
    }
}

#[test]
fn what_is_no_series_is_refused_and_the_file_named() {
    let folder = Folder::new();
    let refusal = |fields: &str| {
        write(&folder, "u8", "raw", fields);
        let error = open_series(&folder.path("a.nrrd")).unwrap_err();
        assert_eq!(error.file, folder.path("a.nrrd"));
        error.to_string()
    };
    let colours = refusal(
        "sizes: 3 2 2 2\nkinds: RGB-color space space space\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n",
    );
    assert!(
        colours.ends_with("kinds `rgb-color` is not supported; `time` or `list` is, for the axis of frames"),
        "{colours}"
    );
    let two = refusal("sizes: 2 2 3 2\nspace directions: none none (0,2,0) (0,0,3)\n");
    assert!(two.contains("space directions `none` is not supported"), "{two}");
    assert!(refusal("sizes: 2 2 3\n").contains("3 values for 4 axes"));
    assert!(refusal("sizes: 2 0 3 2\n").contains("every axis needs at least one sample"));
    folder.write("b.nrrd", b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n");
    let flat = open_series(&folder.path("b.nrrd")).unwrap_err().to_string();
    assert!(
        flat.ends_with("sizes `[4, 3, 2]` is not supported; a series in one file has four axes"),
        "{flat}"
    );
    let ending = open_series(&folder.path("b.mha")).unwrap_err().to_string();
    assert!(
        ending.ends_with("ending `mha` is not supported; a series in one file is .nrrd or .nhdr"),
        "{ending}"
    );
    // A volume is still read as one, and a series is not.
    write(&folder, "u8", "raw", LAST);
    assert!(folder.refusal("a.nrrd").contains("three axes longer than 1 are"));
    write(&folder, "u8", "raw", "sizes: 1 4 3 2\n");
    assert!(folder.read("a.nrrd").is_ok());
}

#[test]
fn memory_is_known_before_and_limits_hold() {
    let folder = Folder::new();
    for (fields, bytes) in [(LAST, 4 * 36 + 128), (FIRST, 4 * 48 + 128)] {
        write(&folder, "u8", "raw", fields);
        let open = || -> UnreadSeries { open_series(&folder.path("a.nrrd")).unwrap() };
        assert_eq!((open().memory_bytes(), open().frames(), open().frame().counts), (bytes, 2, [2, 3, 2]));
        let error = open().read(bytes - 1).unwrap_err();
        assert!(
            matches!(*error.problem, Problem::TooManySamples { needed: Some(needed), .. } if needed == bytes)
        );
        assert!(open().read(bytes).is_ok());
    }
}

fn run(rounds: u64, seed: u64) {
    let folder = Folder::new();
    let mut corpus = Vec::new();
    for kind in ["u8", "i16", "f32", "f64"] {
        for encoding in ["raw", "gzip", "hex", "text"] {
            for fields in [LAST, FIRST, SECOND] {
                let data = encoded(&bytes(kind, false), encoding, kind);
                let head = header(kind, encoding, false, fields);
                corpus.push([head.as_bytes(), b"\n", &data].concat());
            }
        }
    }
    let (mut read, mut refused) = (0, 0);
    for round in 0..rounds {
        let mut random = Pcg64::seed_from_u64(seed + round);
        let mut bytes = corpus[round as usize % corpus.len()].clone();
        mutate(&mut bytes, &mut random);
        folder.write("a.nrrd", &bytes);
        match open_series(&folder.path("a.nrrd")).and_then(|unread| unread.read(1 << 20)) {
            Ok(series) => {
                let samples = series.counts.iter().product::<usize>();
                assert!(samples > 0 && !series.frames.is_empty(), "round {round} of {seed}");
                assert!(series.frames.iter().all(|frame| frame.len() == samples), "round {round} of {seed}");
                let numbers = series.origin.iter().chain(series.steps.as_flattened());
                assert!(numbers.into_iter().all(|v| v.is_finite()), "round {round} of {seed}");
                read += 1;
            }
            Err(error) => {
                assert!(error.to_string().len() < 2000, "round {round} of {seed}: {error}");
                refused += 1;
            }
        }
    }
    println!("{read} read, {refused} refused");
    assert!(read > rounds / 20 && refused > rounds / 20, "{read} read, {refused} refused");
}

#[test]
fn damaged_series_are_refused_or_sound() {
    run(5_000, 3);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn many_more_damaged_series_are_refused_or_sound() {
    run(200_000, 3_000_000);
}
