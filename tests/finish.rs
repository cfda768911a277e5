//! Finishing steps, as a user runs them: `extract --finish`, and a study whose methods have some.

use crate::command::{Folder, Run};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{TriangleMesh, read_ply};
use serde_json::Value;
use std::fs;
use std::path::Path;

const BALL: [&str; 8] = [
    "extract",
    "--field",
    "sqrt(x^2 + y^2 + z^2) - 1",
    "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2",
    "--spacing",
    "0.1",
    "--method",
    "mc",
];
/// Faces in the middle of cubes, so that dual contouring places vertices on edges and corners.
const BOX: [&str; 8] = [
    "extract",
    "--field",
    "max(abs(x), max(abs(y), abs(z))) - 1.05",
    "--bounds=-1.5,-1.5,-1.5,1.5,1.5,1.5",
    "--spacing",
    "0.1",
    "--method",
    "dc-in-cell",
];

/// Extracts into a file with more arguments, reads it back, and returns what was said.
fn extracted(folder: &Folder, of: &[&str], more: &[&str]) -> (TriangleMesh, Run) {
    let said = folder.succeed(&[of, &["-o", "mesh.ply"], more].concat());
    (read_ply(&*fs::read(folder.path("mesh.ply")).unwrap()).unwrap(), said)
}

#[test]
fn a_box_of_cells_is_twelve_triangles() {
    let folder = Folder::new();
    let (plain, _) = extracted(&folder, &BOX, &[]);
    assert!(plain.triangles.len() > 2000, "{}", plain.triangles.len());
    for step in ["coplanar:tolerance=1e-4", "decimate:error=1e-4"] {
        let (found, said) = extracted(&folder, &BOX, &["--finish", step]);
        assert_eq!((found.triangles.len(), found.positions.len()), (12, 8), "{step}: {}", said.stderr);
        assert!(topology(&found).is_closed_manifold());
        assert!((found.volume() - 2.1f64.powi(3)).abs() < 0.01, "{}", found.volume());
        let name = step.split(':').next().unwrap();
        assert!(said.stderr.contains(&format!("mesh.ply: {name}: 12 triangles, 8 vertices, finished in ")));
    }
}

#[test]
fn decimated_and_re_tiled_meshes_have_what_was_asked_for() {
    let folder = Folder::new();
    let (plain, _) = extracted(&folder, &BALL, &[]);
    let (half, _) = extracted(&folder, &BALL, &["--finish", "decimate:ratio=0.5"]);
    assert_eq!(half.triangles.len(), plain.triangles.len() / 2);
    let (few, _) = extracted(&folder, &BALL, &["--finish", "decimate:triangles=100"]);
    assert_eq!(few.triangles.len(), 100);
    let (tiled, _) = extracted(&folder, &BALL, &["--finish", "re-tile:points=500"]);
    assert_eq!(tiled.positions.len(), 500);
    for (mesh, near) in [(&half, 0.02), (&few, 0.2), (&tiled, 0.1)] {
        assert!(topology(mesh).is_closed_manifold());
        assert!((mesh.volume() - plain.volume()).abs() < near, "{}", mesh.volume());
    }
    let (seeded, _) = extracted(&folder, &BALL, &["--finish", "re-tile:points=500,seed=1"]);
    assert_ne!(seeded, tiled);
    let once = fs::read(folder.path("mesh.ply")).unwrap();
    extracted(&folder, &BALL, &["--finish", "re-tile:points=500,seed=1", "--threads", "3"]);
    assert_eq!(fs::read(folder.path("mesh.ply")).unwrap(), once, "on any number of threads");
}

#[test]
fn what_merging_does_to_topology_is_counted() {
    let folder = Folder::new();
    // Two balls a fiftieth apart.
    let balls = "min(sqrt((x - 0.51)^2 + y^2 + z^2), sqrt((x + 0.51)^2 + y^2 + z^2)) - 0.5";
    let of = ["extract", "--field", balls, "--bounds=-1.2,-0.8,-0.8,1.2,0.8,0.8", "--spacing", "0.05"];
    let merge = "merge-by-distance:tolerance=0.03";
    let (found, said) = extracted(&folder, &of, &["--method", "mc", "--finish", merge, "--json"]);
    let report: Value = serde_json::from_str(&said.stdout).unwrap();
    let step = &report["finishing"][0];
    assert_eq!(step["step"], "merge-by-distance");
    assert_eq!(step["tolerance"], 0.03);
    assert_eq!([&step["before"]["components"], &step["after"]["components"]], [2, 1]);
    assert!(step["finishing_s"].as_f64().unwrap() > 0.0);
    let counted = topology(&found);
    assert_eq!(step["after"]["non_manifold_vertices"], counted.non_manifold_vertices);
    assert_eq!(step["after"]["triangles"], found.triangles.len());
    assert_eq!(report["counts"]["triangles"], found.triangles.len());
    assert_eq!(report["topology"]["components"], 1);
    let (_, said) = extracted(&folder, &of, &["--method", "mc", "--finish", merge]);
    assert!(said.stderr.contains("components from 2 to 1"), "{}", said.stderr);
    let (plain, _) = extracted(&folder, &of, &["--method", "mc"]);
    let (welded, said) =
        extracted(&folder, &of, &["--method", "mc", "--finish", "merge-by-distance:tolerance=0"]);
    assert_eq!(topology(&welded), topology(&plain));
    assert!(!said.stderr.contains(" from "), "{}", said.stderr);
}

#[test]
fn steps_follow_each_other_and_say_where_they_stopped() {
    let folder = Folder::new();
    let steps = ["--finish", "coplanar", "--finish", "decimate:triangles=2", "--quality"];
    let (found, said) = extracted(&folder, &BOX, &steps);
    assert_eq!(found.triangles.len(), 4, "no closed surface has fewer");
    assert!(said.stderr.contains("decimate: stopped with 2 triangles too many"), "{}", said.stderr);
    let lines: Vec<&str> = said.stdout.lines().filter(|line| line.starts_with("finishing ")).collect();
    assert_eq!(lines.len(), 2, "{}", said.stdout);
    assert!(lines[0].contains("coplanar: ") && lines[0].contains("topology as before"), "{lines:?}");
    assert!(lines[1].contains("decimate: 4 of ") && lines[1].contains("stopped with 2"), "{lines:?}");
}

#[test]
fn bad_steps_are_refused_with_what_is_allowed() {
    let folder = Folder::new();
    for (step, parts) in [
        ("decimat:ratio=0.5", vec!["--finish", "did you mean decimate?"]),
        ("decimate:ratoi=0.5", vec!["--finish", "did you mean ratio?"]),
        ("decimate:triangles=0", vec!["--finish", "triangles = 0: must be at least 1"]),
        ("decimate", vec!["--finish", "needs one of triangles, ratio and error"]),
        ("merge-by-distance:tolerance=-1", vec!["--finish", "tolerance = -1.0: must be a length from 0"]),
        ("merge-by-distance:tolerance=nan", vec!["--finish", "tolerance = NaN: must be a length from 0"]),
        ("merge-by-distance:tolerance=9", vec!["finish: merge-by-distance: no triangle is left"]),
        ("re-tile:points=30000000", vec!["--finish", "points = 30000000: must be from 1 to 20000000"]),
        ("decimate:ratio=1e-9", vec!["finish: decimate", "is less than one triangle"]),
    ] {
        let run = folder.run(&[&BALL[..], &["-o", "no.ply", "--finish", step]].concat());
        assert_eq!(run.code, Some(2), "{step}: {}", run.stderr);
        assert!(parts.iter().all(|part| run.stderr.contains(part)), "{step}: {}", run.stderr);
        assert!(!folder.path("no.ply").exists());
    }
    // Open at the box: vertices of the border stay.
    let open = ["extract", "--field", "z", "--bounds=-1,-1,-1,1,1,1", "--cells", "20", "-o", "no.ply"];
    let run = folder.run(&[&open[..], &["--finish", "re-tile:points=50"]].concat());
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    assert!(run.stderr.contains("80 vertices of borders and of faults stay"), "{}", run.stderr);
}

/// The study in a folder of its own.
fn study() -> Folder {
    let folder = Folder::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    folder.write("study.toml", include_str!("finish/study.toml"));
    fs::copy(root.join("configs/cpu/x86-64-v3.toml"), folder.path("cpu.toml")).unwrap();
    folder
}

#[test]
fn a_study_of_finished_methods_from_file_to_report() {
    let folder = study();
    let first = folder.succeed(&["study", "study.toml", "--out", "out"]);
    let benchmark = folder.read("out/tables/benchmark.csv");
    let rows: Vec<Vec<&str>> = benchmark
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').collect())
        .collect();
    let cell = |id: &str, name: &str| {
        let column = rows[0].iter().position(|title| *title == name).unwrap_or_else(|| panic!("{name}"));
        rows.iter().find(|row| row[0] == id).unwrap_or_else(|| panic!("{id}"))[column]
    };
    let number = |id: &str, name: &str| cell(id, name).parse::<f64>().unwrap();
    let plain = number("ri_mc", "triangles");
    assert_eq!(number("ri_mc-half", "triangles"), (plain / 2.0).floor());
    assert_eq!(number("ri_mc-tiled", "vertices"), 900.0);
    // As many triangles are left of a finer grid.
    assert!((number("ri_mch-matched", "triangles") / plain - 1.0).abs() <= 0.01);
    assert!(number("ri_mch-matched", "spacing") < 0.04);
    // Finishing is a stage of its own, and in the total.
    assert_eq!(cell("ri_mc", "finishing_s"), "");
    for id in ["ri_mc-half", "ri_mch-matched", "ri_mc-tiled"] {
        let finishing = number(id, "finishing_s");
        let others = ["allocation_s", "sampling_s", "vertex_s", "geometry_s"].map(|name| number(id, name));
        let sum = finishing + others.iter().sum::<f64>();
        assert!(finishing > 0.0);
        assert!((number(id, "total_without_normals_s") - sum).abs() < 1e-5 * (1.0 + sum), "{id}");
    }
    // The file of a mesh is the finished one.
    let mesh = read_ply(&*fs::read(folder.path("out/meshes/benchmark/ri_mc-half.ply")).unwrap()).unwrap();
    assert_eq!(mesh.triangles.len() as f64, number("ri_mc-half", "triangles"));
    let record: Value = serde_json::from_str(&folder.read("out/meshes/benchmark/ri_mc-half.json")).unwrap();
    assert_eq!(record["topology"]["euler_characteristic"], 0);
    assert_eq!(record["topology"]["boundary_edges"], 0);
    // Chunks fit, their borders locked, and are no whole; what cannot be done in chunks is said.
    let chunks = |id: &str| -> Value {
        serde_json::from_str(&folder.read(&format!("out/bench/chunks/{id}.json"))).unwrap()
    };
    assert_eq!([&chunks("ri_mc")["open_seam_edges"], &chunks("ri_mc-half")["open_seam_edges"]], [0, 0]);
    assert_eq!([&chunks("ri_mc")["is_whole"], &chunks("ri_mc-half")["is_whole"]], [true, false]);
    assert!(!folder.path("out/bench/chunks/ri_mc-tiled.json").exists());
    let why = "ri_mc-tiled: no times of chunks: merge-by-distance needs the whole mesh";
    assert!(first.stderr.contains(why), "{}", first.stderr);
    let samples = folder.read("out/bench/short/samples.csv");
    assert!(samples.lines().next().unwrap().ends_with(",finishing_s"));
    for page in ["out/index.html", "out/tables/benchmark.md"] {
        assert!(folder.read(page).contains("Finishing, "), "{page}");
    }
    let again = folder.succeed(&["study", "study.toml", "--out", "out"]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
}

#[test]
fn the_panel_of_a_finished_method_has_its_stage() {
    let folder = study();
    let stages = |id: &str| -> Vec<String> {
        let said = folder.succeed(&["inspect", id, "--study", "study.toml", "--json", "--iterations", "1"]);
        let panel: Value = serde_json::from_str(&said.stdout).unwrap();
        let times = panel["times"].as_array().unwrap();
        times.iter().map(|time| time["stage"].as_str().unwrap().to_owned()).collect()
    };
    let plain = ["allocation", "sampling", "vertex", "geometry", "clustering", "normals", "total"];
    assert_eq!(stages("ri_mc"), plain);
    let [of_extraction @ .., total] = plain;
    assert_eq!(stages("ri_mc-half"), [&of_extraction[..], &["finishing", total]].concat());
}

#[test]
fn bad_steps_of_a_study_are_refused_before_any_work() {
    for (from, to, parts) in [
        (
            "step = \"decimate\", ratio = 0.5",
            "step = \"decimte\", ratio = 0.5",
            vec!["study.toml: line 27: methods[1].recipe.finish[0]: ", "did you mean decimate?"],
        ),
        (
            "step = \"re-tile\", points = 900",
            "step = \"re-tile\", point = 900",
            vec!["methods[3].recipe.finish[1]: ", "did you mean points?"],
        ),
        ("tolerance = 1e-6", "tolerance = -1.0", vec!["methods[3].recipe.finish[0]: ", "tolerance = -1.0"]),
        ("finish = [{ step", "finsh = [{ step", vec!["methods[1].recipe", "finsh"]),
    ] {
        let folder = study();
        let text = folder.read("study.toml");
        assert!(text.contains(from), "{from}");
        folder.write("study.toml", text.replacen(from, to, 1));
        for command in [&["validate", "study.toml"][..], &["study", "study.toml", "--out", "out"]] {
            let run = folder.run(command);
            assert_eq!(run.code, Some(2), "{to}: {}", run.stderr);
            assert!(parts.iter().all(|part| run.stderr.contains(part)), "{to}: {}", run.stderr);
        }
        assert!(!folder.path("out").exists());
    }
}
