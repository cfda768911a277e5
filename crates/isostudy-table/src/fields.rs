//! Columns that are said once: name, heading, the cell of a row, and where people see them.

use crate::{Cell, Column, Table};

/// A column of a table whose rows are made from `R`s.
pub struct Field<R> {
    name: &'static str,
    heading: &'static str,
    cell: fn(&R) -> Cell,
    /// The blocks that show it.
    blocks: &'static [usize],
}

/// A column: its name in CSV, its heading elsewhere, and its cell. Where a quantity has a unit, name and heading say it.
pub const fn field<R>(name: &'static str, heading: &'static str, cell: fn(&R) -> Cell) -> Field<R> {
    Field { name, heading, cell, blocks: &[] }
}

/// A column that is shown in these blocks, counted from 0: see [`Table::show_in_blocks`].
pub const fn field_in<R>(
    blocks: &'static [usize],
    name: &'static str,
    heading: &'static str,
    cell: fn(&R) -> Cell,
) -> Field<R> {
    Field { name, heading, cell, blocks }
}

impl Table {
    /// A table with a row for each of `rows`.
    pub fn of<R>(
        name: &str,
        caption: impl Into<String>,
        fields: &[Field<R>],
        rows: impl IntoIterator<Item = R>,
    ) -> Self {
        let mut table = Self::new(name, caption, &[]);
        table.columns = fields.iter().map(Field::column).collect();
        table.rows = rows.into_iter().map(|row| fields.iter().map(|of| (of.cell)(&row)).collect()).collect();
        table
    }

    /// Prints the table as blocks of some of its columns; these are the captions.
    pub fn show_in_blocks<R>(&mut self, fields: &[Field<R>], captions: &[&str]) {
        let names = |block: usize| -> Vec<&str> {
            fields.iter().filter(|of| of.blocks.contains(&block)).map(|of| of.name).collect()
        };
        let blocks = captions.iter().enumerate().map(|(block, caption)| self.block(caption, &names(block)));
        self.parts = blocks.collect();
    }
}

impl<R> Field<R> {
    fn column(&self) -> Column {
        Column { name: self.name.into(), heading: self.heading.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_said_once() {
        let fields: [Field<(u64, f64)>; 2] = [
            field_in(&[0, 1], "n", "Number", |row| Cell::count(row.0)),
            field_in(&[1], "s", "Time, s", |row| Cell::Number(row.1, 1)),
        ];
        let mut table = Table::of("t", "Times", &fields, [(3, 0.25), (4, 1.0)]);
        table.show_in_blocks(&fields, &["Numbers", "All"]);
        assert_eq!(table.to_csv(), "n,s\n3,0.25\n4,1\n");
        assert_eq!(table.printed()[0].headings(), ["Number"]);
        assert_eq!(table.printed()[1].headings(), ["Number", "Time, s"]);
    }
}
