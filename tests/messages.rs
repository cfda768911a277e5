//! How the command words what it found and what it refuses. Other tests assert names, places and numbers; words stand in
//! `golden/messages.txt` alone, which is compared as a whole. `ISOSTUDY_BLESS=1` writes it anew; its difference is then read before
//! it is committed.

use crate::command::{Folder, Run};
use crate::distance;
use crate::gate::{Pair, planted, quiet, slower};
use serde_json::{Value, json};
use sha2::Digest;
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
const GIVEN: [&[&str]; 22] = [
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
    &["design", "power", "t/study.toml", "--part", "4/3", "-o", "p.json"],
    &["design", "power", "t/study.toml", "--part", "1/3"],
];

/// The program's; the golden file has the first one.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Parts of a simulation, and files that are none, merged with the first of two.
fn parts() -> String {
    let folder = Folder::of("design");
    folder.isostudy().args(["new", "t"]).output().unwrap();
    let part = |part: &str, seed: &str, out: &str| {
        let few = ["--studies", "100", "--participants", "6", "--shares", "0.7"];
        let own = ["power", "t/study.toml", "--part", part, "--seed", seed, "-o", out];
        let Run { code, stdout, stderr } = folder.succeed(&[&own[..], &few].concat());
        assert!(stderr.contains("spread between people"), "{stderr}");
        // The rest has a time.
        section(&own.join(" "), Run { code, stdout, stderr: String::new() })
    };
    let mut said = part("1/2", "1", "1.json");
    part("2/2", "2", "seed.json");
    part("2/3", "1", "cut.json");
    folder.write("changed.json", folder.read("1.json").replacen("\"seed\":1", "\"seed\":7", 1));
    folder.write("end.json", &folder.read("1.json")[..100]);
    folder.write("newer.json", "{\"schema\":2}");
    folder.write("version.json", {
        let text = folder.read("1.json");
        let place = text.find("\"contents\":").unwrap() + "\"contents\":".len();
        let contents = text[place..].trim_end().strip_suffix('}').unwrap().replacen(VERSION, "0.0.9", 1);
        let digest: String = sha2::Sha256::digest(&contents).iter().map(|b| format!("{b:02x}")).collect();
        format!("{{\"schema\":1,\"sha256\":\"{digest}\",\"contents\":{contents}}}")
    });
    std::fs::copy(folder.path("1.json"), folder.path("copy.json")).unwrap();
    for more in [
        "",
        "1.json",
        "copy.json",
        "seed.json",
        "cut.json",
        "changed.json",
        "end.json",
        "newer.json",
        "version.json",
    ] {
        let mut words = vec!["power", "t/study.toml", "--merge", "1.json"];
        words.extend(Some(more).filter(|more| !more.is_empty()));
        said += &section(&words.join(" "), folder.run(&words)).replace(VERSION, "0.1.0");
    }
    folder.write("t/study.toml", folder.read("t/study.toml") + "\n");
    said + &section(
        "the same, with another study file",
        folder.run(&["power", "t/study.toml", "--merge", "1.json"]),
    )
}

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
    let said = comparisons() + &refused.concat() + &refusals() + &parts();
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
