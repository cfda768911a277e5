//! Checks of the answers: who broke a rule of screening and what the tests are without them, and what probes found. Said from
//! the tables, which hold both.

use super::{Block, Evidence, names};
use crate::statement::{Finding, Standing};
use crate::words::{counted, list, p as p_value};
use isostudy_inference::audit::Finding as Probed;
use isostudy_statistics::{Flag, screening};
use isostudy_table::{Cell, Table};
use std::collections::BTreeMap;

/// Tests named at most.
const NAMED: usize = 6;

pub(super) fn findings<'t>(evidence: &Evidence<'_>, table: impl Fn(&str) -> Option<&'t Table>) -> Vec<Block> {
    let mut found = Vec::new();
    if let Some(respondents) = table("respondents") {
        found.push(screened(evidence, respondents));
    }
    found.extend(table("screened").map(|screened| without(evidence, screened)).unwrap_or_default());
    found.extend(table("audit").map(probed).unwrap_or_default());
    found.into_iter().map(Block::Finding).collect()
}

/// The column of this name in every row.
fn column<'t>(table: &'t Table, name: &str) -> impl Iterator<Item = &'t Cell> + use<'t> {
    let place = table.columns.iter().position(|column| column.name == name).expect("a column of this table");
    table.rows.iter().map(move |row| &row[place])
}

fn sum(table: &Table, name: &str) -> u64 {
    column(table, name).filter_map(|cell| cell.in_full().parse::<u64>().ok()).sum()
}

/// Answers to controls.
pub(super) fn controls(respondents: &Table) -> u64 {
    sum(respondents, "controls")
}

/// How many broke which rule, and what was there to judge.
fn screened(evidence: &Evidence<'_>, respondents: &Table) -> Finding {
    let people = respondents.rows.len();
    let flags: Vec<String> = column(respondents, "flags").map(Cell::in_full).collect();
    let broken = flags.iter().filter(|flags| !flags.is_empty()).count();
    let rule = |flag: &Flag| {
        let own = flags.iter().filter(|flags| flags.split(' ').any(|code| code == flag.code())).count();
        (own > 0).then(|| format!("{own} by {}", broken_by(*flag)))
    };
    let rules: Vec<String> = Flag::ALL.iter().filter_map(rule).collect();
    let kinds = [("controls", "control"), ("repeats", "repeat"), ("timed", "timed answer")];
    let (mut judged, mut absent) = (Vec::new(), Vec::new());
    let seen = screening(evidence.shown);
    let of = |rule: &str, number: usize| match number {
        n if n == seen.len() => rule.to_owned(),
        n => format!("{rule} of {}", counted(n, "participant")),
    };
    // The rule sees repeats and controls as well, and so may judge people whom comparisons alone do not.
    let one_sided = flags.iter().filter(|flags| flags.split(' ').any(|code| code == Flag::OneSided.code()));
    let by_comparisons = seen.iter().filter(|of| of.tells_sides() && of.answers[0] + of.answers[2] >= 10);
    match by_comparisons.count().max(one_sided.count()) {
        0 => absent.push("one-sidedness"),
        n => judged.push(of("one-sidedness", n)),
    }
    match seen.iter().filter(|of| of.outlying_p.is_some()).count() {
        0 => absent.push("agreement"),
        n => judged.push(of("agreement", n)),
    }
    for (name, noun) in kinds {
        match sum(respondents, name) {
            0 => absent.push(if name == "timed" { "times" } else { name }),
            n => judged.push(counted(n as usize, noun)),
        }
    }
    // Who answered controls alone is no participant of any other section.
    let others = match people.saturating_sub(seen.len()) {
        0 => String::new(),
        1 => ", 1 of whom compared nothing,".into(),
        n => format!(", {n} of whom compared nothing,"),
    };
    let who = match broken {
        0 => format!("None of {}{others} broke", counted(people, "participant")),
        _ => format!("{broken} of {}{others} broke", counted(people, "participant")),
    };
    let which = if rules.is_empty() { String::new() } else { format!(" ({})", list(&rules)) };
    let mut text = format!(
        "{who} a rule of screening{which}. {}.{}",
        match evidence.excluded {
            0 => "Nobody is left out of any other part of this report".to_owned(),
            1 => "1 of them is left out of every other part of this report".to_owned(),
            n => format!("{n} of them are left out of every other part of this report"),
        },
        if judged.is_empty() { String::new() } else { format!(" Judged: {}.", list(&judged)) }
    );
    if !absent.is_empty() {
        text.push_str(&format!(" Not judged, because the answers do not tell: {}.", list(&absent)));
    }
    Finding::new(Standing::Noted, text)
}

/// How a rule is broken.
fn broken_by(flag: Flag) -> &'static str {
    match flag {
        Flag::OneSided => "choosing one side throughout",
        Flag::Controls => "deciding between equals",
        Flag::Repeats => "choosing otherwise when asked again",
        Flag::Time => "answering faster than anybody can look",
        Flag::Outlying => "answering against the others",
    }
}

/// Rule by rule, the tests that come out otherwise without those who broke it.
fn without(evidence: &Evidence<'_>, screened: &Table) -> Vec<Finding> {
    let in_words: BTreeMap<[&str; 3], String> = evidence
        .hypotheses
        .iter()
        .map(|h| ([&*h.family, &*h.contrast, &*h.scope], names::hypothesis(evidence, h)))
        .collect();
    let keys = [
        "rule",
        "left_out",
        "respondents",
        "family",
        "contrast",
        "scope",
        "conclusion",
        "conclusion_without",
    ];
    let columns: Vec<Vec<String>> =
        keys.iter().map(|name| column(screened, name).map(Cell::in_full).collect()).collect();
    let rows: Vec<usize> = (0..screened.rows.len()).collect();
    let of_rule = |rows: &[usize]| {
        let [rule, left_out, people] = [0, 1, 2].map(|c| columns[c][rows[0]].as_str());
        let changed: Vec<usize> = rows.iter().copied().filter(|&r| columns[6][r] != columns[7][r]).collect();
        let tests = counted(rows.len(), "test");
        let outcome = match changed.len() {
            0 => format!("none of {tests} comes out otherwise"),
            n => {
                let name = |&r: &usize| {
                    let [family, contrast, scope, with, without] = [3, 4, 5, 6, 7].map(|c| &*columns[c][r]);
                    let tested = in_words.get(&[family, contrast, scope]).map_or(contrast, String::as_str);
                    format!("{tested} ({with}, then {without})")
                };
                let mut named: Vec<String> = changed.iter().take(NAMED).map(name).collect();
                if n > NAMED {
                    named.push(format!("{} more", n - NAMED));
                }
                let comes = if n == 1 { "comes" } else { "come" };
                format!("{n} of {tests} {comes} out otherwise: {}", list(&named))
            }
        };
        let noun = if left_out == "1" { "Participant" } else { "Participants" };
        let people = people.replace(' ', ", ").replace(", and, ", " and ").replace(", more", " more");
        let own = Flag::ALL.into_iter().find(|flag| flag.code() == rule);
        let rule = own.map_or("some rule".into(), |flag| format!("a rule by {}", broken_by(flag)));
        Finding::new(Standing::Noted, format!("{noun} {people} broke {rule}: without them, {outcome}."))
    };
    rows.chunk_by(|&a, &b| columns[0][a] == columns[0][b]).map(of_rule).collect()
}

/// What each probe found.
fn probed(audit: &Table) -> Vec<Finding> {
    let texts = |name| column(audit, name).map(Cell::in_full).collect::<Vec<String>>();
    let (questions, found, evidence) = (texts("question"), texts("finding"), texts("evidence"));
    let one = |(i, p): (usize, &Cell)| {
        let (question, evidence) = (&questions[i], &evidence[i]);
        let p = if let Cell::P(p, _) = p { format!(" ({})", p_value(*p)) } else { String::new() };
        if found[i] == Probed::NotAnswerable.label() {
            let because = evidence.trim_start_matches("not answerable here, ");
            let text = format!("{question} Not answerable here, {because}.");
            return Finding::new(Standing::NotAnswerable, text);
        }
        let word = if found[i] == Probed::Found.label() { "Found" } else { "Not found" };
        Finding::new(Standing::Noted, format!("{question} {word}: {evidence}{p}."))
    };
    column(audit, "p").enumerate().map(one).collect()
}
