//! `isostudy distance` as a user runs it.

use std::path::Path;
use std::process::{Command, Output};

/// Two triangles: a square from the origin to `(side, side)` at the height `z`.
fn write_square(path: &Path, side: f64, z: f64) {
    let text = format!("v 0 0 {z}\nv {side} 0 {z}\nv {side} {side} {z}\nv 0 {side} {z}\nf 1 2 3 4\n");
    std::fs::write(path, text).unwrap();
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isostudy"));
    command.current_dir(folder).arg("distance").args(arguments).output().unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let output = run(folder, &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn both_ways_in_units_and_of_the_diagonal_with_places() {
    let folder = tempfile::tempdir().unwrap();
    write_square(&folder.path().join("small.obj"), 1.0, 0.0);
    write_square(&folder.path().join("large.obj"), 3.0, 4.0);
    let found = json(folder.path(), &["small.obj", "large.obj", "--density", "5000"]);
    let number = |pointer: &str| found.pointer(pointer).and_then(|v| v.as_f64()).unwrap();
    assert_eq!((number("/a_to_b/max"), number("/a_to_b/mean"), number("/a_to_b/rms")), (4.0, 4.0, 4.0));
    assert_eq!((number("/a_to_b/samples"), number("/b_to_a/samples")), (5_000.0, 45_000.0));
    // From (3, 3, 4) to (1, 1, 0).
    assert_eq!((number("/b_to_a/max"), number("/hausdorff")), (24f64.sqrt(), 24f64.sqrt()));
    assert!((number("/hausdorff_of_diagonal") - f64::sqrt(24.0 / 18.0)).abs() < 1e-12);
    let place = |pointer: &str| -> Vec<f64> {
        serde_json::from_value(found.pointer(pointer).unwrap().clone()).unwrap()
    };
    assert_eq!(
        (place("/b_to_a/farthest/from"), place("/b_to_a/farthest/to")),
        (vec![3.0, 3.0, 4.0], vec![1.0, 1.0, 0.0])
    );

    let text = run(folder.path(), &["small.obj", "large.obj", "--density", "5000"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("farthest vertex (3.0000000, 3.0000000, 4.0000000), nearest point (1.0000000, 1.0000000, 0.0000000)"), "{text}");
    assert!(text.contains("Hausdorff distance        4.89897949   115.470054 %"), "{text}");
    for threads in ["1", "3"] {
        let again =
            json(folder.path(), &["small.obj", "large.obj", "--density", "5000", "--threads", threads]);
        assert_eq!(again, found);
    }
}

#[test]
fn a_mesh_against_an_object_of_a_study() {
    let folder = tempfile::tempdir().unwrap();
    let study = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
    // An octahedron in a sphere of radius 0.9: the middle of a face is 0.9 (1 - 1/sqrt 3) from it.
    let mut octahedron = String::from("v .9 0 0\nv -.9 0 0\nv 0 .9 0\nv 0 -.9 0\nv 0 0 .9\nv 0 0 -.9\n");
    for (x, y, z) in [(1, 3, 5), (3, 2, 5), (2, 4, 5), (4, 1, 5), (3, 1, 6), (2, 3, 6), (4, 2, 6), (1, 4, 6)]
    {
        octahedron += &format!("f {x} {y} {z}\n");
    }
    std::fs::write(folder.path().join("octahedron.obj"), octahedron).unwrap();
    let study = study.to_str().unwrap();
    let found =
        json(folder.path(), &["octahedron.obj", "--object", "ss", "--study", study, "--samples", "20000"]);
    let number = |pointer: &str| found.pointer(pointer).and_then(|v| v.as_f64()).unwrap();
    let want = 0.9 * (1.0 - 1.0 / f64::sqrt(3.0));
    for way in ["/a_to_b/max", "/b_to_a/max"] {
        assert!((number(way) - want).abs() < 1e-3, "{} is not {want}", number(way));
    }
    assert_eq!(number("/a_to_b/lost_samples"), 0.0);
    let unknown = run(folder.path(), &["octahedron.obj", "--object", "cube", "--study", study]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("--object cube: "));
}

#[test]
fn what_cannot_be_measured_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_square(&path("good.obj"), 1.0, 0.0);
    std::fs::write(path("points.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    std::fs::write(path("line.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("nan.obj"), "v 0 0 nan\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("good.txt"), "").unwrap();
    for (arguments, message) in [
        (&["good.obj", "points.obj"][..], "points.obj: the mesh has no triangles"),
        (&["line.obj", "good.obj"], "line.obj: the mesh has 1 triangles, and none has an area"),
        (&["good.obj", "nan.obj"], "nan.obj: line 1: `nan` is not a finite single-precision number"),
        (&["good.obj", "missing.ply"], "missing.ply"),
        (&["good.obj", "good.txt"], "good.txt: ends neither in .obj nor in .ply nor in .stl"),
        (
            &["good.obj", "good.obj", "--density", "1e12"],
            "good.obj: 1000000000000 samples on an area of 1; allowed are",
        ),
        (&["good.obj", "good.obj", "--density", "0"], "a density of 0 samples per unit of area"),
        (&["good.obj", "good.obj", "--samples", "0"], "--samples"),
        (&["good.obj"], "required"),
    ] {
        let output = run(folder.path(), arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
    }
}
