//! Every truth on every design, by every way in.

use super::compare::{Compared, Wrong, compare};
use super::designs::{self, Design};
use super::oracle::{Oracle, compare_scales, compare_worths, hypotheses};
use super::people::{Given, Truth, answers};
use super::routes::Route;
use super::sentences::compare_sentences;
use crate::tables;
use isostudy_design::Study;
use isostudy_design::forms::Role;
use isostudy_inference::answered::Answered;
use isostudy_inference::{Inputs, Results};
use isostudy_paper::Paper;
use isostudy_report::report::{Report, report};
use isostudy_responses::{Choice, Plan, Responses};
use isostudy_table::Table;
use std::collections::BTreeMap;

/// One truth on one design.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    pub(super) design: &'static str,
    pub(super) truth: &'static str,
    /// By how many ways the answers came in.
    pub(super) routes: usize,
    pub(super) cells: u64,
    pub(super) wrong: Vec<Wrong>,
}

/// Runs everything, with so many people where a truth is not about their number.
pub(super) fn run(people: usize) -> Vec<Outcome> {
    let is_tried = |design: &Design, truth: Truth| {
        let small = [designs::BLOCKS.name, designs::PAIR.name].contains(&design.name);
        truth != Truth::Thousands || small
    };
    let all: Vec<(Design, Truth)> = designs::ALL
        .into_iter()
        .flat_map(|design| Truth::ALL.map(|truth| (design, truth)))
        .filter(|(design, truth)| is_tried(design, *truth))
        .collect();
    // One after the other: what each of them does goes on several threads, and must not wait inside another.
    all.into_iter().map(|(design, truth)| one(&design, truth, people)).collect()
}

/// One truth on one design, by every way that is open.
pub(super) fn one(design: &Design, truth: Truth, people: usize) -> Outcome {
    let number = truth.people(people);
    let study = design.study(number.max(people));
    let plan = Plan::of_study(&study);
    let given = answers(&study, truth, number);
    let oracle = Oracle::of(&study, &given);
    let mut compared = Compared::default();
    let routes: Vec<Route> = Route::ALL.into_iter().filter(|route| route.is_open(&study)).collect();
    let mut read: Vec<(Route, Responses)> = Vec::new();
    for &route in &routes {
        let answers = route.read(&study, &plan, &given);
        let why = answers.as_ref().err().cloned().unwrap_or_default();
        compared.check(answers.is_ok(), ["file", route.name(), ""], why, "answers");
        read.extend(answers.ok().map(|answers| (route, answers)));
    }
    for (route, answers) in &read {
        compared.add(same_answers(&given, *route, answers));
    }
    let mut made: Vec<(Route, Made)> = Vec::new();
    for (route, answers) in read {
        // Tables follow from answers, which were compared, so that one truth and the ways that tell least are enough.
        let apart = [Route::Shuffled, Route::ByCodeName, Route::Wide, Route::Export].contains(&route);
        if route == Route::Long || (apart && truth == Truth::Worths) {
            made.extend(Made::of(&study, answers).map(|made| (route, made)));
        }
    }
    if let Some((_, first)) = made.first() {
        compared.add(first.compare(&oracle, truth));
        for (route, other) in &made[1..] {
            compared.add(same_tables(*route, first, other));
        }
    }
    Outcome {
        design: design.name,
        truth: truth.name(),
        routes: routes.len(),
        cells: compared.cells,
        wrong: compared.wrong,
    }
}

/// Everything that is printed of a study's answers.
pub(super) struct Made {
    pub(super) people: Vec<usize>,
    pub(super) tables: Vec<Table>,
    pub(super) report: Report,
}

impl Made {
    pub(super) fn of(study: &Study, answers: Responses) -> Option<Self> {
        let people = people(&answers);
        let answered = Answered::of(study, answers)?;
        let inputs = Inputs {
            study,
            meshes: &[],
            bench: None,
            chunks: &[],
            stored: &[],
            answers: Some(&answered),
            left_out: &[],
        };
        let results = Results::of(&inputs);
        let tables = tables(&results);
        let report = report(&results, &tables, &[], Paper::of(&results).published(&tables));
        Some(Self { people, tables, report })
    }

    /// Every cell and every sentence against what has to be there.
    pub(super) fn compare(&self, oracle: &Oracle<'_>, truth: Truth) -> Compared {
        let mut compared = Compared::default();
        // With unequal numbers of answers scores have no common unit, and to leave everybody out in turn takes long.
        let thorough = ![Truth::ThirdMissing, Truth::Unequal, Truth::Thousands].contains(&truth);
        for expected in oracle.expected(thorough) {
            compared.add(compare(&self.tables, &expected));
        }
        compared.add(compare_worths(oracle, &self.tables));
        compared.add(compare_scales(&self.tables));
        compared.add(compare_sentences(oracle, &hypotheses(oracle), &self.report));
        compared
    }
}

/// The number of each participant, which is in the name.
fn people(answers: &Responses) -> Vec<usize> {
    let number = |name: &str| name.trim_start_matches('p').parse().expect("names with numbers");
    answers.participants.iter().map(|participant| number(&participant.id)).collect()
}

/// Whether what was read is what was given: who, which question, what on which side, and what was pressed.
fn same_answers(given: &[Given], route: Route, read: &Responses) -> Compared {
    let mut compared = Compared::default();
    let counted = |given: &&Given| route != Route::Export || given.shown.role == Role::Comparison;
    let mut want: BTreeMap<(usize, String), String> = BTreeMap::new();
    for given in given.iter().filter(counted) {
        let said = format!("{} {} {:?}", given.shown.left, given.shown.right, given.pressed);
        want.insert((given.person + 1, given.shown.question.clone()), said);
    }
    // A file that names nobody has people by their rows.
    let mut known: Vec<usize> = want.keys().map(|(person, _)| *person).collect();
    known.dedup();
    let people = people(read);
    for answer in &read.answers {
        let number = people[answer.participant as usize];
        let person =
            if route == Route::Export { known.get(number - 1).copied().unwrap_or(0) } else { number };
        let question = &read.questions[answer.question as usize].id;
        let [left, right] = [answer.left, answer.right].map(|item| &read.items[item as usize]);
        let pressed = match answer.choice {
            Choice::Left => "Left",
            Choice::NoPreference => "Neither",
            Choice::Right => "Right",
        };
        let got = format!("{left} {right} {pressed}");
        // A control has its items behind its id where forms have several of that id.
        let id = question.split(' ').next().unwrap_or_default();
        let own = want.remove(&(person, id.to_owned())).unwrap_or_else(|| "no answer".into());
        let row = format!("{} {person} {question}", route.name());
        compared.check(got == own, ["file", &row, "answer"], &got, &own);
    }
    for ((person, question), said) in want {
        compared.check(
            false,
            ["file", &format!("{} {person} {question}", route.name()), "answer"],
            "no answer",
            said,
        );
    }
    compared
}

/// Tables that are about repeats, controls, times or the order of questions, which not every file has; and those that number
/// people.
const OF_THE_FILE: [&str; 5] = ["answers", "respondents", "screened", "audit", "reading"];

/// Whether the tables of two ways say the same.
fn same_tables(route: Route, first: &Made, other: &Made) -> Compared {
    let mut compared = Compared::default();
    let everything = [Route::Shuffled, Route::Converted].contains(&route);
    let numbered = first.people != other.people;
    for table in &first.tables {
        if OF_THE_FILE.contains(&table.name.as_str()) && (numbered || !everything) {
            continue;
        }
        let same = other.tables.iter().find(|same| same.name == table.name);
        let [own, same] = [Some(table), same].map(|table| table.map(Table::to_csv).unwrap_or_default());
        let lines = own.lines().zip(same.lines().chain(std::iter::repeat("nothing")));
        for (number, (own, same)) in lines.enumerate() {
            let row = format!("{} row {number}", table.name);
            compared.check(own == same, ["route", &row, route.name()], same, own);
        }
        compared.check(own.lines().count() == same.lines().count(), ["route", &table.name, "rows"], "", "");
    }
    compared
}
