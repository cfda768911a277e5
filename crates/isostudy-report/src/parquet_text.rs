//! Parquet files of answers as text, which the readers of answers take.

use polars_arrow::array::{Array, BinaryViewArray, BooleanArray, PrimitiveArray, Utf8ViewArray};
use polars_arrow::datatypes::Field;
use polars_parquet::read::schema::parquet_to_arrow_schema;
use polars_parquet::read::{
    BasicDecompressor, RowGroupMetadata, column_iter_to_arrays, get_page_iterator, read_metadata,
};
use std::fmt::Write;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a Parquet file begins with.
pub const PARQUET_MARK: [u8; 4] = *b"PAR1";

/// Why a Parquet file was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParquetError {
    /// The library refuses it: it is damaged, or compressed by something else than Snappy or Zstandard.
    #[error("not read as Parquet: {0}")]
    Refused(String),
    /// The library gave up on it.
    #[error("not read as Parquet: the file is damaged")]
    Damaged,
    /// A column of another type than texts, numbers and truth values.
    #[error("column {column}: values of the type {found} are not read")]
    Type {
        /// The column's name.
        column: String,
        /// Its type.
        found: String,
    },
}

/// The columns with these names, as CSV with a header; others are left out. Missing values are empty cells.
///
/// # Errors
/// See [`ParquetError`].
pub fn parquet_as_csv(bytes: Vec<u8>, is_wanted: impl Fn(&str) -> bool) -> Result<String, ParquetError> {
    // The library trusts a file's offsets.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let read = catch_unwind(AssertUnwindSafe(|| text(bytes, is_wanted)));
    std::panic::set_hook(hook);
    read.unwrap_or(Err(ParquetError::Damaged))
}

fn refused(error: impl std::fmt::Display) -> ParquetError {
    ParquetError::Refused(error.to_string())
}

fn text(bytes: Vec<u8>, is_wanted: impl Fn(&str) -> bool) -> Result<String, ParquetError> {
    let metadata = read_metadata(&mut Cursor::new(&bytes)).map_err(refused)?;
    let schema = parquet_to_arrow_schema(metadata.schema().fields());
    let fields: Vec<&Field> = schema.iter_values().filter(|field| is_wanted(&field.name)).collect();
    let largest = bytes.len();
    let cursor = Cursor::new(bytes.into());
    let mut text = String::new();
    for (i, field) in fields.iter().enumerate() {
        add_separator(&mut text, i);
        add_text(&mut text, &field.name);
    }
    text.push('\n');
    for group in &metadata.row_groups {
        let column = |field: &&Field| -> Result<Column, ParquetError> {
            let (columns, types) = pages(group, field, |chunk| {
                let pages = get_page_iterator(chunk, cursor.clone(), Vec::new(), largest).map_err(refused)?;
                Ok(BasicDecompressor::new(pages, Vec::new()))
            })?;
            let (arrays, _) =
                column_iter_to_arrays(columns, types, (*field).clone(), None).map_err(refused)?;
            Ok(Column { name: field.name.to_string(), arrays, array: 0, row: 0 })
        };
        let mut columns: Vec<Column> = fields.iter().map(column).collect::<Result<_, _>>()?;
        for _ in 0..group.num_rows() {
            for (i, column) in columns.iter_mut().enumerate() {
                add_separator(&mut text, i);
                column.add_next(&mut text)?;
            }
            text.push('\n');
        }
    }
    Ok(text)
}

type Chunk = polars_parquet::read::ColumnChunkMetadata;
type Type = polars_parquet::parquet::schema::types::PrimitiveType;

/// The parts of a row group that hold a column, each with its type.
fn pages<'a>(
    group: &'a RowGroupMetadata,
    field: &Field,
    read: impl Fn(&Chunk) -> Result<BasicDecompressor, ParquetError>,
) -> Result<(Vec<BasicDecompressor>, Vec<&'a Type>), ParquetError> {
    let chunks: Vec<&Chunk> = group.columns_under_root_iter(&field.name).into_iter().flatten().collect();
    let columns = chunks.iter().map(|chunk| read(chunk)).collect::<Result<_, _>>()?;
    Ok((columns, chunks.into_iter().map(|chunk| &chunk.descriptor().descriptor.primitive_type).collect()))
}

/// A column of a row group, read value by value.
struct Column {
    name: String,
    arrays: Vec<Box<dyn Array>>,
    array: usize,
    row: usize,
}

impl Column {
    fn add_next(&mut self, text: &mut String) -> Result<(), ParquetError> {
        while self.arrays.get(self.array).is_some_and(|array| self.row >= array.len()) {
            (self.array, self.row) = (self.array + 1, 0);
        }
        let array = self.arrays.get(self.array).ok_or(ParquetError::Damaged)?;
        let row = self.row;
        self.row += 1;
        match array.is_null(row) {
            true => Ok(()),
            false => self.add(text, array.as_ref(), row),
        }
    }

    fn add(&self, text: &mut String, array: &dyn Array, row: usize) -> Result<(), ParquetError> {
        let array = array.as_any();
        if let Some(array) = array.downcast_ref::<Utf8ViewArray>() {
            add_text(text, array.value(row));
            return Ok(());
        }
        if let Some(array) = array.downcast_ref::<BinaryViewArray>() {
            add_text(
                text,
                std::str::from_utf8(array.value(row))
                    .map_err(|error| refused(format!("column {}: {error}", self.name)))?,
            );
            return Ok(());
        }
        if let Some(array) = array.downcast_ref::<BooleanArray>() {
            text.push_str(if array.value(row) { "true" } else { "false" });
            return Ok(());
        }
        macro_rules! number {
            ($($of:ty),*) => {
                $(if let Some(array) = array.downcast_ref::<PrimitiveArray<$of>>() {
                    write!(text, "{}", array.value(row)).expect("a string takes everything");
                    return Ok(());
                })*
            };
        }
        number!(i64, i32, u32, u64, f64, f32, i16, u16, i8, u8);
        let found = format!("{:?}", self.arrays[self.array].dtype());
        Err(ParquetError::Type { column: self.name.clone(), found })
    }
}

fn add_separator(text: &mut String, column: usize) {
    if column > 0 {
        text.push(',');
    }
}

fn add_text(text: &mut String, cell: &str) {
    match cell.contains([',', '"', '\n', '\r']) {
        true => {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        }
        false => text.push_str(cell),
    }
}
