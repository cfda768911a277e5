//! Columns of records.

use polars::prelude::*;

/// Records, and the columns that were made of them.
pub(super) struct Rows<T> {
    rows: Vec<T>,
    columns: Vec<Column>,
}

impl<T> Rows<T> {
    pub(super) fn of(rows: impl IntoIterator<Item = T>) -> Self {
        Self { rows: rows.into_iter().collect(), columns: Vec::new() }
    }

    /// A column of texts.
    pub(super) fn text(&mut self, name: &str, of: impl Fn(&T) -> Option<String>) {
        let values: Vec<Option<String>> = self.rows.iter().map(of).collect();
        self.columns.push(Column::new(name.into(), values));
    }

    /// A column of whole numbers.
    ///
    /// # Panics
    /// Above the largest signed number of 64 bits, which nothing that is counted reaches.
    pub(super) fn count(&mut self, name: &str, of: impl Fn(&T) -> Option<u64>) {
        self.whole(name, |row| of(row).map(|count| i64::try_from(count).expect("counted one by one")));
    }

    /// A column of whole numbers with a sign.
    pub(super) fn whole(&mut self, name: &str, of: impl Fn(&T) -> Option<i64>) {
        let values: Vec<Option<i64>> = self.rows.iter().map(of).collect();
        self.columns.push(Column::new(name.into(), values));
    }

    /// A column of numbers; what is not a number is missing.
    pub(super) fn number(&mut self, name: &str, of: impl Fn(&T) -> Option<f64>) {
        let known = |row: &T| of(row).filter(|number| !number.is_nan());
        let values: Vec<Option<f64>> = self.rows.iter().map(known).collect();
        self.columns.push(Column::new(name.into(), values));
    }

    /// A column of truth values.
    pub(super) fn truth(&mut self, name: &str, of: impl Fn(&T) -> Option<bool>) {
        let values: Vec<Option<bool>> = self.rows.iter().map(of).collect();
        self.columns.push(Column::new(name.into(), values));
    }

    /// The columns.
    pub(super) fn columns(self) -> Vec<Column> {
        self.columns
    }

    /// The columns beside one another.
    ///
    /// # Panics
    /// If two have one name.
    pub(super) fn frame(self) -> DataFrame {
        DataFrame::new(self.rows.len(), self.columns).expect("columns of one length, each with its own name")
    }
}
