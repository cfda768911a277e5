//! Reading: bytes, text, rows, format, answers.

use crate::decode::archive::{self, Archive};
use crate::decode::source::Source;
use crate::decode::text;
use crate::decode::workbook;
use crate::error::{Fault, ReadError, shorten};
use crate::format::Format;
use crate::formats::arenakit;
use crate::formats::detect;
use crate::formats::layout::Detected;
use crate::formats::long;
use crate::formats::pwcmp;
use crate::formats::surveys;
use crate::formats::trials;
use crate::formats::webmushra;
use crate::formats::wide;
use crate::mapping::Mapping;
use crate::name;
use crate::plan::Plan;
use crate::report::Report;
use crate::sides::SidesSource;
use crate::value::Responses;
use isostudy_foreign::FileProblem;
use std::path::Path;

/// Largest file that is read, in bytes.
pub const LARGEST_FILE: u64 = 1 << 30;

/// Answers, and how they were read.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The answers.
    pub responses: Responses,
    /// How they were read.
    pub report: Report,
}

/// Reads a file of answers in any known format.
///
/// `plan` has the questions; without, only formats whose rows name both sides can be read.
///
/// # Errors
/// What is wrong, with file, row and column: see [`Fault`]. Nothing is guessed: where two readings fit, the error shows
/// both.
pub fn read(path: &Path, plan: Option<&Plan>, mapping: &Mapping) -> Result<Reading, ReadError> {
    let failed = |source| ReadError::File { file: path.into(), source };
    let bytes = isostudy_foreign::bytes(path, LARGEST_FILE).map_err(|error| match error.problem {
        FileProblem::TooLarge { limit } => {
            let bytes = std::fs::metadata(path).map_or(limit, |found| found.len());
            ReadError::Content { file: path.into(), fault: Box::new(Fault::TooLarge { bytes, limit }) }
        }
        _ => failed(error.into()),
    })?;
    parse(&bytes, path, plan, mapping)
}

/// As [`read`], from the file's content; `path` names it in messages.
///
/// # Errors
/// As for [`read`].
pub fn parse(
    bytes: &[u8],
    path: &Path,
    plan: Option<&Plan>,
    mapping: &Mapping,
) -> Result<Reading, ReadError> {
    let mut report = Report {
        file: path.into(),
        format: Format::Table,
        format_rule: String::new(),
        text_rule: String::new(),
        column_rule: String::new(),
        sides: SidesSource::Unknown,
        remarks: Vec::new(),
    };
    match content(bytes, plan, mapping, &mut report) {
        Ok(responses) => {
            report.sides = responses.sides;
            Ok(Reading { responses, report })
        }
        Err(fault) => Err(ReadError::Content { file: path.into(), fault: Box::new(fault) }),
    }
}

fn content(
    bytes: &[u8],
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    if let Some(name) = plan.into_iter().flat_map(Plan::names).find(|name| name::is_too_long(name)) {
        return Err(Fault::PlannedName { name: shorten(name), limit: name::limit() });
    }
    if archive::is_zip(bytes) {
        let mut archive = Archive::open(bytes)?;
        if workbook::is_workbook(&archive) {
            let (rows, sheet) = workbook::first_sheet(&mut archive)?;
            report.text_rule = format!("first sheet (\"{}\") of a workbook", shorten(&sheet));
            return table(&Source::Sheet(rows), plan, mapping, report);
        }
        let (name, content) = only_table(&mut archive)?;
        let answers = text(&content, plan, mapping, report);
        report.text_rule = format!("{} in a zip file; {}", shorten(&name), report.text_rule);
        return answers;
    }
    text(bytes, plan, mapping, report)
}

/// The one file of a zip file that may hold answers.
fn only_table(archive: &mut Archive<'_>) -> Result<(String, Vec<u8>), Fault> {
    let hidden = |name: &str| {
        name.starts_with("__MACOSX/") || name.rsplit('/').next().is_none_or(|n| n.starts_with('.'))
    };
    let ends = [".csv", ".tsv", ".txt", ".json"];
    let table = |name: &&String| !hidden(name) && ends.iter().any(|end| name.to_lowercase().ends_with(end));
    let tables: Vec<String> = archive.names().iter().filter(table).cloned().collect();
    match &tables[..] {
        [name] => Ok((name.clone(), archive.read(name)?)),
        [] => Err(Fault::Archive("a zip file without a CSV, TSV, text or JSON file".into())),
        [first, second, ..] => {
            let (first, second) = (shorten(first), shorten(second));
            Err(Fault::Archive(format!(
                "a zip file with several tables ({first}, {second}): unpack the one that is meant"
            )))
        }
    }
}

fn text(
    bytes: &[u8],
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let (text, encoding) = text::decode(bytes)?;
    if crate::decode::records::is_blank(&text) {
        return Err(Fault::Empty);
    }
    if let Some(format) = trials::json_format(&text, mapping.format) {
        (report.format, report.text_rule) = (format, encoding.into());
        report.format_rule = match (mapping.format, format) {
            (Some(_), _) => "declared",
            (None, Format::Jatos) => "several JSON values, each a run of its own",
            (None, _) => "one JSON value: a list of trials",
        }
        .into();
        return trials::read_json(&text, plan, mapping, report);
    }
    let (separator, rest, separator_rule) = text::separator(&text, mapping.separator)?;
    let name = if separator == b'\t' { "tab".into() } else { format!("\"{}\"", separator as char) };
    report.text_rule = format!("{encoding}; separator {name} ({separator_rule})");
    table(&Source::Text { text: rest, separator }, plan, mapping, report)
}

fn table(
    source: &Source<'_>,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let head = source.head()?;
    let Detected { format, rule } = match mapping.format {
        Some(format) => Detected { format, rule: "declared".into() },
        None => detect::detect(&head, plan)?,
    };
    (report.format, report.format_rule) = (format, rule);
    match format {
        Format::Long => long::read(source, &head, plan, mapping, report),
        Format::JsPsych | Format::Jatos => trials::read_table(source, &head, plan, mapping, report),
        Format::WebMushra => webmushra::read(source, &head, plan, mapping, report),
        Format::Arenakit => arenakit::read(source, &head, plan, mapping, report),
        Format::Pwcmp => pwcmp::read(source, &head, plan, mapping, report),
        _ => {
            let layout = surveys::layout(format, &head)?;
            wide::read(source, format, &layout, plan, mapping, report)
        }
    }
}
