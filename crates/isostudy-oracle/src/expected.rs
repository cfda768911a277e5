//! What tables have to say: cells and rows.

use crate::exact::Range;

/// What a cell has to say.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Want {
    /// This text, or this whole number.
    Is(String),
    /// A number.
    Near(f64),
    /// A p, which may be rounded up to the second.
    Between(Range),
    /// These rules of screening, and perhaps `outlying`, which is not judged here.
    Flags(String),
    /// Nothing.
    Empty,
    /// Whatever it says.
    Any,
}

impl Want {
    pub(crate) fn count(count: u64) -> Self {
        Self::Is(count.to_string())
    }

    pub(crate) fn number(value: Option<f64>) -> Self {
        value.map_or(Self::Empty, Self::Near)
    }

    pub(crate) fn range(range: Option<Range>) -> Self {
        range.map_or(Self::Empty, Self::Between)
    }

    pub(crate) fn p(p: f64) -> Self {
        Self::Between(Range { low: p, high: p })
    }

    /// Whether a cell, as in CSV, says it.
    pub(crate) fn is_met(&self, cell: &str) -> bool {
        let number = || cell.parse::<f64>().ok();
        match self {
            Self::Any => true,
            Self::Empty => cell.is_empty(),
            Self::Is(text) => cell == text,
            Self::Flags(text) => cell == text || cell == format!("{text} outlying").trim_start(),
            Self::Near(want) => number().is_some_and(|got| (got - want).abs() <= 1e-9 * want.abs().max(1.0)),
            Self::Between(range) => number().is_some_and(|got| range.holds(got)),
        }
    }
}

/// What a table has to say: some of its columns, for rows that are known by others. Rows that are not here may not be there.
#[derive(Debug, Clone)]
pub(crate) struct Expected {
    pub(crate) table: &'static str,
    pub(crate) keys: &'static [&'static str],
    pub(crate) columns: &'static [&'static str],
    pub(crate) rows: Vec<(Vec<String>, Vec<Want>)>,
}

impl Expected {
    pub(crate) fn new(
        table: &'static str,
        keys: &'static [&'static str],
        columns: &'static [&'static str],
    ) -> Self {
        Self { table, keys, columns, rows: Vec::new() }
    }

    pub(crate) fn push<const N: usize>(&mut self, keys: [&str; N], cells: Vec<Want>) {
        assert!(N == self.keys.len() && cells.len() == self.columns.len(), "{}", self.table);
        self.rows.push((keys.map(str::to_owned).to_vec(), cells));
    }
}
