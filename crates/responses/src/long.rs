//! The long format: one row an answer.

use crate::collect::{Collector, Place, Reply};
use crate::error::{Fault, shorten};
use crate::escape::unescape;
use crate::format::Format;
use crate::mapping::Mapping;
use crate::plan::Plan;
use crate::records::{Record, is_blank};
use crate::report::{Kind, Report};
use crate::source::Source;
use crate::value::{Answer, Responses};
use crate::words::normalise;

/// Columns that are read; others are noted.
const NAMES: [&str; 10] =
    ["participant", "question", "left", "right", "choice", "object", "group", "form", "order", "rt_ms"];

/// Where the columns are.
struct Columns {
    participant: usize,
    question: usize,
    /// Both sides, or as the study declares them.
    sides: Option<(usize, usize)>,
    choice: usize,
    object: Option<usize>,
    group: Option<usize>,
    form: Option<usize>,
    order: Option<usize>,
    rt_ms: Option<usize>,
}

impl Columns {
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
                None if is_blank(title) => {}
                None => report.cell(Kind::Noted, row, column, title, "not a column of this format: not read"),
            }
        }
        let needed = |name: usize| at[name].ok_or_else(|| Fault::MissingColumn { name: NAMES[name].into() });
        let sides = match (at[2], at[3]) {
            (Some(left), Some(right)) => Some((left, right)),
            (None, None) if with_plan => None,
            _ => Some((needed(2)?, needed(3)?)),
        };
        Ok(Self {
            participant: needed(0)?,
            question: needed(1)?,
            sides,
            choice: needed(4)?,
            object: at[5],
            group: at[6],
            form: at[7],
            order: at[8],
            rt_ms: at[9],
        })
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
    let mut rows =
        Rows { columns, plan, collector: Collector::new(plan, mapping, report), width: header.len() };
    let (mut end, mut blank) = (header_row + 1, Vec::new());
    source.each(|record| {
        if record.row <= header_row {
            return Ok(());
        }
        end = record.row + 1;
        if record.is_blank() {
            blank.push(record.row);
            return Ok(());
        }
        for row in blank.drain(..) {
            rows.collector.report.row(Kind::Noted, row, "blank row inside the table");
        }
        rows.row(record, source.is_text())
    })?;
    rows.collector.finish(true, end)
}

struct Rows<'a> {
    columns: Columns,
    plan: Option<&'a Plan>,
    collector: Collector<'a>,
    width: usize,
}

impl Rows<'_> {
    fn row(&mut self, record: &Record<'_>, counted: bool) -> Result<(), Fault> {
        let (expected, found) = (self.width, record.cells.len());
        let beyond = record.cells.iter().skip(expected).any(|cell| !is_blank(cell));
        if beyond || (found < expected && counted) {
            return Err(Fault::CellCount { row: record.row, expected, found });
        }
        let row = record.row;
        let id = self.needed(record, self.columns.participant, "participant")?;
        let asked = self.needed(record, self.columns.question, "question")?;
        let form = self.columns.form.map(|column| text(record, column)).filter(|form| !form.is_empty());
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

    fn needed<'r>(&self, record: &'r Record<'_>, column: usize, name: &str) -> Result<&'r str, Fault> {
        let cell = text(record, column);
        if cell.is_empty() {
            return Err(self.refuse(record, column, name, "must not be empty"));
        }
        Ok(cell)
    }

    fn refuse(&self, record: &Record<'_>, column: usize, name: &str, limit: impl Into<String>) -> Fault {
        let (row, cell) = (record.row, shorten(record.cell(column)));
        Fault::Cell { row, column: column + 1, name: name.into(), cell, limit: limit.into() }
    }

    /// The question and the items on its sides. A control that a study does not list is a question of its own.
    fn pair(&mut self, record: &Record<'_>, asked: &str) -> Result<Option<(u32, u32, u32)>, Fault> {
        let label = |column: Option<usize>| column.map_or("", |column| text(record, column));
        let sides = match self.columns.sides {
            None => None,
            Some((left, right)) => {
                Some((self.needed(record, left, "left")?, self.needed(record, right, "right")?))
            }
        };
        let (object, group) = (label(self.columns.object), label(self.columns.group));
        let Some(plan) = self.plan else {
            let (left, right) = sides.expect("needed without a plan");
            let (left, right) = (self.collector.items.number(left), self.collector.items.number(right));
            return Ok(Some((self.collector.question(asked, object, group, left, right), left, right)));
        };
        let known = plan.question(asked);
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

    fn unknown_question(&self, record: &Record<'_>) -> Fault {
        self.refuse(
            record,
            self.columns.question,
            "question",
            "is not a question of this study, nor a control",
        )
    }

    /// A whole number; anything else is rejected and listed.
    fn number(&mut self, record: &Record<'_>, column: usize) -> Option<u32> {
        let cell = text(record, column);
        let number = cell.parse().ok();
        if number.is_none() && !cell.is_empty() {
            let action = "not a whole number: the answer has no place in the order";
            self.collector.report.cell(Kind::Rejected, record.row, column, cell, action);
        }
        number
    }

    /// Milliseconds; anything else is rejected and listed.
    fn time(&mut self, record: &Record<'_>, column: usize) -> Option<f32> {
        let cell = text(record, column);
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

fn text<'r>(record: &'r Record<'_>, column: usize) -> &'r str {
    unescape(record.cell(column).trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}'))
}

/// Says what a file lacks that was declared to be in this format.
pub(crate) fn not_long(row: u64) -> Fault {
    let missing = "the header needs participant, question, left, right and choice".into();
    Fault::NotThatFormat { format: Format::Long, row, missing }
}
