//! Answers of people from a data frame, and tables about them as data frames: both by Arrow, so that no library of frames is preferred.

use std::path::Path;
use std::sync::Arc;

use arrow_array::{Array, ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_cast::cast;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use isostudy_design::config::ResponsesSection;
use isostudy_inference::{Many, Preferences, is_many, open_groups};
use isostudy_report::{answer_tables, found_in_groups, found_in_many, many_tables};
use isostudy_responses::{LONG_COLUMNS, Mapping, Reading, normalise, parse};
use isostudy_table::{Cell, Table};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3_arrow::{PyRecordBatchReader, PyTable};

/// What messages call the frame, which has no path.
const FRAME: &str = "the frame";

/// What was found, how the frame was read, and each table: its name, its caption, its notes, and itself.
type Analysis = (Option<String>, String, Vec<(String, String, Vec<String>, PyTable)>);

/// The sentences and tables of answers.
#[pyfunction]
pub(crate) fn analyse(
    py: Python<'_>,
    frame: PyRecordBatchReader,
    reference: Option<String>,
    shown_s: Option<f64>,
    many: bool,
) -> PyResult<Analysis> {
    let reader = frame.into_reader()?;
    let found = py.detach(|| -> Result<_, String> {
        let text = as_csv(reader).map_err(|error| error.to_string())?;
        let section = ResponsesSection { reference, shown_s, ..ResponsesSection::default() };
        analysed(&text, &section, many)
    });
    let (found, read, tables) = found.map_err(PyValueError::new_err)?;
    let tables = tables.into_iter().map(|table| {
        let columns = as_arrow(&table).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let schema = columns.schema();
        Ok((table.name, table.caption, table.notes, PyTable::try_new(vec![columns], schema)?))
    });
    Ok((found, read, tables.collect::<PyResult<_>>()?))
}

/// As `isostudy analyse FILE` does, with a file that has this text.
fn analysed(
    text: &str,
    section: &ResponsesSection,
    always_many: bool,
) -> Result<(Option<String>, String, Vec<Table>), String> {
    let mapping = Mapping::of(section).map_err(|error| error.to_string())?;
    let Reading { responses, report } =
        parse(text.as_bytes(), Path::new(FRAME), None, &mapping).map_err(|error| error.to_string())?;
    if let Some(reference) = section.reference.as_ref().filter(|of| !responses.items.contains(of)) {
        let items = responses.items.join(", ");
        return Err(format!("reference={reference:?}: no item has this name; there are {items}"));
    }
    let groups = open_groups(&responses, section.reference.as_deref());
    let read = report.to_string();
    if always_many || is_many(&responses, &groups) {
        let many = Many::of(&groups, responses.sides_recorded);
        return Ok((Some(found_in_many(&many)), read, many_tables(&many, responses.sides_recorded)));
    }
    let preferences = Preferences::without_study(&responses, &groups, section.shown_s);
    Ok((found_in_groups(&preferences), read, answer_tables(&preferences)))
}

/// The columns of the long format, as text; others, which nobody asked for, stay out.
fn as_csv(reader: impl Iterator<Item = Result<RecordBatch, ArrowError>>) -> Result<String, ArrowError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut begun = false;
    for batch in reader {
        let batch = batch?;
        let schema = batch.schema();
        let wanted: Vec<usize> = (0..batch.num_columns())
            .filter(|&i| LONG_COLUMNS.contains(&normalise(schema.field(i).name()).as_str()))
            .collect();
        if !begun {
            writer.write_record(wanted.iter().map(|&i| schema.field(i).name())).map_err(csv_error)?;
            begun = true;
        }
        let columns: Vec<ArrayRef> =
            wanted.iter().map(|&i| texts(batch.column(i))).collect::<Result<_, _>>()?;
        let columns: Vec<&StringArray> =
            columns.iter().filter_map(|column| column.as_any().downcast_ref()).collect();
        for row in 0..batch.num_rows() {
            // A missing value is an empty cell.
            let cells = columns.iter().map(|of| if of.is_null(row) { "" } else { of.value(row) });
            writer.write_record(cells).map_err(csv_error)?;
        }
    }
    let bytes = writer.into_inner().map_err(|error| csv_error(error.into_error().into()))?;
    String::from_utf8(bytes).map_err(|error| ArrowError::CsvError(error.to_string()))
}

/// A column as text. Libraries make floating-point numbers of whole numbers where a value is missing: they become whole again.
fn texts(column: &ArrayRef) -> Result<ArrayRef, ArrowError> {
    match column.data_type() {
        DataType::Float16 | DataType::Float32 | DataType::Float64 => {
            let numbers = cast(column, &DataType::Float64)?;
            let numbers: &Float64Array = numbers.as_any().downcast_ref().expect("it was cast to this");
            let texts = numbers.iter().map(|number| number.filter(|n| !n.is_nan()).map(|n| n.to_string()));
            Ok(Arc::new(texts.collect::<StringArray>()))
        }
        _ => cast(column, &DataType::Utf8),
    }
}

fn csv_error(error: csv::Error) -> ArrowError {
    ArrowError::CsvError(error.to_string())
}

/// A table's cells in full: a column of whole numbers, of numbers or of text, with nothing where a cell is missing.
fn as_arrow(table: &Table) -> Result<RecordBatch, ArrowError> {
    let mut fields = Vec::with_capacity(table.columns.len());
    let mut arrays: Vec<ArrayRef> = Vec::with_capacity(table.columns.len());
    for (i, column) in table.columns.iter().enumerate() {
        let cells = || table.rows.iter().map(move |row| &row[i]);
        let has = |kind: fn(&Cell) -> bool| cells().any(kind);
        let array: ArrayRef = if has(|cell| matches!(cell, Cell::Text(_))) {
            let text = |cell: &Cell| (!matches!(cell, Cell::Missing)).then(|| cell.in_full());
            Arc::new(cells().map(text).collect::<StringArray>())
        } else if has(|cell| matches!(cell, Cell::Number(..) | Cell::P(..))) {
            let number = |cell: &Cell| match cell {
                Cell::Number(value, _) => Some(*value),
                // Never zero, as in CSV.
                Cell::P(value, _) => Some(value.max(f64::from_bits(1))),
                Cell::Count(count) => Some(*count as f64),
                Cell::Missing | Cell::Text(_) => None,
            };
            Arc::new(cells().map(number).collect::<Float64Array>())
        } else {
            let count = |cell: &Cell| match cell {
                Cell::Count(count) => Some(*count),
                _ => None,
            };
            Arc::new(cells().map(count).collect::<Int64Array>())
        };
        fields.push(Field::new(&column.name, array.data_type().clone(), true));
        arrays.push(array);
    }
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
}
