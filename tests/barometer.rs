//! `isostudy barometer`: our own engines are right, engines that were made wrong on purpose are found, and recordings are compared.

use crate::command::{self, Run};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const ISOSTUDY: &str = env!("CARGO_BIN_EXE_isostudy");

/// In a folder, where it remembers what it was allowed: nothing, at first.
fn isostudy(place: &Path, arguments: &[&str]) -> Run {
    let mut command = command::isostudy();
    Run::of(command.args(arguments).current_dir(place).env("XDG_STATE_HOME", place.join("state")))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The workloads of this repository, with engines of a test.
fn folder(at: &Path, engines: &[(String, Vec<String>)]) -> PathBuf {
    let folder = at.join("barometer");
    std::fs::create_dir_all(&folder).unwrap();
    for group in ["curated", "reported", "hard", "grown", "chunks"] {
        let name = format!("{group}.toml");
        std::fs::copy(root().join("configs/barometer").join(&name), folder.join(&name)).unwrap();
    }
    let mut text = String::new();
    for (id, command) in engines {
        let ours = id == "mc";
        writeln!(
            text,
            "[[engines]]\nid = {id:?}\nname = {id:?}\nlicense = \"MIT\"\ninstall = \"here\"\ncommand = {command:?}\n\
             takes = \"samples\"\nties = \"outside\"\nfamily = \"cubes\"\nours = {ours}\nquick = true"
        )
        .unwrap();
    }
    std::fs::write(folder.join("engines.toml"), text).unwrap();
    folder
}

fn own(method: &str) -> (String, Vec<String>) {
    (method.to_owned(), [ISOSTUDY, "barometer", "engine", method].map(str::to_owned).to_vec())
}

/// State and faults by workload and engine.
fn measured(out: &Path) -> BTreeMap<(String, String), (String, String)> {
    let mut reader = csv::Reader::from_path(out.join("measurements.csv")).unwrap();
    let rows = reader.records().map(|row| row.unwrap());
    rows.map(|row| ((row[0].into(), row[3].into()), (row[4].into(), row[5].into()))).collect()
}

/// Methods that promise a manifold are right on all that is quick, but for random samples, whose exact topology `mc33` alone promises. Duals
/// with one vertex per cell are no manifolds where sheets share a cell, and have no other fault.
#[test]
fn our_own_engines_are_right() {
    let place = tempfile::tempdir().unwrap();
    let methods = ["mc", "mc33", "nets-manifold", "si", "bi"];
    let others = ["nets", "dc", "snapmc"];
    let engines: Vec<_> = methods.into_iter().chain(others).map(own).collect();
    let folder = folder(place.path(), &engines);
    let out = place.path().join("out");
    let arguments = [
        "barometer",
        "run",
        folder.to_str().unwrap(),
        "--quick",
        "--rounds",
        "1",
        "-o",
        out.to_str().unwrap(),
    ];
    let refused = isostudy(place.path(), &arguments);
    assert_eq!(refused.code, Some(2), "programs run where they are allowed alone: {}", refused.stderr);
    assert!(refused.stderr.contains("--allow-programs"), "{}", refused.stderr);
    let run = isostudy(place.path(), &[&arguments[..], &["--allow-programs"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let found = measured(&out);
    assert_eq!(found.len(), 23 * engines.len());
    for ((workload, engine), (state, faults)) in &found {
        if others.contains(&engine.as_str()) {
            let only = faults.split_once(" non-manifold edges and vertices, expected 0");
            let is_known = only.is_some_and(|(count, rest)| {
                count.bytes().all(|byte| byte.is_ascii_digit())
                    && (rest.is_empty() || rest.ends_with("grids"))
            });
            assert!(
                state == "right" || is_known || workload == "random-12",
                "{engine} on {workload}: {faults}"
            );
        } else if workload != "random-12" || engine == "mc33" {
            assert_eq!(state, "right", "{engine} on {workload}: {faults}");
        }
    }
    let conformance = std::fs::read_to_string(out.join("conformance.csv")).unwrap();
    let of = |engine: &str| -> Vec<u64> {
        let line = conformance.lines().find(|line| line.starts_with(&format!("{engine},"))).unwrap();
        line.split(',').skip(1).take(4).map(|cell| cell.parse().unwrap()).collect()
    };
    assert_eq!(of("mc33"), [2000; 4], "all grids have the exact topology");
    for engine in methods {
        assert_eq!((of(engine)[0], of(engine)[3]), (2000, 2000), "{engine} makes closed manifolds");
    }
    assert!(of("mc")[1] < 1000, "marching cubes promises no such topology");
    for file in [
        "index.html",
        "tables.md",
        "speed-and-correctness.svg",
        "speed-and-correctness.png",
        "engines.csv",
        "about.toml",
    ] {
        assert!(out.join(file).metadata().unwrap().len() > 100, "{file}");
    }

    // Nothing is done again, and the files stay.
    let before = std::fs::read(out.join("measurements.csv")).unwrap();
    let again = isostudy(place.path(), &arguments);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert_eq!(again.stderr.matches(", kept").count(), 23, "{}", again.stderr);
    assert_eq!(std::fs::read(out.join("measurements.csv")).unwrap(), before);

    let out = out.to_str().unwrap();
    let compared = isostudy(place.path(), &["barometer", "compare", out, out]);
    assert_eq!(compared.code, Some(0), "a recording agrees with itself: {}", compared.stderr);
    the_order_of_times_turns(place.path(), out);
    let ranks = isostudy(
        place.path(),
        &["barometer", "rank", out, "--group", "chunks", "--engine", "mc", "--engine", "mc33"],
    );
    assert!(
        ranks.stdout.contains("over the 2 workloads") && !ranks.stdout.contains("| si |"),
        "{}",
        ranks.stdout
    );
    let unknown = isostudy(place.path(), &["barometer", "rank", out, "--engine", "mc34"]);
    assert!(unknown.code == Some(2) && unknown.stderr.contains("mc34"), "{}", unknown.stderr);
}

/// A recording with the times of two engines exchanged, a thousandfold apart, is in disagreement with one in which they are the other way
/// round; but for times of builds of two profiles, which are not compared.
fn the_order_of_times_turns(place: &Path, out: &str) {
    let turned = |name: &str, slow: &str| {
        let folder = place.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        for file in std::fs::read_dir(out).unwrap().map(|entry| entry.unwrap().path()) {
            if file.is_file() {
                std::fs::copy(&file, folder.join(file.file_name().unwrap())).unwrap();
            }
        }
        let path = folder.join("measurements.csv");
        let mut reader = csv::Reader::from_path(&path).unwrap();
        let header = reader.headers().unwrap().clone();
        let time = header.iter().position(|column| column == "time_s").unwrap();
        let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.unwrap()).collect();
        let mut writer = csv::Writer::from_path(&path).unwrap();
        writer.write_record(&header).unwrap();
        for row in rows {
            let of = |cell: &str| cell.parse::<f64>().map(|s| s * if &row[3] == slow { 1e3 } else { 1.0 });
            let cells = row.iter().enumerate().map(|(i, cell)| match (i == time, of(cell)) {
                (true, Ok(slower)) => slower.to_string(),
                _ => cell.to_owned(),
            });
            writer.write_record(cells).unwrap();
        }
        writer.flush().unwrap();
        folder
    };
    let [one, other] = [turned("one", "mc"), turned("other", "mc33")];
    let compare =
        || isostudy(place, &["barometer", "compare", one.to_str().unwrap(), other.to_str().unwrap()]);
    let disagree = compare();
    assert_eq!(disagree.code, Some(1), "{}{}", disagree.stdout, disagree.stderr);
    assert!(
        disagree.stderr.contains("time: mc33 is before mc * in the first recording"),
        "{}",
        disagree.stderr
    );
    let about = other.join("about.toml");
    let text = std::fs::read_to_string(&about).unwrap();
    let line = text.lines().find(|line| line.starts_with("profile = ")).unwrap();
    std::fs::write(&about, text.replace(line, "profile = \"release, opt-level 9\"")).unwrap();
    let apart = compare();
    assert_eq!(apart.code, Some(0), "{}{}", apart.stdout, apart.stderr);
    assert!(
        apart.stderr.contains("times are not compared") && !apart.stdout.contains("| time |"),
        "{}",
        apart.stdout
    );
}

/// One flipped triangle, one lost, open seams, half a cell of displacement, a mesh that is too large, another answer when it is timed: each
/// is found on each workload, and gets no rank. The adapter itself spoils nothing. One that dies once fails once.
#[test]
fn engines_that_were_made_wrong_are_found() {
    let place = tempfile::tempdir().unwrap();
    // A copy, beside which the dying one leaves a mark.
    let script = place.path().join("spoiled_engine.py");
    std::fs::copy(root().join("tests/spoiled_engine.py"), &script).unwrap();
    let spoiled = |way: &str| {
        let command = ["python3", script.to_str().unwrap(), way, ISOSTUDY, "barometer", "engine", "mc"];
        (way.to_owned(), command.map(str::to_owned).to_vec())
    };
    let ways = ["flipped", "lost", "seams", "shifted", "inflated", "lazy"];
    let engines: Vec<_> =
        [own("mc"), spoiled("whole"), spoiled("dying")].into_iter().chain(ways.map(spoiled)).collect();
    let folder = folder(place.path(), &engines);
    let out = place.path().join("out");
    let mut arguments = vec!["barometer", "run", folder.to_str().unwrap(), "--quick", "--rounds", "1", "-o"];
    arguments.extend([out.to_str().unwrap(), "--allow-programs"]);
    let workloads = ["sphere", "torus", "gyroid", "terrain-hills", "unequal-steps", "large-offset"];
    workloads.iter().for_each(|workload| arguments.extend(["--workload", workload]));
    let run = isostudy(place.path(), &arguments);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let found = measured(&out);
    let words = [
        ("flipped", "wrong", "misoriented"),
        ("lost", "wrong", "boundary"),
        ("seams", "wrong", "boundary"),
        ("shifted", "wrong", "displacement"),
        ("inflated", "wrong", "from the surface"),
        ("lazy", "failed", "when it was timed"),
    ];
    for workload in workloads {
        let of = |engine: &str| &found[&(workload.to_owned(), engine.to_owned())];
        assert_eq!((of("mc").0.as_str(), of("whole").0.as_str()), ("right", "right"), "{workload}");
        for (way, expected, word) in words {
            let (state, faults) = of(way);
            assert!(state == expected && faults.contains(word), "{way} on {workload}: {state}: {faults}");
        }
    }
    let deaths =
        workloads.iter().filter(|id| found[&(id.to_string(), "dying".to_owned())].0 == "failed").count();
    assert_eq!(deaths, 1, "{found:?}");
    let tables = std::fs::read_to_string(out.join("tables.md")).unwrap();
    let ranks: Vec<&str> = tables.split("### ").filter(|table| table.starts_with("By ")).collect();
    assert!(!ranks.is_empty() && ranks.iter().all(|table| table.contains("| whole |")), "{tables}");
    for way in ways {
        assert!(ranks.iter().all(|table| !table.contains(&format!("| {way} |"))), "{way}: {tables}");
    }
}
