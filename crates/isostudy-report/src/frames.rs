//! Answers, meshes and times as one long frame each: the rows that tables summarise, for counting here and for other programs as
//! Parquet. `docs/data.md` lists every column with its unit and what a missing value means.

mod answers;
mod cases;
mod meshes;
mod parquet;
mod rows;
mod times;

pub(crate) use answers::{COLUMNS, answers};
pub use cases::{
    CaseMesh, CaseTimes, MeasuredCase, TimedCase, case_meshes, case_times, machine_name, measured_cases,
    timed_cases,
};
pub(crate) use meshes::meshes;
pub(crate) use times::times;

use isostudy_responses::Responses;
use polars::prelude::{DataFrame, PolarsError};
use std::collections::BTreeSet;

/// A table with one observation per row. Columns are whole numbers, numbers, truth values and texts; any may miss a value.
#[derive(Debug, Clone)]
pub struct LongFrame {
    /// The name of its file, without folder and ending.
    pub name: &'static str,
    pub(crate) frame: DataFrame,
    /// Columns that hold places in a list of texts: there may be millions of rows and a handful of texts.
    pub(crate) texts: Vec<(&'static str, Vec<String>)>,
}

/// Why a frame could not be written.
#[derive(Debug, thiserror::Error)]
#[error("data/{name}.parquet")]
pub struct FrameError {
    /// The frame's name.
    name: &'static str,
    #[source]
    source: PolarsError,
}

impl LongFrame {
    /// The number of rows.
    pub fn height(&self) -> usize {
        self.frame.height()
    }

    /// The frame as a Parquet file: not compressed, texts as dictionaries, one row group per 262,144 rows.
    ///
    /// The same frame gives the same bytes: there is neither a time nor a version of this program in them.
    ///
    /// # Errors
    /// If the library refuses a column.
    pub fn to_parquet(&self) -> Result<Vec<u8>, FrameError> {
        parquet::bytes(self).map_err(|source| FrameError { name: self.name, source })
    }
}

/// The frame of answers without a study: items are named as in their file.
pub fn answers_frame(responses: &Responses) -> LongFrame {
    answers(None, responses, &BTreeSet::new(), &COLUMNS)
}

#[cfg(test)]
mod tests;
