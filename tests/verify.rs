//! `isostudy verify` as a user runs it.

mod command;

use command::{Folder, Run};

/// A ring of eight samples above zero in 5 x 5 x 3, as text.
fn write_ring(folder: &Folder) {
    let mut values = vec!["-1"; 75];
    for [x, y] in [[1, 1], [2, 1], [3, 1], [1, 2], [3, 2], [1, 3], [2, 3], [3, 3]] {
        values[25 + 5 * y + x] = "1";
    }
    let header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 5 5 3\nspacings: 1 1 1\nencoding: text\n";
    std::fs::write(folder.path("ring.nrrd"), format!("{header}\n{}\n", values.join(" "))).unwrap();
}

/// Runs a command that must end with an exit code.
fn run(folder: &Folder, arguments: &[&str], code: i32) -> Run {
    let run = folder.run(arguments);
    assert_eq!(run.code, Some(code), "{arguments:?}: {}{}", run.stdout, run.stderr);
    run
}

#[test]
fn a_mesh_of_the_volume_is_right_and_another_level_is_not() {
    let folder = Folder::new();
    write_ring(&folder);
    let extract =
        ["extract", "--volume", "ring.nrrd", "--isovalue", "0", "--method", "mc33", "--out", "ring.ply"];
    folder.succeed(&extract);
    let verify = |more: &[&str], code| {
        let start = ["verify", "ring.ply", "--volume", "ring.nrrd"];
        run(&folder, &[&start[..], more].concat(), code).stdout
    };
    let text = verify(&["--isovalue", "0"], 0);
    assert!(text.trim_end().ends_with("right"), "{text}");
    let json: serde_json::Value = serde_json::from_str(&verify(&["--isovalue", "0", "--json"], 0)).unwrap();
    assert_eq!((&json["right"], &json["expected"]["genus"]), (&true.into(), &1.into()));
    // No sample is beyond 2: there is no surface.
    let text = verify(&["--isovalue", "2"], 1);
    assert!(text.contains("wrong: 1 components, should be 0"), "{text}");
    // At 1 the ring's samples are on the level: outside by default, inside as VTK has it.
    let json = verify(&["--isovalue", "1", "--json"], 1);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["findings"][0]["fault"], "components");
    verify(&["--isovalue", "1", "--ties", "inside"], 0);
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let folder = Folder::new();
    write_ring(&folder);
    std::fs::write(folder.path("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    run(&folder, &["verify", "none.ply", "--volume", "ring.nrrd", "--isovalue", "0"], 2);
    run(&folder, &["verify", "one.obj", "--volume", "ring.nrrd", "--isovalue", "nan"], 2);
    run(&folder, &["verify", "one.obj", "--volume", "ring.nrrd", "--isovalue", "0"], 1);
    let holes = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\n1 1 1 1 1 nan 1 1\n";
    std::fs::write(folder.path("holes.nrrd"), holes).unwrap();
    let run = run(&folder, &["verify", "one.obj", "--volume", "holes.nrrd", "--isovalue", "0"], 2);
    assert!(run.stderr.contains("sample [1, 0, 1] is NaN"), "{}", run.stderr);
}
