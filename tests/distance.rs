//! `isostudy distance` as a user runs it.

use crate::command::{Folder, Run};
use std::path::Path;

/// Two triangles: a square from the origin to `(side, side)` at the height `z`.
fn write_square(path: &Path, side: f64, z: f64) {
    let text = format!("v 0 0 {z}\nv {side} 0 {z}\nv {side} {side} {z}\nv 0 {side} {z}\nf 1 2 3 4\n");
    std::fs::write(path, text).unwrap();
}

fn json(folder: &Folder, arguments: &[&str]) -> serde_json::Value {
    let run = folder.succeed(&[arguments, &["--json"]].concat());
    serde_json::from_str(&run.stdout).unwrap()
}

#[test]
fn both_ways_in_units_and_of_the_diagonal_with_places() {
    let folder = Folder::of("distance");
    write_square(&folder.path("small.obj"), 1.0, 0.0);
    write_square(&folder.path("large.obj"), 3.0, 4.0);
    let found = json(&folder, &["small.obj", "large.obj", "--density", "5000"]);
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

    let text = folder.run(&["small.obj", "large.obj", "--density", "5000"]).stdout;
    for part in ["(3.000000, 3.000000, 4.000000)", "(1.000000, 1.000000, 0)", "4.898979", "115.4701 %"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    for threads in ["1", "3"] {
        let again = json(&folder, &["small.obj", "large.obj", "--density", "5000", "--threads", threads]);
        assert_eq!(again, found);
    }
}

#[test]
fn a_mesh_against_an_object_of_a_study() {
    let folder = Folder::of("distance");
    let study = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
    std::fs::write(folder.path("octahedron.obj"), octahedron(0.9)).unwrap();
    let study = study.to_str().unwrap();
    let found = json(&folder, &["octahedron.obj", "--object", "ss", "--study", study, "--samples", "20000"]);
    let number = |pointer: &str| found.pointer(pointer).and_then(|v| v.as_f64()).unwrap();
    // The middle of a face.
    let want = 0.9 * (1.0 - 1.0 / f64::sqrt(3.0));
    for way in ["/a_to_b/max", "/b_to_a/max"] {
        assert!((number(way) - want).abs() < 1e-3, "{} is not {want}", number(way));
    }
    assert_eq!(number("/a_to_b/lost_samples"), 0.0);
    let unknown = folder.run(&["octahedron.obj", "--object", "cube", "--study", study]);
    assert_eq!(unknown.code, Some(2));
    assert!(unknown.stderr.contains("--object cube: "));
}

/// An octahedron in a sphere: the middle of a face is the farthest from it, a corner lies on it.
fn octahedron(radius: f64) -> String {
    let r = radius;
    let mut text = format!("v {r} 0 0\nv -{r} 0 0\nv 0 {r} 0\nv 0 -{r} 0\nv 0 0 {r}\nv 0 0 -{r}\n");
    for (x, y, z) in [(1, 3, 5), (3, 2, 5), (2, 4, 5), (4, 1, 5), (3, 1, 6), (2, 3, 6), (4, 2, 6), (1, 4, 6)]
    {
        text += &format!("f {x} {y} {z}\n");
    }
    text
}

#[test]
fn a_mesh_against_a_formula_a_volume_and_a_mesh_s_distance() {
    let folder = Folder::of("distance");
    let path = |name: &str| folder.path(name);
    std::fs::write(path("octahedron.obj"), octahedron(0.9)).unwrap();
    let found = |arguments: &[&str]| {
        let all = [&["octahedron.obj", "--samples", "20000"], arguments].concat();
        let found = json(&folder, &all);
        ["/a_to_b/max", "/b_to_a/max"].map(|way| found.pointer(way).and_then(|v| v.as_f64()).unwrap())
    };
    let to_sphere = 0.9 * (1.0 - 1.0 / f64::sqrt(3.0));
    let ball = "--bounds=-1,-1,-1,1,1,1";
    for formula in [&["length(x,y,z) - 0.9"][..], &["0.9 - length(x,y,z)", "--inside", "above"]] {
        for way in found(&[&["--field"], formula, &[ball, "--cells", "60"]].concat()) {
            assert!((way - to_sphere).abs() < 1e-3, "{formula:?}: {way} is not {to_sphere}");
        }
    }
    // 41 samples a side, 0.05 apart, of the distance from the origin.
    let at = |i: usize, k: u32| (i / 41usize.pow(k) % 41) as f32 * 0.05 - 1.0;
    let values = (0..41usize.pow(3)).map(|i| (0..3).map(|k| at(i, k).powi(2)).sum::<f32>().sqrt());
    let header = "NRRD0004\ntype: float\nendian: little\ndimension: 3\nsizes: 41 41 41\nencoding: raw\n\
                  space dimension: 3\nspace directions: (0.05,0,0) (0,0.05,0) (0,0,0.05)\nspace origin: (-1,-1,-1)\n\n";
    let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    std::fs::write(path("ball.nrrd"), [header.as_bytes(), &bytes].concat()).unwrap();
    for way in found(&["--volume", "ball.nrrd", "--isovalue", "0.9", "--inside", "below"]) {
        assert!((way - to_sphere).abs() < 2e-3, "{way} is not {to_sphere}");
    }
    // 0.2 inside an octahedron is an octahedron whose faces are 0.2 farther in; its corners are 0.2 sqrt 3 farther in.
    let [to_inner, from_inner] = found(&["--mesh", "octahedron.obj", "--isovalue", "0.2", "--cells", "80"]);
    assert!((from_inner - 0.2).abs() < 1e-3, "{from_inner}");
    assert!((to_inner - 0.2 * 3f64.sqrt()).abs() < 0.02, "{to_inner}");
}

/// What cannot be measured, and the file, key or number that is named. `messages.rs` has the words.
pub(crate) const REFUSED: [(&[&str], &str); 13] = [
    (&["good.obj", "points.obj"], "points.obj"),
    (&["line.obj", "good.obj"], "line.obj"),
    (&["good.obj", "nan.obj"], "nan.obj: line 1"),
    (&["good.obj", "missing.ply"], "missing.ply"),
    (&["good.obj", "good.txt"], "good.txt"),
    (&["good.obj", "good.obj", "--density", "1e12"], "1000000000000"),
    (&["good.obj", "good.obj", "--density", "0"], "density"),
    (&["good.obj", "good.obj", "--samples", "0"], "--samples"),
    (&["good.obj"], "<B|"),
    (&["good.obj", "good.obj", "--field", "x"], "--field"),
    (&["good.obj", "good.obj", "--spacing", "1"], "--spacing"),
    (&["good.obj", "--field", "x"], "--bounds"),
    (&["good.obj", "--field", "x^2+1", "--bounds=0,0,0,1,1,1"], "good.obj and x^2+1"),
];

/// A folder with good and bad meshes.
pub(crate) fn meshes() -> Folder {
    let folder = Folder::of("distance");
    let path = |name: &str| folder.path(name);
    write_square(&path("good.obj"), 1.0, 0.0);
    std::fs::write(path("points.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    std::fs::write(path("line.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("nan.obj"), "v 0 0 nan\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("good.txt"), "").unwrap();
    folder
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let folder = meshes();
    for (arguments, message) in REFUSED {
        let Run { code, stderr, .. } = folder.run(arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
    }
}
