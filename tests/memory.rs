//! What takes memory has a limit, which is held before samples are read and while a mesh grows.

use crate::command::{Folder, Run, isostudy};
use crate::fixture::Fixture;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// A header of 1024 x 1024 x 1024 samples, 4 GiB of them in memory, whose data file is not there: whoever looks for it says so. The data is
/// compressed, so that no part of it could be read by itself.
const HEADER: &str =
    "size = [1024, 1024, 1024]\ntype = \"f32\"\nfile = \"nowhere.raw\"\nencoding = \"gzip\"\n";
const NRRD: &str = "NRRD0004\ntype: float\ndimension: 3\nsizes: 1024 1024 1024\nendian: little\nencoding: gzip\n\
                    data file: nowhere.raw\n";
const META: &str = "NDims = 3\nDimSize = 1024 1024 1024\nElementType = MET_FLOAT\nCompressedData = True\n\
                    ElementDataFile = nowhere.raw\n";
/// How every refusal says it.
const SAMPLES: &str = "4.0 GiB for 1024 x 1024 x 1024 samples, four bytes each";

fn headers(folder: &Folder) {
    for (name, text) in [("a.toml", HEADER), ("a.nhdr", NRRD), ("a.mhd", META)] {
        folder.write(name, text);
    }
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

/// Refused with the number, the limit and who sets it; where the limit is larger, the data is looked for.
#[test]
fn what_does_not_fit_is_refused_from_the_header() {
    let extract = Folder::of("extract");
    headers(&extract);
    let at = |word: &'static str| ["--isovalue", word, "-o", "a.ply"].to_vec();
    let several = ["--isovalues", "1,2", "-o", "a-{isovalue}.ply"].to_vec();
    let ways = [
        at("0.5"),
        [at("0.5"), vec!["--method", "bi"]].concat(),
        [at("0.5"), vec!["--close"]].concat(),
        [at("0.5"), vec!["--cells", "20"]].concat(),
        several.clone(),
        [several, vec!["--method", "bi"]].concat(),
    ];
    for (way, name) in ways.iter().flat_map(|way| ["a.toml", "a.nhdr", "a.mhd"].map(|name| (way, name))) {
        let said = refused(&extract, &[&["--volume", name], &way[..]].concat(), name);
        assert!(
            said.contains(". If the file is raw, and not compressed, only parts of it are in memory"),
            "{said}"
        );
    }
    refused(&extract, &["--labels", "a.nhdr", "-o", "a.ply"], "a.nhdr");
    let others = [
        ("verify", vec!["a.obj", "--volume", "a.nhdr", "--isovalue", "1"]),
        ("distance", vec!["a.obj", "--volume", "a.nhdr", "--isovalue", "1"]),
    ];
    for (command, arguments) in others {
        let folder = Folder::of(command);
        headers(&folder);
        refused(&folder, &arguments, "a.nhdr");
    }
}

fn refused(folder: &Folder, arguments: &[&str], name: &str) -> String {
    let said = folder.run(&[arguments, &["--memory", "4.0625GiB"]].concat());
    assert_eq!(said.code, Some(2), "{arguments:?}: {}", said.stderr);
    for part in [name, " of memory are needed: ", SAMPLES, "; --memory allows 4.0 GiB"] {
        // A machine with less says so.
        let is_there = said.stderr.contains(part)
            || part.contains("allows") && said.stderr.contains("; this machine has ");
        assert!(is_there, "{arguments:?}: {part} is not in {}", said.stderr);
    }
    assert!(!said.stderr.contains("nowhere.raw"), "{arguments:?}: {}", said.stderr);
    said.stderr
}

/// The same sentence, with another limit, before anything is made.
#[test]
fn a_study_is_refused_from_the_header() {
    let fixture = Fixture::new();
    fixture.edit(
        "field = { kind = \"sphere\", radius = 1.0 }",
        "field = { kind = \"volume\", file = \"a.toml\" }",
    );
    fixture.edit("memory_gib = 8.0", "memory_gib = 4.0");
    std::fs::write(fixture.folder().join("a.toml"), HEADER).unwrap();
    for run in [fixture.run("study", &[]), Run::of(isostudy().arg("validate").arg(fixture.config()))] {
        assert_eq!(run.code, Some(2), "{}", run.stderr);
        for part in ["objects[0]", " of memory are needed: ", SAMPLES, "; limits.memory_gib allows 4.0 GiB"] {
            assert!(run.stderr.contains(part), "{part} is not in {}", run.stderr);
        }
        assert!(!run.stderr.contains("nowhere.raw"), "{}", run.stderr);
    }
    assert!(!fixture.out().exists());
}

/// What a process may hold beside what `--memory` counts.
pub(crate) const BESIDE: u64 = 64 << 20;

/// A run of `isostudy extract`, and the most memory that was resident, in bytes.
#[cfg(target_os = "linux")]
pub(crate) fn peak(folder: &Folder, arguments: &[&str]) -> (Option<i32>, String, u64) {
    let mut command = folder.isostudy();
    command.arg("extract").args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    // It never falls. What is looked for comes long before the end: normals are made before a file is written.
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(&status).unwrap_or_default();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        most = peak.map_or(most, |kib| kib.parse::<u64>().unwrap() << 10);
        std::thread::sleep(Duration::from_micros(500));
    }
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap(), most)
}

/// Random bytes: nearly every cell is crossed, so the mesh is many times as large as the volume.
fn noise(path: &Path, side: u64) {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    let header =
        format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {side} {side} {side}\nencoding: raw\n\n");
    let samples: Vec<u8> = (0..side.pow(3)).map(|_| next()).collect();
    std::fs::write(path, [header.as_bytes(), &samples].concat()).unwrap();
}

/// Looks for the least limit that is enough. Whatever the limit is, either the mesh is the same bytes, or the run ends with the number
/// and without a file; and no more memory is resident than the limit and [`BESIDE`].
#[cfg(target_os = "linux")]
fn limits_hold(folder: &Folder, method: &str, threads: &str) {
    let run = |limit: u64, out: &str| {
        let limit = limit.to_string();
        let asked =
            ["--volume", "noise.nrrd", "--isovalue", "127.5", "--method", method, "--threads", threads];
        peak(folder, &[&asked[..], &["--memory", &limit, "-o", out]].concat())
    };
    let (code, said, most) = run(8 << 30, "whole.ply");
    assert_eq!(code, Some(0), "{method}: {said}");
    assert!(most > 0);
    let whole = std::fs::read(folder.path("whole.ply")).unwrap();
    let (mut low, mut high) = (1 << 20, most + BESIDE);
    let mut refused_in_the_mesh = 0;
    while high - low > 2 << 20 {
        let limit = low.midpoint(high);
        let (code, said, most) = run(limit, "a.ply");
        assert!(most <= limit + BESIDE, "{method} within {limit}: {most} bytes were resident; {said}");
        if code == Some(0) {
            assert!(std::fs::read(folder.path("a.ply")).unwrap() == whole, "{method} within {limit}");
            std::fs::remove_file(folder.path("a.ply")).unwrap();
            high = limit;
        } else {
            assert_eq!(code, Some(2), "{method} within {limit}: {said}");
            assert!(said.contains("--memory allows ") && !folder.path("a.ply").exists(), "{method}: {said}");
            refused_in_the_mesh += u32::from(said.contains("that are left beside"));
            low = limit;
        }
    }
    assert!(refused_in_the_mesh > 0, "{method}: the mesh never grew beyond the limit");
}

#[cfg(target_os = "linux")]
#[test]
fn a_mesh_grows_no_larger_than_its_limit() {
    let folder = Folder::new();
    noise(&folder.path("noise.nrrd"), 64);
    for (method, threads) in [("mc33", "1"), ("nets", "2"), ("bi", "2"), ("bi-relaxed", "1")] {
        limits_hold(&folder, method, threads);
    }
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "minutes: run by make test-long"]
fn no_method_holds_more_than_its_limit() {
    let folder = Folder::new();
    noise(&folder.path("noise.nrrd"), 96);
    for preset in isostudy_extract::presets() {
        limits_hold(&folder, preset.id, "2");
        println!("{}: held", preset.id);
    }
}
