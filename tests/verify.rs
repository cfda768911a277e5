//! `isostudy verify` as a user runs it.

use crate::command::{Folder, Run};

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

/// Samples that mean nothing, positive and negative whole numbers.
fn noise(i: usize) -> i32 {
    let mixed = (i as u32).wrapping_mul(0x9e37_79b9).wrapping_add(77);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b);
    (mixed >> 24) as i32 - 128
}

/// On a volume's own cells the truth of the samples is met, whatever the steps are: equal, unequal, turned, mirrored, sheared.
#[test]
fn a_volume_is_extracted_on_its_own_cells() {
    let folder = Folder::new();
    let spaces = [
        ("equal", "(1,0,0) (0,1,0) (0,0,1)"),
        ("unequal", "(0.5,0,0) (0,1,0) (0,0,3.25)"),
        ("turned", "(0.6,0.8,0) (-0.8,0.6,0) (0,0,1.5)"),
        ("mirrored", "(-1,0,0) (0,1,0) (0,0,2)"),
        ("sheared", "(1,0,0) (0.5,1,0) (0,0.25,1)"),
    ];
    let counts = [7, 6, 5];
    let text: Vec<String> = (0..counts.iter().product()).map(|i| noise(i).to_string()).collect();
    let mut found = Vec::new();
    for (name, directions) in spaces {
        let header = format!(
            "NRRD0004\ntype: short\ndimension: 3\nsizes: 7 6 5\nspace dimension: 3\n\
             space origin: (3,-2,1)\nspace directions: {directions}\nencoding: text\n\n{}\n",
            text.join(" ")
        );
        let volume = format!("{name}.nrrd");
        folder.write(&volume, header);
        let extract = ["extract", "--volume", &volume, "--isovalue", "4.5", "--out", "a.ply", "--json"];
        let verify = ["verify", "a.ply", "--volume", &volume, "--isovalue", "4.5"];
        let said = folder.succeed(&[&extract[..], &["--method", "mc33"]].concat());
        let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
        assert_eq!(report["own_cells"], true, "{name}");
        assert_eq!(report["cells"], serde_json::json!([6, 5, 4]));
        assert_eq!(said.stderr, "");
        // Samples at random have cells that signs alone decide otherwise.
        run(&folder, &verify, 0);
        let counts = [report["topology"]["vertices"].clone(), report["quality"]["triangles"].clone()];
        folder.succeed(&[&extract[..], &["--method", "mc"]].concat());
        run(&folder, &verify, 1);
        // The same samples turned round are the same surface, seen from the other side.
        folder.succeed(&[&extract[..], &["--method", "mc33", "--inside", "below"]].concat());
        run(&folder, &verify, 0);
        found.push(counts);
    }
    assert!(found.iter().all(|counts| *counts == found[0]), "{found:?}");
    // A lattice that is asked for is not the volume's.
    let words = ["extract", "--volume", "unequal.nrrd", "--isovalue", "4.5", "--out", "a.ply", "--json"];
    let said = folder.succeed(&[&words[..], &["--method", "mc33", "--spacing", "0.5"]].concat());
    let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!((&report["own_cells"], &report["cells"][2]), (&false.into(), &26.into()));
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
