//! The benchmark as a user runs it: killed and gone on with, compared, imported. No test here judges a measured time.

use crate::command;
use crate::command::Run;
use crate::fixture::Fixture;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

const STAGES: [&str; 6] = ["allocation", "sampling", "vertex", "geometry", "clustering", "normals"];
/// The journal of the full run, which has the machine's name in its own.
fn journal_of(out: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(out.join(".stages")).ok()?.flatten().map(|entry| entry.path());
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    let is_own = |path: &PathBuf| {
        let name = name(path);
        name.starts_with("bench.full.") && name.ends_with(".journal")
    };
    entries.into_iter().find(is_own)
}

fn run_of(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("bench/full/run.json")).unwrap()).unwrap()
}

/// Starts the benchmark and kills it when its journal has so many lines.
fn kill_at(fixture: &Fixture, lines: usize) -> Vec<Value> {
    let mut child = fixture.command("bench").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let read =
        || journal_of(fixture.out()).and_then(|path| std::fs::read_to_string(path).ok()).unwrap_or_default();
    while read().matches('\n').count() < lines {
        assert_eq!(child.try_wait().unwrap(), None, "it ended before it could be killed");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let text = read();
    let whole = &text[..text.rfind('\n').unwrap()];
    whole.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_killed_benchmark_goes_on_in_the_middle_of_a_round() {
    let fixture = Fixture::new();
    // The first line, the machine at rest, and the first process: one round of 18, so that 10 samples are not all.
    let journal = kill_at(&fixture, 2 + 10);
    fixture.succeed("bench", &[]);
    assert_eq!(journal_of(fixture.out()), None);
    let run = run_of(fixture.out());
    let samples = run["samples"].as_array().unwrap();
    assert_eq!((samples.len(), run["aa_samples"].as_array().unwrap().len()), (5 * 18, 4 * 18));
    let kept = journal.iter().filter(|entry| entry["entry"] == "sample");
    for (before, after) in kept.zip(samples) {
        assert_eq!(before["total_s"], after["total_s"], "what was measured is not measured again");
    }
    let resumed = run["resumed"].as_array().unwrap();
    assert_eq!(resumed.len(), 1);
    assert_eq!((&resumed[0]["invocation"], &resumed[0]["iteration"]), (&0.into(), &0.into()));
    assert!(resumed[0]["place"].as_u64().unwrap() >= 10);
    let finished = fixture.succeed("bench", &[]);
    assert!(finished.stderr.contains("up to date"), "{}", finished.stderr);
}

#[test]
fn a_journal_of_another_plan_is_not_used() {
    let fixture = Fixture::new();
    kill_at(&fixture, 2 + 5);
    fixture.edit("seed = 2026", "seed = 2027");
    let run = fixture.succeed("bench", &[]);
    assert!(run.stderr.contains("begun anew"), "{}", run.stderr);
    assert_eq!(run_of(fixture.out())["resumed"], Value::Array(vec![]));
}

#[test]
fn every_statement_is_there_in_every_format() {
    let fixture = Fixture::new();
    let run = fixture.succeed("bench", &[]);
    assert!(run.stdout.contains(r"ss\_bi"), "{}", run.stdout);
    for name in ["bench_medians", "bench_ratios", "bench_counters", "bench_allocations"] {
        for extension in ["csv", "md", "tex"] {
            assert!(
                fixture.out().join(format!("bench/full/{name}.{extension}")).is_file(),
                "{name}.{extension}"
            );
        }
    }
    let counters = std::fs::read_to_string(fixture.out().join("bench/full/bench_counters.csv")).unwrap();
    let mut lines = counters.lines().filter(|line| !line.starts_with('#'));
    assert!(lines.next().unwrap().contains(",allocations,allocated_mib,"), "{counters}");
    assert_eq!(lines.count(), 18);
    let run = run_of(fixture.out());
    let counted = run["allocations"].as_array().unwrap();
    assert_eq!(counted.len(), 18);
    for of in counted {
        let [calls, bytes] = ["calls", "bytes"].map(|what| of[what]["total"].as_u64().unwrap());
        assert!(calls > 10 && bytes > 10_000, "{of}");
        let collapses = of["id"].as_str().unwrap().ends_with('p');
        assert_eq!(of["calls"]["clustering"].as_u64().unwrap() > 0, collapses, "{of}");
    }
    let path = fixture.out().join("bench/full/statements.json");
    let statements: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!(statements["schema"], 3);
    assert_eq!(statements["medians"].as_array().unwrap().len(), 18 * 7);
    assert_eq!(statements["ratios"].as_array().unwrap().len(), 45 * 5);
    let ratios = std::fs::read_to_string(fixture.out().join("bench/full/bench_ratios.csv")).unwrap();
    for stage in ["total", "sampling", "vertex", "geometry and clustering", "normals"] {
        let of_stage = |line: &&str| line.split(',').next() == Some(stage);
        assert_eq!(ratios.lines().filter(of_stage).count(), 45, "{stage}");
    }
    let machine = std::fs::read_to_string(fixture.out().join("bench/full/machine.csv")).unwrap();
    assert!(machine.contains("\ncompiler,,rustc"), "{machine}");
}

/// Times are measured here, and none is judged: that rounds and configurations are those asked for, and where they are kept.
#[test]
fn some_configurations_are_measured_for_as_long_as_asked() {
    let fixture = Fixture::new();
    let selected = || -> Value {
        serde_json::from_slice(&std::fs::read(fixture.out().join("bench/selected/run.json")).unwrap())
            .unwrap()
    };
    fixture.succeed(
        "bench",
        &["--only", "ss_bi", "--only", "as_sp", "--rounds", "7", "--save-baseline", "main"],
    );
    let run = selected();
    let mut ids: Vec<&str> =
        run["samples"].as_array().unwrap().iter().map(|sample| sample["id"].as_str().unwrap()).collect();
    assert_eq!((ids.len(), &run["iterations"]), (14, &7.into()));
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids, ["as_sp", "ss_bi"]);
    assert!(!fixture.out().join("bench/full").exists(), "the study's own run is another");
    let sample = &run["samples"][0];
    if cfg!(target_os = "linux") {
        assert!(sample["counters"]["cpu_s"].as_f64().unwrap() > 0.0, "{sample}");
        assert!(
            sample["counters"]["page_faults"].is_u64() && sample["counters"]["context_switches"].is_u64()
        );
    }
    let kept = std::fs::read(fixture.out().join("bench/baselines/main.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&kept).unwrap(), run);
    let history = std::fs::read_to_string(fixture.out().join("bench/history.jsonl")).unwrap();
    assert_eq!(history.lines().count(), 1);

    // No machine tells a millionth: it ends after the batches that it may have, and says so.
    let blind = fixture.run("bench", &["--only", "ss_bi", "--until", "0.0001%", "--rounds", "9"]);
    assert_eq!(blind.code, Some(3), "{}", blind.stderr);
    assert!(blind.stderr.contains("--until"), "{}", blind.stderr);
    let run = selected();
    let (rounds, batch) = (run["iterations"].as_u64().unwrap(), 5);
    assert_eq!((rounds, run["samples"].as_array().unwrap().len()), (2 * batch, 2 * batch as usize));
    // Any change of ten thousand times is told after the first batch that has intervals at all.
    let easy = fixture.run("bench", &["--only", "ss_bi", "--until", "1000000%", "--rounds", "100"]);
    assert_eq!(easy.code, Some(0), "{}", easy.stderr);
    assert!(selected()["iterations"].as_u64().unwrap() < 100);

    let unknown = fixture.run("bench", &["--only", "zz_bi"]);
    assert!(unknown.code == Some(2) && unknown.stderr.contains("ss_bi"), "{}", unknown.stderr);
    let conflict = fixture.run("bench", &["--short", "--rounds", "3"]);
    assert_eq!(conflict.code, Some(2));
    assert_eq!(fixture.run("bench", &["--save-baseline", "../x"]).code, Some(2));
}

/// Runs that differ as a test wants them to.
struct Pair {
    fixture: Fixture,
    a: PathBuf,
    b: PathBuf,
}

impl Pair {
    /// Of one run whose times have been replaced: every sample 10 ms and a little more from round to round.
    fn new() -> Self {
        let fixture = Fixture::new();
        fixture.succeed("bench", &[]);
        let mut run = run_of(fixture.out());
        run["load"] = Value::Array(vec![]);
        for block in ["samples", "aa_samples"] {
            for sample in run[block].as_array_mut().unwrap() {
                let unrest = 1.0 + 0.001 * (sample["iteration"].as_u64().unwrap() % 3) as f64;
                for stage in STAGES {
                    sample[format!("{stage}_s")] = (0.01 * unrest / 6.0).into();
                }
                sample["total_s"] = (0.01 * unrest).into();
                sample["reference_s"] = 0.001.into();
            }
        }
        // An interval for 18 configurations together takes ten rounds.
        let rounds = run["iterations"].as_u64().unwrap();
        let measured = run["samples"].as_array().unwrap().clone();
        for copy in 1..10_u64.div_ceil(rounds) {
            for mut sample in measured.clone() {
                sample["iteration"] = (sample["iteration"].as_u64().unwrap() + copy * rounds).into();
                run["samples"].as_array_mut().unwrap().push(sample);
            }
        }
        run["iterations"] = (10_u64.div_ceil(rounds) * rounds).into();
        let (a, b) = (fixture.folder().join("a.json"), fixture.folder().join("b.json"));
        let pair = Self { fixture, a, b };
        pair.write(&pair.a, &run);
        pair.write(&pair.b, &run);
        pair
    }

    fn write(&self, path: &Path, run: &Value) {
        std::fs::write(path, serde_json::to_vec(run).unwrap()).unwrap();
    }

    fn change_b(&self, change: impl FnOnce(&mut Value)) {
        let mut run: Value = serde_json::from_slice(&std::fs::read(&self.b).unwrap()).unwrap();
        change(&mut run);
        self.write(&self.b, &run);
    }

    fn compare(&self, arguments: &[&str]) -> Run {
        isostudy(
            &[&["bench", "compare", self.a.to_str().unwrap(), self.b.to_str().unwrap()], arguments].concat(),
        )
    }
}

fn isostudy(arguments: &[&str]) -> Run {
    Run::of(command::isostudy().args(arguments).current_dir(std::env::temp_dir()))
}

#[test]
fn comparisons_end_as_scripts_expect() {
    let pair = Pair::new();
    let same = pair.compare(&["--all"]);
    assert_eq!(same.code, Some(0), "{}", same.stderr);
    assert!(same.stdout.contains("cannot say") && !same.stdout.contains("slower"), "{}", same.stdout);

    // Its A/A block is slower with it: the build is slower, not the machine restless.
    pair.change_b(|run| {
        for block in ["samples", "aa_samples"] {
            for sample in run[block].as_array_mut().unwrap().iter_mut().filter(|s| s["id"] == "ss_bi") {
                for time in STAGES.iter().chain(&["total"]) {
                    let time = format!("{time}_s");
                    sample[&time] = (1.2 * sample[&time].as_f64().unwrap()).into();
                }
            }
        }
    });
    let slower = pair.compare(&["--format", "json"]);
    assert_eq!(slower.code, Some(1), "{}", slower.stderr);
    assert!(
        ["ss_bi, total", "12.012 ms", "10.010 ms"].iter().all(|part| slower.stderr.contains(part)),
        "{}",
        slower.stderr
    );
    let comparison: Value = serde_json::from_str(&slower.stdout).unwrap();
    let rows = comparison["rows"].as_array().unwrap();
    let totals: Vec<&Value> = rows.iter().filter(|row| row["stage"] == "total").collect();
    assert_eq!(totals.len(), 18);
    for row in totals {
        let want = if row["id"] == "ss_bi" { "slower" } else { "cannot-say" };
        assert_eq!(row["judgement"]["verdict"], want, "{row}");
    }
    assert_eq!(pair.compare(&["--relative", "0.3"]).code, Some(0), "slower, but within the limit");
    assert_eq!(pair.compare(&["--absolute", "0.01"]).code, Some(0), "slower, but by too little");
    let (csv, latex) = (pair.compare(&["--format", "csv"]), pair.compare(&["--format", "latex"]));
    assert!(
        csv.stdout
            .starts_with("id,a_ms,b_ms,ratio,cpu_ratio,low,high,floor,smallest_detectable,verdict,reason\n"),
        "{}",
        csv.stdout
    );
    assert!(latex.stdout.contains("\\begin{longtable}"), "{}", latex.stdout);

    pair.change_b(|run| run["machine"]["model"] = "Another CPU".into());
    let refused = pair.compare(&["--all"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("Another CPU in B") && refused.stderr.contains("--across-machines"));
    let labelled = pair.compare(&["--across-machines", "--all"]);
    assert_eq!(labelled.code, Some(1));
    assert!(labelled.stdout.contains("slower (not measured alike)"), "{}", labelled.stdout);
    assert!(labelled.stderr.contains("regression (not measured alike)"), "{}", labelled.stderr);
    let headings = labelled.stdout.lines().filter(|line| line.starts_with("**B against A"));
    assert!(
        headings.clone().count() == 2 && headings.clone().all(|line| line.contains("(NOT MEASURED ALIKE)"))
    );
}

#[test]
fn only_what_did_the_same_work_is_compared() {
    let pair = Pair::new();
    pair.change_b(|run| run["workloads"][0]["digest"] = "other".into());
    let compared = pair.compare(&["--format", "json"]);
    let found: Value = serde_json::from_str(&compared.stdout).unwrap();
    let of_run: Value = serde_json::from_slice(&std::fs::read(&pair.a).unwrap()).unwrap();
    let changed = &of_run["workloads"][0]["id"];
    assert_eq!(found["changed"], serde_json::json!([changed]));
    let rows = found["rows"].as_array().unwrap();
    assert!(!rows.is_empty() && rows.iter().all(|row| row["id"] != *changed), "{found}");
    let named = pair.compare(&["--all"]);
    assert!(named.stdout.contains(&changed.as_str().unwrap().replace('_', r"\_")), "{}", named.stdout);
}

#[test]
fn what_cannot_be_compared_is_refused_by_name() {
    let pair = Pair::new();
    pair.change_b(|run| {
        run["workloads"].as_array_mut().unwrap().iter_mut().for_each(|of| of["digest"] = "other".into());
    });
    let refused = pair.compare(&["--across-machines"]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("extractions"), "{}", refused.stderr);
    pair.change_b(|run| run["schema"] = 1.into());
    let refused = pair.compare(&[]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("b.json: schema = 1"), "{}", refused.stderr);
    pair.change_b(|run| run["schema"] = 3.into());
    pair.change_b(|run| run["samples"][3]["vertex_s"] = (-0.5).into());
    let refused = pair.compare(&[]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("b.json: samples[3], "), "{}", refused.stderr);
    assert!(refused.stderr.contains("vertex = -0.5 s"), "{}", refused.stderr);
    for text in ["{", "[]"] {
        std::fs::write(&pair.b, text).unwrap();
        let refused = pair.compare(&[]);
        assert!(refused.code == Some(2) && !refused.stderr.contains("Versioned"), "{}", refused.stderr);
    }
    let empty = isostudy(&["bench", "compare", pair.a.to_str().unwrap(), "/nowhere"]);
    assert!(empty.code == Some(2) && empty.stderr.contains("/nowhere"), "{}", empty.stderr);
    assert_eq!(pair.compare(&["--relative", "-1"]).code, Some(2));
    // The results folder stands for its run.
    let folder = pair.fixture.out().to_str().unwrap();
    let itself = isostudy(&["bench", "compare", folder, folder, "--beside-other-work"]);
    assert_eq!(itself.code, Some(0), "{}", itself.stderr);
}

#[test]
fn the_published_table_stands_beside_a_run() {
    let pair = Pair::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let at = |path: &str| root.join(path).to_str().unwrap().to_owned();
    let out = pair.fixture.folder().join("published.json");
    let (table, machine) = (at("study/paper/published_benchmark.csv"), at("configs/cpu/i7-11700.toml"));
    let import = ["bench", "import", &table, "--machine", &machine, "--out", out.to_str().unwrap()];
    let made = isostudy(&import);
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    std::fs::copy(&out, &pair.b).unwrap();
    let beside = pair.compare(&["--across-machines", "--format", "csv"]);
    assert_eq!(beside.code, Some(0), "{}", beside.stderr);
    let row = beside.stdout.lines().find(|line| line.starts_with("ss_bu,")).unwrap().to_owned();
    // 0.771 + 7.032 + 6.958 + 3.084 + 0.627 ms over 10.01 ms.
    let numbers: Vec<f64> = row.split(',').skip(1).take(3).map(|cell| cell.parse().unwrap()).collect();
    assert!((numbers[1] - 18.472).abs() < 1e-9 && (numbers[2] - 18.472 / 10.01).abs() < 1e-9, "{row}");
    assert!(row.contains("cannot say"), "{row}");
    // The paper's machine is the default wherever one stands.
    let elsewhere = pair.fixture.folder().join("elsewhere.json");
    let made = isostudy(&["bench", "import", &table, "--out", elsewhere.to_str().unwrap()]);
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    assert_eq!(std::fs::read(elsewhere).unwrap(), std::fs::read(&out).unwrap());
    let missing = isostudy(&["bench", "import", "/nowhere.csv", "--machine", &machine, "--out", "x"]);
    assert!(missing.code == Some(2) && missing.stderr.contains("/nowhere.csv"), "{}", missing.stderr);
}

/// A fixture with a small sweep of the sphere.
fn with_sweep(cells: &str) -> Fixture {
    let fixture = Fixture::new();
    let sweep = format!(
        "sweep = {{ objects = [\"ss\"], cells = {cells}, threads = [1, 2], iterations = 2 }}\ntarget ="
    );
    fixture.edit("target =", &sweep);
    fixture
}

fn sweep(fixture: &Fixture) -> Run {
    let (config, out) = (fixture.config(), fixture.out());
    isostudy(&["bench", "sweep", config.to_str().unwrap(), "--out", out.to_str().unwrap()])
}

#[test]
fn a_sweep_goes_on_where_it_stopped() {
    let fixture = with_sweep("[8, 12]");
    let first = sweep(&fixture);
    assert_eq!(first.code, Some(0), "{}", first.stderr);
    let folder = fixture.out().join("bench/sweep");
    let read =
        || -> Value { serde_json::from_slice(&std::fs::read(folder.join("sweep.json")).unwrap()).unwrap() };
    let found = read();
    assert_eq!(found["schema"], 1);
    assert_eq!(found["points"].as_array().unwrap().len(), 2 * 2 * 6);
    assert_eq!(found["speed_ups"].as_array().unwrap().len(), 2 * 6);
    for name in ["sweep", "sweep_speed_up"] {
        for extension in ["csv", "md", "tex"] {
            assert!(folder.join(format!("{name}.{extension}")).is_file(), "{name}.{extension}");
        }
    }
    for name in ["sweep_time", "sweep_per_triangle", "sweep_speed_up", "sweep_quality"] {
        assert!(
            folder.join(format!("{name}.svg")).is_file() && folder.join(format!("{name}.png")).is_file(),
            "{name}"
        );
    }
    // Killed at the last resolution: only that is measured again.
    std::fs::remove_file(folder.join("0012-2/run.json")).unwrap();
    let second = sweep(&fixture);
    let (made, kept) =
        (second.stderr.matches(" made, ").count(), second.stderr.matches("up to date").count());
    assert_eq!((second.code, made, kept), (Some(0), 1, 3), "{}", second.stderr);
    let again = read();
    let of = |run: &Value, cells: u64, threads: u64| -> Vec<Value> {
        let own = |p: &&Value| p["cells"] == cells && p["threads"] == threads;
        run["points"].as_array().unwrap().iter().filter(own).cloned().collect()
    };
    assert_eq!(of(&found, 12, 1), of(&again, 12, 1), "what was measured is not measured again");
    assert_eq!(sweep(&fixture).stderr.matches(" made, ").count(), 0);
}

#[test]
fn a_sweep_that_makes_no_sense_is_refused_by_key() {
    for (cells, want) in [
        ("[12, 8]", "benchmark.sweep.cells[1] = 8"),
        ("[2]", "benchmark.sweep.cells[0] = 2"),
        ("[]", "benchmark.sweep.cells = []"),
        ("[1024]", "benchmark.sweep.cells[0] = 1024"),
    ] {
        let fixture = with_sweep(cells);
        fixture.edit("memory_gib = 8.0", "memory_gib = 0.05");
        let refused = sweep(&fixture);
        assert!(refused.code == Some(2) && refused.stderr.contains(want), "{cells}: {}", refused.stderr);
    }
    let none = Fixture::new();
    let refused = sweep(&none);
    assert!(refused.code == Some(2) && refused.stderr.contains("[benchmark.sweep]"), "{}", refused.stderr);
}

/// The default study is in the program, has none of the paper's faults, and needs no checkout; the paper's are named.
#[test]
fn a_configuration_is_inspected_anywhere() {
    let fixture = Fixture::new();
    let inspect = |more: &[&str]| {
        let words =
            [&["inspect", "ss_bi", "--resolution", "20", "--iterations", "1", "--json"], more].concat();
        let done = Run::of(command::isostudy().args(&words).current_dir(fixture.folder()));
        assert_eq!(done.code, Some(0), "{}", done.stderr);
        let panel: Value = serde_json::from_str(&done.stdout).unwrap();
        (panel["mesh"]["topology"].clone(), done.stderr)
    };
    let (own, said) = inspect(&[]);
    // A closed sphere.
    assert_eq!((&own["euler_characteristic"], &own["boundary_edges"]), (&2.into(), &0.into()), "{own}");
    assert!(!said.contains("faults") && said.contains("streaming"), "{said}");
    let config = fixture.config();
    let (papers, said) = inspect(&["--study", config.to_str().unwrap()]);
    assert_ne!(papers["boundary_edges"], 0);
    for part in ["faults", "accumulated positions", "published topology", "dense"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// The panel of the published slides: 20 cells per axis. Counts of the lattice are exact; how many vertices there are is
/// decided by rounding where the sphere touches its volume, and 2,180 were published.
#[test]
fn a_configuration_is_inspected() {
    let fixture = Fixture::new();
    let config = fixture.config();
    let inspect = |id: &str, more: &[&str]| {
        let start = ["inspect", id, "--study", config.to_str().unwrap(), "--iterations", "3"];
        isostudy(&[&start[..], more].concat())
    };
    let json = inspect("ss_bi", &["--resolution", "20", "--json"]);
    assert_eq!(json.code, Some(0), "{}", json.stderr);
    let panel: Value = serde_json::from_str(&json.stdout).unwrap();
    let counts = &panel["mesh"]["counts"];
    assert_eq!(counts["samples"], 19_661);
    for (key, published) in [
        ("stored_samples", 20_812),
        ("stored_edges", 291_368),
        ("needed_edges", 125_260),
        ("tetrahedra_evaluated", 25_056),
        ("tetrahedra", 100_800),
    ] {
        assert_eq!(counts["tetrahedra"][key], published, "{key}");
    }
    let vertices = counts["vertices"].as_f64().unwrap();
    assert!((vertices / 2180.0 - 1.0).abs() < 0.01, "{vertices}");
    assert_eq!((&panel["schema"], panel["times"].as_array().unwrap().len()), (&4.into(), 7));
    assert_eq!((&panel["iterations"], &panel["machine"]["os"]), (&3.into(), &std::env::consts::OS.into()));
    let stages: f64 =
        panel["times"].as_array().unwrap()[..6].iter().map(|t| t["median"].as_f64().unwrap()).sum();
    assert!(stages > 0.0);
    let text = inspect("ss_bi", &["--resolution", "20"]).stdout;
    for heading in ["mesh", "generation", "timing", "geometry"] {
        assert!(text.lines().any(|line| line.starts_with(heading)), "{heading}: {text}");
    }
    assert!(text.lines().any(|line| line.contains("20,812") && line.contains("105.85 %")), "{text}");
    let unknown = inspect("zz_bi", &[]);
    assert!(unknown.code == Some(2) && unknown.stderr.contains("zz_bi") && unknown.stderr.contains("ss_bu"));
    assert_eq!(inspect("ss_bi", &["--resolution", "0"]).code, Some(2));
    let large = inspect("ss_bi", &["--resolution", "1024"]);
    assert!(large.code == Some(2) && large.stderr.contains("body-centred"), "{}", large.stderr);
}

const BLOBS: &str = "\
methods = [\"mc\", \"nets\"]
cells = 12
rounds = 3
aa_rounds = 2

[objects.ball]
field = { kind = \"sphere\", radius = 1.0 }

[objects.waves]
field = { kind = \"formula\", text = \"sin(3*x)*sin(3*y) - 2*z\" }
min = [-1, -1, -0.5]
max = [1, 1, 0.5]
";

/// Times are measured and not judged: what was asked for is there, and how long it takes is said first.
#[test]
fn methods_and_fields_are_a_benchmark_without_a_study() {
    let folder = command::Folder::of("bench");
    folder.write("blobs.toml", BLOBS);
    let run = folder.run(&["blobs.toml", "--out", "out"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let said = run.stderr.find("timings: about ").expect("how long it takes");
    assert!(run.stderr[said..].contains("4 configurations"), "{}", run.stderr);
    let measured: Value = serde_json::from_str(&folder.read("out/bench/full/run.json")).unwrap();
    let ids: Vec<&str> =
        measured["workloads"].as_array().unwrap().iter().map(|of| of["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["ball_mc", "ball_nets", "waves_mc", "waves_nets"]);
    assert_eq!(measured["samples"].as_array().unwrap().len(), 3 * 4);
}

#[test]
fn all_faults_of_a_benchmark_file_are_named_at_once() {
    let folder = command::Folder::of("bench");
    let broken = BLOBS
        .replace("\"nets\"", "\"nest\"")
        .replace("radius = 1.0", "radius = 0.0")
        .replace("2*z", "2*w")
        .replace("rounds = 3", "rounds = 0");
    folder.write("blobs.toml", broken);
    let run = folder.run(&["blobs.toml", "--out", "out"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    for part in [
        "4 faults",
        "line 3: rounds",
        "did you mean nets?",
        "objects.ball.field",
        "line 10: objects.waves.field",
    ] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
}
