//! Surfaces of points and of polygon soup: by `isostudy extract`, in a study from its file to its report, and what is said of bad files.

use crate::command::{Folder, Run};
use isostudy_mesh::read_ply;
use isostudy_mesh::topology::{TopologyReport, topology};
use std::fs;
use std::path::Path;

const STUDY: &str = include_str!("scattered/study.toml");
const BOX: &str = "--bounds=-1.25,-1.25,-1.25,1.25,1.25,1.25";

/// So many points of the unit ball in a spiral, each with the normal of the ball; the cap on top is missing.
fn spiral(count: i32) -> Vec<[f64; 3]> {
    let point = |i: i32| {
        let z = 1.0 - f64::from(2 * i + 1) / f64::from(count);
        let (turn, r) = (2.399_963 * f64::from(i), (1.0 - z * z).sqrt());
        [r * turn.cos(), r * turn.sin(), z]
    };
    (0..count).map(point).filter(|p| p[2] < 0.85).collect()
}

fn scan(with_normals: bool) -> String {
    scan_of(400, with_normals)
}

fn scan_of(count: i32, with_normals: bool) -> String {
    let words = |[x, y, z]: [f64; 3]| match with_normals {
        true => format!("{x:.6} {y:.6} {z:.6} {x:.6} {y:.6} {z:.6}\n"),
        false => format!("{x:.6} {y:.6} {z:.6}\n"),
    };
    spiral(count).into_iter().map(words).collect()
}

fn soup() -> String {
    soup_of(3)
}

/// The triangles of an octahedron that is cut so often and pushed onto the ball, each with corners of its own, without every seventh.
fn soup_of(cuts: usize) -> String {
    let middle = |a: [f64; 3], b: [f64; 3]| {
        let sum: [f64; 3] = std::array::from_fn(|k| a[k] + b[k]);
        let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
        sum.map(|x| x / length)
    };
    let mut triangles = Vec::new();
    for octant in 0..8 {
        let sign = |k: i32| if octant >> k & 1 == 0 { 1.0 } else { -1.0 };
        let corners = [[sign(0), 0.0, 0.0], [0.0, sign(1), 0.0], [0.0, 0.0, sign(2)]];
        let [a, b, c] = corners;
        triangles.push(if sign(0) * sign(1) * sign(2) > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..cuts {
        let cut = |[a, b, c]: [[f64; 3]; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    let kept = triangles.into_iter().enumerate().filter(|(t, _)| t % 7 != 3);
    let words = |corners: [[f64; 3]; 3]| {
        let lines = corners.map(|[x, y, z]| format!("v {x:.6} {y:.6} {z:.6}\n")).concat();
        lines + "f -3 -2 -1\n"
    };
    kept.map(|(_, corners)| words(corners)).collect()
}

fn folder() -> Folder {
    let folder = Folder::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    fs::copy(root.join("configs/cpu/x86-64-v3.toml"), folder.path("cpu.toml")).unwrap();
    folder.write("study.toml", STUDY);
    folder.write("scan.xyz", scan(true));
    folder.write("soup.obj", soup());
    folder
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    fs::read(folder.path(name)).unwrap()
}

/// The topology of the mesh that is written. Measures of `--quality` ask these fields too often for a test.
fn made(folder: &Folder, arguments: &[&str]) -> TopologyReport {
    folder.succeed(&[&["extract"], arguments, &["-o", "made.ply"]].concat());
    topology(&read_ply(&*bytes(folder, "made.ply")).unwrap())
}

fn assert_is_a_ball(found: &TopologyReport, options: &[&str]) {
    assert!(found.is_closed_manifold(), "{options:?}: {found:?}");
    assert_eq!((found.components, found.euler_characteristic), (1, 2), "{options:?}");
}

#[test]
fn a_scan_with_a_hole_is_closed_and_its_fit_is_told() {
    let folder = folder();
    let said = folder.succeed(&["extract", "--points", "scan.xyz", "--cells", "30", "-o", "a.ply"]).stderr;
    assert!(
        said.contains("scan.xyz: 370 points; of 1,110 places on and beside the surface, 1,110 are centres. At the points the fit is "),
        "{said}"
    );
    for options in [&[][..], &["--kernel", "triharmonic"], &["--normals", "estimated"], &["--centres", "400"]]
    {
        let line = [&["--points", "scan.xyz", "--cells", "30"], options].concat();
        assert_is_a_ball(&made(&folder, &line), options);
    }
}

#[test]
fn soup_with_a_seventh_left_out_is_closed() {
    let folder = folder();
    for options in [&[][..], &["--epsilon", "0"], &["--epsilon", "0.1"]] {
        let line = [&["--soup", "soup.obj", "--cells", "30"], options].concat();
        assert_is_a_ball(&made(&folder, &line), options);
    }
    // Turned round, inside is in front of the triangles: what is left of the box.
    let outside = ["--soup", "soup.obj", "--inside", "below", "--close", "--cells", "20"];
    assert_eq!(made(&folder, &outside).components, 2);
}

/// The study of some of its objects alone.
fn study_of(objects: &[&str]) -> String {
    let mut study: toml::Table = STUDY.parse().unwrap();
    study["objects"].as_array_mut().unwrap().retain(|of| objects.contains(&of["id"].as_str().unwrap()));
    let is_there =
        |of: &toml::Value| objects.contains(&of["left"].as_str().unwrap().split('_').next().unwrap());
    study["comparisons"].as_array_mut().unwrap().retain(is_there);
    toml::to_string(&study).unwrap()
}

/// Meshes of the study are those of the command, on any number of threads; and it has a report.
fn assert_study_makes_meshes_of_the_command(folder: &Folder, object: &str, source: &[&str]) -> String {
    folder.write("study.toml", study_of(&[object]));
    let ran = folder.succeed(&["study", "study.toml", "--out", "out"]);
    let table = folder.read("out/tables/benchmark.csv");
    for (method, recipe) in [("mc", "{ kind = \"cubes\" }"), ("dc", "{ kind = \"dual-contouring\" }")] {
        let grid = [BOX, "--spacing", "0.2", "--recipe", recipe];
        for threads in ["1", "2"] {
            let line = [&["extract"], source, &grid, &["--threads", threads, "-o", "made.ply"]].concat();
            folder.succeed(&line);
            let of_study = bytes(folder, &format!("out/meshes/stimulus/{object}_{method}.ply"));
            assert!(of_study == bytes(folder, "made.ply"), "{object}_{method} on {threads} threads");
        }
        assert!(table.contains(&format!("{object}_{method}")), "{table}");
    }
    ran.stderr
}

#[test]
fn a_study_of_points_makes_the_meshes_of_the_command_and_a_report() {
    let folder = folder();
    // Measures of a study ask a field millions of times, so the scan is small.
    folder.write("scan.xyz", scan_of(100, true));
    let points =
        ["--points", "scan.xyz", "--kernel", "triharmonic", "--smoothing", "1e-4", "--centres", "200"];
    let said = assert_study_makes_meshes_of_the_command(&folder, "sc", &points);
    assert!(said.contains("of 276 places on and beside the surface, 200 are chosen as centres"), "{said}");
    assert!(folder.read("out/report.html").contains("scan"));
    // Nothing is made again, but for another file.
    let again = folder.succeed(&["extract", "study.toml", "-o", "out"]).stderr;
    assert!(!again.contains("places on and beside"), "{again}");
    folder.write("scan.xyz", scan_of(100, true).replacen("0.", "0.0", 1));
    let again = folder.succeed(&["extract", "study.toml", "--only", "sc_mc", "-o", "out"]).stderr;
    assert!(again.contains("places on and beside"), "{again}");
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn a_study_of_soup_makes_the_meshes_of_the_command_and_a_report() {
    let folder = folder();
    folder.write("soup.obj", soup_of(2));
    assert_study_makes_meshes_of_the_command(&folder, "so", &["--soup", "soup.obj", "--epsilon", "0.03"]);
    assert!(folder.read("out/report.html").contains("soup"));
}

/// A refusal: its words, without a panic, and no mesh.
fn refused(folder: &Folder, arguments: &[&str]) -> String {
    let Run { code, stderr, .. } = folder.run(&[&["extract"], arguments, &["-o", "no.ply"]].concat());
    assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
    assert!(!folder.path("no.ply").exists() && !stderr.contains("panicked"), "{stderr}");
    stderr
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let folder = folder();
    folder.write("bare.xyz", scan(false));
    folder.write("few.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n");
    folder.write("nan.xyz", "0 0 0 0 0 1\n1 0 nan 0 0 1\n");
    folder.write("two.xyz", scan(true) + "2 2 2 0 0 1\n# again\n2 2 2 0 1 0\n");
    folder.write("flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 2\n");
    folder.write("none.obj", "v 0 0 0\n");
    folder.write("some.xyz2", "0 0 0\n");
    for (arguments, parts) in [
        (&["--points", "bare.xyz"][..], &["bare.xyz: the points have no normals", "--normals estimated"][..]),
        (&["--points", "few.xyz"], &["few.xyz: 3 points at different places; at least 4 are needed"]),
        (&["--points", "nan.xyz"], &["nan.xyz: line 2: `nan` is not a finite single-precision number"]),
        (
            &["--points", "two.xyz"],
            &["two.xyz: line 371 and line 373 are one point, at [2, 2, 2], and their normals differ"],
        ),
        (&["--points", "some.xyz2"], &["some.xyz2: known endings of points are .ply, .xyz, .obj"]),
        (&["--points", "missing.xyz"], &["missing.xyz"]),
        (&["--points", "scan.xyz", "--offset", "0"], &["--offset", "allowed: above 0, at most 1e6"]),
        (&["--points", "scan.xyz", "--centres", "3"], &["--centres", "4..=10000"]),
        (&["--points", "scan.xyz", "--epsilon", "1"], &["--soup"]),
        (&["--points", "scan.xyz", "--soup", "soup.obj"], &["cannot be used with"]),
        (
            &["--points", "scan.xyz", "--isovalue", "90"],
            &["no surface at isovalue 90", "; the points reach from "],
        ),
        (&["--soup", "flat.obj"], &["flat.obj: all 2 triangles are flat"]),
        (&["--soup", "none.obj"], &["none.obj: the mesh has no triangles"]),
        (&["--soup", "soup.obj", "--epsilon=-1"], &["--epsilon", "allowed: 0 to 1e6"]),
    ] {
        let said = refused(&folder, arguments);
        parts.iter().for_each(|part| assert!(said.contains(part), "{part:?} is not in: {said}"));
    }
    // Of a study before any work, with the key.
    for (from, to, part) in [
        ("\"scan.xyz\"", "\"bare.xyz\"", "objects[0].field: "),
        ("\"scan.xyz\"", "\"missing.xyz\"", "objects[0].field.file names "),
        ("\"soup.obj\"", "\"flat.obj\"", "objects[1].field: "),
        ("centres = 200", "centres = 3", "objects[0].field.centres = 3"),
        ("epsilon = 0.03", "epsilon = -1", "objects[1].field.epsilon = -1"),
    ] {
        folder.write("wrong.toml", STUDY.replacen(from, to, 1));
        let said = refused(&folder, &["wrong.toml"]);
        assert!(said.contains("wrong.toml: line ") && said.contains(part), "{part:?} is not in: {said}");
    }
}

#[test]
fn what_was_left_out_is_said() {
    let folder = folder();
    folder.write(
        "twice.xyz",
        scan(true) + &scan(true).lines().take(3).map(|line| format!("{line}\n")).collect::<String>(),
    );
    let said = folder.succeed(&["extract", "--points", "twice.xyz", "--cells", "12", "-o", "a.ply"]).stderr;
    assert!(said.contains("twice.xyz: 3 points left out, with the place and the normal of others"), "{said}");
    folder.write("flat.obj", soup() + "v 0 0 0\nv 1 0 0\nf -2 -1 -1\n");
    let said = folder.succeed(&["extract", "--soup", "flat.obj", "--cells", "12", "-o", "a.ply"]).stderr;
    assert!(
        said.contains(
            "flat.obj: 1 of 440 triangles left out, which have no plane: triangle 439 is the first"
        ),
        "{said}"
    );
}
