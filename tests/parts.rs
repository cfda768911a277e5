//! Simulations in parts, as a cluster runs them: the same bytes as one run, or a refusal that writes nothing.

use crate::command::Folder;
use crate::fixture::files;
use serde_json::Value;
use std::path::Path;

/// A study of two methods, small enough for many runs.
fn study() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml").display().to_string()
}

/// One run of a simulation into `one`, parts of so many and merged ones into `merged`: what was printed and written is the same.
fn is_the_same(folder: &Folder, simulation: &[&str], settings: &[&str], parts: u64) {
    let run = |more: &[&str]| {
        let run = folder.run(&[simulation, more].concat());
        // Of few studies a probe may fail.
        assert!(matches!(run.code, Some(0 | 1)), "{more:?}: {}{}", run.stdout, run.stderr);
        (run.code, run.stdout)
    };
    let one = run(&[settings, &["-o", "one"]].concat());
    let names: Vec<String> = (1..=parts).map(|number| format!("{parts}/{number}.json")).collect();
    for (number, name) in (1..).zip(&names) {
        let part = format!("{number}/{parts}");
        let (code, said) = run(&[settings, &["--part", &part, "-o", name]].concat());
        assert!(code == Some(0) && said.starts_with(name.as_str()), "{said}");
        assert!(said.contains(&format!("part {number} of {parts}")), "{said}");
    }
    let mut shuffled: Vec<&str> = names.iter().map(String::as_str).collect();
    // Multiples of 37 modulo 101 come in no order.
    let mut number = 0;
    shuffled.sort_by_cached_key(|_| {
        number += 37;
        number % 101
    });
    let out = format!("merged{parts}");
    let (code, said) = run(&[&["--merge"], shuffled.as_slice(), &["-o", &out]].concat());
    assert_eq!((code, said.replace(&out, "one")), one, "{parts}");
    let written = files(&folder.path("one"));
    assert!(written.len() >= 4 && written == files(&folder.path(&out)), "{parts}: {:?}", written.keys());
}

#[test]
fn the_self_test_is_the_same_bytes_in_any_number_of_parts() {
    let folder = Folder::of("analyse");
    for parts in [1, 7] {
        is_the_same(&folder, &["--self-test"], &["--studies", "100", "--seed", "5"], parts);
    }
}

#[test]
fn power_is_the_same_bytes_in_any_number_of_parts() {
    let folder = Folder::of("design");
    let settings = ["--studies", "150", "--participants", "6,12", "--side-bias", "0,1", "--seed", "5"];
    for parts in [1, 2, 7, 100] {
        is_the_same(&folder, &["power", &study()], &settings, parts);
    }
}

#[test]
fn what_does_not_fit_is_named_and_nothing_is_written() {
    let (folder, config) = (Folder::new(), study());
    let config = config.as_str();
    let power = ["design", "power", config, "--participants", "6"];
    let part = |part: &str, more: &[&str], out: &str| {
        folder.succeed(&[&power[..], &["--part", part, "-o", out], more].concat());
    };
    part("1/3", &["--studies", "100"], "1.json");
    part("2/3", &["--studies", "100"], "2.json");
    part("3/3", &["--studies", "100"], "3.json");
    part("3/3", &["--studies", "100", "--seed", "2"], "seed.json");
    part("3/3", &["--studies", "101"], "studies.json");
    part("3/4", &["--studies", "100"], "cut.json");
    folder.succeed(&["analyse", "--self-test", "--studies", "100", "--part", "90/100", "-o", "self.json"]);
    folder.write("cut-off.json", &folder.read("3.json")[..500]);
    folder.write("changed.json", folder.read("3.json").replacen("\"seed\":1", "\"seed\":2", 1));
    folder.write("none.json", "{}");
    // Another study file, with the same questions.
    folder.succeed(&["new", "my"]);
    let other = ["design", "power", "my/study.toml", "--participants", "6", "--studies", "100"];
    folder.succeed(&[&other[..], &["--part", "3/3", "-o", "study.json"]].concat());
    let refused = |words: &[&str], names: &[&str]| {
        let run = folder.run(&[words, &["-o", "refused"]].concat());
        assert_eq!(run.code, Some(2), "{words:?}: {}", run.stdout);
        assert!(names.iter().all(|name| run.stderr.contains(name)), "{names:?}: {}", run.stderr);
        assert!(!folder.path("refused").exists(), "{words:?}");
    };
    let merge = |of: &[&str], names: &[&str]| {
        refused(&[&["design", "power", config, "--merge", "1.json", "2.json"], of].concat(), names);
    };
    merge(&[], &["1.json", "missing: 3"]);
    merge(&["3.json", "2.json"], &["2.json: part 2 of 3 is given twice"]);
    merge(&["seed.json"], &["seed.json: seed is 2, and 1 in 1.json"]);
    merge(&["studies.json"], &["studies.json: studies is 101, and 100 in 1.json"]);
    merge(&["cut.json"], &["cut.json: is part 3 of 4, and 1.json is part 1 of 3"]);
    merge(&["self.json"], &["self.json: is a part of `isostudy analyse --self-test`"]);
    merge(&["study.json"], &["study.json: ", "two-methods.toml"]);
    for damaged in ["cut-off.json", "changed.json", "none.json", "nothing.json"] {
        merge(&[damaged], &[damaged]);
    }
    refused(
        &["analyse", "--self-test", "--merge", "1.json"],
        &["1.json: is a part of `isostudy design power`"],
    );
    refused(
        &["analyse", "--self-test", "--merge", "self.json"],
        &["self.json: is one of 100 parts", "and 89 more"],
    );
    // Arguments come from the parts.
    refused(&["design", "power", config, "--merge", "1.json", "--seed", "1"], &["--merge", "--seed"]);
    refused(
        &["analyse", "--self-test", "--merge", "self.json", "--studies", "100"],
        &["--merge", "--studies"],
    );
    let run = folder.run(&[&power[..], &["--part", "1/3"]].concat());
    assert!(run.code == Some(2) && run.stderr.contains("--out"), "{}", run.stderr);
}

/// The parts of a simulation as jobs of a plan leave what one run leaves.
#[test]
fn a_simulation_by_jobs_is_the_simulation_in_one_run() {
    let (folder, study) = (Folder::new(), study());
    let plan = folder.succeed(&["plan", &study, "--out", "out", "--power", "3", "--json"]);
    let plan: Value = serde_json::from_str(&plan.stdout).unwrap();
    let jobs: Vec<&Value> =
        plan["jobs"].as_array().unwrap().iter().filter(|job| job["kind"] == "simulation").collect();
    let ids: Vec<&str> = jobs.iter().map(|job| job["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["power/1-of-3", "power/2-of-3", "power/3-of-3", "power/all-of-3"]);
    let job = |id: &str, digest: &Value| {
        folder.run(&["job", &study, "--out", "out", id, "--digests", digest.as_str().unwrap()])
    };
    let early = job(ids[3], &jobs[3]["digest"]);
    assert_eq!(early.code, Some(2));
    assert!(early.stderr.contains("power/1-of-3 is not up to date"), "{}", early.stderr);
    for (id, planned) in ids.iter().zip(&jobs) {
        let done = job(id, &planned["digest"]);
        assert!(done.code == Some(0) && done.stderr.contains(": made"), "{}", done.stderr);
        assert!(job(id, &planned["digest"]).stderr.contains(": up to date"));
        for output in planned["outputs"].as_array().unwrap() {
            assert!(folder.path("out").join(output.as_str().unwrap()).is_file(), "{output}");
        }
    }
    folder.succeed(&["design", "power", &study, "--out", "whole"]);
    let by_jobs = files(&folder.path("out/power"));
    for (name, bytes) in files(&folder.path("whole")) {
        assert!(by_jobs.get(&name) == Some(&bytes), "{name}");
    }
    for wrong in ["power/4-of-3", "power/x-of-3", "power/0-of-3"] {
        let refused = folder.run(&["job", &study, "--out", "out", wrong]);
        assert!(refused.code == Some(2) && refused.stderr.contains("is no part of a simulation"), "{wrong}");
    }
    let other = job("power/1-of-3", &jobs[1]["digest"]);
    assert!(other.code == Some(2) && other.stderr.contains("Make the plan again"), "{}", other.stderr);
}
