//! Whether it mattered on what screens people answered. Said from the table.

use super::Block;
use crate::statement::{Finding, Standing};
use crate::words::{counted, list, p as p_value};
use isostudy_table::{Cell, Table};

/// `level` is that of tests, after correction.
pub(super) fn findings(table: Option<&Table>, level: f64) -> Vec<Block> {
    let Some(table) = table.filter(|table| !table.rows.is_empty()) else { return Vec::new() };
    let place = |name: &str| {
        table.columns.iter().position(|column| column.name == name).expect("a column of this table")
    };
    let text = |row: &[Cell], name: &str| row[place(name)].in_full();
    let number = |row: &[Cell], name: &str| match row[place(name)] {
        Cell::P(value, _) | Cell::Number(value, _) => Some(value),
        _ => None,
    };
    let tested: Vec<&Vec<Cell>> = table.rows.iter().filter(|row| number(row, "p").is_some()).collect();
    let mut alike: Vec<String> = Vec::new();
    for row in table.rows.iter().filter(|row| number(row, "p").is_none()) {
        let name = text(row, "condition");
        if !alike.contains(&name) {
            alike.push(name);
        }
    }
    let adjusted = |row: &[Cell]| number(row, "p_adjusted").unwrap_or(1.0);
    let percent =
        |share: Option<f64>| share.map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share));
    let mut said = match tested.iter().map(|row| adjusted(row)).min_by(f64::total_cmp) {
        None => {
            "Everybody answered on the same kind of screen, as far as was recorded, so nothing is compared."
                .to_owned()
        }
        Some(least) => {
            let differ: Vec<String> = tested
                .iter()
                .filter(|row| adjusted(row) <= level)
                .map(|row| {
                    format!(
                        "{} ({}: {} against {}: {}; \"{}\" {} against {}, {})",
                        text(row, "condition"),
                        text(row, "measure"),
                        text(row, "first"),
                        text(row, "second"),
                        counted(
                            ["people_first", "people_second"]
                                .map(|n| text(row, n).parse::<usize>().unwrap_or(0))
                                .iter()
                                .sum(),
                            "participant"
                        ),
                        text(row, "measure"),
                        percent(number(row, "share_first")),
                        percent(number(row, "share_second")),
                        p_value(adjusted(row)),
                    )
                })
                .collect();
            let tests = counted(tested.len(), "test");
            match differ.is_empty() {
                true => format!(
                    "Answers do not differ demonstrably by the screen that they were given on: none of {tests}, of answers \
                     without preference and of answers like most others\u{2019}, holds after correction (smallest corrected \
                     {}). That is no proof that screens do not matter.",
                    p_value(least)
                ),
                false => format!(
                    "Answers differ by the screen that they were given on, in {} of {tests} after correction: {}. Screens were \
                     not assigned: people who have them may differ in other things.",
                    differ.len(),
                    list(&differ.iter().map(String::as_str).collect::<Vec<_>>())
                ),
            }
        }
    };
    if !alike.is_empty() && !tested.is_empty() {
        let names: Vec<&str> = alike.iter().map(String::as_str).collect();
        said.push_str(&format!(" Not tested, since all answers are of one part: {}.", list(&names)));
    }
    vec![Block::Finding(Finding::new(Standing::Noted, said))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::screens::screens;

    /// Ten people, half of them on phones, who decide or do not by their number.
    fn said(undecided: impl Fn(usize) -> bool) -> String {
        let row = |person: usize, question: usize| {
            let (choice, width) =
                (if undecided(person) { "none" } else { "left" }, if person < 5 { 390 } else { 1280 });
            format!("p{person},q{question},a,b,{choice},{width},touch\n")
        };
        let rows: String =
            (0..10).flat_map(|person| (0..4).map(move |q| (person, q))).map(|(p, q)| row(p, q)).collect();
        let text = format!("participant,question,left,right,choice,viewport_width,input\n{rows}");
        let path = std::path::Path::new("answers.csv");
        let read =
            isostudy_responses::parse(text.as_bytes(), path, None, &isostudy_responses::Mapping::default())
                .unwrap();
        match &findings(Some(&screens(&read.responses)), 0.05)[..] {
            [Block::Finding(finding)] => finding.text.clone(),
            _ => panic!("one finding"),
        }
    }

    #[test]
    fn a_difference_is_named_and_none_is_no_proof() {
        // Corrected p: twice 2 / 252.
        let differs = said(|person| person < 5);
        assert!(
            differs.contains("in 2 of 2 tests") && differs.contains("\"no preference\" 100 % against 0 %"),
            "{differs}"
        );
        assert!(differs.contains("Not tested, since all answers are of one part: input."), "{differs}");
        let alike = said(|person| person % 2 == 0);
        assert!(alike.contains("none of 2 tests") && alike.contains("no proof"), "{alike}");
        assert!(findings(None, 0.05).is_empty());
    }
}
