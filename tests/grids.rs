//! `isostudy extract --grid`, and grids as objects of a study, as a user runs them: one surface by every route, what is said, what is
//! refused.

use crate::command::Folder;
use isostudy_mesh::MeshFormat;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// The files that VTK wrote of one grid of tetrahedra; see the tests of isostudy-grid.
fn written_by_vtk() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../isostudy-grid/tests/it/vtk")
}

fn copy_all(folder: &Folder) -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(written_by_vtk()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        fs::copy(&path, folder.path(&name)).unwrap();
        names.push(name);
    }
    let cpu = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/cpu/x86-64-v3.toml");
    fs::copy(cpu, folder.path("cpu.toml")).unwrap();
    names.sort();
    names
}

/// A grid by its own cells and by cubes.
const STUDY: &str = r#"
schema = 1
[study]
id = "grids"
title = "A grid's cells and cubes"
seed = 1
[limits]
memory_gib = 2.0
[[methods]]
id = "cells"
label = "the grid's cells"
recipe = { kind = "grid-cells" }
[[methods]]
id = "mc33"
label = "cubes"
recipe = { kind = "cubes" }
[[objects]]
id = "g"
name = "points in a box"
field = { kind = "grid", file = "few_51_0_vtu.vtk", array = "a value" }
isovalue = 0.105
min = [-1.0, -1.0, -1.0]
max = [1.0, 1.0, 1.0]
benchmark_spacing = 0.25
stimulus_spacing = 0.25
camera = { distance = 2.0, vertical_fov_rad = 0.6 }
[turntable]
width = 64
height = 64
frames = 2
duration_s = 0.2
elevation_rad = 0.3
near = 0.01
far = 100.0
supersampling = 1
[shading]
light = [-0.6, 0.2, -0.8]
light_follows = "camera"
ambient = 0.25
lit = [0.949, 0.553, 0.027]
shade = [0.212, 0.071, 0.310]
highlight = [1.0, 0.95, 0.8]
background = [0.004, 0.509, 0.506]
[stimuli]
pair_scale = 1
[benchmark]
warmup = 0
iterations = 2
short_iterations = 2
threads = 1
target = "cpu.toml"
"#;

#[test]
fn every_route_makes_one_mesh() {
    let folder = Folder::new();
    let mut meshes: Vec<(String, Vec<u8>)> = Vec::new();
    let few = copy_all(&folder).into_iter().filter(|name| name.starts_with("few") && !name.ends_with(".txt"));
    for name in few {
        let array = if name.contains('_') { "a value" } else { "1" };
        let said = folder.succeed(&[
            "extract",
            "--grid",
            &name,
            "--array",
            array,
            "--isovalue",
            "0.105",
            "-o",
            "a.ply",
        ]);
        assert_eq!(said.stdout, "a.ply\n");
        assert!(
            said.stderr.starts_with("a.ply: 80 triangles, 49 vertices, extracted in "),
            "{}",
            said.stderr
        );
        meshes.push((name, fs::read(folder.path("a.ply")).unwrap()));
    }
    folder.write("study.toml", STUDY);
    folder.succeed(&["extract", "study.toml", "-o", "out"]);
    meshes.push(("the study".into(), fs::read(folder.path("out/meshes/benchmark/g_cells.ply")).unwrap()));
    assert_eq!(meshes.len(), 12);
    for (name, mesh) in &meshes {
        assert!(*mesh == meshes[0].1, "{name}");
    }
    // The study's field is the interpolant whose surface it is.
    let record: Value = serde_json::from_str(&folder.read("out/meshes/benchmark/g_cells.json")).unwrap();
    let farthest = record["accuracy"]["distance"]["max"].as_f64().unwrap();
    assert!(farthest < 1e-5, "{farthest}");
}

#[test]
fn a_study_of_a_grid_has_times_and_a_report() {
    let folder = Folder::new();
    copy_all(&folder);
    folder.write("study.toml", STUDY);
    folder.succeed(&["validate", "study.toml"]);
    folder.succeed(&["study", "study.toml", "--out", "out"]);
    let table = folder.read("out/tables/benchmark.csv");
    let mut rows =
        table.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap();
    let column = |name: &str| names.iter().position(|other| *other == name).unwrap();
    let of_cells = rows.find(|row| row[0] == "g_cells").unwrap();
    assert_eq!(of_cells[column("triangles")], "80");
    assert!(of_cells[column("total_without_normals_s")].parse::<f64>().unwrap() > 0.0);
    // Another file is another mesh: the study makes it again.
    let said = folder.succeed(&["study", "study.toml", "--out", "out"]);
    assert!(!said.stderr.contains("g_cells"), "{}", said.stderr);
    let text = folder.read("few_51_0_vtu.vtk").replace("a%20value", "b%20value");
    folder.write("few_51_0_vtu.vtk", text);
    let said = folder.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(said.code, Some(2));
    assert!(
        said.stderr.contains("no array on points has the name `a value`; those on points are"),
        "{}",
        said.stderr
    );
    assert!(said.stderr.contains("; did you mean b value?"), "{}", said.stderr);
}

#[test]
fn the_report_says_what_the_surface_is() {
    let folder = Folder::of("extract");
    copy_all(&folder);
    let of = ["--grid", "few_51_0_vtu.vtk", "--array", "a value", "--isovalue", "0.105", "-o", "a.glb"];
    let said = folder.succeed(&[&of[..], &["--json", "--picture", "a.png"]].concat());
    let report: Value = serde_json::from_str(&said.stdout).unwrap();
    let grid = ["points", "cells", "tetrahedra"].map(|key| report[key].as_u64().unwrap());
    assert_eq!((grid[1], grid[2]), (66, 66));
    assert_eq!(report["array"], json!("a value"));
    assert_eq!(report["inside"], json!("above"));
    let topology = &report["topology"];
    assert_eq!((topology["vertices"].clone(), topology["misoriented_edges"].clone()), (json!(49), json!(0)));
    assert!(fs::read(folder.path("a.png")).unwrap().starts_with(b"\x89PNG"));
    let said = folder.succeed(&[&of[..], &["--quality"]].concat());
    let first = said.stdout.lines().next().unwrap();
    assert!(first.starts_with("grid            24 points, 66 cells, 66 tetrahedra, "), "{first}");
    // From the other side it is the same surface, turned round.
    let area = |name: &str, side: &str| {
        folder.succeed(&[&of[..6], &["-o", name, "--inside", side]].concat());
        let mesh = MeshFormat::Ply.read(&*fs::read(folder.path(name)).unwrap()).unwrap();
        (0..mesh.triangles.len()).fold(glam::DVec3::ZERO, |sum, t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
            sum + (b - a).cross(c - a)
        })
    };
    assert!((area("above.ply", "above") + area("below.ply", "below")).length() < 1e-4);
}

#[test]
fn what_cannot_be_taken_is_told() {
    let folder = Folder::of("extract");
    copy_all(&folder);
    let grid = ["--grid", "few_51_0_vtu.vtk", "-o", "a.ply"];
    let told = |more: &[&str]| {
        let said = folder.run(&[&grid[..], more].concat());
        assert_eq!(said.code, Some(2), "{more:?}: {}", said.stderr);
        assert!(!folder.path("a.ply").exists());
        said.stderr
    };
    for (more, want) in [
        (
            &["--isovalue", "0", "--array", "a valeu"][..],
            "no array on points has the name `a valeu`; those on points are",
        ),
        (&["--isovalue", "0", "--array", "a valeu"], "; did you mean a value?"),
        (&["--isovalue", "0", "--array", "on cells"], "the array `on cells` has its values on cells"),
        (&["--isovalue", "0", "--array", "velocity"], "the array `velocity` has 3 numbers per point"),
        (
            &["--isovalue", "9", "--array", "a value"],
            "few_51_0_vtu.vtk: no surface at isovalue 9: the values run from ",
        ),
        (&["--array", "a value"], "--isovalue"),
        (&["--isovalue", "0", "--method", "mc"], "--method"),
        (&["--isovalue", "0", "--cells", "9"], "--cells"),
        (&["--isovalue", "0", "--close"], "--close"),
        (&["--isovalue", "0", "--memory", "1kB"], "few_51_0_vtu.vtk: larger than 1000 bytes"),
    ] {
        let got = told(more);
        assert!(got.contains(want), "{more:?}: {got}");
    }
    let said =
        folder.run(&["--grid", "few.node", "--isovalue", "0", "-o", "few.node.ply", "--picture", "few.node"]);
    assert!(said.stderr.contains("few.node: is the input; it would be written over"), "{}", said.stderr);
}

#[test]
fn what_is_odd_in_a_grid_is_told_and_taken() {
    let folder = Folder::of("extract");
    let points = "0 0 0  1 0 0  0 1 0  0 0 1  1 1 1  0 0 1  5 5 5";
    let text = format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 7 double\n{points}\nCELLS 4 20\n4 0 1 2 3\n\
         4 1 3 2 4\n4 0 1 2 5\n4 1 2 4 6\nCELL_TYPES 4\n10 10 10 10\nPOINT_DATA 7\nSCALARS v double\nLOOKUP_TABLE default\n\
         1 0 0 0 -1 0 nan\n"
    );
    folder.write("odd.vtk", text);
    let said = folder.succeed(&["--grid", "odd.vtk", "--isovalue", "0.5", "-o", "a.ply"]);
    for part in [
        "odd.vtk: 1 cell wound against the others: turned round\n",
        "odd.vtk: 1 tetrahedron with a value that is not finite: no surface goes through it\n",
        "odd.vtk: 1 point at the place of an earlier one: cells on different points do not hang together\n",
    ] {
        assert!(said.stderr.contains(part), "{}", said.stderr);
    }
}

#[test]
fn cells_of_a_grid_are_no_method_of_other_objects() {
    let folder = Folder::new();
    copy_all(&folder);
    let told = |from: &str, to: &str| {
        assert!(STUDY.contains(from));
        folder.write("study.toml", STUDY.replacen(from, to, 1));
        let said = folder.run(&["validate", "study.toml"]);
        assert_eq!(said.code, Some(2), "{}", said.stderr);
        said.stderr
    };
    let field = "field = { kind = \"grid\", file = \"few_51_0_vtu.vtk\", array = \"a value\" }";
    for (from, to, want) in [
        (
            field,
            "field = { kind = \"formula\", text = \"x^2 + y^2 + z^2 - 0.5\" }",
            "object g has no cells of its own",
        ),
        ("array = \"a value\"", "array = \"velocity\"", "the array `velocity` has 3 numbers per point"),
        ("few_51_0_vtu.vtk", "none.vtk", "none.vtk: no such file"),
        ("isovalue = 0.105", "isovalue = 8.0", "has every value on one side of isovalue = 8.0"),
        (
            "recipe = { kind = \"grid-cells\" }",
            "recipe = { kind = \"grid-cells\" }\nmatch = { triangles_of = \"mc33\" }",
            "the cells of a grid have no spacing to choose",
        ),
        ("kind = \"grid-cells\"", "kind = \"grid-cell\"", "grid-cells"),
    ] {
        let got = told(from, to);
        assert!(got.contains(want), "{to}: {got}");
    }
    // The surface lies in the object's box, as that of other methods must.
    folder.write("study.toml", STUDY.replacen("max = [1.0, 1.0, 1.0]", "max = [1.0, 1.0, 0.2]", 1));
    let said = folder.run(&["extract", "study.toml", "--only", "g_cells", "-o", "out"]);
    assert_eq!(said.code, Some(2), "{}", said.stderr);
}
