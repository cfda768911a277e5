//! Volumes that do not fit into `--memory` stay in their file: the meshes are the same bytes, and what is wrong with the file is told.

use crate::command::{Folder, Run};
#[cfg(target_os = "linux")]
use crate::memory::{BESIDE, peak};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{MeshFormat, TriangleMesh};
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::process::Stdio;

/// Samples along each axis: no two alike, none a multiple of a brick, and layers enough for slabs of several threads.
const COUNTS: [usize; 3] = [120, 100, 130];
/// Less than the samples take, and enough for parts of them and the mesh.
const LITTLE: &str = "6200kB";
/// What is said where a volume stays in its file.
const SAID: &str = " of them are read from the file";

/// Balls that touch and leave the volume at two sides, brighter inside, with a little noise near their surfaces: whole numbers from 0 to
/// 255.
fn samples() -> Vec<u8> {
    let balls = [
        ([40.0, 45.0, 50.0], 16.0),
        ([58.0, 40.0, 64.0], 11.0),
        ([115.0, 60.0, 20.0], 9.0),
        ([30.0, 3.0, 100.0], 8.0),
    ];
    let mut state = 1u64;
    let [nx, ny, nz] = COUNTS;
    let mut all = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let p = [x as f32, y as f32, z as f32];
                let depth = |(centre, radius): &([f32; 3], f32)| {
                    radius - (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f32>().sqrt()
                };
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let noise = (state >> 60) as f32 - 7.5;
                let most = balls.iter().map(depth).fold(f32::NEG_INFINITY, f32::max);
                all.push((128.0 + 20.0 * most + noise).clamp(0.0, 255.0) as u8);
            }
        }
    }
    all
}

/// A sample as a type has it, the lowest byte first.
fn bytes_of(kind: &str, sample: u8) -> Vec<u8> {
    match kind {
        "u8" => vec![sample],
        "u16" => (u16::from(sample) * 250).to_le_bytes().to_vec(),
        "i16" => ((i16::from(sample) - 128) * 250).to_le_bytes().to_vec(),
        _ => (f32::from(sample) / 3.0 - 40.0).to_le_bytes().to_vec(),
    }
}

/// The level between two samples in the middle of the range.
fn isovalue(kind: &str) -> &'static str {
    match kind {
        "u8" => "127.5",
        "u16" => "31875.25",
        "i16" => "-125.25",
        _ => "2.5",
    }
}

fn data(kind: &str, big_endian: bool, samples: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    for &sample in samples {
        let mut bytes = bytes_of(kind, sample);
        if big_endian {
            bytes.reverse();
        }
        all.extend(bytes);
    }
    all
}

fn nrrd(kind: &str, big_endian: bool, more: &str) -> String {
    let [x, y, z] = COUNTS;
    let endian = if big_endian { "big" } else { "little" };
    let kind = match kind {
        "u8" => "uchar",
        "u16" => "ushort",
        "i16" => "short",
        _ => "float",
    };
    format!(
        "NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {x} {y} {z}\nendian: {endian}\nencoding: raw\n{more}"
    )
}

/// The plain volume of bytes.
fn plain(folder: &Folder) {
    folder.write("plain.nrrd", [nrrd("u8", false, "\n").as_bytes(), &samples()].concat());
}

/// Extracts in memory and in parts, and compares bytes.
fn assert_same(folder: &Folder, arguments: &[&str], parts: &str) {
    assert_same_within(folder, arguments, parts, &[LITTLE]);
}

/// The same within the first of some limits that is enough for the mesh. None of them is enough for the samples.
fn assert_same_within(folder: &Folder, arguments: &[&str], parts: &str, limits: &[&str]) {
    let whole = folder.succeed(&[arguments, &["-o", "whole.ply"]].concat());
    assert!(!whole.stderr.contains(SAID), "{arguments:?}: {}", whole.stderr);
    let within = |limit| folder.run(&[arguments, &["-o", "parts.ply", "--memory", limit]].concat());
    let is_enough = |run: &Run| !run.stderr.contains("that are left beside");
    let little = limits.iter().map(|limit| within(limit)).find(is_enough).expect("memory for the mesh");
    assert_eq!(little.code, Some(0), "{arguments:?}: {}", little.stderr);
    let said = format!(": {parts}{SAID}");
    assert_eq!(little.stderr.matches(&said).count(), 1, "{arguments:?}: {}", little.stderr);
    let [whole, parts] = ["whole.ply", "parts.ply"].map(|name| fs::read(folder.path(name)).unwrap());
    assert!(whole == parts, "{arguments:?}: {} and {} bytes", whole.len(), parts.len());
    assert!(whole.len() > 50_000, "{arguments:?}: {} bytes", whole.len());
    fs::remove_file(folder.path("parts.ply")).unwrap();
}

#[test]
fn methods_make_the_same_bytes_of_parts() {
    let folder = Folder::of("extract");
    plain(&folder);
    for (method, parts) in [
        ("mc", "layers"),
        ("mc33", "layers"),
        ("nets", "layers"),
        ("nets-manifold", "layers"),
        ("snapmc", "layers"),
        ("continued", "layers"),
        ("bi", "bricks"),
        ("si", "bricks"),
        ("si-relaxed", "bricks"),
        ("dc-in-cell", "bricks"),
        ("macet", "bricks"),
    ] {
        let threads = if method.len() % 2 == 0 { "1" } else { "3" };
        let asked =
            ["--volume", "plain.nrrd", "--isovalue", "127.5", "--threads", threads, "--method", method];
        assert_same(&folder, &asked, parts);
    }
}

#[test]
fn types_orders_and_headers_make_the_same_bytes_of_parts() {
    let folder = Folder::of("extract");
    let samples = samples();
    let methods = ["mc33", "bi", "nets", "si"];
    for (i, kind) in ["u8", "u16", "i16", "f32"].into_iter().enumerate() {
        for big_endian in [false, true] {
            if kind == "u8" && big_endian {
                continue;
            }
            let data = data(kind, big_endian, &samples);
            // In the header's own file or another, behind lines or bytes, or at the end of it.
            let spaced = "spacings: 0.5 0.75 1.25\naxis mins: -3 4 1000\n";
            folder
                .write("a.nrrd", [nrrd(kind, big_endian, &format!("{spaced}\n")).as_bytes(), &data].concat());
            folder.write("b.nhdr", nrrd(kind, big_endian, "line skip: 1\nbyte skip: 7\ndata file: b.data\n"));
            folder.write("b.data", [&b"a line\n1234567"[..], &data].concat());
            folder.write("c.nhdr", nrrd(kind, big_endian, "byte skip: -1\ndata file: b.data\n"));
            let [x, y, z] = COUNTS;
            let endian = if big_endian { "big" } else { "little" };
            folder.write(
                "d.toml",
                format!("file = 'b.data'\nsize = [{x}, {y}, {z}]\ntype = '{kind}'\nendian = '{endian}'\nskip_bytes = 14\norigin = [5, 6, 7]\n"),
            );
            let method = methods[(i + usize::from(big_endian)) % 4];
            let name = ["a.nrrd", "b.nhdr", "c.nhdr", "d.toml"][(i + 2 * usize::from(big_endian)) % 4];
            let parts = if method.len() == 2 { "bricks" } else { "layers" };
            for (name, method, parts) in [(name, method, parts), ("a.nrrd", "mc", "layers")] {
                let asked =
                    ["--volume", name, "--isovalue", isovalue(kind), "--method", method, "--threads", "2"];
                assert_same(&folder, &asked, parts);
            }
        }
    }
}

#[test]
fn boxes_walls_and_turned_axes_make_the_same_bytes_of_parts() {
    let folder = Folder::of("extract");
    let samples = samples();
    let of = |directions: &str| {
        let more = format!("space dimension: 3\nspace directions: {directions}\nspace origin: (3,-2,10)\n\n");
        [nrrd("u8", false, &more).as_bytes(), &samples].concat()
    };
    plain(&folder);
    folder.write("turned.nrrd", of("(0.6,0.8,0) (-0.8,0.6,0) (0,0,1)"));
    folder.write("mirrored.nrrd", of("(0,-1,0) (0.75,0,0) (0,0,-1.25)"));
    let cases: [(&[&str], &str); 9] = [
        (&["--volume", "plain.nrrd", "--close", "--method", "mc33"], "bricks"),
        (&["--volume", "plain.nrrd", "--method", "bi", "--inside", "below"], "bricks"),
        (&["--volume", "plain.nrrd", "--inside", "below", "--method", "nets"], "layers"),
        (&["--volume", "plain.nrrd", "--cells", "60", "--method", "nets-manifold"], "bricks"),
        (&["--volume", "plain.nrrd", "--bounds=10.3,10,10,100,71.7,91", "--method", "si"], "bricks"),
        (&["--volume", "turned.nrrd", "--method", "bi"], "bricks"),
        (&["--volume", "turned.nrrd", "--method", "mc33"], "layers"),
        (&["--volume", "mirrored.nrrd", "--method", "si", "--close"], "bricks"),
        (&["--volume", "mirrored.nrrd", "--method", "nets-manifold"], "layers"),
    ];
    for (i, (case, parts)) in cases.into_iter().enumerate() {
        let threads = ["1", "2", "4"][i % 3];
        assert_same(&folder, &[case, &["--isovalue", "127.5", "--threads", threads]].concat(), parts);
    }
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn every_method_makes_the_same_bytes_of_parts_or_says_which_do() {
    let folder = Folder::of("extract");
    plain(&folder);
    let mut refused = 0;
    for preset in isostudy_extract::presets() {
        let grids: &[&[&str]] = &[&[], &["--close"], &["--cells", "70"]];
        for grid in grids {
            let asked =
                ["--volume", "plain.nrrd", "--isovalue", "127.5", "--threads", "2", "--method", preset.id];
            let asked = [&asked[..], grid].concat();
            if preset.id.ends_with("-published") {
                let said = folder.run(&[&asked[..], &["-o", "parts.ply", "--memory", LITTLE]].concat());
                assert_eq!(said.code, Some(2), "{}: {}", preset.id, said.stderr);
                let names = "take one that keeps a few layers, such as mc, mc33, nets, nets-manifold, snapmc, bi or si";
                assert!(said.stderr.contains(names), "{}", said.stderr);
                refused += 1;
                continue;
            }
            let is_of_cubes = preset.method.is_of_cubes() && grid.is_empty();
            let parts = if is_of_cubes { "layers" } else { "bricks" };
            // Some have more layers, or collapse edges, for which they need more.
            assert_same_within(&folder, &asked, parts, &[LITTLE, "6700kB", "7200kB", "8200kB", "9200kB"]);
        }
    }
    assert!(refused > 0);
}

#[test]
fn a_method_that_keeps_its_lattice_is_refused_with_those_that_do_not() {
    let folder = Folder::of("extract");
    plain(&folder);
    let said = folder.run(&[
        "--volume",
        "plain.nrrd",
        "--isovalue",
        "127.5",
        "--method",
        "bi-published",
        "-o",
        "a.ply",
        "--memory",
        LITTLE,
    ]);
    assert_eq!(said.code, Some(2), "{}", said.stderr);
    for part in
        ["for bricks of 120 x 100 x 130 samples", "take one that keeps a few layers, such as mc, mc33, nets"]
    {
        assert!(said.stderr.contains(part), "{}", said.stderr);
    }
    assert!(!said.stderr.contains(SAID) && !folder.path("a.ply").exists(), "{}", said.stderr);
}

/// Several surfaces; the report, whose distances read bricks of the file; a surface that is not there.
#[test]
fn reports_and_several_isovalues_are_those_of_memory() {
    let folder = Folder::of("extract");
    plain(&folder);
    for (method, grid) in [("mc33", "--threads=2"), ("bi", "--cells=60")] {
        let asked = ["--volume", "plain.nrrd", "--isovalues", "100.5,127.5,254.5", "--method", method, grid];
        folder.succeed(&[&asked[..], &["-o", "whole-{isovalue}.ply"]].concat());
        let said =
            folder.succeed(&[&asked[..], &["-o", "parts-{isovalue}.ply", "--memory", LITTLE]].concat());
        assert!(said.stderr.contains(SAID), "{}", said.stderr);
        for isovalue in ["100.5", "127.5", "254.5"] {
            let of = |kind: &str| fs::read(folder.path(&format!("{kind}-{isovalue}.ply"))).unwrap();
            assert!(of("whole") == of("parts"), "{method} at {isovalue}");
        }
        let report = |more: &[&str]| {
            let asked = [
                "--volume",
                "plain.nrrd",
                "--isovalue",
                "127.5",
                "--json",
                "-o",
                "a.ply",
                "--method",
                method,
                grid,
            ];
            let said = folder.succeed(&[&asked[..], more].concat());
            let mut report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
            report["extraction_s"] = 0.into();
            report
        };
        assert_eq!(report(&[]), report(&["--memory", LITTLE]), "{method}");
        let none =
            ["--volume", "plain.nrrd", "--isovalue", "300", "-o", "none.ply", "--method", method, grid];
        let [whole, parts] = [folder.run(&none), folder.run(&[&none[..], &["--memory", LITTLE]].concat())];
        assert_eq!((whole.code, parts.code), (Some(2), Some(2)));
        assert!(whole.stderr.contains("; the volume's samples run from 0 to 255"), "{}", whole.stderr);
        assert!(parts.stderr.ends_with(&whole.stderr), "{}", parts.stderr);
        let none = [
            "--volume",
            "plain.nrrd",
            "--isovalues",
            "300,400",
            "-o",
            "n-{isovalue}.ply",
            "--method",
            method,
            grid,
        ];
        let [whole, parts] = [folder.run(&none), folder.run(&[&none[..], &["--memory", LITTLE]].concat())];
        assert!(
            whole.code == Some(2) && parts.code == Some(2) && parts.stderr.ends_with(&whole.stderr),
            "{}",
            parts.stderr
        );
    }
}

/// As in memory: before a sample is read.
#[test]
fn files_that_do_not_hold_their_samples_are_refused() {
    let folder = Folder::of("extract");
    let samples = samples();
    let header = nrrd("u8", false, "data file: a.data\n");
    folder.write("a.nhdr", &header);
    for (data, said) in [
        (Some(&samples[..700_000]), "a.data: the data ends after 700000 of 1560000 samples"),
        (Some(&[&samples[..], &[0]].concat()[..]), "a.data: there is more data than the 1560000 samples"),
        (None, "a.data: No such file"),
    ] {
        match data {
            Some(data) => folder.write("a.data", data),
            None => fs::remove_file(folder.path("a.data")).unwrap(),
        }
        for method in ["mc", "bi"] {
            let run = folder.run(&[
                "--volume",
                "a.nhdr",
                "--isovalue",
                "1",
                "--method",
                method,
                "-o",
                "a.ply",
                "--memory",
                LITTLE,
            ]);
            assert!(run.code == Some(2) && run.stderr.contains(said), "{}", run.stderr);
            assert!(!folder.path("a.ply").exists());
        }
    }
}

/// A volume of bytes without a hole on the disk where nothing is written: a ball.
fn sparse_ball(path: &Path, side: usize, centre: [f32; 3], radius: f32) {
    let file = File::create(path).unwrap();
    let header =
        format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {side} {side} {side}\nencoding: raw\n\n");
    file.write_all_at(header.as_bytes(), 0).unwrap();
    file.set_len(header.len() as u64 + (side as u64).pow(3)).unwrap();
    let reach = radius + 17.0;
    let range =
        |k: usize| (centre[k] - reach).max(0.0) as usize..((centre[k] + reach) as usize + 1).min(side);
    for z in range(2) {
        for y in range(1) {
            let row: Vec<u8> = range(0)
                .map(|x| {
                    let p = [x as f32, y as f32, z as f32];
                    let away = (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f32>().sqrt();
                    (128.0 + 8.0 * (radius - away)).clamp(0.0, 255.0) as u8
                })
                .collect();
            let sample = ((z * side + y) * side + range(0).start) as u64;
            file.write_all_at(&row, header.len() as u64 + sample).unwrap();
        }
    }
}

/// What is asked is done when the line that says so is there; a file as large takes longer than to change it.
fn changed_meanwhile(method: &str, change: fn(&File)) {
    for side in [400, 600, 900] {
        let folder = Folder::new();
        sparse_ball(&folder.path("ball.nrrd"), side, [200.0; 3], 50.0);
        let mut command = folder.isostudy();
        command.args(["extract", "--volume", "ball.nrrd", "--isovalue", "127.5", "--method", method]);
        command.args(["--threads", "1", "--memory", "100MB", "-o", "ball.ply"]);
        let mut child =
            command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let said = lines.next().unwrap().unwrap();
        assert!(said.contains(SAID), "{said}");
        change(&OpenOptions::new().write(true).open(folder.path("ball.nrrd")).unwrap());
        let rest: Vec<String> = lines.map(Result::unwrap).collect();
        let code = child.wait().unwrap().code();
        if code == Some(0) {
            // It was done before.
            continue;
        }
        assert_eq!(code, Some(2), "{method}: {rest:?}");
        let [error] = &rest[..] else { panic!("{rest:?}") };
        assert!(
            error.contains("ball.nrrd: the samples from [") && error.contains("] on: the file changed"),
            "{error}"
        );
        let names: Vec<_> =
            fs::read_dir(folder.root()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert!(!names.iter().any(|name| name.to_string_lossy().contains("ply")), "{names:?}");
        return;
    }
    panic!("{method}: no file was changed in time");
}

#[test]
fn a_file_that_changes_meanwhile_is_an_error_and_leaves_nothing() {
    for method in ["nets", "bi"] {
        changed_meanwhile(method, |file| file.set_len(1_000_000).unwrap());
        changed_meanwhile(method, |file| file.write_all_at(&[7], 30_000_000).unwrap());
    }
}

/// In an ordinary test: a volume of 31 MB in memory within 8 MB.
#[cfg(target_os = "linux")]
#[test]
fn a_volume_in_its_file_is_held_to_its_limit() {
    let folder = Folder::new();
    sparse_ball(&folder.path("ball.nrrd"), 200, [90.0, 100.0, 110.0], 30.0);
    for method in ["mc33", "nets-manifold", "bi", "si"] {
        let asked = ["--volume", "ball.nrrd", "--isovalue", "127.5", "--method", method, "--threads", "2"];
        let (code, said, most) =
            peak(&folder, &[&asked[..], &["--memory", "8MB", "-o", "ball.ply"]].concat());
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains(SAID) && most > 0 && most < 8_000_000 + BESIDE, "{method}: {most}; {said}");
    }
}

fn mesh_of(folder: &Folder, name: &str) -> TriangleMesh {
    MeshFormat::from_extension("ply").unwrap().read(&*fs::read(folder.path(name)).unwrap()).unwrap()
}

/// A volume of so many samples a side within so many bytes. The ball lies where 32-bit numbers of samples have overflowed. Its mesh is that
/// of the same ball in a small volume, moved; and the same bytes as in memory, if that is to be tried.
#[cfg(target_os = "linux")]
fn large_volume(side: usize, memory: &str, bytes: u64, in_memory: bool) {
    let folder = Folder::new();
    let (radius, small) = (90.0, 256);
    let low = side - small;
    let centre = |side: usize| [side as f32 - 125.25, side as f32 - 130.5, side as f32 - 128.75];
    sparse_ball(&folder.path("ball.nrrd"), side, centre(side), radius);
    sparse_ball(&folder.path("small.nrrd"), small, centre(small), radius);
    for method in ["mc", "mc33", "nets", "nets-manifold", "bi", "si"] {
        let asked = |name: &'static str| ["--volume", name, "--isovalue", "127.5", "--method", method];
        let begin = std::time::Instant::now();
        let (code, said, most) =
            peak(&folder, &[&asked("ball.nrrd")[..], &["--memory", memory, "-o", "ball.ply"]].concat());
        assert_eq!(code, Some(0), "{method}: {said}");
        println!("{side} {method}: {} MB, {:.1} s; {said}", most / 1_000_000, begin.elapsed().as_secs_f64());
        assert!(said.contains(SAID) && most <= bytes, "{method}: {most} bytes; {said}");
        Run::succeed(folder.isostudy().arg("extract").args(asked("small.nrrd")).args(["-o", "small.ply"]));
        let [found, wanted] = ["ball.ply", "small.ply"].map(|name| mesh_of(&folder, name));
        assert!(topology(&found).is_closed_manifold(), "{method}");
        assert_eq!(found.triangles.len(), wanted.triangles.len(), "{method}");
        // Elsewhere coordinates are rounded otherwise, and of two diagonals that are as long another one is taken.
        assert!(!method.starts_with("mc") || found.triangles == wanted.triangles, "{method}");
        let (low, off) = (glam::Vec3::splat(low as f32), 1e-3);
        let is_near = |(a, b): (&glam::Vec3, &glam::Vec3)| (*a - *b - low).abs().max_element() < off;
        assert!(found.positions.iter().zip(&wanted.positions).all(is_near), "{method}");
        if in_memory {
            let more = ["--memory", "16GiB", "-o", "whole.ply"];
            let said = Run::succeed(folder.isostudy().arg("extract").args(asked("ball.nrrd")).args(more));
            assert!(!said.stderr.contains(SAID), "{}", said.stderr);
            let of = |name: &str| fs::read(folder.path(name)).unwrap();
            assert!(of("whole.ply") == of("ball.ply"), "{method}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "minutes: run by make test-long"]
fn a_volume_of_1024_samples_a_side_takes_a_gigabyte() {
    large_volume(1024, "1GB", 1_000_000_000, true);
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "minutes: run by make test-long"]
fn a_volume_of_2048_samples_a_side_takes_two_gigabytes() {
    large_volume(2048, "2GB", 2_000_000_000, false);
}
