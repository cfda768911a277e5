//! `[sweep]`: cases, their jobs, and what is said of them; and several machines in one study.

use crate::command::{Folder, Run};
use crate::fixture::files;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// A ball and a box by two methods.
const STUDY: &str = r#"
schema = 1
study = { id = "swept", title = "Swept", seed = 1 }
limits = { memory_gib = 1.0 }
turntable = { width = 64, height = 64, frames = 2, duration_s = 1.0, elevation_rad = 0.5, near = 0.01, far = 10.0, supersampling = 1 }
shading = { light = [0.0, 1.0, 0.0], lit = [1.0, 0.5, 0.2], shade = [0.0, 0.0, 0.0], highlight = [1.0, 0.0, 0.0], background = [1.0, 1.0, 1.0], ambient = 0.1, error_scale = 1.0, crease_deg = 30.0 }
stimuli = { pair_scale = 1 }
benchmark = { warmup = 0, iterations = 6, short_iterations = 1, aa_iterations = 4, threads = 1, target = "cpu.toml" }

[[objects]]
id = "ball"
name = "ball"
field = { kind = "sphere", radius = 0.7 }
isovalue = 0.0
min = [-1.0, -1.0, -1.0]
max = [1.0, 1.0, 1.0]
benchmark_spacing = 0.25
stimulus_spacing = 0.25
camera = { distance = 2.0, vertical_fov_rad = 1.0 }

[[methods]]
id = "mc"
label = "cubes"
recipe = { kind = "cubes" }

[[methods]]
id = "bi"
label = "tetrahedra"
recipe = { kind = "tetrahedra", arrangement = "body-centred" }
"#;

fn folder(more: &str) -> Folder {
    let folder = Folder::new();
    folder.write("cpu.toml", include_str!("../configs/cpu/x86-64-v3.toml"));
    folder.write("study.toml", format!("{STUDY}\n{more}"));
    folder
}

fn study(folder: &Folder) -> Run {
    folder.succeed(&["study", "study.toml", "--out", "out"])
}

/// The rows of a table, by the columns' names. The name of a machine has commas in it.
fn table(folder: &Folder, name: &str) -> Vec<BTreeMap<String, String>> {
    let path = folder.path(&format!("out/tables/{name}.csv"));
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
    reader.deserialize().collect::<Result<_, _>>().unwrap()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

/// A sphere's triangles grow with the square of the resolution, and its distance falls with it; a larger sphere has more triangles.
#[test]
fn a_sweep_says_what_geometry_says() {
    let folder = folder(
        r#"
[sweep]
cells = [16, 32, 64]
cases_per_job = 5
pictures = true
[[sweep.settings]]
objects = ["ball"]
key = "field.radius"
values = [0.4, 0.8]
[[sweep.settings]]
methods = ["bi"]
key = "edge_clamp"
range = { from = 0.0, to = 0.02, steps = 3 }
"#,
    );
    study(&folder);
    let exponent = |id: &str, quantity: &str| {
        let rows = table(&folder, "sweep_exponents");
        let row = rows.iter().find(|row| row["id"] == id && row["quantity"] == quantity);
        number(&row.unwrap_or_else(|| panic!("{id} {quantity}: {rows:?}"))["exponent"])
    };
    for id in ["ball_mc", "ball_bi"] {
        assert!((exponent(id, "triangles") - 2.0).abs() < 0.1, "{id}: {}", exponent(id, "triangles"));
        let distance = exponent(id, "distance to the isosurface");
        assert!((distance + 2.0).abs() < 0.15, "{id}: {distance}");
        assert!((exponent(id, "sample points") - 3.0).abs() < 0.3, "{id}");
    }
    let rows = table(&folder, "sweep_settings");
    let triangles = |value: &str| {
        let of = |row: &&BTreeMap<String, String>| {
            row["id"] == "ball_mc"
                && row["setting"] == "object.field.radius"
                && row["value"] == value
                && row["quantity"] == "triangles"
        };
        number(&rows.iter().find(of).unwrap()["mean"])
    };
    // As the areas.
    let ratio = triangles("0.8") / triangles("0.4");
    assert!((ratio - 4.0).abs() < 0.2, "{ratio}");
    let cases = table(&folder, "sweep_cases");
    let said: Vec<String> =
        cases.iter().map(|row| format!("{} {} {}", row["id"], row["cases"], row["left_out"])).collect();
    assert_eq!(said, ["ball_mc 6 0", "ball_bi 18 0"]);
    let made = files(&folder.path("out"));
    let blocks: Vec<&String> =
        made.keys().filter(|path| path.ends_with(".parquet") && path.starts_with("sweep/")).collect();
    assert_eq!(blocks.len(), 2 + 4, "{blocks:?}");
    assert_eq!(made.keys().filter(|path| path.starts_with("sweep/pictures/")).count(), 24);
    let report = String::from_utf8_lossy(&made["report.html"]);
    assert!(report.contains("How measures change with resolution and settings"));
    // A second run finds everything done.
    assert!(study(&folder).stderr.contains("6 up to date"));
}

/// A case is the mesh that a study makes whose object and method are written so.
#[test]
fn a_case_is_what_a_study_of_its_own_makes() {
    let swept = folder(
        r#"
[sweep]
methods = ["bi"]
cells = [20]
[[sweep.settings]]
objects = ["ball"]
key = "field.radius"
values = [0.55]
[[sweep.settings]]
methods = ["bi"]
key = "placement"
values = ["projected"]
"#,
    );
    study(&swept);
    let plain = Folder::new();
    plain.write("cpu.toml", include_str!("../configs/cpu/x86-64-v3.toml"));
    let text = STUDY
        .replace("radius = 0.7", "radius = 0.55")
        .replace("benchmark_spacing = 0.25", "benchmark_spacing = 0.1")
        .replace(
            "arrangement = \"body-centred\"",
            "arrangement = \"body-centred\", placement = \"projected\"",
        );
    plain.write("study.toml", text);
    study(&plain);
    let record: Value =
        serde_json::from_slice(&fs::read(plain.path("out/meshes/benchmark/ball_bi.json")).unwrap()).unwrap();
    let of = |quantity: &str| {
        let rows = table(&swept, "sweep_resolutions");
        let row = rows.iter().find(|row| row["quantity"] == quantity).unwrap();
        number(&row["mean"])
    };
    for (quantity, value) in [
        ("triangles", &record["counts"]["triangles"]),
        ("sample points", &record["counts"]["samples"]),
        ("distance to the isosurface", &record["accuracy"]["distance"]["mean"]),
        ("distance to the mesh", &record["accuracy"]["distance_to_mesh"]["mean"]),
        ("radius ratio", &record["quality"]["radius_ratio"]["mean"]),
    ] {
        let (ours, theirs) = (of(quantity), value.as_f64().unwrap());
        assert!((ours / theirs - 1.0).abs() < 1e-9, "{quantity}: {ours} {theirs}");
    }
}

/// A case without a surface has a row that says so, and no exponent is made of what is left. A case is timed in a process of its own.
#[test]
fn a_case_without_a_surface_is_left_out_and_times_have_their_machine() {
    let folder = folder(
        r#"
[sweep]
methods = ["mc"]
cells = [8, 16]
times = 2
[[sweep.settings]]
objects = ["ball"]
key = "isovalue"
values = [0.0, 5.0]
"#,
    );
    study(&folder);
    let cases = table(&folder, "sweep_cases");
    assert_eq!((cases[0]["cases"].as_str(), cases[0]["left_out"].as_str()), ("4", "2"));
    assert!(!folder.path("out/tables/sweep_exponents.csv").exists(), "of what is left no exponent is made");
    let lines = table(&folder, "sweep_resolutions");
    assert!(lines.iter().all(|row| row["cases"] == "1" && row["missing"] == "1"), "{lines:?}");
    let of = |quantity: &str| lines.iter().filter(|row| row["quantity"] == quantity).count();
    assert_eq!((of("triangles"), of("time in seconds")), (2, 2));
    assert!(
        lines.iter().filter(|row| row["quantity"] == "time in seconds").all(|row| !row["machine"].is_empty())
    );
    let plan: Value =
        serde_json::from_str(&folder.succeed(&["plan", "study.toml", "--out", "out", "--json"]).stdout)
            .unwrap();
    let jobs = plan["jobs"].as_array().unwrap();
    let job = |id: &str| jobs.iter().find(|job| job["id"] == id).unwrap_or_else(|| panic!("no {id}"));
    assert_eq!(job("sweep/meshes/ball/mc/00000")["exclusive"], false);
    assert_eq!(job("sweep/times/ball/mc/00000")["exclusive"], true);
    assert_eq!(job("sweep/meshes/ball/mc/00000")["inputs"][0], "study.toml");
    // Times are not measured again where another machine looks them up, nor here.
    let before = files(&folder.path("out/sweep/times"));
    let run = folder.succeed(&["job", "study.toml", "--out", "out", "sweep/times/ball/mc/00000"]);
    assert!(run.stderr.contains("1 up to date"), "{}", run.stderr);
    assert!(before == files(&folder.path("out/sweep/times")));
}

#[test]
fn what_cannot_be_swept_is_refused_before_anything_is_made() {
    let refused = |sweep: &str, parts: &[&str]| {
        let folder = folder(&format!("[sweep]\n{sweep}"));
        let run = folder.run(&["study", "study.toml", "--out", "out"]);
        assert_eq!(run.code, Some(2), "{}", run.stderr);
        for part in parts {
            assert!(run.stderr.contains(part), "{part} is not in {}", run.stderr);
        }
        assert!(!folder.path("out/meshes").exists());
    };
    let setting = |keys: &str| format!("cells = [16]\n[[sweep.settings]]\n{keys}");
    refused(
        &setting("methods = [\"bi\"]\nkey = \"edge_clmp\"\nvalues = [0.1]"),
        &["sweep.settings[0]", "edge_clmp"],
    );
    refused(&setting("methods = [\"bi\"]\nkey = \"edge_clamp\"\nvalues = [0.1, 0.7]"), &["edge_clamp = 0.7"]);
    refused(
        &setting("objects = [\"ball\"]\nkey = \"field.radius\"\nvalues = [-1.0]"),
        &["objects[0].field.radius = -1"],
    );
    refused("cells = [16]\nlimit = 1", &["sweep = 2 cases", "sweep.limit allows 1"]);
    let folder = folder("[sweep]\ncells = [16, 512]");
    let text = fs::read_to_string(folder.path("study.toml"))
        .unwrap()
        .replace("memory_gib = 1.0", "memory_gib = 0.01");
    folder.write("study.toml", text);
    let run = folder.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    assert!(
        run.stderr.contains("512 cells per axis") && run.stderr.contains("limits.memory_gib"),
        "{}",
        run.stderr
    );
}

/// Each machine's run is a job of its own; the report says which have measured, and whether they agree.
#[test]
fn several_machines_are_held_against_each_other() {
    let folder = folder("");
    let text = fs::read_to_string(folder.path("study.toml")).unwrap();
    folder.write(
        "study.toml",
        text.replace("threads = 1, target", "threads = 1, machines = [\"desk\", \"rack\"], target"),
    );
    let told = study(&folder).stderr;
    for machine in ["desk", "rack"] {
        let command = format!(
            "machine {machine} has not measured the study as it is: run `isostudy job study.toml bench/machine/{machine}`"
        );
        assert!(told.contains(&command), "{told}");
    }
    assert!(!folder.path("out/tables/machines.csv").exists());
    let job = |arguments: &[&str]| {
        folder.run(&[&["job", "study.toml", "--out", "out", "bench/machine/desk"], arguments].concat())
    };
    assert_eq!(job(&[]).code, Some(0));
    let report = |wanted: &[&str]| {
        study(&folder);
        let text = fs::read_to_string(folder.path("out/report.md")).unwrap();
        for part in wanted {
            assert!(text.contains(part), "{part} is not in {text}");
        }
    };
    report(&["A single machine measured the study", "rack has not measured the study as it is now"]);
    folder.succeed(&["job", "study.toml", "--out", "out", "bench/machine/rack"]);
    report(&["desk and rack are of one kind. That they agree says little.", "Whether machines agree"]);
    let machines = table(&folder, "machines");
    assert_eq!(machines.iter().map(|row| row["machine"].as_str()).collect::<Vec<_>>(), ["desk", "rack"]);
    assert!(
        machines.iter().all(|row| number(&row["floor_high_percent"]) >= number(&row["floor_low_percent"]))
    );
    assert_eq!(table(&folder, "times_on_desk").len(), 2);
    // Times of another machine are not written over.
    let path = folder.path("out/bench/machine/desk/run.json");
    let run = fs::read_to_string(&path).unwrap();
    let mut run: Value = serde_json::from_str(&run).unwrap();
    run["machine"]["model"] = "Another CPU".into();
    fs::write(&path, serde_json::to_string(&run).unwrap()).unwrap();
    let refused = job(&[]);
    assert_eq!(refused.code, Some(2));
    assert!(
        refused.stderr.contains("bench/machine/desk: it was measured on another machine, Another CPU"),
        "{}",
        refused.stderr
    );
    assert_eq!(job(&["--force"]).code, Some(0));
}
