//! The long format: one row an answer, or, with a `count`, one row for several people's.

use crate::collect::{Collector, Ids, MOST_COUNTED, Place, Reply};
use crate::decode::records::{Record, is_blank, trim};
use crate::decode::source::Source;
use crate::error::{Fault, shorten};
use crate::format::Format;
use crate::formats::layout::{Head, Header};
use crate::mapping::Mapping;
use crate::name;
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::screen::{SCREEN_COLUMNS, Screen, ScreenId};
use crate::sides::SidesSource;
use crate::value::{Answer, Responses, StimulusId};
use crate::words::{is_na, normalise};
use isostudy_design::wording::nearest;
use isostudy_table::formula::unescape;
use std::borrow::Cow;
use std::num::IntErrorKind;

mod columns;

pub(crate) use columns::{Columns, Rule, joined};
pub use columns::{LONG_COLUMNS, LONG_NEEDED};

/// Whether a header has the columns that nothing else has.
pub(crate) fn is_long(header: &[String]) -> bool {
    missing(header).is_empty()
}

fn has(header: &[String], name: &str) -> bool {
    header.iter().any(|title| normalise(title) == name)
}

/// The columns that the long format needs and a header lacks.
fn missing(header: &[String]) -> Vec<&'static str> {
    let has = |name| has(header, name);
    let sides = has("left") && has("right");
    let mut missing = Vec::new();
    let names_people = has("participant") || (has("count") && sides);
    if !names_people {
        missing.push("participant");
    }
    if !has("question") && !sides {
        // One side names the pair that the other one completes.
        missing.extend(["left", "right"].into_iter().filter(|side| !has(side)));
    }
    if !has("choice") {
        missing.push("choice");
    }
    missing
}

/// What in a header speaks for the long format, and which column it does without.
pub(crate) fn rule(header: &[String]) -> Option<String> {
    if !is_long(header) {
        return None;
    }
    let who = if has(header, "participant") { "participant" } else { "count" };
    Some(match has(header, "question") {
        true => format!("the header has {who}, question and choice"),
        false => format!("the header has {who}, left, right and choice, and no question: each pair is one"),
    })
}

/// Other words for the columns that are needed.
const MEANT: [(&str, &[&str]); 2] = [
    ("participant", &["person", "people", "respondent", "subject", "user", "rater", "voter", "who", "id"]),
    ("choice", &["answer", "response", "chosen", "preferred", "preference", "winner", "vote"]),
];

/// What a header that is nearly the long format's lacks, and which of its titles may have been meant; nothing of one that has
/// fewer than two of the columns that are needed.
pub(crate) fn nearly(header: &[String]) -> Option<String> {
    let needed = &LONG_COLUMNS[..LONG_NEEDED];
    let known = needed.iter().filter(|name| has(header, name)).count();
    let missing = missing(header);
    if known < 2 || missing.is_empty() {
        return None;
    }
    let others: Vec<&String> =
        header.iter().filter(|title| !LONG_COLUMNS.contains(&normalise(title).as_str())).collect();
    let one = |name: &&str| {
        let words = MEANT.iter().find(|(of, _)| of == name).map_or(&[][..], |(_, words)| words);
        let means = |title: &&&String| {
            words.contains(&normalise(title).as_str()) || nearest(title, [*name]).is_some()
        };
        let meant = others.iter().find(means);
        meant.map_or_else(
            || format!("no column {name}"),
            |title| format!("no column {name} (did you mean it by \"{}\"?)", shorten(title)),
        )
    };
    Some(missing.iter().map(one).collect::<Vec<_>>().join(" and "))
}

/// Reads every row under the header, which is the first row that is not blank.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read(
    source: &Source<'_>,
    head: &Head,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let header = Header::of(Format::Long, head);
    if !is_long(header.cells) {
        let needed = "the header needs participant, question, left, right and choice";
        return Err(header.missing(match nearly(header.cells) {
            Some(missing) => format!("{needed}, and has {missing}"),
            None => needed.into(),
        }));
    }
    let columns = Columns::of(&header, plan.is_some(), report)?;
    let ids = if columns.question.is_some() { Ids::OnePair } else { Ids::MadeUp };
    let rule = Rule { ids, ..Rule::LONG };
    read_columns(source, &header, columns, rule, plan, mapping, report)
}

/// Reads every row under a header whose columns are known.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read_columns(
    source: &Source<'_>,
    &Header { row: header_row, cells: header, .. }: &Header<'_>,
    columns: Columns,
    rule: Rule,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let sides = columns.source(rule, plan, header_row)?;
    let mut collector = Collector::new(plan, mapping, report);
    (collector.naming, collector.ordered) = (rule.ids, rule.ordered);
    let mut rows =
        Rows { columns, rule, sides, plan, collector, header, run: 0, last_trial: None, passed_over: 0 };
    let (mut end, mut blank) = (header_row + 1, None::<(u64, u64)>);
    source.each(|record| {
        if record.row <= header_row {
            return Ok(());
        }
        end = record.row + 1;
        if record.is_blank() {
            blank = Some((blank.map_or(record.row, |(first, _)| first), record.row));
            return Ok(());
        }
        rows.collector.report.blank_rows(&mut blank);
        rows.row(record, source.is_text())
    })?;
    if rows.passed_over > 0 {
        let action = match rows.passed_over {
            1 => "1 row without a question is no answer: not read".into(),
            rows => format!("{rows} rows without a question are no answers: not read"),
        };
        rows.collector.report.row(Kind::Noted, header_row, action);
    }
    rows.collector.finish(sides, (header_row, end))
}

/// Rows as they are read.
pub(crate) struct Rows<'a> {
    pub(crate) columns: Columns,
    pub(crate) rule: Rule,
    pub(crate) sides: SidesSource,
    pub(crate) plan: Option<&'a Plan>,
    pub(crate) collector: Collector<'a>,
    header: &'a [String],
    /// Participants so far, where the trials' numbers tell them apart.
    run: u32,
    last_trial: Option<u32>,
    passed_over: u64,
}

impl Rows<'_> {
    fn row(&mut self, record: &Record<'_>, counted: bool) -> Result<(), Fault> {
        let (expected, found) = (self.header.len(), record.cells.len());
        let beyond = record.cells.iter().skip(expected).any(|cell| !is_blank(cell));
        if beyond || (found < expected && counted) {
            return Err(Fault::CellCount { row: record.row, expected, found });
        }
        let row = record.row;
        let run = self.run(record);
        let unasked = self.columns.question.is_some_and(|column| is_blank(record.cell(column)));
        if !self.rule.every_row && unasked {
            self.passed_over += 1;
            return Ok(());
        }
        let count = self.count(record)?;
        if count == 0 {
            self.collector.report.row(Kind::Noted, row, "a count of 0: nobody gave this answer");
            return Ok(());
        }
        let id = match &run {
            Some(run) => Some(run.as_str()),
            None => self.participant(record, count)?,
        };
        let asked = match self.columns.question {
            Some(column) => self.needed(record, column, "question")?,
            None => "",
        };
        let form = Some(self.name(record, self.columns.form, "form")?).filter(|form| !form.is_empty());
        let named = id.map(|id| self.collector.participant(id, form, row)).transpose()?;
        let Some((question, [left, right])) = self.asked(record, asked, form)? else { return Ok(()) };
        let place = Place { row, column: self.columns.choice };
        let asked = match asked {
            "" => Cow::Owned(self.collector.id_of(question).to_owned()),
            asked => Cow::Borrowed(asked),
        };
        let step = match self.collector.reply(record.cell(self.columns.choice), place, &asked) {
            Reply::Step(step) => step,
            Reply::Unknown => return Ok(()),
            Reply::Blank => {
                let action =
                    format!("{} left {} unanswered", shorten(id.unwrap_or("nobody")), shorten(&asked));
                self.collector.report.row(Kind::Noted, row, action);
                return Ok(());
            }
        };
        let order = self.columns.order.and_then(|column| self.number(record, column));
        let rt_ms = self.columns.rt_ms.and_then(|column| self.time(record, column));
        let stimulus = self.stimulus(record)?;
        // What several answers together were given on nobody knows.
        let screen = if named.is_some() { self.screen(record) } else { None };
        let of = |participant: u32| Answer {
            order,
            rt_ms,
            stimulus,
            screen,
            much: step.much,
            ..Answer::new(participant, question, [left, right], step.choice)
        };
        match named {
            Some(participant) => {
                if self.rule.split_ties {
                    let session = self.columns.session.map_or("", |column| self.text(record, column));
                    self.collector.session(session);
                }
                self.collector.answer(of(participant), row);
            }
            None => {
                let first = self.collector.nameless(count, form, row)?;
                let mut answer = of(first);
                if count > 1 && (order.is_some() || rt_ms.is_some()) {
                    (answer.order, answer.rt_ms) = (None, None);
                    let action = "a place or a time for several answers together: not read";
                    self.collector.report.row(Kind::Noted, row, action);
                }
                self.collector.answers(answer, count, row);
            }
        }
        Ok(())
    }

    /// The code name in a row; one that the study lacks is remembered with its place.
    fn stimulus(&mut self, record: &Record<'_>) -> Result<Option<StimulusId>, Fault> {
        let Some(column) = self.columns.stimulus else { return Ok(None) };
        let name = self.name(record, Some(column), "stimulus")?;
        let unknown = self.plan.is_some_and(|plan| plan.has_codes() && plan.code(name).is_none());
        let place = Place { row: record.row, column };
        Ok(self.collector.stimulus(name, unknown.then_some(place)))
    }

    /// On what it was given; a cell that says nothing that can be is rejected and listed.
    fn screen(&mut self, record: &Record<'_>) -> Option<ScreenId> {
        let mut screen = Screen::default();
        for (name, column) in self.columns.screen.into_iter().enumerate() {
            let Some(column) = column else { continue };
            let cell = self.text(record, column).to_owned();
            if cell.is_empty() || is_na(&cell) {
                continue;
            }
            if let Err(why) = screen.set(name, &cell) {
                let action = format!("{why}: the answer has no {}", SCREEN_COLUMNS[name]);
                self.collector.report.cell(Kind::Rejected, record.row, column, &cell, action);
            }
        }
        (screen != Screen::default()).then(|| self.collector.screen(screen))
    }

    /// How many answers a row stands for.
    fn count(&self, record: &Record<'_>) -> Result<u32, Fault> {
        let Some(column) = self.columns.count else { return Ok(1) };
        let cell = self.text(record, column);
        let limit = match cell.parse::<u64>() {
            Ok(count) if count <= MOST_COUNTED => return Ok(count as u32),
            Err(error) if *error.kind() != IntErrorKind::PosOverflow => {
                "must be a whole number of answers".into()
            }
            _ => format!("must be at most {MOST_COUNTED}, the most answers that are read"),
        };
        Err(self.refuse(record, column, "count", limit))
    }

    /// Who answered; `None` is somebody else in every row.
    fn participant<'r>(&self, record: &'r Record<'_>, count: u32) -> Result<Option<&'r str>, Fault> {
        let Some(column) = self.columns.participant else { return Ok(None) };
        let counted = self.columns.count;
        if counted.is_some() && self.text(record, column).is_empty() {
            return Ok(None);
        }
        let id = self.needed(record, column, "participant")?;
        match counted {
            Some(counted) if count > 1 => {
                let limit = "must be 1 where a participant is named, who gives an answer once; leave the participant empty \
                             where these are different people";
                Err(self.refuse(record, counted, "count", limit))
            }
            _ => Ok(Some(id)),
        }
    }

    /// The number of the participant, where trials are counted anew for each.
    fn run(&mut self, record: &Record<'_>) -> Option<String> {
        if !self.columns.restarts {
            return None;
        }
        let trial = self.columns.participant.and_then(|column| record.cell(column).trim().parse().ok());
        if self.run == 0 || trial.is_some_and(|trial| self.last_trial.is_some_and(|last| trial <= last)) {
            self.run += 1;
        }
        self.last_trial = trial.or(self.last_trial);
        Some(self.run.to_string())
    }

    pub(crate) fn text<'r>(&self, record: &'r Record<'_>, column: usize) -> &'r str {
        let cell = trim(record.cell(column));
        if self.rule.escaped { unescape(cell) } else { cell }
    }

    pub(crate) fn needed<'r>(
        &self,
        record: &'r Record<'_>,
        column: usize,
        name: &str,
    ) -> Result<&'r str, Fault> {
        let cell = self.text(record, column);
        if cell.is_empty() {
            return Err(self.refuse(record, column, name, "must not be empty"));
        }
        self.name(record, Some(column), name)
    }

    /// The name in a cell, empty where there is no such column.
    pub(crate) fn name<'r>(
        &self,
        record: &'r Record<'_>,
        column: Option<usize>,
        name: &str,
    ) -> Result<&'r str, Fault> {
        let Some(column) = column else { return Ok("") };
        let cell = self.text(record, column);
        if name::is_too_long(cell) {
            return Err(self.refuse(record, column, name, name::limit()));
        }
        Ok(cell)
    }

    /// A fault of a cell, named by the column's title; `name` is for columns without.
    pub(crate) fn refuse(
        &self,
        record: &Record<'_>,
        column: usize,
        name: &str,
        limit: impl Into<String>,
    ) -> Fault {
        let (row, cell) = (record.row, shorten(record.cell(column)));
        let title = self.header.get(column).map_or("", |title| trim(title));
        let name = if title.is_empty() { name.into() } else { shorten(title) };
        Fault::Cell { row, column: column + 1, name, cell, limit: limit.into() }
    }

    /// A whole number; anything else is rejected and listed.
    fn number(&mut self, record: &Record<'_>, column: usize) -> Option<u32> {
        let cell = self.text(record, column);
        let number = cell.parse().ok();
        if number.is_none() && !cell.is_empty() && !is_na(cell) {
            let action = "not a whole number: the answer has no place in the order";
            self.collector.report.cell(Kind::Rejected, record.row, column, cell, action);
        }
        number
    }

    /// Milliseconds; anything else is rejected and listed.
    fn time(&mut self, record: &Record<'_>, column: usize) -> Option<f32> {
        let cell = self.text(record, column);
        if cell.is_empty() || is_na(cell) {
            return None;
        }
        let sound = |time: &f32| time.is_finite() && *time >= 0.0;
        if let Some(time) = cell.parse().ok().filter(sound) {
            return Some(time);
        }
        let time = cell.replace(',', ".").parse().ok().filter(sound);
        let (kind, action) = match time {
            Some(_) => (Kind::Repaired, "read as a decimal comma"),
            None => (Kind::Rejected, "not a time in milliseconds: the answer has none"),
        };
        self.collector.report.cell(kind, record.row, column, cell, action);
        time
    }
}
