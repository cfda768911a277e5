//! The matrix, and that it would see what it is there to see.

use super::compare::{Compared, Wrong, compare};
use super::designs::{self, Design};
use super::matrix::{self, Made, one};
use super::oracle::{Oracle, compare_worths, hypotheses};
use super::people::{Given, Truth, answers};
use super::routes::Route;
use super::sentences::compare_sentences;
use isostudy_design::Study;
use isostudy_report::report::Block;
use isostudy_responses::{Choice, Plan, Responses};
use isostudy_table::{Cell, Table};
use std::collections::BTreeSet;

#[test]
fn every_cell_is_right() {
    let all = matrix::run(36);
    // Thousands are tried on two designs alone.
    assert_eq!(all.len(), designs::ALL.len() * (Truth::ALL.len() - 1) + 2);
    assert!(all.iter().all(|of| of.cells > 100), "something was not compared");
    let wrong: Vec<String> = all
        .iter()
        .flat_map(|of| of.wrong.iter().map(|w| format!("{} | {} | {w}", of.design, of.truth)))
        .collect();
    assert!(wrong.is_empty(), "{} cells:\n{}", wrong.len(), wrong[..wrong.len().min(40)].join("\n"));
}

/// The balanced study, what is given to it, and what is read.
fn planted(design: &Design, truth: Truth) -> (Study, Vec<Given>, Responses) {
    let study = design.study(36);
    let given = answers(&study, truth, 36);
    let read = Route::Long.read(&study, &Plan::of_study(&study), &given).unwrap();
    (study, given, read)
}

/// The columns that a program has wrong; of sentences the place and what is wrong with it.
fn columns(wrong: &[Wrong]) -> BTreeSet<String> {
    wrong.iter().map(|wrong| format!("{}.{}", wrong.table, wrong.column)).collect()
}

/// Answers to pairs that were shown the other way round than listed, taken for answers to the listed sides: what the
/// contrasts, the prediction and parts of the report once did.
fn mistaken(mut read: Responses) -> Responses {
    for answer in &mut read.answers {
        if answer.left != read.questions[answer.question as usize].left {
            answer.choice = match answer.choice {
                Choice::Left => Choice::Right,
                Choice::NoPreference => Choice::NoPreference,
                Choice::Right => Choice::Left,
            };
        }
    }
    read
}

#[test]
fn sides_that_are_mistaken_are_seen_in_every_table() {
    for design in designs::ALL {
        let as_listed = design.name == "as listed";
        for truth in [Truth::Unanimous, Truth::AlwaysLeft, Truth::Worths] {
            let (study, given, read) = planted(&design, truth);
            let oracle = Oracle::of(&study, &given);
            let right = Made::of(&study, read.clone()).unwrap().compare(&oracle, truth);
            let wrong = Made::of(&study, mistaken(read)).unwrap().compare(&oracle, truth);
            let [right, wrong] = [right, wrong].map(|compared| columns(&compared.wrong));
            let new: BTreeSet<&str> = wrong.difference(&right).map(String::as_str).collect();
            // Where everybody saw the listed sides there is nothing to mistake.
            assert_eq!(new.is_empty(), as_listed, "{}, {}: {new:?}", design.name, truth.name());
            if as_listed {
                continue;
            }
            for column in [
                "answer_counts.left_answers",
                "preference_groups.wins",
                "preference_groups.factor",
                "preference_objects.wins",
                "preference_overall.factor",
                "tests.first",
                "tests.second",
                "tests.net",
                "tests.mean",
                "tests.p_sign_flip",
                "report.counts",
            ] {
                // One question that everybody answers by the side has no more answers for the one than for the other.
                let even = ["tests.p_sign_flip", "report.counts"].contains(&column) && truth == Truth::Worths;
                assert!(new.contains(column) || even, "{}, {}: {column}: {new:?}", design.name, truth.name());
            }
        }
    }
}

/// A cell that says something else.
fn other(cell: &Cell) -> Cell {
    match cell {
        Cell::Missing => Cell::Count(1),
        Cell::Text(text) => Cell::Text(format!("{text}, not")),
        Cell::Count(count) => Cell::Count(count + 1),
        Cell::Number(value, decimals) => Cell::Number(value + 0.001, *decimals),
        Cell::P(p, decimals) => Cell::P(if *p > 0.5 { p - 0.01 } else { p + 0.01 }, *decimals),
    }
}

fn table<'t>(tables: &'t mut [Table], name: &str) -> &'t mut Table {
    tables.iter_mut().find(|table| table.name == name).unwrap_or_else(|| panic!("no table {name}"))
}

#[test]
fn every_cell_that_is_changed_is_seen() {
    let (study, given, read) = planted(&designs::CHECKED, Truth::Worths);
    let oracle = Oracle::of(&study, &given);
    let made = Made::of(&study, read).unwrap();
    let mut seen = 0;
    for expected in oracle.expected(true) {
        let before = columns(&compare(&made.tables, &expected).wrong);
        for column in expected.keys.iter().chain(expected.columns) {
            let mut tables = made.tables.clone();
            let own = table(&mut tables, expected.table);
            let place = own.columns.iter().position(|own| own.name == *column).unwrap();
            // Single questions have neither all corrections nor all columns: the first row is a contrast.
            own.rows[0][place] = other(&own.rows[0][place]);
            let after = compare(&tables, &expected).wrong;
            let named =
                format!("{}.{}", expected.table, if expected.keys.contains(column) { "" } else { column });
            assert!(before.contains(&named) || columns(&after).contains(&named), "{named}: {after:?}");
            seen += 1;
        }
        let mut tables = made.tables.clone();
        table(&mut tables, expected.table).rows.pop();
        assert!(
            compare(&tables, &expected).wrong.iter().any(|wrong| wrong.want == "a row"),
            "{}",
            expected.table
        );
    }
    assert!(seen > 60, "{seen}");
}

#[test]
fn worths_that_are_not_the_likeliest_are_seen() {
    let (study, given, read) = planted(&designs::CHECKED, Truth::Worths);
    let oracle = Oracle::of(&study, &given);
    let made = Made::of(&study, read).unwrap();
    let before = columns(&compare_worths(&oracle, &made.tables).wrong);
    for (name, column, by, seen) in [
        ("worths", "log_worth", 0.008, "models.slope in "),
        ("models", "log_likelihood", 0.001, "models.log_likelihood"),
        ("models", "ln_nu", 0.01, "models.slope in the ties"),
        ("models", "side", 0.01, "models.slope in the side"),
        ("models", "side_p", 0.01, "models.side_p"),
    ] {
        let mut tables = made.tables.clone();
        let own = table(&mut tables, name);
        let place = own.columns.iter().position(|own| own.name == column).unwrap();
        for row in &mut own.rows {
            row[place] = match &row[place] {
                Cell::Number(value, decimals) if *value != 0.0 => Cell::Number(value + by, *decimals),
                Cell::P(p, decimals) => Cell::P(p + by, *decimals),
                cell => cell.clone(),
            };
        }
        let after = columns(&compare_worths(&oracle, &tables).wrong);
        assert!(
            after.difference(&before).any(|column| column.starts_with(seen)),
            "{name}.{column}: {after:?}"
        );
    }
}

/// The report with one text replaced in every sentence.
fn reworded(made: &Made, from: &str, to: &str) -> Made {
    let mut report = made.report.clone();
    for block in report.sections.iter_mut().flat_map(|section| &mut section.blocks) {
        if let Block::Finding(finding) = block {
            finding.text = finding.text.replace(from, to);
        }
    }
    report.lead.iter_mut().for_each(|text| *text = text.replace(from, to));
    Made { people: made.people.clone(), tables: made.tables.clone(), report }
}

#[test]
fn every_number_of_a_sentence_that_is_changed_is_seen() {
    let (study, given, read) = planted(&designs::CHECKED, Truth::Worths);
    let oracle = Oracle::of(&study, &given);
    let made = Made::of(&study, read).unwrap();
    let found = |made: &Made| -> Compared { compare_sentences(&oracle, &hypotheses(&oracle), &made.report) };
    let before = columns(&found(&made).wrong);
    for (from, to, seen) in [
        (" answers against ", " answers against 1", "report.counts"),
        (", adjusted p = 0.", ", adjusted p = 0.9", "report.p corrected"),
        ("gave ", "gave 1", "report.counts"),
        (" went left, ", " went left, 1", "report.sides"),
        (" in a circle", " in a circle", ""),
        ("triads of three items, ", "triads of three items, 1", "report.triads"),
        ("no clustering", "edge collapse", "report.contrast"),
        ("o clustering", "othing", "report.names"),
    ] {
        let after = columns(&found(&reworded(&made, from, to)).wrong);
        assert!(
            seen.is_empty() && after == before || after.contains(seen) && !before.contains(seen),
            "{from}: {after:?}"
        );
    }
}

/// What the issue began with.
#[test]
fn pressing_left_is_no_preference_and_unanimity_is_one() {
    for (truth, holds) in [(Truth::AlwaysLeft, false), (Truth::Unanimous, true)] {
        let (study, given, _) = planted(&designs::CHECKED, truth);
        let own = hypotheses(&Oracle::of(&study, &given));
        let plain = own.iter().filter(|of| of.counts.is_some() && of.family != "questions");
        assert!(plain.clone().count() >= 25);
        for of in plain {
            let p = of.adjusted.low;
            assert!(if holds { p < 0.001 } else { p >= 0.5 }, "{} {}: {p}", of.contrast, of.scope);
        }
    }
}

#[test]
fn the_same_on_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", one(&designs::PAIR, Truth::Worths, 12)))
    };
    assert_eq!(run(1), run(3));
}
