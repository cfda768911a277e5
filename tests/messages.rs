//! How the command words what it found and what it refuses. Other tests assert names, places and numbers; words stand in
//! `golden/messages.txt` alone, which is compared as a whole. `ISOSTUDY_BLESS=1` writes it anew; its difference is then read before
//! it is committed.

use crate::command::{Folder, Run};
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

/// Passages of the study file that `isostudy new` writes, and what somebody may make of them.
const STUDY: [(&str, &str); 18] = [
    (
        "kind = \"tetrahedra\", arrangement = \"body-centred\", clustering = \"integrated\" }",
        "kind = \"mc\" }",
    ),
    ("{ kind = \"tetrahedra\", arrangement = \"body-centred\", clustering = \"integrated\" }", "\"mc\""),
    ("kind = \"tetrahedra\", arr", "kind = \"tetrahedron\", arr"),
    (
        "recipe = { kind = \"tetrahedra\", arrangement = \"body-centred\"",
        "recipe = { kind = \"tetrahedra\", arrangement = \"body-centered\"",
    ),
    ("clustering = \"integrated\" }", "clustring = \"integrated\" }"),
    ("levels = { placement = \"mean\" }", "levels = { placement = \"means\" }"),
    ("character = \"cliffs\", seed = 2", "seed = 2"),
    ("character = \"cliffs\", seed", "character = \"cliff\", seed"),
    ("seed = 2 }", "sead = 2 }"),
    ("seed = 2 }", "seed = -2 }"),
    ("kind = \"formula\", text", "kind = \"formla\", text"),
    ("kind = \"formula\", text", "kind = \"mc\", text"),
    ("benchmark_spacing = 0.05", "benchmark_spacing = 0.000005"),
    ("isovalue = 0.0", "isovalue = 9.0"),
    ("right = \"torus_bi-relaxed\"", "right = \"torus_bi-relax\""),
    ("sides = \"balanced\"", "sides = \"balance\""),
    ("choices = [\"Left\", \"No preference\", \"Right\"]", "choices = [\"Left\", \"Right\"]"),
    ("target = \"cpu/x86-64-v3.toml\"", "target = \"cpu/m1.toml\""),
];

/// Files and flags that somebody may give who is new to it.
const GIVEN: [&[&str]; 20] = [
    &["validate", "nothing.toml"],
    &["validate", "t"],
    &["validate", "wrong.csv"],
    &["extract", "t/study.toml", "--only", "torus_bi-relax"],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--method",
        "MC",
    ],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--method",
        "marching-cubes",
    ],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--method",
        "poisson",
    ],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--recipe",
        "mc",
    ],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--recipe",
        "{ kind = \"mc\" }",
    ],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--recipe",
        "{ kind = \"cubes\", face = \"trilinear\" }",
    ],
    &[
        "extract",
        "--field",
        "x",
        "--bounds=-1,-1,-1,1,1,1",
        "--spacing",
        "0.1",
        "-o",
        "a.ply",
        "--arrangement",
        "Body-Centered",
    ],
    &["collect", "t/study.toml", "wrong.csv", "-o", "c.csv"],
    &["collect", "t/study.toml", "choice.csv", "-o", "c.csv"],
    &["collect", "t/study.toml", "order.csv", "-o", "c.csv"],
    &["collect", "t/study.toml", "empty.csv", "-o", "c.csv"],
    &["analyse", "t/study.toml"],
    &["analyse", "t/study.toml", "--responses", "wrong.csv"],
    &["deidentify", "t/study.toml", "-o", "x"],
    &["design", "power", "t/study.toml", "--shares", "69"],
    &["design", "power", "t/study.toml", "--side-bias", "left"],
];

fn refusals() -> String {
    let folder = Folder::new();
    let run = |arguments: &[&str]| Run::of(folder.isostudy().args(arguments));
    assert_eq!(run(&["new", "t"]).code, Some(0));
    let study = folder.read("t/study.toml");
    let mut said = String::new();
    for (from, to) in STUDY {
        assert!(study.contains(from), "{from}");
        folder.write("t/x.toml", study.replacen(from, to, 1));
        said += &section(&format!("a study with {to}"), run(&["validate", "t/x.toml"]));
    }
    folder.write("wrong.csv", "person,Q1,Q2\np1,left,right\n");
    let download = "participant,form,order,stimulus,choice,rt_ms\np1,1,2,abcd,L,1000\n";
    folder.write("choice.csv", format!("{download}p1,1,3,efgh,left,900\n"));
    folder.write("order.csv", download.replace("1,2", "1,second"));
    folder.write("empty.csv", "");
    said + &GIVEN.map(|arguments| section(&arguments.join(" "), run(arguments))).concat()
}

#[test]
fn messages_are_worded_as_in_their_file() {
    let meshes = distance::meshes();
    let refused = distance::REFUSED
        .map(|(arguments, _)| section(&format!("distance {}", arguments.join(" ")), meshes.run(arguments)));
    let said = comparisons() + &refused.concat() + &refusals();
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
