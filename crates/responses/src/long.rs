//! The long format: one row an answer.

use crate::collect::{Collector, Place, Reply};
use crate::error::{Fault, shorten};
use crate::escape::unescape;
use crate::format::Format;
use crate::mapping::Mapping;
use crate::name;
use crate::plan::Plan;
use crate::records::{Record, is_blank, trim};
use crate::report::{Kind, Report};
use crate::source::Source;
use crate::value::{Answer, Question, Responses};
use crate::words::normalise;

/// Columns that are read; others are noted.
const NAMES: [&str; 10] =
    ["participant", "question", "left", "right", "choice", "object", "group", "form", "order", "rt_ms"];

/// Columns of `isostudy`'s own export that say nothing of an answer which the study does not say itself.
const KNOWN: [&str; 2] = ["role", "stimulus"];

/// Where the columns of a file with one row an answer are.
pub(crate) struct Columns {
    pub(crate) participant: usize,
    /// The participant's column counts trials instead, and starts again with each participant.
    pub(crate) restarts: bool,
    pub(crate) question: usize,
    /// Both sides, or as the study declares them.
    pub(crate) sides: Option<(usize, usize)>,
    pub(crate) choice: usize,
    pub(crate) object: Option<usize>,
    pub(crate) group: Option<usize>,
    pub(crate) form: Option<usize>,
    pub(crate) order: Option<usize>,
    pub(crate) rt_ms: Option<usize>,
}

/// What the id of a repeat has behind that of its question, and that of training before its number, in a study's forms.
const REPEAT: &str = "-r";
const TRAINING: &str = "training-";

fn is_training(id: &str) -> bool {
    id.strip_prefix(TRAINING).is_some_and(|number| number.parse::<u32>().is_ok())
}

/// What differs between formats with one row an answer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rule {
    /// Whether left and right are sides.
    pub(crate) sides_recorded: bool,
    /// Whether cells were protected from spreadsheets.
    pub(crate) escaped: bool,
    /// Whether every row is an answer; otherwise those with a question.
    pub(crate) every_row: bool,
}

impl Columns {
    /// What there must be; the rest is absent.
    pub(crate) fn new(participant: usize, question: usize, choice: usize) -> Self {
        let (sides, restarts) = (None, false);
        let (object, group, form, order, rt_ms) = (None, None, None, None, None);
        Self { participant, restarts, question, sides, choice, object, group, form, order, rt_ms }
    }

    fn of(header: &[String], row: u64, with_plan: bool, report: &mut Report) -> Result<Self, Fault> {
        let mut at = [None; NAMES.len()];
        for (column, title) in header.iter().enumerate() {
            match NAMES.iter().position(|name| *name == normalise(title)) {
                Some(name) => {
                    if let Some(first) = at[name].replace(column) {
                        let name = NAMES[name].into();
                        return Err(Fault::DuplicateColumn { column: column + 1, first: first + 1, name });
                    }
                }
                None if is_blank(title) || KNOWN.contains(&normalise(title).as_str()) => {}
                None => report.cell(Kind::Noted, row, column, title, "not a column of this format: not read"),
            }
        }
        let needed = |name: usize| at[name].ok_or_else(|| Fault::MissingColumn { name: NAMES[name].into() });
        let sides = match (at[2], at[3]) {
            (Some(left), Some(right)) => Some((left, right)),
            (None, None) if with_plan => None,
            _ => Some((needed(2)?, needed(3)?)),
        };
        let (object, group, form, order, rt_ms) = (at[5], at[6], at[7], at[8], at[9]);
        Ok(Self { sides, object, group, form, order, rt_ms, ..Self::new(needed(0)?, needed(1)?, needed(4)?) })
    }
}

/// Whether a header has the columns that nothing else has.
pub(crate) fn is_long(header: &[String]) -> bool {
    let has = |name: &str| header.iter().any(|title| normalise(title) == name);
    has("participant") && has("choice") && (has("question") || (has("left") && has("right")))
}

/// Reads every row under the header, which is the first row that is not blank.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read(
    source: &Source<'_>,
    (header_row, header): (u64, &[String]),
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let columns = Columns::of(header, header_row, plan.is_some(), report)?;
    let rule = Rule { sides_recorded: true, escaped: true, every_row: true };
    read_columns(source, (header_row, header.len()), columns, rule, plan, mapping, report)
}

/// Reads every row under a header whose columns are known.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read_columns(
    source: &Source<'_>,
    (header_row, width): (u64, usize),
    columns: Columns,
    rule: Rule,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let collector = Collector::new(plan, mapping, report);
    let mut rows = Rows { columns, rule, plan, collector, width, run: 0, last_trial: None, passed_over: 0 };
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
    rows.collector.finish(rule.sides_recorded, end)
}

struct Rows<'a> {
    columns: Columns,
    rule: Rule,
    plan: Option<&'a Plan>,
    collector: Collector<'a>,
    width: usize,
    /// Participants so far, where the trials' numbers tell them apart.
    run: u32,
    last_trial: Option<u32>,
    passed_over: u64,
}

impl Rows<'_> {
    fn row(&mut self, record: &Record<'_>, counted: bool) -> Result<(), Fault> {
        let (expected, found) = (self.width, record.cells.len());
        let beyond = record.cells.iter().skip(expected).any(|cell| !is_blank(cell));
        if beyond || (found < expected && counted) {
            return Err(Fault::CellCount { row: record.row, expected, found });
        }
        let row = record.row;
        let run = self.run(record);
        if !self.rule.every_row && is_blank(record.cell(self.columns.question)) {
            self.passed_over += 1;
            return Ok(());
        }
        let id = match &run {
            Some(run) => run.as_str(),
            None => self.needed(record, self.columns.participant, "participant")?,
        };
        let asked = self.needed(record, self.columns.question, "question")?;
        let form = Some(self.name(record, self.columns.form, "form")?).filter(|form| !form.is_empty());
        let participant = self.collector.participant(id, form, row)?;
        let Some((question, left, right)) = self.pair(record, asked)? else { return Ok(()) };
        let place = Place { row, column: self.columns.choice };
        let choice = match self.collector.reply(record.cell(self.columns.choice), place, asked) {
            Reply::Choice(choice) => choice,
            Reply::Unknown => return Ok(()),
            Reply::Blank => {
                let action = format!("{} left {} unanswered", shorten(id), shorten(asked));
                self.collector.report.row(Kind::Noted, row, action);
                return Ok(());
            }
        };
        let order = self.columns.order.and_then(|column| self.number(record, column));
        let rt_ms = self.columns.rt_ms.and_then(|column| self.time(record, column));
        self.collector.answer(Answer { participant, question, left, right, choice, order, rt_ms }, row);
        Ok(())
    }

    /// The number of the participant, where trials are counted anew for each.
    fn run(&mut self, record: &Record<'_>) -> Option<String> {
        if !self.columns.restarts {
            return None;
        }
        let trial = record.cell(self.columns.participant).trim().parse().ok();
        if self.run == 0 || trial.is_some_and(|trial| self.last_trial.is_some_and(|last| trial <= last)) {
            self.run += 1;
        }
        self.last_trial = trial.or(self.last_trial);
        Some(self.run.to_string())
    }

    fn text<'r>(&self, record: &'r Record<'_>, column: usize) -> &'r str {
        let cell = trim(record.cell(column));
        if self.rule.escaped { unescape(cell) } else { cell }
    }

    fn needed<'r>(&self, record: &'r Record<'_>, column: usize, name: &str) -> Result<&'r str, Fault> {
        let cell = self.text(record, column);
        if cell.is_empty() {
            return Err(self.refuse(record, column, name, "must not be empty"));
        }
        self.name(record, Some(column), name)
    }

    /// The name in a cell, empty where there is no such column.
    fn name<'r>(&self, record: &'r Record<'_>, column: Option<usize>, name: &str) -> Result<&'r str, Fault> {
        let Some(column) = column else { return Ok("") };
        let cell = self.text(record, column);
        if name::is_too_long(cell) {
            return Err(self.refuse(record, column, name, name::limit()));
        }
        Ok(cell)
    }

    fn refuse(&self, record: &Record<'_>, column: usize, name: &str, limit: impl Into<String>) -> Fault {
        let (row, cell) = (record.row, shorten(record.cell(column)));
        Fault::Cell { row, column: column + 1, name: name.into(), cell, limit: limit.into() }
    }

    /// The question and the items on its sides. A control that a study does not list is a question of its own.
    fn pair(&mut self, record: &Record<'_>, asked: &str) -> Result<Option<(u32, u32, u32)>, Fault> {
        let sides = match self.columns.sides {
            None => None,
            Some((left, right)) => {
                Some((self.needed(record, left, "left")?, self.needed(record, right, "right")?))
            }
        };
        let object = self.name(record, self.columns.object, "object")?;
        let group = self.name(record, self.columns.group, "group")?;
        let Some(plan) = self.plan else {
            let (left, right) = sides.expect("needed without a plan");
            let (left, right) = (self.collector.items.number(left), self.collector.items.number(right));
            return Ok(Some((self.collector.question(asked, object, group, left, right), left, right)));
        };
        let known = plan.question(asked);
        // Forms of a study have repeats and training beside its questions.
        if known.is_none() && is_training(asked) {
            self.collector.report.row(Kind::Noted, record.row, "training, which is not analysed: not read");
            return Ok(None);
        }
        let repeated =
            asked.strip_suffix(REPEAT).filter(|_| known.is_none()).and_then(|id| plan.question(id));
        if let Some(question) = repeated {
            return self.repeat(record, asked, &plan.questions()[question as usize], sides).map(Some);
        }
        let Some((left, right)) = sides else {
            let question = known.ok_or_else(|| self.unknown_question(record))?;
            let of = &plan.questions()[question as usize];
            return Ok(Some((question, of.left, of.right)));
        };
        let [a, b] = [left, right].map(|name| plan.item(name, known));
        match (known, a, b) {
            (Some(question), Some(a), Some(b))
                if a != b || plan.questions()[question as usize].is_control() =>
            {
                Ok(Some((question, a, b)))
            }
            (Some(question), ..) => Err(Fault::Pair {
                row: record.row,
                question: shorten(asked),
                declared: plan.pair(question),
                found: format!("{} and {}", shorten(left), shorten(right)),
            }),
            (None, Some(a), Some(b)) if a == b => {
                Ok(Some((self.collector.question(asked, object, group, a, b), a, b)))
            }
            (None, ..) => Err(self.unknown_question(record)),
        }
    }

    /// A question again, as a question of its own: it checks answers and is not one of the study's. Where the file has no
    /// sides they are exchanged.
    fn repeat(
        &mut self,
        record: &Record<'_>,
        asked: &str,
        of: &Question,
        sides: Option<(&str, &str)>,
    ) -> Result<(u32, u32, u32), Fault> {
        let plan = self.plan.expect("only a plan's questions are repeated");
        let known = plan.question(&of.id);
        let (left, right) = match sides {
            None => (of.right, of.left),
            Some((left, right)) => match (plan.item(left, known), plan.item(right, known)) {
                (Some(a), Some(b)) if a != b => (a, b),
                _ => {
                    return Err(Fault::Pair {
                        row: record.row,
                        question: shorten(asked),
                        declared: plan.pair(known.expect("found by this id")),
                        found: format!("{} and {}", shorten(left), shorten(right)),
                    });
                }
            },
        };
        Ok((self.collector.question(asked, &of.object, &of.group, left, right), left, right))
    }

    fn unknown_question(&self, record: &Record<'_>) -> Fault {
        self.refuse(
            record,
            self.columns.question,
            "question",
            "is not a question of this study, nor a control or a repeat",
        )
    }

    /// A whole number; anything else is rejected and listed.
    fn number(&mut self, record: &Record<'_>, column: usize) -> Option<u32> {
        let cell = self.text(record, column);
        let number = cell.parse().ok();
        if number.is_none() && !cell.is_empty() {
            let action = "not a whole number: the answer has no place in the order";
            self.collector.report.cell(Kind::Rejected, record.row, column, cell, action);
        }
        number
    }

    /// Milliseconds; anything else is rejected and listed.
    fn time(&mut self, record: &Record<'_>, column: usize) -> Option<f32> {
        let cell = self.text(record, column);
        if cell.is_empty() {
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

/// Says what a file lacks that was declared to be in this format.
pub(crate) fn not_long(row: u64) -> Fault {
    let missing = "the header needs participant, question, left, right and choice".into();
    Fault::NotThatFormat { format: Format::Long, row, missing }
}
