//! A study may compare any method on any object: everything at once, from a study file to a report whose tests are about methods; and
//! what is said where something is wrong with it.

use crate::command::{Folder, Run};
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
struct Study(Folder);

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
    fn new() -> Self {
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

    fn edit(&self, from: &str, to: &str) {
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

    fn table(&self, path: &str) -> Vec<Vec<String>> {
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
    let ran = folder.run(&["extract", "study.toml", "--out", "out", "--allow-programs"]);
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    for part in ["study.toml: methods[2].match.triangles_of = bi", "te_fp", " 1 %"] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
    // Who takes what is nearer than that says so.
    folder.edit("match = { triangles_of = \"bi\" }", "match = { triangles_of = \"bi\", within = 0.2 }");
    folder.succeed(&["extract", "study.toml", "--out", "out", "--allow-programs"]);
}

/// A program that crashes, hangs or answers with nonsense fails by name; the others go on, and the exit code says so.
#[test]
fn a_program_that_fails_is_left_out_by_name() {
    for (program, told) in [
        (
            "import time\nprint('{\"ready\": {\"name\": \"x\", \"version\": \"1\"}}', flush=True)\ntime.sleep(60)\n",
            "5 s",
        ),
        ("print('hello', flush=True)\ninput()\n", "`hello`"),
    ] {
        left_out(program, told, "extract");
    }
    let told = "ended with code 3";
    let folder = left_out("import sys\nsys.exit(3)\n", told, "study");
    let benchmark = folder.table("out/tables/benchmark.csv");
    let ids: BTreeSet<&str> = benchmark[1..].iter().map(|row| row[0].as_str()).collect();
    assert!(ids.contains("fo_bi") && !ids.contains("fo_program"), "{ids:?}");
    let left_out = folder.table("out/tables/left_out.csv");
    let ids: Vec<&str> = left_out[1..].iter().map(|row| row[0].as_str()).collect();
    assert_eq!(ids, ["fo_program", "te_program", "vo_program"]);
    assert!(left_out[1][1].contains(told), "{left_out:?}");
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert!(
        page.contains("Nothing is said about fo_program, te_program and vo_program, which failed."),
        "{told}"
    );
    // Every picture that the page names is there.
    let page = page.replace("&#x2f;", "/");
    let sources = page.split("src=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let missing: Vec<&str> = sources.filter(|file| !folder.path(&format!("out/{file}")).exists()).collect();
    assert_eq!(missing, [""; 0], "{told}");
    let bundle = folder.run(&["bundle", "study.toml", "--out", "out", "--allow-programs"]);
    assert_eq!(bundle.code, Some(2), "{}", bundle.stderr);
}

/// Runs the study's meshes, or all of it, with a program that fails; others are made, and the exit code and the words say who is not.
fn left_out(program: &str, told: &str, command: &str) -> Study {
    let folder = Study::new();
    folder.write("example.py", program);
    // Enough to start Python beside other work.
    folder.edit("time_limit_s = 60", "time_limit_s = 5");
    let ran = folder.run(&[command, "study.toml", "--out", "out", "--allow-programs"]);
    assert_eq!(ran.code, Some(1), "{program}: {}", ran.stderr);
    assert!(ran.stderr.contains("fo_program failed") && ran.stderr.contains(told), "{told}: {}", ran.stderr);
    assert!(ran.stderr.contains("failed and left out: fo_program, te_program, vo_program"), "{}", ran.stderr);
    assert!(folder.path("out/meshes/benchmark/fo_bi.json").exists());
    assert!(!folder.path("out/meshes/benchmark/fo_program.json").exists());
    folder
}

/// A program that crashes in the middle of the benchmark loses its own times and nobody else's; and one is inspected and swept like an
/// extractor of ours.
#[test]
fn a_program_that_fails_while_it_is_timed_is_left_out_of_the_times() {
    let number = |text: &str| text.parse::<f64>().unwrap();
    let folder = Study::new();
    let example = fs::read_to_string(folder.path("example.py")).unwrap();
    let from = "    request = json.loads(line)\n";
    assert!(example.contains(from));
    // A process of the meshes is asked once; one of the benchmark more often.
    let crash = format!("{from}    if request[\"id\"] == 2 and request[\"size\"][2] < 13: sys.exit(3)\n");
    folder.write("example.py", example.replacen(from, &crash, 1));
    let line = ["study", "study.toml", "--out", "out", "--allow-programs"];
    for time in 0..2 {
        let ran = folder.run(&line);
        assert_eq!(ran.code, Some(1), "{}", ran.stderr);
        assert!(ran.stderr.contains("failed and left out: fo_program, te_program"), "{time}: {}", ran.stderr);
        assert!(ran.stderr.contains("ended with code 3"), "{time}: {}", ran.stderr);
        let samples = folder.table("out/bench/short/samples.csv");
        let times = |id: &str| samples.iter().filter(|row| row[0] == id).count();
        assert_eq!((times("fo_bi"), times("vo_program"), times("fo_program")), (2, 2, 0), "{samples:?}");
        // A program's own time (the eighth column) lies within the time from outside (the last), which others have not.
        for row in &samples[1..] {
            match row[0] == "vo_program" {
                true => assert!(number(&row[19]) >= number(&row[7]) && number(&row[7]) > 0.0, "{row:?}"),
                false if !row[0].ends_with("_program") => assert_eq!(row[19], "", "{row:?}"),
                false => {}
            }
        }
    }
    assert!(folder.path("out/meshes/stimulus/fo_program.ply").exists());

    let inspect = ["inspect", "vo_program", "--study", "study.toml", "--iterations", "2", "--json"];
    // Somebody else has allowed nothing yet.
    let mut other = folder.isostudy();
    let refused = Run::of(other.args(inspect).env("XDG_STATE_HOME", folder.path("of-another")));
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("--allow-programs"), "{}", refused.stderr);
    let panel: serde_json::Value =
        serde_json::from_str(&folder.succeed(&[&inspect[..], &["--allow-programs"]].concat()).stdout)
            .unwrap();
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path("out/meshes/benchmark/vo_program.json")).unwrap())
            .unwrap();
    assert_eq!(panel["mesh"]["counts"], record["counts"]);
    assert_eq!(panel["iterations"], 2);
    assert!(panel["times"][6]["median"].as_f64().unwrap() > 0.0);
    // One with a budget has the spacing that the study found for it.
    let budget = ["inspect", "fo_fp", "--study", "study.toml", "--iterations", "1", "--json"];
    let panel: serde_json::Value = serde_json::from_str(&folder.succeed(&budget).stdout).unwrap();
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path("out/meshes/benchmark/fo_fp.json")).unwrap()).unwrap();
    assert_eq!(panel["mesh"]["spacing"], record["spacing"]);
    assert_ne!(panel["mesh"]["spacing"], 0.1);
    // A mesh that was made by hand is measured, and has no time.
    let artist = folder.succeed(&["inspect", "vo_artist", "--study", "study.toml"]).stdout;
    assert!(artist.contains("timing: none, the mesh was read from a file"), "{artist}");
}

/// A mesh with a hole is told of once, by whichever process reads it first; and a program that fails at its third call is left out of a
/// benchmark by name, while the others' rounds go on to the end.
#[test]
fn a_program_that_fails_at_its_third_call_is_left_out_of_a_benchmark() {
    let folder = Study::new();
    folder.edit(
        "{ kind = \"formula\", text = \"sqrt((sqrt(x^2 + y^2) - 0.6)^2 + z^2) - 0.25\" }",
        "{ kind = \"mesh\", file = \"open.obj\" }",
    );
    // An octahedron without one of its sides.
    folder.write(
        "open.obj",
        "v 0.6 0 0\nv -0.6 0 0\nv 0 0.3 0\nv 0 -0.3 0\nv 0 0 0.4\nv 0 0 -0.4\n\
         f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\n",
    );
    let example = fs::read_to_string(folder.path("example.py")).unwrap();
    let from = "    request = json.loads(line)\n";
    let words = "no third time";
    let crash =
        format!("{from}    if request[\"id\"] == 3 and request[\"size\"][2] < 13: sys.exit(\"{words}\")\n");
    folder.write("example.py", example.replacen(from, &crash, 1));
    folder.edit("iterations = 2", "iterations = 4");
    let only = ["fo_bi", "fo_fp", "fo_program", "vo_bi", "vo_program"];
    let only: Vec<&str> = only.iter().flat_map(|id| ["--only", id]).collect();
    let times = |text: &str, hole: &str| text.matches(hole).count();
    let closed = "open.obj: 1 hole was closed";

    let this = env!("CARGO_BIN_EXE_isostudy");
    let short = ["--seconds", "1", "--processes", "3", "--allow-programs"];
    let ab = [&["bench", "ab", this, this, "study.toml", "--out", "out"][..], &only, &short].concat();
    for time in 0..2 {
        let ran = folder.run(&ab);
        assert_eq!(ran.code, Some(1), "{}{}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains(words), "{time}: what it said: {}", ran.stderr);
        assert!(ran.stderr.contains("failed and left out: fo_program\n"), "{time}: {}", ran.stderr);
        assert!(ran.stdout.contains("Failed and left out: fo_program."), "{time}: {}", ran.stdout);
        assert!(ran.stdout.contains("4 configurations in 3 pairs of processes"), "{time}: {}", ran.stdout);
        // The second run finds everything up to date and reads no mesh.
        assert!(times(&ran.stderr, closed) <= 1, "{}", ran.stderr);
        assert!(time == 1 || times(&ran.stderr, closed) == 1, "{}", ran.stderr);
    }
    let run: serde_json::Value = serde_json::from_str(&folder.read("out/bench/ab/ab.json")).unwrap();
    let pairs = run["pairs"].as_array().unwrap();
    let of = |id: &str| pairs.iter().filter(|pair| pair["old"]["id"] == id).count();
    assert!(of("fo_program") == 0 && of("vo_program") >= 3 * 3, "{run}");
    assert_eq!(of("fo_bi"), of("vo_program"));
    assert_eq!(run["failed"][0]["id"], "fo_program");
    assert!(run["failed"][0]["reason"].as_str().unwrap().contains(words));
    let table = folder.read("out/bench/ab/bench_ab.md");
    assert!(table.contains("failed and is left out: asked by ") && table.contains(words), "{table}");
    let json = folder.run(&[&ab[..], &["--format", "json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!((&json["exit_status"], &json["failed"][0]["id"]), (&1.into(), &"fo_program".into()));

    let ran = folder.run(&[&["bench", "study.toml", "--out", "out", "--allow-programs"][..], &only].concat());
    assert_eq!(ran.code, Some(1), "{}{}", ran.stdout, ran.stderr);
    assert_eq!(times(&ran.stderr, closed), 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("failed and left out: fo_program\n"), "{}", ran.stderr);
    let run: serde_json::Value = serde_json::from_str(&folder.read("out/bench/selected/run.json")).unwrap();
    let of = |id: &str| run["samples"].as_array().unwrap().iter().filter(|sample| sample["id"] == id).count();
    assert_eq!((of("fo_program"), of("vo_program"), of("fo_bi")), (0, 4, 4), "{}", run["failed"]);
    let told = ran.stdout.replace('\\', "");
    assert!(told.contains("| vo_program |") && !told.contains("| fo_program |"), "{told}");
}
