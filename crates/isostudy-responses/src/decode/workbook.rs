//! The first sheet of an XLSX workbook (ECMA-376, parts 18.3 and 18.4), as text.
//!
//! Not `calamine`: it unpacks without a limit, holds a sheet as a full rectangle whatever its corner cells say, and asks for a
//! zip backend that would change the PNG writer of the whole workspace. Values are taken as stored, so that a time is
//! the serial number that it is; no format here is needed to read an answer.

use crate::decode::archive::Archive;
use crate::error::Fault;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// Largest sheet; XLSX itself allows 1,048,576 by 16,384.
const MOST_ROWS: usize = 1 << 20;
const MOST_COLUMNS: usize = 1 << 14;
/// Most cells, gaps included: rows are filled up to their last cell.
const MOST_CELLS: usize = 1 << 24;

/// Whether a zip file is a workbook.
pub(crate) fn is_workbook(archive: &Archive<'_>) -> bool {
    archive.names().iter().any(|name| name == "xl/workbook.xml")
}

/// Rows of the first sheet from row 1 on, and its name.
///
/// # Errors
/// If the workbook is damaged or too large.
pub(crate) fn first_sheet(archive: &mut Archive<'_>) -> Result<(Vec<Vec<String>>, String), Fault> {
    let workbook = archive.read("xl/workbook.xml")?;
    let mut first = None;
    each(&workbook, "xl/workbook.xml", |event| {
        match event {
            Event::Start(tag) | Event::Empty(tag)
                if first.is_none() && tag.local_name().as_ref() == "sheet" =>
            {
                first = Some((attribute(tag, "name"), attribute(tag, "r:id")));
            }
            _ => {}
        }
        Ok(())
    })?;
    let Some((name, id)) = first else { return Err(Fault::Archive("a workbook without a sheet".into())) };
    let path = sheet_path(archive, &id.unwrap_or_default())?;
    let shared = match archive.names().iter().any(|name| name == "xl/sharedStrings.xml") {
        true => shared_strings(&archive.read("xl/sharedStrings.xml")?)?,
        false => Vec::new(),
    };
    let sheet = archive.read(&path)?;
    Ok((rows(&sheet, &path, &shared)?, name.unwrap_or_default()))
}

/// The part that a relationship of the workbook leads to.
fn sheet_path(archive: &mut Archive<'_>, id: &str) -> Result<String, Fault> {
    const RELATIONS: &str = "xl/_rels/workbook.xml.rels";
    let relations = archive.read(RELATIONS)?;
    let mut target = None;
    each(&relations, RELATIONS, |event| {
        if let Event::Start(tag) | Event::Empty(tag) = event
            && tag.local_name().as_ref() == "Relationship"
            && attribute(tag, "Id").as_deref() == Some(id)
        {
            target = attribute(tag, "Target");
        }
        Ok(())
    })?;
    let target = target.ok_or_else(|| Fault::Archive("a workbook whose first sheet is nowhere".into()))?;
    Ok(match target.strip_prefix('/') {
        Some(absolute) => absolute.to_owned(),
        None => format!("xl/{target}"),
    })
}

/// Texts that cells refer to; runs of rich text are joined, phonetic guides left out.
fn shared_strings(xml: &[u8]) -> Result<Vec<String>, Fault> {
    let (mut strings, mut text) = (Vec::new(), Text::default());
    each(xml, "xl/sharedStrings.xml", |event| {
        match event {
            Event::Start(tag) if tag.local_name().as_ref() == "si" => text = Text::default(),
            Event::Empty(tag) if tag.local_name().as_ref() == "si" => strings.push(String::new()),
            Event::End(tag) if tag.local_name().as_ref() == "si" => strings.push(text.take()),
            event => text.take_in(event)?,
        }
        Ok(())
    })?;
    Ok(strings)
}

/// Collects what stands in `<t>`.
#[derive(Default)]
struct Text {
    text: String,
    inside: bool,
    phonetic: bool,
}

impl Text {
    fn take_in(&mut self, event: &Event<'_>) -> Result<(), Fault> {
        match event {
            Event::Start(tag) if tag.local_name().as_ref() == "t" => self.inside = !self.phonetic,
            Event::Start(tag) if tag.local_name().as_ref() == "rPh" => self.phonetic = true,
            Event::End(tag) if tag.local_name().as_ref() == "t" => self.inside = false,
            Event::End(tag) if tag.local_name().as_ref() == "rPh" => self.phonetic = false,
            event if self.inside => push_text(&mut self.text, event)?,
            _ => {}
        }
        Ok(())
    }

    fn take(&mut self) -> String {
        std::mem::take(&mut self.text)
    }
}

fn push_text(text: &mut String, event: &Event<'_>) -> Result<(), Fault> {
    let damaged =
        |error: &dyn std::fmt::Display| Fault::Archive(format!("a workbook with damaged text: {error}"));
    match event {
        Event::Text(part) => text.push_str(&part.xml10_content()),
        Event::CData(part) => text.push_str(&part.xml10_content()),
        Event::GeneralRef(name) => match name.resolve_char_ref().map_err(|error| damaged(&error))? {
            Some(character) => text.push(character),
            None => {
                let known = quick_xml::escape::resolve_predefined_entity(&name.xml10_content());
                text.push_str(known.ok_or_else(|| damaged(&"an unknown entity"))?);
            }
        },
        _ => {}
    }
    Ok(())
}

/// What a cell's value is.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Shared,
    Inline,
    Boolean,
    Plain,
}

fn rows(xml: &[u8], path: &str, shared: &[String]) -> Result<Vec<Vec<String>>, Fault> {
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut cells = 0;
    // The cell being read: place, kind, its value as stored and as inline text.
    let (mut row, mut column, mut kind) = (0, 0, Kind::Plain);
    let (mut value, mut in_value, mut inline) = (String::new(), false, Text::default());
    let damaged = |what: &str| Fault::Archive(format!("{path} in the workbook: {what}"));
    let mut put = |row: usize, column: usize, text: String| {
        if row > MOST_ROWS || column > MOST_COLUMNS || row == 0 || column == 0 {
            return Err(damaged(&format!("a cell at row {row}, column {column}")));
        }
        let grown = row.saturating_sub(rows.len());
        rows.resize_with(rows.len() + grown, Vec::new);
        let line = &mut rows[row - 1];
        cells += grown + column.saturating_sub(line.len());
        if cells > MOST_CELLS {
            return Err(damaged(&format!("more than {MOST_CELLS} cells")));
        }
        line.resize(line.len().max(column), String::new());
        line[column - 1] = text;
        Ok(())
    };
    each(xml, path, |event| {
        match event {
            Event::Start(tag) | Event::Empty(tag) => match tag.local_name().as_ref() {
                "row" => {
                    let number = attribute(tag, "r").map(|r| r.parse::<usize>());
                    row = match number {
                        None => row + 1,
                        Some(number) => number.map_err(|_| damaged("a row without a number"))?,
                    };
                    column = 0;
                }
                "c" => {
                    column = match attribute(tag, "r") {
                        None => column + 1,
                        Some(place) => column_of(&place).ok_or_else(|| damaged("a cell without a place"))?,
                    };
                    kind = match attribute(tag, "t").as_deref() {
                        Some("s") => Kind::Shared,
                        Some("inlineStr") => Kind::Inline,
                        Some("b") => Kind::Boolean,
                        _ => Kind::Plain,
                    };
                    (value, inline) = (String::new(), Text::default());
                }
                "v" => in_value = matches!(event, Event::Start(_)),
                _ => inline.take_in(event)?,
            },
            Event::End(tag) => match tag.local_name().as_ref() {
                "v" => in_value = false,
                "c" => {
                    let text = match kind {
                        Kind::Shared => {
                            let index = value.trim().parse::<usize>().ok();
                            let text = index.and_then(|index| shared.get(index));
                            text.ok_or_else(|| damaged("a text that is not in the workbook"))?.clone()
                        }
                        Kind::Inline => inline.take(),
                        Kind::Boolean => if value.trim() == "1" { "TRUE" } else { "FALSE" }.into(),
                        Kind::Plain => std::mem::take(&mut value),
                    };
                    if !text.is_empty() {
                        put(row, column, text)?;
                    }
                }
                _ => inline.take_in(event)?,
            },
            event if in_value => push_text(&mut value, event)?,
            event => inline.take_in(event)?,
        }
        Ok(())
    })?;
    Ok(rows)
}

/// The column of a place such as `AB12`, from 1.
fn column_of(place: &str) -> Option<usize> {
    let letters = place.bytes().take_while(u8::is_ascii_alphabetic);
    let column =
        letters.take(4).fold(0, |n, letter| n * 26 + usize::from(letter.to_ascii_uppercase() - b'A') + 1);
    (column > 0).then_some(column)
}

fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.attributes().flatten().find(|attribute| attribute.key.as_ref() == name)?;
    quick_xml::escape::unescape(&found.value).ok().map(std::borrow::Cow::into_owned)
}

/// Visits every event of a part.
fn each(xml: &[u8], path: &str, mut visit: impl FnMut(&Event<'_>) -> Result<(), Fault>) -> Result<(), Fault> {
    let (xml, _) = crate::decode::text::decode(xml)?;
    let mut reader = Reader::from_str(&xml);
    loop {
        match reader.read_event() {
            Ok(Event::Eof) => return Ok(()),
            Ok(event) => visit(&event)?,
            Err(error) => return Err(Fault::Archive(format!("{path} in the workbook is damaged: {error}"))),
        }
    }
}
