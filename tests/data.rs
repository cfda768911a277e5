//! The Parquet files, read by programs that are not ours: pyarrow and DuckDB, through `scripts/check_data.py`.
//!
//! `DATA_PYTHON` names the Python that has them; otherwise it is `python3`. What is not there is skipped, and said.

use crate::answers::analyse;
use crate::fixture::{Fixture, files};
use std::path::Path;
use std::process::Command;

const READERS: [&str; 2] = ["pyarrow", "duckdb"];

/// What the check says with one reader; `None` where that is not installed.
fn check(results: &Path, reader: &str) -> Option<String> {
    let python = std::env::var("DATA_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/check_data.py");
    let output = match Command::new(&python).arg(script).arg(results).arg(reader).output() {
        Ok(output) => output,
        Err(error) => {
            eprintln!("SKIPPED: {python}: {error}");
            return None;
        }
    };
    if output.status.code() == Some(77) {
        eprintln!("SKIPPED: {python} has no {reader}: data/*.parquet were not read by it");
        return None;
    }
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{reader}: {said}{}", String::from_utf8_lossy(&output.stderr));
    Some(said)
}

#[test]
fn other_readers_find_what_the_tables_say() {
    let fixture = Fixture::new();
    fixture.succeed("study", &[]);
    let made = files(fixture.out());
    let data: Vec<&str> = made.keys().filter_map(|path| path.strip_prefix("data/")).collect();
    assert_eq!(data, ["answers.parquet", "meshes.parquet", "times.parquet"]);
    let manifest = String::from_utf8_lossy(&made["manifest.json"]);
    for name in data {
        let bytes = &made[&format!("data/{name}")];
        assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"), "{name}");
        assert!(manifest.contains(&format!("\"data/{name}\"")), "{name}");
    }
    for said in READERS.iter().filter_map(|reader| check(fixture.out(), reader)) {
        let answers = "answers: 486 rows, 12 rows of preference_groups.csv, 27 questions";
        assert!(
            said.contains(answers) && said.contains("meshes: 54 rows, 18 rows of benchmark.csv"),
            "{said}"
        );
    }
}

#[test]
fn answers_alone_are_written_too() {
    let fixture = Fixture::new();
    fixture.succeed("analyse", &[]);
    let with_study = files(fixture.out());
    assert_eq!(with_study.keys().filter(|path| path.starts_with("data/")).count(), 1);

    let answers = fixture.folder().join("games.csv");
    let text = "participant,object,left,right,choice\nanna@example.org,hill,m1,m2,left\nbo,hill,m2,m1,none\nbo,dale,m2,m10,right\n";
    std::fs::write(&answers, text).unwrap();
    let out = fixture.folder().join("alone");
    let run = analyse(&[answers.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let made = files(&out);
    let bytes = &made["data/answers.parquet"];
    // What people are called stays in their file.
    assert!(!bytes.windows(4).any(|part| part == b"anna"));
    for said in READERS.iter().filter_map(|reader| check(&out, reader)) {
        assert!(said.contains("answers: 3 rows"), "{said}");
    }
    for said in READERS.iter().filter_map(|reader| check(fixture.out(), reader)) {
        assert!(said.contains("answers: 486 rows, 12 rows"), "{said}");
    }
}
