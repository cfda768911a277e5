//! Parts of a volume in a file are those of the whole, in every way that is read; a file that changes is an error with its place.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::FileExt;
use std::time::Duration;

use crate::files::*;
use isostudy_volume::{Problem, Stored, Volume, VolumeError};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn stored(folder: &Folder, name: &str) -> Result<Stored, VolumeError> {
    isostudy_volume::open(&folder.path(name))?.stored()
}

/// The samples of a box out of all.
fn of_whole(whole: &Volume, first: [usize; 3], size: [usize; 3]) -> Vec<f32> {
    let [nx, ny, _] = whole.counts;
    let mut values = Vec::new();
    for z in first[2]..first[2] + size[2] {
        for y in first[1]..first[1] + size[1] {
            values.extend_from_slice(&whole.values[(z * ny + y) * nx + first[0]..][..size[0]]);
        }
    }
    values
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Every box, or so many random ones, is that of the whole.
fn assert_boxes_agree(folder: &Folder, name: &str, boxes: Option<u64>) {
    let whole = folder.read(name).unwrap_or_else(|error| panic!("{error}"));
    let stored = stored(folder, name).unwrap();
    let frame = stored.frame();
    assert_eq!(
        (frame.counts, frame.origin, frame.steps),
        (whole.counts, whole.origin, whole.steps),
        "{name}"
    );
    let same = |first: [usize; 3], size: [usize; 3]| {
        let mut values = vec![7.5; size.iter().product()];
        stored.read_box(first, size, &mut values).unwrap();
        assert!(bits(&values) == bits(&of_whole(&whole, first, size)), "{name}: {size:?} from {first:?} on");
    };
    match boxes {
        Some(count) => {
            let mut random = Pcg64::seed_from_u64(1);
            for _ in 0..count {
                let first = whole.counts.map(|n| random.random_range(0..n));
                same(first, [0, 1, 2].map(|k| random.random_range(1..=whole.counts[k] - first[k])));
            }
            same([0; 3], whole.counts);
        }
        None => {
            let ranges =
                |n: usize| (0..n).flat_map(move |first| (0..=n - first).map(move |size| [first, size]));
            for [x, nx] in ranges(whole.counts[0]) {
                for [y, ny] in ranges(whole.counts[1]) {
                    ranges(whole.counts[2]).for_each(|[z, nz]| same([x, y, z], [nx, ny, nz]));
                }
            }
        }
    }
}

#[test]
fn every_box_of_every_raw_file_is_that_of_the_whole() {
    let folder = Folder::new();
    for kind in TYPES {
        for big_endian in [false, true] {
            let data = bytes(kind, big_endian);
            let header = nrrd_header(kind, "raw", big_endian);
            folder.write("a.nrrd", [header.as_bytes(), b"\n", &data].concat());
            folder.write("b.nhdr", format!("{header}data file: b.data\n"));
            folder.write("b.data", &data);
            folder.write("c.nhdr", format!("{header}line skip: 2\nbyte skip: 3\ndata file: c.data\n"));
            folder.write("c.data", [&b"one\ntwo\nabc"[..], &data].concat());
            folder.write("d.nhdr", format!("{header}byte skip: -1\ndata file: c.data\n"));
            let meta = meta_header(kind, "raw", big_endian);
            folder.write("a.mha", [meta.as_bytes(), b"ElementDataFile = LOCAL\n", &data].concat());
            folder.write("b.mhd", format!("{meta}HeaderSize = -1\nElementDataFile = c.data\n"));
            let endian = if big_endian { "big" } else { "little" };
            folder.write(
                "a.toml",
                format!("size = [4, 3, 2]\ntype = '{kind}'\nendian = '{endian}'\nskip_bytes = 11\nfile = 'c.data'\n"),
            );
            for name in ["a.nrrd", "b.nhdr", "c.nhdr", "d.nhdr", "a.mha", "b.mhd", "a.toml"] {
                assert_boxes_agree(&folder, name, None);
            }
        }
    }
}

/// Rows that are read one by one, some together, and in pieces.
#[test]
fn boxes_of_short_and_of_long_rows_are_those_of_the_whole() {
    let folder = Folder::new();
    let mut random = Pcg64::seed_from_u64(2);
    for (kind, size) in
        [("u8", [50, 40, 9]), ("i16", [1500, 21, 3]), ("f32", [40_000, 3, 2]), ("f64", [9001, 2, 3])]
    {
        let width = [("u8", 1), ("i16", 2), ("f32", 4), ("f64", 8)].iter().find(|of| of.0 == kind).unwrap().1;
        // Any bytes: of the floating types too, which then are not numbers, or too large. Those are another test's.
        let data: Vec<u8> = (0..size.iter().product::<usize>() * width)
            .map(|i| if kind.starts_with('f') && i % width == width - 1 { 0x3f } else { random.random() })
            .collect();
        folder.write("a.raw", &data);
        folder.write("a.toml", format!("size = {size:?}\ntype = '{kind}'\n"));
        assert_boxes_agree(&folder, "a.raw", Some(60));
    }
}

#[test]
fn what_is_not_raw_has_no_parts() {
    let folder = Folder::new();
    for (encoding, is_raw) in [("raw", true), ("gzip", false), ("hex", false), ("text", false)] {
        let header = nrrd_header("u8", encoding, false);
        let data = encoded(&bytes("u8", false), encoding, "u8");
        folder.write("a.nrrd", [header.as_bytes(), b"\n", &data].concat());
        assert_eq!(isostudy_volume::open(&folder.path("a.nrrd")).unwrap().is_raw(), is_raw);
        if !is_raw {
            let said = stored(&folder, "a.nrrd").unwrap_err().to_string();
            let want = format!("a.nrrd: encoding `{encoding}` is not supported; raw is, to read parts");
            assert!(said.ends_with(&want), "{said}");
        }
    }
}

/// The same sentences as of the whole, before a sample is read.
#[test]
fn a_file_of_another_length_is_refused_when_it_is_opened() {
    let folder = Folder::new();
    let header = nrrd_header("i16", "raw", false);
    let data = bytes("i16", false);
    for length in (0..data.len()).chain([data.len() + 1, data.len() + 50]) {
        let mut other = data.clone();
        other.resize(length, 0);
        folder.write("a.nrrd", [header.as_bytes(), b"\n", &other].concat());
        folder.write("b.nhdr", format!("{header}byte skip: 5\ndata file: b.data\n"));
        folder.write("b.data", [&b"abcde"[..], &other].concat());
        folder.write("c.nhdr", format!("{header}byte skip: 99999999999999\ndata file: b.data\n"));
        for name in ["a.nrrd", "b.nhdr", "c.nhdr"] {
            let (said, of_whole) = (stored(&folder, name).unwrap_err(), folder.read(name).unwrap_err());
            assert_eq!(said.to_string(), of_whole.to_string(), "{length}");
        }
    }
    folder.write("a.nrrd", format!("{header}data file: nowhere.raw\n"));
    let said = stored(&folder, "a.nrrd").unwrap_err();
    assert!(said.file.ends_with("nowhere.raw") && matches!(*said.problem, Problem::Io(_)), "{said}");
}

#[test]
fn doubles_beyond_single_precision_are_counted_with_their_place() {
    let folder = Folder::new();
    let numbers = [0.0, 1e300, f64::INFINITY, -1e39, f64::NAN, 3.4e38, f64::NEG_INFINITY, 1e-300];
    folder.write("a.raw", numbers.map(f64::to_le_bytes).concat());
    folder.write("a.toml", "size = [2, 2, 2]\ntype = 'f64'\n");
    let stored = stored(&folder, "a.toml").unwrap();
    let mut values = [0.0; 4];
    let problem = stored.read_box([0; 3], [2, 2, 1], &mut values).unwrap_err();
    assert!(
        problem.to_string().contains("a.raw: 1 of the samples from [0, 0, 0] on are beyond 3.4028235e38"),
        "{problem}"
    );
    let problem = stored.read_box([1, 1, 0], [1, 1, 1], &mut values[..1]).unwrap_err();
    assert!(problem.to_string().contains("a.raw: 1 of the samples from [1, 1, 0] on are"), "{problem}");
    stored.read_box([0, 0, 1], [2, 2, 1], &mut values).unwrap();
    assert!(values[0].is_nan() && values[1..] == [3.4e38, f32::NEG_INFINITY, 0.0], "{values:?}");
}

#[test]
fn a_file_that_changes_is_an_error_with_its_place() {
    type Change = fn(&File);
    let changes: [(Change, &str); 3] = [
        (|file| file.set_len(20).unwrap(), ": it had 24 bytes and has 20"),
        (|file| file.set_len(30).unwrap(), ": it had 24 bytes and has 30"),
        (|file| file.write_all_at(b"\x07", 3).unwrap(), ""),
    ];
    for (change, lengths) in changes {
        let folder = Folder::new();
        folder.write("a.raw", bytes("u8", false));
        folder.write("a.toml", "size = [4, 3, 2]\ntype = 'u8'\n");
        let stored = stored(&folder, "a.toml").unwrap();
        let mut values = [0.0; 12];
        stored.read_box([0, 0, 0], [4, 3, 1], &mut values).unwrap();
        let file = OpenOptions::new().write(true).open(folder.path("a.raw")).unwrap();
        let later = file.metadata().unwrap().modified().unwrap() + Duration::from_secs(2);
        change(&file);
        file.set_modified(later).unwrap();
        let error = stored.read_box([1, 0, 1], [3, 3, 1], &mut values[..9]).unwrap_err();
        let want =
            format!("a.raw: the samples from [1, 0, 1] on: the file changed while it was read{lengths}");
        assert!(error.to_string().ends_with(&want), "{error}");
    }
}

#[test]
fn several_threads_read_at_once() {
    let folder = Folder::new();
    let mut random = Pcg64::seed_from_u64(3);
    let size = [37, 29, 23];
    folder.write(
        "a.raw",
        (0..2 * size.iter().product::<usize>()).map(|_| random.random()).collect::<Vec<u8>>(),
    );
    folder.write("a.toml", format!("size = {size:?}\ntype = 'u16'\nendian = 'big'\n"));
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_boxes_agree(&folder, "a.toml", Some(100)));
        }
    });
}
