//! Many answers: the same numbers as of few, and Parquet as well as CSV.

use crate::command::{Folder, Run};
use std::collections::BTreeMap;

/// The cells of a CSV without quotes, by the columns named.
fn cells(csv: &str, columns: &[&str]) -> Vec<Vec<String>> {
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let place = |name: &&str| header.iter().position(|title| title == name).expect("a column");
    let places: Vec<usize> = columns.iter().map(place).collect();
    lines.map(|line| places.iter().map(|&place| line[place].to_owned()).collect()).collect()
}

/// Answers of 40 people to four pairs of four items each, which any machine draws alike.
fn answers() -> String {
    let mut state = 9_u32;
    let mut draw = move |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) % below
    };
    let mut text = String::from("participant,left,right,choice,order\n");
    for person in 0..40 {
        for order in 0..4 {
            // No question twice, but some pairs with their sides exchanged.
            let left = order;
            let right = (left + 1 + draw(3)) % 4;
            let choice = match draw(12) {
                0 | 1 => "none",
                at if at < 7 + left - right.min(left) => "left",
                _ => "right",
            };
            text += &format!("p{person},m{left},m{right},{choice},{order}\n");
        }
    }
    text
}

fn analyse(folder: &Folder, file: &str, out: &str, many: bool) -> Run {
    let mut command = folder.isostudy();
    command.args(["analyse", file, "--out", out]).args(many.then_some("--many"));
    Run::succeed(&mut command)
}

#[test]
fn worths_models_and_tests_are_those_of_the_full_analysis() {
    let folder = Folder::new();
    folder.write("answers.csv", answers());
    analyse(&folder, "answers.csv", "few", false);
    let run = analyse(&folder, "answers.csv", "many", true);
    assert!(run.stderr.contains("are counted as many answers"), "{}", run.stderr);
    for table in ["worths", "models"] {
        let path = format!("tables/{table}.csv");
        assert_eq!(folder.read(&format!("few/{path}")), folder.read(&format!("many/{path}")));
    }
    let numbers = [
        "first",
        "no_preference",
        "second",
        "participants",
        "p_sign_flip",
        "p_adjusted",
        "mean",
        "low",
        "high",
        "p_equivalence",
    ];
    let few = cells(&folder.read("few/tables/tests.csv"), &numbers);
    let many = cells(&folder.read("many/tables/pairs.csv"), &numbers);
    assert_eq!((few.len(), &few), (6, &many));
    // Counted here once more.
    let mut wins: BTreeMap<String, usize> = BTreeMap::new();
    for row in cells(&answers(), &["left", "right", "choice"]) {
        let chosen = match row[2].as_str() {
            "left" => &row[0],
            "right" => &row[1],
            _ => continue,
        };
        *wins.entry(chosen.clone()).or_default() += 1;
    }
    for row in cells(&folder.read("many/tables/factors.csv"), &["item", "wins", "answers", "factor"]) {
        let want = wins[&row[0]];
        assert_eq!((row[1].parse(), row[2].as_str()), (Ok(want), "160"));
        assert_eq!(row[3].parse::<f64>().unwrap(), want as f64 / 160.0);
    }
}

#[test]
fn a_parquet_file_has_the_numbers_of_its_csv() {
    let folder = Folder::new();
    folder.write("answers.csv", answers());
    analyse(&folder, "answers.csv", "csv", false);
    // The answers as rows, which the full analysis writes.
    let run = analyse(&folder, "csv/data/answers.parquet", "parquet", true);
    assert!(run.stderr.contains("answers.parquet: long"), "{}", run.stderr);
    let [csv, parquet] = ["csv", "parquet"].map(|of| folder.read(&format!("{of}/tables/worths.csv")));
    assert_eq!(csv, parquet);
}

#[test]
fn a_damaged_parquet_file_is_an_error_that_names_it() {
    let folder = Folder::new();
    folder.write("answers.csv", answers());
    analyse(&folder, "answers.csv", "csv", false);
    let whole = std::fs::read(folder.path("csv/data/answers.parquet")).unwrap();
    let mut damaged: Vec<Vec<u8>> =
        [4, 100, whole.len() / 2, whole.len() - 1].map(|end| whole[..end].to_vec()).to_vec();
    for place in (4..whole.len()).step_by(whole.len() / 24) {
        let mut one = whole.clone();
        one[place] ^= 0x55;
        damaged.push(one);
    }
    for (i, bytes) in damaged.iter().enumerate() {
        folder.write("damaged.parquet", bytes);
        let run = Run::of(
            folder.isostudy().args(["analyse", "damaged.parquet", "--many", "--out"]).arg(format!("d{i}")),
        );
        assert!(!run.stderr.contains("panicked"), "{i}: {}", run.stderr);
        match run.code {
            // A name may have changed.
            Some(0) => {}
            code => assert!(code == Some(2) && run.stderr.contains("damaged.parquet"), "{i}: {run:?}"),
        }
    }
}

#[test]
fn a_study_is_not_counted_as_many() {
    let folder = Folder::new();
    folder.write("study.toml", "");
    let run = Run::of(folder.isostudy().args(["analyse", "study.toml", "--many"]));
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("--many is for answers without a study"), "{}", run.stderr);
}
