//! A frame as the bytes of a Parquet file.

use super::LongFrame;
use polars::prelude::*;
use polars_arrow::array::{ArrayRef, DictionaryArray, PrimitiveArray, Utf8ViewArray};
use polars_arrow::record_batch::RecordBatchT;
use polars_parquet::write::{
    CompressionOptions, FileWriter, RowGroupIterator, StatisticsOptions, Version, WriteOptions,
    get_dtype_encoding,
};
use std::sync::Arc;

/// Rows that are encoded at a time: what is not yet written of millions stays small.
const ROWS_OF_GROUP: usize = 1 << 18;

pub(super) fn bytes(long: &LongFrame) -> PolarsResult<Vec<u8>> {
    compressed(long, CompressionOptions::Uncompressed)
}

fn compressed(long: &LongFrame, compression: CompressionOptions) -> PolarsResult<Vec<u8>> {
    let options = WriteOptions {
        statistics: StatisticsOptions::default(),
        compression,
        version: Version::V1,
        data_page_size: None,
    };
    // No rows have the columns of all.
    let schema = Arc::new(schema(&arrays(long, 0, 0)?));
    let encodings = schema.iter_values().map(|field| get_dtype_encoding(&field.dtype)).collect();
    let starts = (0..long.height()).step_by(ROWS_OF_GROUP);
    let parts: Vec<(usize, usize)> =
        starts.map(|start| (start, ROWS_OF_GROUP.min(long.height() - start))).collect();
    let groups = parts.iter().map(|&(start, rows)| {
        let arrays = arrays(long, start, rows)?.into_iter().map(|(_, array)| array).collect();
        RecordBatchT::try_new(rows, schema.clone(), arrays)
    });
    let mut writer = FileWriter::try_new(Vec::new(), (*schema).clone(), options)?;
    let encoded = RowGroupIterator::try_new(groups, &schema, options, encodings)?;
    for ((_, rows), group) in parts.iter().zip(encoded) {
        writer.write(*rows as u64, group?)?;
    }
    // Without Arrow's own schema, readers see plain texts and not dictionaries.
    writer.end(Some(Vec::new()))?;
    Ok(writer.into_inner())
}

fn schema(arrays: &[(PlSmallStr, ArrayRef)]) -> ArrowSchema {
    let field =
        |(name, array): &(PlSmallStr, ArrayRef)| ArrowField::new(name.clone(), array.dtype().clone(), true);
    arrays.iter().map(|column| (column.0.clone(), field(column))).collect()
}

/// Columns of some rows, by name.
fn arrays(long: &LongFrame, start: usize, rows: usize) -> PolarsResult<Vec<(PlSmallStr, ArrayRef)>> {
    let part = long.frame.slice(start as i64, rows);
    let array = |column: &Column| -> PolarsResult<(PlSmallStr, ArrayRef)> {
        let (name, series) = (column.name().clone(), column.as_materialized_series().rechunk());
        let texts = long.texts.iter().find(|(of, _)| *of == name.as_str()).map(|(_, texts)| texts);
        let array = match (series.dtype(), texts) {
            (DataType::UInt32, Some(texts)) => named(series.u32()?, texts)?,
            (DataType::UInt32, None) => series.cast(&DataType::Int64)?.to_arrow(0, CompatLevel::newest()),
            _ => series.to_arrow(0, CompatLevel::newest()),
        };
        Ok((name, array))
    };
    part.columns().iter().map(array).collect()
}

/// Places in a list as a dictionary array.
fn named(places: &UInt32Chunked, texts: &[String]) -> PolarsResult<ArrayRef> {
    let keys: PrimitiveArray<u32> = places.iter().collect();
    let values = Utf8ViewArray::from_slice_values(texts);
    Ok(DictionaryArray::try_from_keys(keys, values.boxed(), false)?.boxed())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parquet_text::parquet_as_csv;

    /// As other programs write it.
    #[test]
    fn compressed_files_are_read_as_plain_ones() {
        let places: Vec<u32> = (0..5000).map(|row| row % 3).collect();
        let seconds: Vec<Option<f64>> =
            (0..5000).map(|row| (row % 7 > 0).then(|| f64::from(row) / 8.0)).collect();
        let columns = vec![Column::new("choice".into(), places), Column::new("seconds".into(), seconds)];
        let texts = ["left", "none", "right"].map(str::to_owned).to_vec();
        let frame = DataFrame::new(5000, columns).unwrap();
        let long = LongFrame { name: "test", frame, texts: vec![("choice", texts)] };
        let read = |compression| {
            let bytes = compressed(&long, compression).unwrap();
            (bytes.len(), parquet_as_csv(bytes, |_| true).unwrap())
        };
        let (plain_bytes, plain) = read(CompressionOptions::Uncompressed);
        assert!(plain.starts_with("choice,seconds\nleft,\nnone,0.125\n"), "{}", &plain[..60]);
        for compression in [CompressionOptions::Snappy, CompressionOptions::Zstd(None)] {
            let (bytes, text) = read(compression);
            assert!(bytes < plain_bytes, "{compression:?}");
            assert!(text == plain, "{compression:?}");
        }
    }
}
