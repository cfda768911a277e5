//! Cells that are as they have to be, and those that are not.

use crate::expected::Expected;
use isostudy_table::Table;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A cell, or a number in a sentence, that says something else than it has to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Wrong {
    pub(super) table: String,
    pub(super) row: String,
    pub(super) column: String,
    pub(super) got: String,
    pub(super) want: String,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { table, row, column, got, want } = self;
        write!(f, "{table} | {row} | {column} | {got} | {want}")
    }
}

/// What was compared.
#[derive(Debug, Clone, Default)]
pub(super) struct Compared {
    pub(super) cells: u64,
    pub(super) wrong: Vec<Wrong>,
}

impl Compared {
    /// Counts one cell.
    pub(super) fn check(
        &mut self,
        met: bool,
        place: [&str; 3],
        got: impl fmt::Display,
        want: impl fmt::Display,
    ) {
        self.cells += 1;
        if !met {
            let [table, row, column] = place.map(str::to_owned);
            self.wrong.push(Wrong { table, row, column, got: got.to_string(), want: want.to_string() });
        }
    }

    pub(super) fn add(&mut self, other: Self) {
        self.cells += other.cells;
        self.wrong.extend(other.wrong);
    }
}

/// The cells of a table, in full as in CSV.
pub(super) struct Cells<'t> {
    table: &'t Table,
}

impl<'t> Cells<'t> {
    pub(super) fn of(tables: &'t [Table], name: &str) -> Option<Self> {
        tables.iter().find(|table| table.name == name).map(|table| Self { table })
    }

    /// A column's place; `None` if the table has no such column.
    fn place(&self, column: &str) -> Option<usize> {
        self.table.columns.iter().position(|own| own.name == column)
    }

    pub(super) fn rows(&self) -> usize {
        self.table.rows.len()
    }

    /// What a row says in a column.
    pub(super) fn at(&self, row: usize, column: &str) -> Option<String> {
        Some(self.table.rows[row][self.place(column)?].in_full())
    }

    /// The same as a number.
    pub(super) fn number(&self, row: usize, column: &str) -> Option<f64> {
        self.at(row, column)?.parse().ok()
    }
}

/// Holds a table against what it has to say: every cell of every row, and that there are no other rows.
pub(super) fn compare(tables: &[Table], expected: &Expected) -> Compared {
    let mut compared = Compared::default();
    let Expected { table, keys, columns, rows } = expected;
    let Some(cells) = Cells::of(tables, table) else {
        compared.check(rows.is_empty(), [table, "", ""], "no table", format!("{} rows", rows.len()));
        return compared;
    };
    let key = |row: usize| -> Vec<String> {
        keys.iter().map(|key| cells.at(row, key).unwrap_or_default()).collect()
    };
    let mut places: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    for row in 0..cells.rows() {
        let twice = places.insert(key(row), row).is_some();
        compared.check(!twice, [table, &key(row).join(" "), ""], "twice", "once");
    }
    for (key, wants) in rows {
        let name = key.join(" ");
        let Some(&row) = places.get(key) else {
            compared.check(false, [table, &name, ""], "no row", "a row");
            continue;
        };
        for (column, want) in columns.iter().zip(wants) {
            let got = cells.at(row, column);
            let met = got.as_ref().is_some_and(|got| want.is_met(got));
            compared.check(
                met,
                [table, &name, column],
                got.unwrap_or("no column".into()),
                format!("{want:?}"),
            );
        }
    }
    let known: BTreeSet<&Vec<String>> = rows.iter().map(|(key, _)| key).collect();
    for key in places.keys().filter(|key| !known.contains(key)) {
        compared.check(false, [table, &key.join(" "), ""], "a row", "no row");
    }
    compared
}
