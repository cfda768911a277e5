//! Which column answers which question.

use crate::decode::records::is_blank;
use crate::decode::source::Source;
use crate::error::{Fault, number_of, shorten};
use crate::format::Format;
use crate::formats::layout::Layout;
use crate::mapping::Mapping;
use crate::plan::{Plan, is_training};
use crate::words::normalise;

/// A column (from 0) with its question.
pub(crate) type Assigned = Vec<(usize, u32)>;

/// Assigns columns to questions, and says by which rule.
///
/// Declared positions come first. Else the headers' names and the columns that hold nothing but answers are looked at; where
/// both say something they must say the same, and neither is taken where it leaves a choice.
///
/// # Errors
/// Two readings that fit, or none.
pub(crate) fn assign(
    source: &Source<'_>,
    format: Format,
    layout: &Layout,
    plan: &Plan,
    mapping: &Mapping,
) -> Result<(Assigned, String), Fault> {
    let wanted = wanted(plan, mapping)?;
    if format == Format::Table {
        return own_table(layout, plan, &wanted);
    }
    if let Some(declared) = declared(layout, mapping, wanted.len())? {
        let rule = format!("questions by declared position: {}", listed(&declared));
        return Ok((declared.into_iter().zip(wanted).collect(), rule));
    }
    let named = named(layout, plan, &wanted);
    let answers = answering(source, layout, mapping)?;
    let by_position = by_position(&answers, wanted.len());
    match (named, by_position) {
        (Some(named), by_position) => {
            let columns: Vec<usize> = named.iter().map(|(column, _)| *column).collect();
            let outside = columns.iter().find(|column| answers.other.contains(column));
            match (outside, by_position) {
                (Some(&outside), Ok(positions)) if !positions.contains(&outside) => Err(Fault::Columns {
                    first: format!(
                        "by names: {}, of which column {} (\"{}\") holds something else than answers",
                        listed(&columns),
                        outside + 1,
                        shorten(layout.title(outside))
                    ),
                    second: format!("by position: {}, which hold answers alone", listed(&positions)),
                }),
                // Whatever else a column holds is refused or listed cell by cell.
                _ => Ok((named, "questions by their names in the header".into())),
            }
        }
        (None, by_position) => {
            let positions = by_position?;
            let assigned: Assigned = positions.iter().copied().zip(wanted).collect();
            contradiction(layout, plan, &assigned)?;
            let rule = format!(
                "questions by position in the study's order: {} alone can hold its {}",
                listed(&positions),
                number_of(positions.len(), "question")
            );
            Ok((assigned, rule))
        }
    }
}

/// The questions to find, in the order of their columns.
fn wanted(plan: &Plan, mapping: &Mapping) -> Result<Vec<u32>, Fault> {
    let Some(ids) = &mapping.questions else { return Ok((0..plan.questions().len() as u32).collect()) };
    let mut wanted = Vec::new();
    for id in ids {
        let declaration =
            |limit: &str| Fault::Declaration { key: "questions", value: shorten(id), limit: limit.into() };
        let question = plan.question(id).or_else(|| plan.beside(id));
        let question = question.ok_or_else(|| declaration("is not a question of this study"))?;
        if wanted.contains(&question) {
            return Err(declaration("is named twice"));
        }
        wanted.push(question);
    }
    Ok(wanted)
}

/// The study's own table: every column is named, and every question has one. Repeats and controls may have one, and training is
/// not read.
fn own_table(layout: &Layout, plan: &Plan, wanted: &[u32]) -> Result<(Assigned, String), Fault> {
    let mut assigned: Assigned = Vec::new();
    for column in 0..layout.titles.len() {
        if layout.participant == Some(column) || layout.form == Some(column) {
            continue;
        }
        let name = layout.title(column);
        let question = plan.question(name).or_else(|| plan.beside(name));
        if question.is_none() && is_training(name) {
            continue;
        }
        let Some(question) = question else {
            return Err(Fault::UnknownQuestion { column: column + 1, name: shorten(name) });
        };
        if let Some((first, _)) = assigned.iter().find(|(_, other)| *other == question) {
            let name = format!("question {}", shorten(name));
            return Err(Fault::DuplicateColumn { column: column + 1, first: first + 1, name });
        }
        assigned.push((column, question));
    }
    for question in wanted {
        if assigned.iter().all(|(_, found)| found != question) {
            let name = format!("question {}", plan.asked(*question).id);
            return Err(Fault::MissingColumn { name });
        }
    }
    Ok((assigned, "questions by their ids in the header".into()))
}

fn declared(layout: &Layout, mapping: &Mapping, count: usize) -> Result<Option<Vec<usize>>, Fault> {
    let width = layout.titles.len();
    let refuse = |key, value: String, limit: String| Err(Fault::Declaration { key, value, limit });
    if let Some(columns) = &mapping.question_columns {
        let value = || format!("{columns:?}");
        if columns.len() != count {
            return refuse(
                "question_columns",
                value(),
                format!("the study has {}", number_of(count, "question")),
            );
        }
        if let Some(beyond) = columns.iter().find(|&&column| column == 0 || column > width) {
            return refuse(
                "question_columns",
                beyond.to_string(),
                format!("the file has {}", number_of(width, "column")),
            );
        }
        if (1..columns.len()).any(|i| columns[..i].contains(&columns[i])) {
            return refuse("question_columns", value(), "a column is named twice".into());
        }
        return Ok(Some(columns.iter().map(|column| column - 1).collect()));
    }
    let Some(first) = mapping.first_question_column else { return Ok(None) };
    if first == 0 || first > width {
        return refuse(
            "first_question_column",
            first.to_string(),
            format!("the file has {}", number_of(width, "column")),
        );
    }
    let following = (first - 1..width).filter(|column| !layout.aside.contains(column));
    let columns: Vec<usize> = following.take(count).collect();
    if columns.len() < count {
        let limit = format!(
            "{} from there on, and the study has {}",
            number_of(columns.len(), "column"),
            number_of(count, "question")
        );
        return refuse("first_question_column", first.to_string(), limit);
    }
    Ok(Some(columns))
}

/// Every question by a header that is its id, or begins with it: `Q7. Which ...`. None if one is missing or comes twice.
fn named(layout: &Layout, plan: &Plan, wanted: &[u32]) -> Option<Assigned> {
    let columns = |question: u32| -> Vec<usize> { columns_of(layout, &plan.asked(question).id) };
    let mut assigned: Assigned = Vec::new();
    for &question in wanted {
        match columns(question)[..] {
            [column] if assigned.iter().all(|(other, _)| *other != column) => {
                assigned.push((column, question))
            }
            _ => return None,
        }
    }
    // Repeats and controls that are there count as well; none has to be.
    for (number, beside) in plan.all_beside().filter(|(number, _)| !wanted.contains(number)) {
        if let [column] = columns_of(layout, &beside.id)[..]
            && assigned.iter().all(|(other, _)| *other != column)
        {
            assigned.push((column, number));
        }
    }
    Some(assigned)
}

/// The columns whose headers name a question.
fn columns_of(layout: &Layout, id: &str) -> Vec<usize> {
    (0..layout.titles.len())
        .filter(|column| !layout.aside.contains(column))
        .filter(|&column| layout.titles[column].iter().any(|title| names(title, id)))
        .collect()
}

/// Whether a header names the question: the id alone, or in front of `.`, `:`, `)` or a space.
fn names(title: &str, id: &str) -> bool {
    let (title, id) = (normalise(title), normalise(id));
    match title.strip_prefix(&id) {
        Some("") => true,
        Some(rest) => rest.starts_with(['.', ':', ')', ' ']),
        None => false,
    }
}

/// What the columns hold that are not the tool's own.
struct Answering {
    /// Answers alone, and at least one.
    answers: Vec<usize>,
    /// Nothing.
    blank: Vec<usize>,
    /// Something else.
    other: Vec<usize>,
}

fn answering(source: &Source<'_>, layout: &Layout, mapping: &Mapping) -> Result<Answering, Fault> {
    #[derive(Clone, Copy, PartialEq)]
    enum Holds {
        Nothing,
        Answers,
        Other,
    }
    let mut holds = vec![Holds::Nothing; layout.titles.len()];
    let mut seen: std::collections::HashMap<String, bool> = std::collections::HashMap::new();
    source.each(|record| {
        if record.row <= layout.last_header_row
            || layout.preview.iter().any(|s| (s.says)(record.cell(s.column)))
        {
            return Ok(());
        }
        for (column, holds) in holds.iter_mut().enumerate().filter(|(_, holds)| **holds != Holds::Other) {
            let cell = record.cell(column);
            if is_blank(cell) || mapping.words.is_missing(cell) {
                continue;
            }
            let known = match seen.get(cell) {
                Some(&known) => known,
                None => {
                    let known = mapping.words.choice(cell.trim_end().trim_end_matches(';')).is_some();
                    if seen.len() < 4096 {
                        seen.insert(cell.to_owned(), known);
                    }
                    known
                }
            };
            *holds = if known { Holds::Answers } else { Holds::Other };
        }
        Ok(())
    })?;
    let of = |what: Holds| -> Vec<usize> {
        let own = |column: &usize| !layout.aside.contains(column) && holds[*column] == what;
        (0..holds.len()).filter(own).collect()
    };
    Ok(Answering { answers: of(Holds::Answers), blank: of(Holds::Nothing), other: of(Holds::Other) })
}

/// The one way to find so many questions among the columns, in their order.
fn by_position(found: &Answering, count: usize) -> Result<Vec<usize>, Fault> {
    let merge = |parts: &[&[usize]]| {
        let mut merged = parts.concat();
        merged.sort_unstable();
        merged
    };
    let candidates = [
        found.answers.clone(),
        merge(&[&found.answers, &found.blank]),
        merge(&[&found.answers, &found.blank, &found.other]),
    ];
    if let Some(columns) = candidates[..2].iter().find(|columns| columns.len() == count) {
        return Ok(columns.clone());
    }
    if let Some(many) = candidates[..2].iter().find(|columns| columns.len() > count) {
        let (first, second) = (&many[..count], &many[many.len() - count..]);
        return Err(Fault::Columns {
            first: format!("{} for the study's {}", listed(first), number_of(count, "question")),
            second: listed(second),
        });
    }
    if candidates[2].len() == count {
        return Ok(candidates[2].clone());
    }
    let reason = format!(
        "the study has {}; known answers and nothing else are in {}; other words may be declared as `synonyms`",
        number_of(count, "question"),
        listed(&found.answers)
    );
    Err(Fault::NoColumns { reason })
}

/// A header that is a question's id must not stand over another question.
fn contradiction(layout: &Layout, plan: &Plan, assigned: &Assigned) -> Result<(), Fault> {
    for &(column, question) in assigned {
        let other =
            layout.titles[column].iter().find_map(|title| plan.question(title).filter(|&q| q != question));
        if let Some(other) = other {
            let id = |question: u32| &plan.asked(question).id;
            return Err(Fault::Columns {
                first: format!("column {} is {} by its name", column + 1, id(other)),
                second: format!("it is {} by its position", id(question)),
            });
        }
    }
    Ok(())
}

/// `columns 3 to 29`, or the columns one by one; counted from 1.
pub(crate) fn listed(columns: &[usize]) -> String {
    match columns {
        [] => "no columns".into(),
        [one] => format!("column {}", one + 1),
        [first, .., last] if last - first + 1 == columns.len() && columns.is_sorted() => {
            format!("columns {} to {}", first + 1, last + 1)
        }
        _ => {
            let numbers: Vec<String> = columns.iter().map(|column| (column + 1).to_string()).collect();
            format!("columns {}", numbers.join(", "))
        }
    }
}
