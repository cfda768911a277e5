//! How the command words what it found and what it refuses. Other tests assert names, places and numbers; words stand in
//! `golden/messages.txt` alone, which is compared as a whole. `ISOSTUDY_BLESS=1` writes it anew; its difference is then read before
//! it is committed.

use crate::command::Run;
use crate::distance;
use crate::gate::{Pair, planted, quiet, slower};
use serde_json::{Value, json};
use std::path::Path;

/// What a run said, under what it was.
fn section(title: &str, Run { code, stdout, stderr }: Run) -> String {
    format!("# {title}: exit code {}\n{stdout}\n{stderr}\n", code.unwrap())
}

/// Two runs whose times are planted: nothing is measured, so every word and number is the same anywhere.
fn comparisons() -> String {
    let changed = |change: fn(&mut Value)| {
        let mut run = planted(quiet(0.0021));
        change(&mut run);
        run
    };
    let still = || planted(quiet(0.002));
    let busy = changed(|run| {
        let windows = run["load"].as_array_mut().unwrap();
        windows[..17].iter_mut().for_each(|window| window["others"] = 0.934.into());
    });
    let alone = changed(|run| (run["aa_samples"], run["aa_iterations"]) = (json!([]), json!(0)));
    let other_threads = changed(|run| run["reference_threads"] = 1.into());
    let newer = changed(|run| run["schema"] = 5.into());
    let older = changed(|run| run["schema"] = 1.into());
    let odd = changed(|run| run["colour"] = "red".into());
    let invalid = changed(|run| run["samples"][3]["vertex_s"] = (-0.5).into());
    let cases: [(&str, Value, Value, &[&str]); 12] = [
        ("slower", still(), planted(slower(0.002)), &[]),
        ("within the limit", still(), planted(slower(0.002)), &["--relative", "30%"]),
        ("blind", planted(quiet(0.4)), planted(quiet(0.39)), &["--must-tell", "10%"]),
        ("no A/A block", still(), alone, &["--must-tell", "10%"]),
        ("beside other work", still(), busy, &[]),
        ("nothing measured", still(), planted(|_, _| 0.0), &[]),
        ("the same run", still(), still(), &[]),
        ("reference work on other threads", still(), other_threads, &[]),
        ("newer", newer, still(), &[]),
        ("older", still(), older, &[]),
        ("keys that no run has", still(), odd, &[]),
        ("a time that is none", still(), invalid, &[]),
    ];
    cases
        .map(|(title, a, b, more)| section(&format!("compare, {title}"), Pair::new(&a, &b).compare(more)))
        .concat()
}

#[test]
fn messages_are_worded_as_in_their_file() {
    let meshes = distance::meshes();
    let refused = distance::REFUSED
        .map(|(arguments, _)| section(&format!("distance {}", arguments.join(" ")), meshes.run(arguments)));
    let said = comparisons() + &refused.concat();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/messages.txt");
    if std::env::var_os("ISOSTUDY_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&golden, &said).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap();
    for (expected, said) in expected.lines().zip(said.lines()) {
        assert_eq!(said, expected, "golden/messages.txt; ISOSTUDY_BLESS=1 writes it anew");
    }
    assert_eq!(said, expected, "golden/messages.txt; ISOSTUDY_BLESS=1 writes it anew");
}
