//! Planted truths, through the command and the files that people use. Every number of the tables is proved by
//! `isostudy analyse --self-test`; here it is proved that forms, page, server and files lead to the same tables.

use crate::command;
use crate::command::Run;
use crate::fixture::Fixture;
use crate::http;
use crate::server::{Server, TOKEN, answer, begin};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A line of a table, by column.
type Row = BTreeMap<String, String>;

/// Runs the command, which must end well.
fn isostudy<S: AsRef<std::ffi::OsStr>>(words: &[S]) {
    Run::succeed(command::isostudy().args(words));
}

/// The rows of a CSV without quoted cells.
fn rows(path: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    lines.map(|cells| header.iter().cloned().zip(cells).collect()).collect()
}

/// What the forms of a study show, training left out.
fn key(study: &Path, out: &Path) -> Vec<Row> {
    isostudy(&["design".as_ref(), "forms".as_ref(), study.as_os_str(), "--out".as_ref(), out.as_os_str()]);
    let mut key = rows(&out.join("key/forms.csv"));
    key.retain(|row| row["role"] != "training");
    key
}

/// How good a configuration is: its clustering counts for more than its lattice.
fn value(id: &str) -> usize {
    let [lattice, clustering] = id.as_bytes()[id.len() - 2..] else { panic!("{id}") };
    2 * b"upi".iter().position(|&letter| letter == clustering).unwrap() + usize::from(lattice == b'b')
}

fn better(shown: &Row) -> &'static str {
    match value(&shown["left"]).cmp(&value(&shown["right"])) {
        std::cmp::Ordering::Greater => "L",
        std::cmp::Ordering::Equal => "NP",
        std::cmp::Ordering::Less => "R",
    }
}

/// The better one but for some, who are as likely to be anybody on any question.
fn mostly_better(shown: &Row) -> &'static str {
    let mixed = shown["question"]
        .bytes()
        .chain(shown["form"].bytes())
        .fold(17_u64, |sum, letter| (sum ^ u64::from(letter)).wrapping_mul(0x100_0000_01b3));
    match (mixed >> 20) % 10 {
        0 => "NP",
        1 | 2 => {
            if better(shown) == "L" {
                "R"
            } else {
                "L"
            }
        }
        _ => better(shown),
    }
}

/// Tables that do not depend on who is called what, nor on times.
const TABLES: [&str; 11] = [
    "answer_counts",
    "preference_groups",
    "preference_overall",
    "preference_margins",
    "preference_objects",
    "preference_arrangements",
    "tests",
    "omnibus",
    "worths",
    "models",
    "agreement",
];

/// Analyses a file of answers.
fn tables(study: &Path, answers: &Path, out: &Path) -> BTreeMap<&'static str, String> {
    isostudy(&[
        "analyse".as_ref(),
        study.as_os_str(),
        "--responses".as_ref(),
        answers.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ]);
    let read = |name| std::fs::read_to_string(out.join(format!("tables/{name}.csv"))).unwrap();
    TABLES.map(|name| (name, read(name))).into()
}

/// The same cells; numbers may differ where sums in another order round otherwise.
fn assert_same(way: &str, first: &BTreeMap<&str, String>, other: &BTreeMap<&str, String>) {
    for (name, own) in first {
        let cells = |text: &str| text.split([',', '\n']).map(str::to_owned).collect::<Vec<_>>();
        let (own, other) = (cells(own), cells(&other[name]));
        assert_eq!(own.len(), other.len(), "{way}: {name}");
        for (own, other) in own.iter().zip(&other) {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(1.0);
            let same = own == other || own.parse().is_ok_and(|a| other.parse().is_ok_and(|b| near(a, b)));
            assert!(same, "{way}: {name} has {other} for {own}");
        }
    }
}

/// What the page gives whoever has answered: the CSV, or the JSON.
fn download(fixture: &Fixture, study: &str, form: &[&Row]) -> PathBuf {
    let number: u64 = form[0]["form"].parse().unwrap();
    // Names are drawn at random, so their order is not that of forms.
    let name = format!("{:08x}", number.wrapping_mul(2_654_435_761) % (1 << 32));
    let answers: Vec<Value> = form
        .iter()
        .map(|shown| {
            json!({
                "participant": name, "form": number, "order": shown["order"].parse::<u32>().unwrap(),
                "stimulus": shown["stimulus"], "choice": mostly_better(shown), "rt_ms": 4000, "answered": "2026-11-21T10:00:00Z",
            })
        })
        .collect();
    let is_json = number.is_multiple_of(2);
    let path = fixture.folder().join(format!("{name}.{}", if is_json { "json" } else { "csv" }));
    let text = if is_json {
        json!({
            "schema": 1, "study": study, "participant": name, "form": number, "started": "2026-11-21T09:00:00Z",
            "finished": "2026-11-21T10:00:00Z", "answers": answers,
        })
        .to_string()
    } else {
        let columns = ["participant", "form", "order", "stimulus", "choice", "rt_ms", "answered"];
        let line =
            |answer: &Value| columns.map(|column| answer[column].to_string().replace('"', "")).join(",");
        let lines: Vec<String> = answers.iter().map(line).collect();
        format!("{}\r\n{}\r\n", columns.join(","), lines.join("\r\n"))
    };
    std::fs::write(&path, text).unwrap();
    path
}

/// One row a person, with the number of the form and what was pressed.
fn wide(key: &[Row]) -> String {
    let questions: Vec<String> = (1..=27).map(|number| format!("Q{number}")).collect();
    let mut text = format!("participant,form,{}\n", questions.join(","));
    for form in key.chunk_by(|a, b| a["form"] == b["form"]) {
        let pressed = |question: &String| {
            form.iter().find(|shown| shown["question"] == *question).map_or("", |shown| mostly_better(shown))
        };
        let cells: Vec<&str> = questions.iter().map(pressed).collect();
        text += &format!("p{0},{0},{1}\n", form[0]["form"], cells.join(","));
    }
    text
}

/// Everybody answers through the server's interface.
fn serve(fixture: &Fixture, key: &[Row], people: usize) -> (PathBuf, PathBuf) {
    let server = Server::start(fixture, 0);
    for _ in 0..people {
        let session = begin(server.address);
        let form = session["form"]["form"].to_string();
        let own: Vec<&Row> = key.iter().filter(|shown| shown["form"] == form).collect();
        for (place, shown) in own.iter().enumerate() {
            assert_eq!(session["form"]["questions"][place], shown["stimulus"]);
            let sent = answer(&session, place, mostly_better(shown));
            let (status, body) = http::post(server.address, "/api/answers", &sent).unwrap();
            assert_eq!(status, 200, "{body}");
        }
    }
    let (status, csv) = http::get(server.address, "/api/admin/answers.csv", TOKEN).unwrap();
    assert_eq!(status, 200);
    let kept = fixture.folder().join("kept.csv");
    std::fs::write(&kept, csv).unwrap();
    let shared = fixture.folder().join("shared");
    isostudy(&[
        "deidentify".as_ref(),
        fixture.config().as_os_str(),
        "--answers".as_ref(),
        fixture.folder().join("answers").as_os_str(),
        "--out".as_ref(),
        shared.as_os_str(),
    ]);
    (kept, shared.join("answers.csv"))
}

fn every_way_in(most: u32, asked: usize) {
    let fixture = Fixture::balanced();
    fixture.edit("max_questions = 32", &format!("max_questions = {most}"));
    let (study, folder) = (fixture.config(), fixture.folder().to_owned());
    let key = key(&study, &folder.join("forms"));
    let forms: Vec<Vec<&Row>> =
        key.chunk_by(|a, b| a["form"] == b["form"]).map(|form| form.iter().collect()).collect();
    assert_eq!(forms.len(), 36);

    // The page's downloads.
    let collected = folder.join("collected.csv");
    let mut words = vec![PathBuf::from("collect"), study.clone()];
    words.extend(forms.iter().map(|form| download(&fixture, "quick", form)));
    words.extend(["--out".into(), collected.clone()]);
    isostudy(&words);
    let first = tables(&study, &collected, &folder.join("page"));

    // What was chosen, counted from the key.
    let counts = rows(&folder.join("page/tables/answer_counts.csv"));
    let mut all = 0;
    for row in &counts {
        let own = key.iter().filter(|shown| shown["question"] == row["question"]);
        let chosen = own.map(|shown| match mostly_better(shown) {
            "L" => &shown["left"],
            "R" => &shown["right"],
            _ => "",
        });
        let chosen: Vec<&str> = chosen.collect();
        for (column, id) in
            [("left_answers", row["left"].as_str()), ("no_preference", ""), ("right_answers", &row["right"])]
        {
            let want = chosen.iter().filter(|own| **own == id).count();
            assert_eq!(row[column], want.to_string(), "{row:?}");
            all += want;
        }
    }
    assert_eq!((counts.len(), all), (27, asked));

    let wide_file = folder.join("wide.csv");
    std::fs::write(&wide_file, wide(&key)).unwrap();
    assert_same("wide", &first, &tables(&study, &wide_file, &folder.join("wide")));

    for (way, source) in [("converted", &collected), ("converted from wide", &wide_file)] {
        let long = folder.join(format!("{way}.csv"));
        isostudy(&[
            "convert".as_ref(),
            source.as_os_str(),
            "--study".as_ref(),
            study.as_os_str(),
            "--to".as_ref(),
            "long".as_ref(),
            "--out".as_ref(),
            long.as_os_str(),
        ]);
        assert_same(way, &first, &tables(&study, &long, &folder.join(way)));
    }

    let (kept, shared) = serve(&fixture, &key, forms.len());
    for (way, answers) in [("served", kept), ("deidentified", shared)] {
        assert_same(way, &first, &tables(&study, &answers, &folder.join(way)));
    }
}

#[test]
fn every_way_in_leads_to_the_same_tables() {
    every_way_in(32, 36 * 27);
}

#[test]
fn every_way_in_leads_to_the_same_tables_where_questions_are_dealt_into_blocks() {
    every_way_in(14, 36 * 9);
}

/// The published design done right, its bunny replaced so that nothing is fetched.
fn published() -> (tempfile::TempDir, PathBuf) {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").canonicalize().unwrap();
    let text = std::fs::read_to_string(configs.join("balanced.toml")).unwrap();
    let (before, rest) = text.split_once("[objects.field]").unwrap();
    let after = &rest[rest.find("[turntable]").unwrap()..];
    let text = format!("{before}field = {{ kind = \"sphere\", radius = 0.4 }}\n{after}")
        .replace("\"cpu/", &format!("\"{}/cpu/", configs.display()));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("balanced.toml");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

/// Every row of `tests.csv` where everybody answers the published design in this way.
fn tests(pressed: impl Fn(&Row) -> &'static str) -> Vec<Row> {
    let (folder, study) = published();
    let mut text = String::from("participant,form,order,question,left,right,choice\n");
    for shown in key(&study, &folder.path().join("forms")) {
        let [form, order, question, left, right] =
            ["form", "order", "question", "left", "right"].map(|name| &shown[name]);
        text += &format!("p{form},{form},{order},{question},{left},{right},{}\n", pressed(&shown));
    }
    let answers = folder.path().join("answers.csv");
    std::fs::write(&answers, text).unwrap();
    let out = folder.path().join("out");
    drop(tables(&study, &answers, &out));
    rows(&out.join("tables/tests.csv"))
}

fn p(row: &Row) -> f64 {
    row["p_adjusted"].parse().unwrap()
}

/// Whoever looks at nothing has preferred nothing.
#[test]
fn pressing_left_always_is_no_preference() {
    let tests = tests(|_| "L");
    assert!(tests.len() > 27 + 25);
    for row in tests.iter().filter(|row| row["family"] != "questions") {
        assert!(p(row) >= 0.5, "{row:?}");
    }
}

#[test]
fn unanimity_is_a_preference() {
    let tests = tests(better);
    let mut found = BTreeMap::new();
    for row in tests
        .iter()
        .filter(|row| ["pooled", "groups"].contains(&&*row["family"]) || row["family"].starts_with("objects"))
    {
        assert!(p(row) < 0.001, "{row:?}");
        *found.entry(row["family"].as_str()).or_insert(0) += 1;
    }
    assert_eq!(
        found,
        BTreeMap::from([("groups", 9), ("objects", 3), ("objects-clustering", 9), ("pooled", 4)])
    );
    // And the same everywhere, so that nothing depends on anything.
    let differences = tests.iter().filter(|row| row["scope"].contains(" - "));
    assert!(differences.clone().count() > 9 && differences.clone().all(|row| p(row) == 1.0));
}
