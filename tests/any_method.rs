//! A study may compare any method on any object: everything at once, from a study file to a report whose tests are about methods; and
//! what is said where something is wrong with it.

use crate::command::Folder;
use crate::http;
use crate::server::{Server, TOKEN, answer, begin};
use std::collections::BTreeSet;
use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::process::Command;

const STUDY: &str = include_str!("any_method/study.toml");
const METHODS: [&str; 5] = ["bi", "bi-relaxed", "fp", "program", "artist"];
const OBJECTS: [&str; 3] = ["fo", "te", "vo"];

/// The study with all that it names, in a folder of its own.
pub(crate) struct Study(Folder);

impl Deref for Study {
    type Target = Folder;

    fn deref(&self) -> &Folder {
        &self.0
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

impl Study {
    /// The study with its files: a program, a scan, and meshes made by hand.
    pub(crate) fn new() -> Self {
        let folder = Self(Folder::new());
        let mut comparisons = String::from("comparisons = [\n");
        let mut number = 0;
        for object in OBJECTS {
            for (i, left) in METHODS.iter().enumerate() {
                for right in &METHODS[i + 1..] {
                    number += 1;
                    comparisons += &format!(
                        "  {{ question = \"Q{number}\", left = \"{object}_{left}\", right = \"{object}_{right}\" }},\n"
                    );
                }
            }
        }
        folder.write("study.toml", STUDY.replace("schema = 1\n", &format!("schema = 1\n{comparisons}]\n")));
        fs::copy(root().join("scripts/methods/example.py"), folder.path("example.py")).unwrap();
        fs::copy(root().join("configs/cpu/x86-64-v3.toml"), folder.path("cpu.toml")).unwrap();
        fs::write(folder.path("scan.nrrd"), scan()).unwrap();
        fs::create_dir(folder.path("by-hand")).unwrap();
        // Coarser than any other, from the same surfaces.
        let ring = "sqrt((sqrt(x^2 + y^2) - 0.6)^2 + z^2) - 0.25";
        let boxed = "--bounds=-1,-1,-0.5,1,1,0.5";
        folder.extract(&["--field", ring, boxed, "--spacing", "0.2", "-o", "by-hand/fo.ply"]);
        let hill = "max(z - 0.3*fbm(x, y, 0, 2), max(max(abs(x), abs(y)) - 0.9, -0.4 - z))";
        folder.extract(&["--field", hill, boxed, "--spacing", "0.2", "-o", "by-hand/te.obj"]);
        folder.extract(&[
            "--volume",
            "scan.nrrd",
            "--isovalue",
            "0.5",
            "--spacing",
            "0.25",
            "--close",
            "-o",
            "by-hand/vo.ply",
        ]);
        folder
    }

    pub(crate) fn edit(&self, from: &str, to: &str) {
        let text = fs::read_to_string(self.path("study.toml")).unwrap();
        assert!(text.contains(from), "{from} is not in the study");
        self.write("study.toml", text.replacen(from, to, 1));
    }

    /// With VTK's Flying Edges for the program where Python has VTK. `METHODS_PYTHON` names that Python; where there is none, the example of
    /// docs/programs.md stays, and that is said.
    fn with_vtk() -> (Self, String) {
        let (folder, python) = (Self::new(), std::env::var("METHODS_PYTHON").unwrap_or("python3".into()));
        let import = Command::new(&python).args(["-c", "import numpy, vtkmodules.vtkFiltersCore"]).output();
        if !import.is_ok_and(|output| output.status.success()) {
            eprintln!(
                "SKIPPED: VTK's program: {python} has no VTK; the example of docs/programs.md stands in for it"
            );
            return (folder, "python3 ./example.py".into());
        }
        for file in ["vtk_flying_edges.py", "vtk_image.py", "protocol.py"] {
            fs::copy(root().join("scripts/methods").join(file), folder.path(file)).unwrap();
        }
        folder.edit("\"python3\", \"./example.py\"", &format!("{python:?}, \"./vtk_flying_edges.py\""));
        folder.edit("memory_gib = 1.0", "memory_gib = 4.0");
        (folder, format!("{python} ./vtk_flying_edges.py"))
    }

    fn extract(&self, arguments: &[&str]) {
        self.succeed(&[&["extract"], arguments].concat());
    }

    pub(crate) fn table(&self, path: &str) -> Vec<Vec<String>> {
        let text = fs::read_to_string(self.path(path)).unwrap();
        text.lines().filter(|line| !line.starts_with('#')).map(cells).collect()
    }
}

/// The cells of a line of CSV.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            _ => cells.last_mut().unwrap().push(letter),
        }
    }
    cells
}

/// A ball's density on 25 samples along each side, from -1 to 1: a half at a distance of 0.7.
fn scan() -> Vec<u8> {
    let n = 25;
    let step = 2.0 / (n - 1) as f32;
    let mut bytes = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {n} {n} {n}\nendian: little\nencoding: raw\nspace dimension: 3\n\
         space directions: ({step},0,0) (0,{step},0) (0,0,{step})\nspace origin: (-1,-1,-1)\n\n"
    )
    .into_bytes();
    let at = |i: i32| i as f32 * step - 1.0;
    for k in 0..n {
        for j in 0..n {
            for i in 0..n {
                let distance = (at(i).powi(2) + at(j).powi(2) + at(k).powi(2)).sqrt();
                bytes.extend((1.2 - distance).to_le_bytes());
            }
        }
    }
    bytes
}

#[test]
fn any_method_on_any_object_from_file_to_report() {
    let (folder, program) = Study::with_vtk();
    let faults = folder.run(&["design", "check", "study.toml"]);
    assert_eq!(faults.code, Some(0), "{}{}", faults.stdout, faults.stderr);
    folder.succeed(&["validate", "study.toml"]);

    // A study file from a stranger is code.
    let refused = folder.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    let quoted: Vec<String> = program.split(' ').map(|word| format!("{word:?}")).collect();
    assert!(
        refused.stderr.contains("--allow-programs")
            && refused.stderr.contains(&format!("program: {}", quoted.join(" "))),
        "{}",
        refused.stderr
    );
    assert!(!folder.path("out").exists());

    folder.succeed(&["study", "study.toml", "--out", "out", "--allow-programs"]);
    for object in OBJECTS {
        for method in METHODS {
            assert!(folder.path(&format!("out/meshes/benchmark/{object}_{method}.ply")).exists());
        }
    }
    let benchmark = folder.table("out/tables/benchmark.csv");
    let column =
        |name: &str| benchmark[0].iter().position(|title| title == name).unwrap_or_else(|| panic!("{name}"));
    let cell = |id: &str, name: &str| {
        benchmark.iter().find(|row| row[0] == id).unwrap_or_else(|| panic!("{id}"))[column(name)].clone()
    };
    for object in OBJECTS {
        let number =
            |method: &str, name: &str| cell(&format!("{object}_{method}"), name).parse::<f64>().unwrap();
        // The budget is met to 1 %, by another spacing.
        let share = number("fp", "triangles") / number("bi", "triangles");
        assert!((share - 1.0).abs() <= 0.01, "{object}: {share}");
        // What a method has not is an empty cell, and what has no time has none.
        assert_eq!(cell(&format!("{object}_program"), "tetrahedra"), "");
        assert_eq!(cell(&format!("{object}_artist"), "total_without_normals_s"), "");
        assert!(number("program", "total_without_normals_s") > 0.0);
        // Relaxing moves vertices and leaves triangles.
        assert_eq!(number("bi", "triangles"), number("bi-relaxed", "triangles"));
    }
    // Another spacing stands in the table, and why under it and under the figures.
    assert_ne!(cell("fo_fp", "spacing"), cell("fo_bi", "spacing"));
    let configurations = folder.table("out/tables/configurations.csv");
    let at = configurations[0].iter().position(|title| title == "benchmark_spacing").unwrap();
    let said = |id: &str| configurations.iter().find(|row| row[0] == id).unwrap()[at].clone();
    assert_eq!(said("fo_fp"), cell("fo_fp", "spacing"));
    // A mesh that was there has no grid; a program says who it is, and its stages are not told apart.
    assert_eq!([said("fo_artist"), cell("fo_artist", "resolution"), cell("fo_artist", "spacing")], [""; 3]);
    for stage in ["allocation_s", "vertex_s", "clustering_s", "normals_s"] {
        assert_eq!(cell("fo_program", stage), "", "{stage}");
        assert_ne!(cell("fo_bi", stage), "", "{stage}");
    }
    let programs = folder.table("out/tables/programs.csv");
    assert_eq!(programs.len(), 2, "{programs:?}");
    assert!(programs[1].iter().take(3).all(|cell| !cell.is_empty()), "{programs:?}");
    let why = "Spacings were chosen for fp to have as many triangles as bi to 1 %";
    for page in ["tables/benchmark.md", "index.html"] {
        assert!(fs::read_to_string(folder.path("out").join(page)).unwrap().contains(why), "{page}");
    }
    let manifest: serde_json::Value = serde_json::from_str(&folder.read("out/manifest.json")).unwrap();
    let inputs: BTreeSet<&str> = manifest["inputs"].as_object().unwrap().keys().map(String::as_str).collect();
    for file in ["scan.nrrd", "by-hand/fo.ply", "by-hand/te.obj", "by-hand/vo.ply"] {
        assert!(inputs.contains(file), "{file} is not among {inputs:?}");
    }
    assert_eq!(cell("fo_bi", "method"), "body-centred, integrated");
    assert_eq!(cell("fo_bi-relaxed", "placement"), "relaxed");
    assert_eq!(cell("fo_fp", "placement"), "");

    // Again: nothing is made, whatever the kind.
    let again = folder.succeed(&["study", "study.toml", "--out", "out", "--allow-programs"]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
    // One method is shown flat. Where its animations are that much brighter or darker, the design's judge says so; they are bundled
    // nevertheless.
    let judged = folder.run(&["design", "check", "study.toml", "--results", "out"]);
    assert!(judged.code == Some(0) || judged.stdout.contains("exposure"), "{}", judged.stdout);
    folder.succeed(&["bundle", "study.toml", "--out", "out", "--allow-programs", "--with-faults"]);
    assert_eq!(fs::read_dir(folder.path("out/bundle/stimuli")).unwrap().count() % 2, 0);

    answered(&folder);
    served(&folder);
}

/// The same truth through the server: whoever sees relaxed vertices presses their side, on the form that they were dealt.
fn served(folder: &Study) {
    folder.succeed(&["design", "forms", "study.toml", "--out", "dealt"]);
    let key = folder.table("dealt/key/forms.csv");
    let column =
        |name: &str| key[0].iter().position(|title| title == name).unwrap_or_else(|| panic!("{name}"));
    let [form, role, stimulus, left, right] = ["form", "role", "stimulus", "left", "right"].map(column);
    let mut command = folder.isostudy();
    command.args(["serve", "study.toml", "--out", "out", "--answers", "kept", "--port", "0"]);
    command.args(["--admin-token", TOKEN, "--with-faults", "--allow-programs"]);
    let server = Server::of(command);
    let mut pressed = 0;
    for _ in 0..6 {
        let session = begin(server.address);
        let dealt = session["form"]["form"].to_string();
        let own = key.iter().filter(|row| row[form] == dealt);
        for (place, shown) in own.filter(|row| row[role] != "training").enumerate() {
            assert_eq!(session["form"]["questions"][place], shown[stimulus]);
            let choice = match [left, right].map(|side| shown[side].ends_with("_bi-relaxed")) {
                [true, false] => "L",
                [false, true] => "R",
                _ => "NP",
            };
            pressed += u64::from(choice != "NP" && shown[role] == "comparison");
            let sent = answer(&session, place, choice);
            assert_eq!(http::post(server.address, "/api/answers", &sent).unwrap().0, 200);
        }
    }
    drop(server);
    assert!(pressed > 0);
    folder.succeed(&["deidentify", "study.toml", "--answers", "kept", "--out", "shared"]);
    folder.succeed(&["analyse", "study.toml", "--responses", "shared/answers.csv", "--out", "served"]);
    let counts = folder.table("served/tables/preference_groups.csv");
    let wins = counts[0].iter().position(|title| title == "wins").unwrap();
    for row in &counts[1..] {
        let expected = if row[1] == "bi-relaxed" { pressed } else { 0 };
        assert_eq!(row[wins], expected.to_string(), "{row:?}");
    }
}

/// Everybody likes relaxed vertices wherever they see them, and has no preference else. The tests are about methods.
fn answered(folder: &Study) {
    let study: toml::Table = fs::read_to_string(folder.path("study.toml")).unwrap().parse().unwrap();
    let mut long = String::from("participant,question,left,right,choice\n");
    for person in 0..24 {
        for comparison in study["comparisons"].as_array().unwrap() {
            let text = |key: &str| comparison[key].as_str().unwrap();
            let (mut left, mut right) = (text("left"), text("right"));
            if person % 2 == 1 {
                (left, right) = (right, left);
            }
            let choice = match (left.ends_with("_bi-relaxed"), right.ends_with("_bi-relaxed")) {
                (true, _) => "left",
                (_, true) => "right",
                _ => "none",
            };
            long += &format!("p{person},{},{left},{right},{choice}\n", text("question"));
        }
    }
    folder.write("answers.csv", &long);
    folder.succeed(&["analyse", "study.toml", "--responses", "answers.csv", "--out", "analysed"]);
    let tests = folder.table("analysed/tables/tests.csv");
    let column =
        |name: &str| tests[0].iter().position(|title| title == name).unwrap_or_else(|| panic!("{name}"));
    let found: Vec<(&str, &str, f64)> = tests[1..]
        .iter()
        .filter(|row| row[column("scope")] == "all")
        .map(|row| {
            (&*row[column("family")], &*row[column("contrast")], row[column("p_adjusted")].parse().unwrap())
        })
        .collect();
    // One declared factor, and ten pairs of methods of which it has one.
    let pooled: Vec<&str> = found.iter().filter(|of| of.0 == "pooled").map(|of| of.1).collect();
    assert_eq!(pooled, ["mean-relaxed"]);
    let methods: BTreeSet<&str> = found.iter().filter(|of| of.0 == "methods").map(|of| of.1).collect();
    assert_eq!(methods.len(), 9, "{methods:?}");
    for (family, contrast, p) in &found {
        let about_relaxed = contrast.contains("relaxed");
        assert!(if about_relaxed { *p < 0.001 } else { *p > 0.5 }, "{family} {contrast}: {p}");
    }
    let report = fs::read_to_string(folder.path("analysed/report.md")).unwrap();
    for told in [
        "Relaxed vertices was preferred to mean placement: 72 answers against 0, none without preference; 100 %",
        "Body-centred, integrated, relaxed was preferred to made by hand: 72 answers against 0, none without preference; 100 %",
    ] {
        assert!(report.contains(told), "{report}");
    }
}

/// What is wrong is said with file, key and what is allowed, before any work starts.
#[test]
fn bad_input_is_refused_before_any_work() {
    for (from, to, told) in [
        ("id = \"fp\"", "id = \"bi\"", vec!["study.toml: line ", ": methods[2].id = bi"]),
        (
            "levels = { placement = \"mean\" }",
            "levels = { colour = \"red\" }",
            vec!["methods[0].levels = colour", "placement"],
        ),
        (
            "levels = { placement = \"mean\" }",
            "levels = { placement = \"median\" }",
            vec!["methods[0].levels.placement = median", "mean, relaxed"],
        ),
        (
            "recipe = { kind = \"tetrahedra\", arrangement = \"body-centred\", clustering = \"integrated\" }",
            "recipe = { kind = \"tetrahedra\", arrangement = \"body-centred\", command = [\"x\"] }",
            vec!["study.toml: line ", ": methods[0].recipe", "command", "clustering"],
        ),
        (
            "recipe = { kind = \"tetrahedra\", arrangement = \"body-centred\", clustering = \"integrated\" }",
            "recipe = { kind = \"cones\" }",
            vec![
                "study.toml: line ",
                ": methods[0].recipe",
                "cones",
                "tetrahedra",
                "\"dual-contouring\", \"continuation\", \"program\", \"meshes\"",
            ],
        ),
        (
            "arrangement = \"face-centred\", clustering = \"edge-collapse\"",
            "arrangement = \"face-centred\", clustering = \"integrated\"",
            vec![
                "study.toml: line ",
                ": methods[2].recipe",
                "integrated clustering does not go with face-centred",
            ],
        ),
        (
            "recipe = { kind = \"tetrahedra\", arrangement = \"face-centred\"",
            "recipe = { kind = \"tetrahedra\", arrangement = \"diamond\"",
            vec!["study.toml: line ", ": methods[2].recipe", "diamond", "face-centred`\n"],
        ),
        ("- 0.25\" }", "+ 25\" }", vec!["study.toml: line ", ": objects[0].field", "no surface"]),
        ("z^2) - 0.25", "z^2 - 0.25", vec!["study.toml: line ", ": objects[0].field", "text"]),
        (
            "scan.nrrd",
            "skan.nrrd",
            vec!["study.toml: line ", ": objects[2].field", "skan.nrrd", "no such file"],
        ),
        (
            "character = \"caves\"",
            "character = \"moon\"",
            vec!["study.toml: line ", ": objects[1].field", "moon", "hills"],
        ),
        ("caves = 0.15", "caves = 15", vec!["study.toml: line ", ": objects[1].field", "caves", "0 to 0.5"]),
        ("./example.py", "./nobody.py", vec!["study.toml: line ", ": methods[3].recipe", "nobody.py"]),
        (
            "\"python3\"",
            "\"no-such-program-anywhere\"",
            vec!["study.toml: line ", ": methods[3].recipe", "no-such-program-anywhere"],
        ),
        ("fo = \"by-hand/fo.ply\", ", "", vec!["study.toml: line ", ": methods[4].recipe", "files.fo"]),
        (
            "by-hand/te.obj",
            "by-hand/nothing.obj",
            vec!["study.toml: line ", ": methods[4].recipe", "files.te", "no such file"],
        ),
        (
            "triangles_of = \"bi\"",
            "triangles_of = \"fp\"",
            vec!["study.toml: line ", ": methods[2].match.triangles_of = fp", "another method"],
        ),
        (
            "triangles_of = \"bi\"",
            "triangles_of = \"mc\"",
            vec!["study.toml: line ", ": methods[2].match.triangles_of = mc"],
        ),
        (
            "triangles_of = \"bi\"",
            "samples_of = \"artist\"",
            vec!["study.toml: line ", ": methods[2].match.samples_of = artist", "have no samples to match"],
        ),
        (
            "triangles_of = \"bi\"",
            "time_of = \"artist\"",
            vec!["study.toml: line ", ": methods[2].match.time_of = artist", "have no time to match"],
        ),
        (
            "triangles_of = \"bi\"",
            "vertices_of = \"bi\"",
            vec!["vertices_of", "triangles_of", "samples_of", "time_of"],
        ),
        (
            "triangles_of = \"bi\"",
            "triangles_of = \"bi\", time_of = \"bi\"",
            vec!["study.toml", "triangles_of, samples_of and time_of"],
        ),
        (
            "triangles_of = \"bi\"",
            "triangles_of = \"bi\", within = 2",
            vec!["study.toml: line ", ": methods[2].match.within = 2", "0.5"],
        ),
    ] {
        let folder = Study::new();
        folder.edit(from, to);
        let ran = folder.run(&["study", "study.toml", "--out", "out", "--allow-programs"]);
        assert_eq!(ran.code, Some(2), "{to}: {}{}", ran.stdout, ran.stderr);
        for part in told {
            assert!(ran.stderr.contains(part), "{to}: no `{part}` in: {}", ran.stderr);
        }
        assert!(!folder.path("out").exists(), "{to}");
    }
}

/// A budget that no spacing meets, since counts jump where one more cell fits into the box.
#[test]
fn a_budget_that_cannot_be_met_is_said() {
    let folder = Study::new();
    folder.edit("benchmark_spacing = 0.1\nstimulus_spacing = 0.11\ncamera = { distance = 2.0, vertical_fov_rad = 0.6 }\n\n[[objects]]\nid = \"vo\"", "benchmark_spacing = 0.1\nstimulus_spacing = 0.125\ncamera = { distance = 2.0, vertical_fov_rad = 0.6 }\n\n[[objects]]\nid = \"vo\"");
    // Of the terrain alone: its program would take as long as all else.
    let words =
        ["extract", "study.toml", "--out", "out", "--allow-programs", "--only", "te_bi", "--only", "te_fp"];
    let ran = folder.run(&words);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    for part in ["study.toml: methods[2].match.triangles_of = bi", "te_fp", " 1 %"] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
    // Who takes what is nearer than that says so.
    folder.edit("match = { triangles_of = \"bi\" }", "match = { triangles_of = \"bi\", within = 0.2 }");
    folder.succeed(&words);
}
