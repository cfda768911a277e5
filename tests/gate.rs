//! A gate on runs whose times are planted: what it says of each, and how it ends. Nothing is measured here.

use crate::command::{Folder, Run};
use serde_json::{Value, json};

const IDS: [&str; 3] = ["ss_bu", "ss_bi", "as_sp"];
const STAGES: [&str; 6] =
    ["allocation_s", "sampling_s", "vertex_s", "geometry_s", "clustering_s", "normals_s"];
/// Of 30 measured rounds in three processes; those of the A/A block come between.
const PROCESSES: [(u64, bool); 5] = [(0, false), (1, true), (2, false), (3, true), (4, false)];

/// A run in which a sample of a configuration takes what `total_ms` says of its place in [`IDS`] and its round.
pub(crate) fn planted(total_ms: impl Fn(usize, u64) -> f64) -> Value {
    let (mut samples, mut aa_samples, mut load) = (Vec::new(), Vec::new(), Vec::new());
    let mut rounds = [0, 0];
    for (invocation, aa) in PROCESSES {
        for _ in 0..if aa { 2 } else { 10 } {
            let iteration = rounds[usize::from(aa)];
            rounds[usize::from(aa)] += 1;
            for (place, id) in IDS.iter().enumerate() {
                let mut sample = json!({
                    "id": id, "invocation": invocation, "iteration": iteration, "place": place, "reference_s": 0.001,
                    "counters": {
                        "cpu_s": 0.01, "page_faults": 3, "context_switches": 1, "instructions": null,
                        "cache_misses": null, "branch_misses": null, "energy_j": null,
                    },
                });
                sample["total_s"] = timed(&mut sample, total_ms(place, iteration)).into();
                if aa { aa_samples.push(sample) } else { samples.push(sample) }
            }
            load.push(json!({
                "invocation": invocation, "rounds": [iteration, iteration], "others": 0.01, "steal": 0.0, "load_average": 0.1
            }));
        }
    }
    json!({
        "schema": 4, "study": "planted", "workloads": [], "imported_from": null, "warmup": 1, "iterations": rounds[0],
        "aa_iterations": rounds[1], "seed": 1, "threads": 2, "reference_threads": 2, "pinned": null,
        "target": {"name": "any", "model": ""},
        "machine": {
            "model": "Example CPU", "cores": 2, "threads": 2, "memory_bytes": null, "l1d_kib": null, "l2_kib": null,
            "l3_kib": null, "os": "linux", "isa": null, "features": [], "max_mhz": null, "governor": null, "turbo": null,
            "smt": null, "cpu_limit": null, "memory_limit_bytes": null, "load": 0.1,
            "build": {
                "compiler": "rustc 1", "profile": "release", "opt_level": "3", "rustflags": "", "target_cpu": "x86-64",
                "commit": "0123456789abcdef", "dirty": false, "sources": "feed"
            },
        },
        "differences": [], "samples": samples, "aa_samples": aa_samples, "load": load, "memory": [], "resumed": [],
    })
}

/// Shares a total out among the stages, and returns what they add up to.
fn timed(sample: &mut Value, total_ms: f64) -> f64 {
    let stage = 1e-3 * total_ms / 6.0;
    STAGES.iter().for_each(|name| sample[name] = stage.into());
    STAGES.iter().fold(0.0, |sum, _| sum + stage)
}

/// 10 ms, and up to half of `unrest` more or less, in an order that repeats in no block of ten rounds.
pub(crate) fn quiet(unrest: f64) -> impl Fn(usize, u64) -> f64 {
    move |place, round| 10.0 * (1.0 + unrest * (((round * 7 + place as u64 * 3) % 11) as f64 / 10.0 - 0.5))
}

/// The first configuration takes 20 % longer.
pub(crate) fn slower(unrest: f64) -> impl Fn(usize, u64) -> f64 {
    move |place, round| quiet(unrest)(place, round) * if place == 0 { 1.2 } else { 1.0 }
}

/// A and B in a folder.
pub(crate) struct Pair(Folder);

impl Pair {
    pub(crate) fn new(a: &Value, b: &Value) -> Self {
        let folder = Folder::of("bench");
        folder.write("a.json", a.to_string());
        folder.write("b.json", b.to_string());
        Self(folder)
    }

    pub(crate) fn compare(&self, arguments: &[&str]) -> Run {
        self.0.run(&[&["compare", "a.json", "b.json"], arguments].concat())
    }

    fn json(&self, arguments: &[&str]) -> Value {
        serde_json::from_str(&self.compare(&[arguments, &["--format", "json"]].concat()).stdout).unwrap()
    }
}

#[test]
fn ten_lines_say_what_was_told() {
    let pair = Pair::new(&planted(quiet(0.002)), &planted(slower(0.002)));
    let run = pair.compare(&[]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(1), ""), "{}", run.stdout);
    assert!(run.stdout.lines().count() <= 10, "{}", run.stdout);
    assert!(run.stdout.contains("ss_bu +20.0 %"), "{}", run.stdout);
    assert!(!run.stdout.contains('|'), "no table: {}", run.stdout);
    let all = pair.compare(&["--all"]);
    assert!(all.stdout.contains('|') && all.stderr.contains("ss_bu, total"), "{}", all.stderr);
    assert_eq!(pair.compare(&["--relative", "30%"]).code, Some(0), "within the limit");
}

#[test]
fn a_program_reads_all_that_decided() {
    let pair = Pair::new(&planted(quiet(0.002)), &planted(slower(0.002)));
    let found = pair.json(&["--must-tell", "0.1"]);
    assert_eq!((&found["schema"], &found["exit_status"]), (&4.into(), &1.into()));
    assert_eq!(found["limits"], json!({"relative": 0.05, "absolute_s": 0.0001, "must_tell": 0.1}));
    let of_total: Vec<&Value> =
        found["regressions"].as_array().unwrap().iter().filter(|row| row["stage"] == "total").collect();
    assert_eq!(of_total.len(), 1);
    assert_eq!(of_total[0]["id"], "ss_bu");
    let (a_s, b_s) = (of_total[0]["a_s"].as_f64().unwrap(), of_total[0]["b_s"].as_f64().unwrap());
    assert!((a_s - 0.01).abs() < 1e-5 && (b_s - 0.012).abs() < 1e-5, "{a_s} {b_s}");
    assert_eq!((&found["a"]["commit"], &found["b"]["rounds"]), (&"0123456789abcdef".into(), &30.into()));
    assert_eq!(
        (&found["a"]["load"], &found["missing"], &found["blind"]),
        (&0.01.into(), &json!([]), &json!([]))
    );
    assert_eq!(found["reference_ratio"], 1.0);
    assert_eq!(found["rows"].as_array().unwrap().len(), 3 * 7);
}

/// Of 30 rounds that scatter over 40 %, no change of 10 % can be told; of rounds that scatter over 0.2 %, it can.
#[test]
fn a_gate_that_is_blind_says_so() {
    let restless = Pair::new(&planted(quiet(0.4)), &planted(quiet(0.39)));
    assert_eq!(restless.compare(&[]).code, Some(0), "nothing was asked");
    let blind = restless.compare(&["--must-tell", "10%"]);
    assert_eq!(blind.code, Some(3), "{}", blind.stdout);
    assert!(blind.stdout.contains("as_sp, ss_bi, ss_bu"), "{}", blind.stdout);
    assert_eq!(restless.compare(&["--must-tell", "200%"]).code, Some(0));
    let found = restless.json(&["--must-tell", "0.1"]);
    assert_eq!((&found["exit_status"], &found["blind"]), (&3.into(), &json!(["as_sp", "ss_bi", "ss_bu"])));

    let still = Pair::new(&planted(quiet(0.002)), &planted(quiet(0.0021)));
    assert_eq!(still.compare(&["--must-tell", "0.10"]).code, Some(0));
    // Without an A/A block nothing is told, so everything is hidden.
    let mut alone = planted(quiet(0.002));
    (alone["aa_samples"], alone["aa_iterations"]) = (json!([]), json!(0));
    let unknown = Pair::new(&planted(quiet(0.002)), &alone).compare(&["--must-tell", "0.10"]);
    assert_eq!(unknown.code, Some(3), "{}", unknown.stdout);
    // What is found counts before what could not have been.
    let slow = Pair::new(&planted(quiet(0.002)), &planted(slower(0.002)));
    assert_eq!(slow.compare(&["--must-tell", "0.0001"]).code, Some(1));
}

#[test]
fn a_run_beside_other_work_is_invalid_and_not_slower() {
    let mut busy = planted(|place, round| 2.0 * quiet(0.002)(place, round));
    let windows = busy["load"].as_array_mut().unwrap();
    let half = windows.len() / 2;
    windows[..half].iter_mut().for_each(|window| window["others"] = 0.934.into());
    let pair = Pair::new(&planted(quiet(0.002)), &busy);
    let refused = pair.compare(&[]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    for part in ["17 of 34", "93.4 %", "--beside-other-work"] {
        assert!(refused.stderr.contains(part), "{part}: {}", refused.stderr);
    }
    assert_ne!(pair.compare(&["--beside-other-work"]).code, Some(2));
    let mut less = busy.clone();
    less["load"][0]["others"] = 0.1.into();
    assert_ne!(Pair::new(&planted(quiet(0.002)), &less).compare(&[]).code, Some(2), "less than half");
}

#[test]
fn what_is_no_measurement_is_said() {
    let quiet_run = planted(quiet(0.002));
    let nothing = Pair::new(&quiet_run, &planted(|_, _| 0.0)).compare(&[]);
    assert_eq!(nothing.code, Some(2));
    assert!(nothing.stderr.contains("b.json: samples: "), "{}", nothing.stderr);

    let itself = Pair::new(&quiet_run, &quiet_run);
    assert_eq!(itself.compare(&[]).code, Some(0));
    assert_ne!(itself.compare(&["--all"]).stderr, "");
    assert_eq!(itself.compare(&["--must-tell", "10%"]).code, Some(3), "it could tell nothing");
    assert_eq!(itself.json(&[])["itself"], true);

    let mut odd = planted(quiet(0.0021));
    odd["colour"] = "red".into();
    odd["samples"][4]["counters"]["wishes"] = 3.into();
    let named = Pair::new(&quiet_run, &odd).compare(&[]);
    assert_eq!(named.code, Some(0));
    assert!(named.stderr.contains("colour, samples[].counters.wishes"), "{}", named.stderr);
}

#[test]
fn older_runs_are_read_and_newer_ones_refused() {
    let mut old = planted(slower(0.002));
    old["schema"] = 3.into();
    old.as_object_mut().unwrap().remove("reference_threads");
    for block in ["samples", "aa_samples"] {
        let samples = old[block].as_array_mut().unwrap();
        samples.iter_mut().for_each(|sample| drop(sample.as_object_mut().unwrap().remove("counters")));
    }
    let with_new = Pair::new(&planted(quiet(0.002)), &old).compare(&[]);
    assert_eq!((with_new.code, with_new.stderr.as_str()), (Some(0), ""), "{}", with_new.stdout);
    // Its reference work had one thread, this one's two: how fast the machines were is not known.
    assert_eq!(Pair::new(&planted(quiet(0.002)), &old).json(&[])["reference_ratio"], Value::Null);
    let mut before = planted(quiet(0.002));
    (before["schema"], before["reference_threads"]) = (3.into(), 1.into());
    assert_eq!(Pair::new(&before, &old).compare(&[]).code, Some(1), "two old ones tell what they told");
    let mut new = planted(quiet(0.002));
    new["schema"] = 5.into();
    let refused = Pair::new(&new, &old).compare(&[]);
    assert!(refused.code == Some(2) && refused.stderr.contains("a.json: schema = 5"), "{}", refused.stderr);
}

#[test]
fn a_baseline_has_a_name() {
    let pair = Pair::new(&planted(quiet(0.002)), &planted(slower(0.002)));
    let folder = &pair.0;
    std::fs::create_dir_all(folder.path("results/bench/full")).unwrap();
    std::fs::create_dir_all(folder.path("results/bench/baselines")).unwrap();
    folder.write("results/bench/full/run.json", folder.read("b.json"));
    folder.write("results/bench/baselines/main.json", folder.read("a.json"));
    let run = folder.run(&["compare", "main", "results"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stdout.contains("ss_bu +20.0 %"), "{}", run.stdout);
    let unknown = folder.run(&["compare", "other", "results"]);
    assert!(unknown.code == Some(2) && unknown.stderr.contains("other"), "{}", unknown.stderr);
}

#[test]
fn a_run_is_written_as_other_benchmarks_write_theirs() {
    let pair = Pair::new(&planted(quiet(0.0)), &planted(quiet(0.0)));
    let folder = &pair.0;
    folder.succeed(&["export", "a.json", "--to", "hyperfine", "--out", "h.json"]);
    let found: Value = serde_json::from_str(&folder.read("h.json")).unwrap();
    let results = found["results"].as_array().unwrap();
    assert_eq!(results.len(), 3);
    let first = &results[0];
    assert_eq!((&first["command"], first["times"].as_array().unwrap().len()), (&"as_sp".into(), 30));
    for key in ["mean", "median", "min", "max"] {
        assert!((first[key].as_f64().unwrap() - 0.01).abs() < 1e-12, "{key}: {first}");
    }
    assert!((first["user"].as_f64().unwrap() - 0.01).abs() < 1e-12);
    folder.succeed(&["export", "a.json", "--to", "criterion", "--out", "criterion"]);
    let of = |name: &str| -> Value {
        serde_json::from_str(&folder.read(&format!("criterion/planted/ss_bu/new/{name}.json"))).unwrap()
    };
    assert_eq!(of("benchmark")["full_id"], "planted/ss_bu");
    assert_eq!(of("sample")["times"].as_array().unwrap().len(), 30);
    // Criterion's times are nanoseconds.
    assert!((of("estimates")["median"]["point_estimate"].as_f64().unwrap() - 1e7).abs() < 1.0);
}

#[test]
fn kept_runs_have_a_history() {
    let folder = Folder::of("bench");
    let none = folder.run(&["history", "."]);
    assert!(none.code == Some(2) && none.stderr.contains("--save-baseline"), "{}", none.stderr);
    let line = |name: &str, total: f64| {
        json!({
            "name": name, "commit": "abc", "model": null, "rounds": 30, "workloads": {"ss_bi": "x"},
            "totals_s": {"ss_bi": total}, "reference_s": 0.001
        })
        .to_string()
    };
    std::fs::create_dir(folder.path("bench")).unwrap();
    folder.write("bench/history.jsonl", format!("{}\n{}\n", line("one", 0.01), line("two", 0.012)));
    let shown = folder.succeed(&["history", "."]);
    assert!(shown.stdout.contains("| two"), "{}", shown.stdout);
    let csv = folder.read("bench/history.csv");
    assert_eq!(csv.lines().nth(2), Some("2,two,abc,30,1.2,1.2,1.2,ss_bi,1"), "{csv}");
    assert!(folder.read("bench/history.svg").contains("<svg"));
    assert!(folder.path("bench/history.png").is_file());
    folder.write("bench/history.jsonl", "{\n");
    let broken = folder.run(&["history", "."]);
    assert!(broken.code == Some(2) && broken.stderr.contains("history.jsonl, line 1"), "{}", broken.stderr);
}
