//! Files with one row a participant and one column a question.
//!
//! Such a file has no sides. A cell says what was pressed, and the sides are those that the participant saw: the listed ones
//! where everybody saw these, otherwise those of the form whose number is in the `form` column. A file without that column is
//! refused then. So a table of answers that were turned to the listed sides must not be given as one of these.

use crate::address;
use crate::asked;
use crate::choice::{Choice, Step};
use crate::collect::{Asking, Collector, Place, Reply};
use crate::decode::records::{Record, is_blank, trim};
use crate::decode::source::Source;
use crate::error::{Fault, number_of, shorten};
use crate::format::Format;
use crate::formats::columns::{Assigned, assign};
use crate::formats::layout::Layout;
use crate::formats::people::People;
use crate::mapping::Mapping;
use crate::name;
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::shown::Sheet;
use crate::sides::SidesSource;
use crate::value::{Answer, Question, Responses};
use crate::words::normalise;
use isostudy_table::formula::unescape;
use std::collections::HashMap;

/// Reads every row under the header.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read(
    source: &Source<'_>,
    format: Format,
    layout: &Layout,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let plan = plan.ok_or(Fault::NoPlan { format })?;
    let mut layout = layout.clone();
    let width = layout.titles.len();
    if let Some(column) = mapping.participant(width)? {
        layout.participant = Some(column);
        layout.aside.push(column);
    }
    let sides = match layout.form {
        _ if plan.shows_listed_sides() => SidesSource::AsListed,
        Some(_) => SidesSource::FromForms,
        None => return Err(Fault::NoSides { row: layout.last_header_row }),
    };
    let (assigned, rule) = assign(source, format, &layout, plan, mapping)?;
    report.column_rule = rule;
    let passed_over: Vec<usize> = (0..width)
        .filter(|column| !layout.aside.contains(column) && assigned.iter().all(|(c, _)| c != column))
        .filter(|&column| layout.participant != Some(column) && layout.form != Some(column))
        .collect();
    for column in passed_over {
        let title = layout.title(column).to_owned();
        report.cell(Kind::Noted, layout.last_header_row, column, &title, "not a question: column not read");
    }
    let orders = Orders::of(&layout, &assigned);
    let mut collector = Collector::new(Some(plan), mapping, report);
    // Who is there twice has filled in two questionnaires, whose places say nothing about one another.
    collector.shown_again = false;
    let mut rows = Rows {
        layout: &layout,
        plan,
        sides,
        assigned,
        orders,
        collector,
        number: 0,
        people: People::default(),
        blank: None,
    };
    let mut end = layout.last_header_row + 1;
    source.each(|record| {
        if record.row <= layout.last_header_row {
            return Ok(());
        }
        end = record.row + 1;
        rows.row(record, source.is_text())
    })?;
    rows.collector.finish(sides, (layout.last_header_row, end))
}

struct Rows<'a> {
    layout: &'a Layout,
    plan: &'a Plan,
    sides: SidesSource,
    assigned: Assigned,
    orders: Orders,
    collector: Collector<'a>,
    /// Rows with answers so far.
    number: usize,
    people: People,
    /// First and last of the blank rows that may be at the end.
    blank: Option<(u64, u64)>,
}

impl<'a> Rows<'a> {
    fn row(&mut self, record: &Record<'_>, counted: bool) -> Result<(), Fault> {
        let row = record.row;
        if record.is_blank() {
            self.blank = Some((self.blank.map_or(row, |(first, _)| first), row));
            return Ok(());
        }
        self.collector.report.blank_rows(&mut self.blank);
        self.check_width(record, counted)?;
        if let Some(column) = record.stray {
            let action = "text after the closing quote, taken as part of the cell";
            self.collector.report.cell(Kind::Repaired, row, column, record.cell(column), action);
        }
        if let Some(sign) = self.layout.preview.iter().find(|sign| (sign.says)(record.cell(sign.column))) {
            let cell = record.cell(sign.column);
            self.collector.report.cell(
                Kind::Rejected,
                row,
                sign.column,
                cell,
                format!("{}: row left out", sign.what),
            );
            return Ok(());
        }
        self.number += 1;
        let id = self.layout.participant.map(|column| label(record.cell(column))).filter(|id| !id.is_empty());
        let id = match id {
            Some(id) if name::is_too_long(id) => return Err(self.too_long(record, self.layout.participant)),
            Some(id) => address::folded(id).unwrap_or_else(|| id.to_owned()),
            None => self.number.to_string(),
        };
        let Collector { mapping, report, .. } = &mut self.collector;
        let (id, again) = self.people.id(record, self.layout, id, mapping, report)?;
        if let Some(sign) = self.layout.unfinished.iter().find(|sign| (sign.says)(record.cell(sign.column))) {
            let action = format!("{} ({}): answers kept as far as they go", sign.what, shorten(&id));
            self.collector.report.cell(Kind::Noted, row, sign.column, record.cell(sign.column), action);
        }
        let choices = self.answers(record, &id)?;
        if !again {
            self.people.sheet(record, self.layout, &choices, self.collector.report);
        }
        Ok(())
    }

    fn check_width(&mut self, record: &Record<'_>, counted: bool) -> Result<(), Fault> {
        let (expected, found) = (self.layout.titles.len(), record.cells.len());
        if found == expected || (found < expected && !counted) {
            return Ok(());
        }
        let beyond = record.cells.iter().skip(expected).all(|cell| is_blank(cell));
        if found < expected || !beyond {
            return Err(Fault::CellCount { row: record.row, expected, found });
        }
        let action = format!("{found} cells under {}; those beyond are empty", number_of(expected, "header"));
        self.collector.report.row(Kind::Noted, record.row, action);
        Ok(())
    }

    /// Takes a row's answers; returns them, one a question.
    fn answers(&mut self, record: &Record<'_>, id: &str) -> Result<Vec<Option<Choice>>, Fault> {
        let row = record.row;
        let form = self.layout.form.map(|column| label(record.cell(column))).filter(|form| !form.is_empty());
        if form.is_some_and(name::is_too_long) {
            return Err(self.too_long(record, self.layout.form));
        }
        let sheet = match self.sides {
            SidesSource::FromForms => Some(self.sheet(record, form)?),
            _ => None,
        };
        let participant = self.collector.participant(id, form, row)?;
        let orders = self.orders.of_row(record);
        let mut unanswered: Vec<&str> = Vec::new();
        let (mut all, mut answered, mut choices) = (0, 0, vec![None; self.assigned.len()]);
        for (&(column, number), kept) in self.assigned.iter().zip(&mut choices) {
            let asked = self.plan.asked(number);
            let reply = self.collector.reply(record.cell(column), Place { row, column }, &asked.id);
            let sides = match sheet {
                Some(sheet) => sheet[number as usize],
                None => self.plan.listed(number),
            };
            // What the form does not ask is not left unanswered.
            all += usize::from(sides.is_some() || sheet.is_none());
            match (reply, sides) {
                (Reply::Step(Step { choice, much }), Some(sides)) => {
                    answered += 1;
                    *kept = Some(choice);
                    let question = match self.plan.questions().get(number as usize) {
                        Some(_) => number,
                        None => {
                            let Question { id, object, group, role, .. } = asked;
                            self.collector.question(Asking { id, object, group, sides, role: *role }, row)?
                        }
                    };
                    let order = orders.get(&number).copied();
                    let answer = Answer { order, much, ..Answer::new(participant, question, sides, choice) };
                    self.collector.answer(answer, row);
                }
                (Reply::Step(_), None) => {
                    let (question, form) = (shorten(&asked.id), shorten(form.unwrap_or_default()));
                    return Err(match sheet {
                        Some(_) => Fault::NotInForm { row, form, question },
                        None => Fault::NoSidesOf { row, question },
                    });
                }
                (Reply::Blank, None) if sheet.is_some() => {}
                (Reply::Blank, _) => unanswered.push(&asked.id),
                (Reply::Unknown, _) => answered += 1,
            }
        }
        if answered == 0 {
            self.collector.report.row(Kind::Rejected, row, format!("{} answered no question", shorten(id)));
        } else if !unanswered.is_empty() {
            const SHOWN: usize = 10;
            let more = if unanswered.len() > SHOWN { ", ..." } else { "" };
            let shown = unanswered.iter().take(SHOWN).copied().collect::<Vec<_>>().join(", ");
            let action = format!(
                "{} left {} of {all} questions unanswered: {shown}{more}",
                shorten(id),
                unanswered.len()
            );
            self.collector.report.row(Kind::Noted, row, action);
        }
        Ok(choices)
    }

    /// What a row's form asks.
    fn sheet(&self, record: &Record<'_>, form: Option<&str>) -> Result<&'a Sheet, Fault> {
        asked::sheet(self.plan, form).map_err(|limit| {
            let column = self.layout.form.expect("sides are told by it");
            let (name, cell) = (shorten(self.layout.title(column)), shorten(record.cell(column)));
            Fault::Cell { row: record.row, column: column + 1, name, cell, limit }
        })
    }

    fn too_long(&self, record: &Record<'_>, column: Option<usize>) -> Fault {
        let column = column.expect("the column whose name it is");
        let (name, cell) = (shorten(self.layout.title(column)), shorten(record.cell(column)));
        Fault::Cell { row: record.row, column: column + 1, name, cell, limit: name::limit() }
    }
}

/// An id or name as it was before a spreadsheet was kept from running it.
fn label(cell: &str) -> &str {
    unescape(trim(cell))
}

/// Recovers the order in which questions were shown from columns that list their names.
struct Orders {
    columns: Vec<usize>,
    by_name: HashMap<String, u32>,
}

impl Orders {
    fn of(layout: &Layout, assigned: &Assigned) -> Self {
        let names = assigned.iter().flat_map(|&(column, question)| {
            layout.titles[column].iter().take(1).map(move |title| (normalise(title), question))
        });
        Self { columns: layout.orders.clone(), by_name: names.collect() }
    }

    fn of_row(&self, record: &Record<'_>) -> HashMap<u32, u32> {
        let mut orders = HashMap::new();
        for &column in &self.columns {
            let names: Vec<&str> = record.cell(column).split('|').collect();
            let questions: Vec<Option<&u32>> =
                names.iter().map(|name| self.by_name.get(&normalise(name))).collect();
            if questions.iter().any(Option::is_some) && orders.is_empty() {
                let places = questions.into_iter().enumerate();
                orders.extend(places.filter_map(|(place, question)| Some((*question?, place as u32 + 1))));
            }
        }
        orders
    }
}
