//! `isostudy extract` and `validate` with continuation's seeds: where they may lie, what they reach, and what is said if they reach nothing.

use crate::command::{Folder, Run};

const BALL: [&str; 7] = [
    "extract",
    "--field",
    "length(x,y,z) - 0.8",
    "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2",
    "--spacing",
    "0.05",
    "--isovalue=0",
];

fn recipe(seeds: &str) -> String {
    format!("{{ kind = \"continuation\", seeds = {seeds} }}")
}

/// A refusal: its words, without a panic, and no mesh.
fn refused(folder: &Folder, arguments: &[&str]) -> String {
    let Run { code, stderr, .. } = folder.run(&[arguments, &["-o", "no.ply"]].concat());
    assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
    assert!(!folder.path("no.ply").exists() && !stderr.contains("panicked"), "{stderr}");
    stderr
}

/// The bytes of a mesh.
fn made(folder: &Folder, arguments: &[&str]) -> Vec<u8> {
    folder.succeed(&[arguments, &["-o", "made.ply"]].concat());
    std::fs::read(folder.path("made.ply")).unwrap()
}

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is not in: {text}");
    }
}

#[test]
fn seeds_that_reach_nothing_are_named() {
    let folder = Folder::new();
    let said = refused(&folder, &[&BALL[..], &["--recipe", &recipe("[[0.9, 0.9, 0.9]]")]].concat());
    has(
        &said,
        &["no surface was reached at isovalue 0 ", "seeds = [[0.9, 0.9, 0.9]] met none", "leave `seeds` out"],
    );
    assert!(!said.contains("one side"), "{said}");
    // Without seeds nothing is missed, and there all samples do lie on one side.
    let beyond = [&BALL[..6], &["--isovalue=9", "--method", "continued"]].concat();
    has(&refused(&folder, &beyond), &["every sample lies on one side"]);
    // One that reaches nothing adds nothing beside one that does.
    let both = recipe("[[0.9, 0.9, 0.9], [0.8, 0, 0]]");
    let whole = made(&folder, &[&BALL[..], &["--method", "mc"]].concat());
    assert_eq!(made(&folder, &[&BALL[..], &["--recipe", &both]].concat()), whole);
}

#[test]
fn a_seed_outside_of_the_box_is_refused() {
    let folder = Folder::new();
    for (seeds, named) in [
        ("[[9, 9, 9]]", "seeds[0] = [9.0, 9.0, 9.0]: this seed lies outside of the box"),
        ("[[0.5, 0, 0], [0, 0, -1.25]]", "seeds[1] = [0.0, 0.0, -1.25]: this seed lies outside of the box"),
    ] {
        let said = refused(&folder, &[&BALL[..], &["--recipe", &recipe(seeds)]].concat());
        assert!(said.starts_with(&format!("isostudy: {named}")), "{said}");
        has(&said, &["from [-1.2, -1.2, -1.2] to [1.2, 1.2, 1.2]"]);
    }
    // A corner of the box is not outside of it.
    let corner = recipe("[[0.8, 0, 0], [1.2, -1.2, 1.2]]");
    folder.succeed(&[&BALL[..], &["--recipe", &corner, "-o", "a.ply"]].concat());
}

#[test]
fn a_study_with_a_seed_outside_of_a_box_is_refused_before_any_work() {
    let folder = Folder::new();
    folder.succeed(&["new", "a"]);
    let study = folder.read("a/study.toml");
    let of =
        "recipe = { kind = \"tetrahedra\", arrangement = \"body-centred\", clustering = \"integrated\" }";
    let with = |seeds: &str| {
        assert!(study.contains(of));
        folder.write("a/study.toml", study.replacen(of, &format!("recipe = {}", recipe(seeds)), 1));
    };
    // The torus has a box from x = -0.5 to 0.5, the cliffs one from -1 to 1.
    with("[[0, 0, 0.4], [0.75, 0, 0]]");
    for arguments in [&["validate", "a/study.toml"][..], &["extract", "a/study.toml", "-o", "out"]] {
        let Run { code, stderr, .. } = folder.run(arguments);
        assert_eq!(code, Some(2), "{stderr}");
        has(
            &stderr,
            &["study.toml: line ", ": methods[0].recipe.seeds[1] = [0.75, 0.0, 0.0]", "box of object torus"],
        );
        assert!(!folder.path("out").exists(), "something was written");
    }
    with("[[0, 0, 0.4], [0.5, 0, 0]]");
    folder.succeed(&["validate", "a/study.toml"]);
    // In the box, and next to no surface: the edges of the box from there do not meet the torus.
    with("[[-0.5, -1, -0.5]]");
    folder.succeed(&["validate", "a/study.toml"]);
    let Run { code, stderr, .. } =
        folder.run(&["extract", "a/study.toml", "--only", "torus_bi", "-o", "out"]);
    assert_eq!(code, Some(2), "{stderr}");
    has(
        &stderr,
        &[
            "torus_bi",
            "no surface was reached with spacing 0.05",
            "seeds = [[-0.5, -1.0, -0.5]] met none",
            "leave `seeds` out",
        ],
    );
    assert!(!stderr.contains("one side"), "{stderr}");
}

/// The box cuts the torus into two tubes.
#[test]
fn a_seed_reaches_its_part_inside_the_box_alone() {
    let folder = Folder::new();
    let torus = [
        "extract",
        "--field",
        "sqrt((sqrt(x^2 + y^2) - 0.6)^2 + z^2) - 0.25",
        "--bounds=-1,-0.3,-0.5,1,0.3,0.5",
        "--spacing",
        "0.05",
        "--isovalue=0",
        "--json",
    ];
    let parts = |seeds: &str| {
        let said = folder.succeed(&[&torus[..], &["--recipe", &recipe(seeds), "-o", "a.ply"]].concat());
        let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
        (report["topology"]["components"].as_u64(), report["boundary_loops"].as_u64())
    };
    assert_eq!(parts("[[0.6, 0, 0.25]]"), (Some(1), Some(2)));
    assert_eq!(parts("[[0.6, 0, 0.25], [-0.6, 0, 0.25]]"), (Some(2), Some(4)));
    assert_eq!(parts("[]"), (Some(2), Some(4)));
}

/// A ball of radius 1 round the origin, 32 samples a side, mirrored along x.
fn ball_volume(folder: &Folder) {
    let at = |i: usize| (0..3).map(|k| ((i / 32usize.pow(k) % 32) as f32 - 15.5).powi(2)).sum::<f32>().sqrt();
    let values: Vec<u8> = (0..32768).map(|i| (100.0 - 5.0 * at(i)).max(0.0).round() as u8).collect();
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 32 32 32\nencoding: raw\nspace dimension: 3\n\
                  space directions: (-0.1,0,0) (0,0.1,0) (0,0,0.1)\nspace origin: (1.55,-1.55,-1.55)\n\n";
    folder.write("ball.nrrd", [header.as_bytes(), &values].concat());
}

/// The extractor counts in steps there.
#[test]
fn seeds_of_a_volumes_own_cells_are_points_of_its_space() {
    let folder = Folder::new();
    ball_volume(&folder);
    let ball = ["extract", "--volume", "ball.nrrd", "--isovalue", "50"];
    let whole = made(&folder, &[&ball[..], &["--method", "mc"]].concat());
    // In steps from the first sample this would be a corner, from whose edges no ball is seen.
    let near = recipe("[[0.97, 0.01, 0.02]]");
    assert_eq!(made(&folder, &[&ball[..], &["--recipe", &near]].concat()), whole);
    let corner = recipe("[[1.55, -1.55, 1.55]]");
    let said = refused(&folder, &[&ball[..], &["--recipe", &corner]].concat());
    has(&said, &["seeds = [[1.55, -1.55, 1.55]] met none", "samples run from"]);
    // In steps this would be a point of the volume.
    let said = refused(&folder, &[&ball[..], &["--recipe", &recipe("[[0, 0, 0], [20, 15, 15]]")]].concat());
    has(&said, &["ball.nrrd: seeds[1] = [20.0, 15.0, 15.0]: this seed lies outside of the volume's samples"]);

    let several = ["extract", "--volume", "ball.nrrd", "--isovalues", "50,60", "-o", "{isovalue}.ply"];
    folder.succeed(&[&several[..], &["--recipe", &near]].concat());
    assert_eq!(std::fs::read(folder.path("50.ply")).unwrap(), whole);
    let Run { code, stdout, stderr } = folder.run(&[&several[..], &["--recipe", &corner]].concat());
    assert_eq!(code, Some(2), "{stderr}");
    has(&stdout, &["isovalue 60: no surface reached from the seeds, no file"]);
    has(&stderr, &["no surface was reached at any of 2 isovalues", "seeds = [[1.55, -1.55, 1.55]] met none"]);
}
