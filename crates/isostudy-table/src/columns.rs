//! Columns that are said once: name, heading, unit, the cell of a row, and where people see them.

use crate::{Cell, Column, Table};

/// Columns over rows of any kind, which become a [`Table`]: the one way to make one.
///
/// ```
/// use isostudy_table::{Cell, Columns};
///
/// let table = Columns::over([("bi", 3_u64, 0.25), ("mc", 4, 1.0)])
///     .column("id", "Id", |row| Cell::text(row.0))
///     .column("triangles", "Triangles", |row| Cell::count(row.1))
///     .quantity("total_s", "Total, {}", "s", |row| Cell::Number(row.2, 1))
///     .into_table("counts", "What was counted");
/// assert_eq!(table.to_csv(), "id,triangles,total_s\nbi,3,0.25\nmc,4,1\n");
/// assert_eq!(table.headings(), ["Id", "Triangles", "Total, s"]);
/// ```
#[derive(Debug)]
pub struct Columns<R> {
    rows: Vec<R>,
    columns: Vec<Column>,
    cells: Vec<Vec<Cell>>,
    /// The blocks that show each column.
    blocks: Vec<Vec<usize>>,
}

impl<R> Columns<R> {
    /// No column yet.
    pub fn over(rows: impl IntoIterator<Item = R>) -> Self {
        let rows: Vec<R> = rows.into_iter().collect();
        Self { cells: vec![Vec::new(); rows.len()], rows, columns: Vec::new(), blocks: Vec::new() }
    }

    /// One more column: its name for scripts, its heading for people, and what it says of a row.
    #[must_use]
    pub fn column(
        self,
        name: impl Into<String>,
        heading: impl Into<String>,
        cell: impl Fn(&R) -> Cell,
    ) -> Self {
        let (name, heading, unit) = (name.into(), heading.into(), String::new());
        self.with(&[], Column { name, heading, unit }, cell)
    }

    /// A column of numbers with a unit, which its heading says where it has `{}`.
    #[must_use]
    pub fn quantity(
        self,
        name: impl Into<String>,
        heading: &str,
        unit: &str,
        cell: impl Fn(&R) -> Cell,
    ) -> Self {
        let (name, heading, unit) = (name.into(), heading.replace("{}", unit), unit.into());
        self.with(&[], Column { name, heading, unit }, cell)
    }

    /// A column that is shown in these blocks, counted from 0: see [`Columns::into_blocks`].
    #[must_use]
    pub fn column_in(
        self,
        blocks: &[usize],
        name: impl Into<String>,
        heading: impl Into<String>,
        cell: impl Fn(&R) -> Cell,
    ) -> Self {
        let (name, heading, unit) = (name.into(), heading.into(), String::new());
        self.with(blocks, Column { name, heading, unit }, cell)
    }

    fn with(mut self, blocks: &[usize], column: Column, cell: impl Fn(&R) -> Cell) -> Self {
        self.columns.push(column);
        self.blocks.push(blocks.to_vec());
        self.cells.iter_mut().zip(&self.rows).for_each(|(cells, row)| cells.push(cell(row)));
        self
    }

    /// A column or more for each of `all`, which only the data know.
    #[must_use]
    pub fn columns_of<T>(self, all: impl IntoIterator<Item = T>, add: impl FnMut(Self, T) -> Self) -> Self {
        all.into_iter().fold(self, add)
    }

    /// Columns that stand only where something holds.
    #[must_use]
    pub fn columns_if(self, holds: bool, add: impl FnOnce(Self) -> Self) -> Self {
        if holds { add(self) } else { self }
    }

    /// The table, with a row for each.
    pub fn into_table(self, name: &str, caption: impl Into<String>) -> Table {
        let Self { columns, cells, .. } = self;
        let (notes, parts) = (Vec::new(), Vec::new());
        Table { name: name.into(), caption: caption.into(), columns, rows: cells, notes, parts }
    }

    /// The table, printed as blocks of some of its columns; `captions` are theirs.
    pub fn into_blocks(mut self, name: &str, caption: impl Into<String>, captions: &[&str]) -> Table {
        let blocks = std::mem::take(&mut self.blocks);
        let mut table = self.into_table(name, caption);
        let shown =
            |block: usize| (0..blocks.len()).filter(|&i| blocks[i].contains(&block)).collect::<Vec<_>>();
        table.parts = captions
            .iter()
            .enumerate()
            .map(|(block, caption)| table.picked(caption, &shown(block)))
            .collect();
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_said_once() {
        let table = Columns::over([(3, 0.25), (4, 1.0)])
            .column_in(&[0, 1], "n", "Number", |row| Cell::count(row.0))
            .column_in(&[1], "s", "Time, s", |row| Cell::Number(row.1, 1))
            .into_blocks("t", "Times", &["Numbers", "All"]);
        assert_eq!(table.to_csv(), "n,s\n3,0.25\n4,1\n");
        assert_eq!(table.printed()[0].headings(), ["Number"]);
        assert_eq!(table.printed()[1].headings(), ["Number", "Time, s"]);
    }

    #[test]
    fn a_heading_says_the_unit_where_it_has_room_for_it() {
        let table = Columns::over([1.5])
            .quantity("total_ms", "Total, {}", "ms", |ms| Cell::Number(*ms, 1))
            .quantity("low_ms", "from", "ms", |ms| Cell::Number(*ms, 1))
            .columns_of(["a", "b"], |columns, id| columns.column(id, "{}", move |_| Cell::text(id)))
            .into_table("t", "");
        assert_eq!(table.headings(), ["Total, ms", "from", "{}", "{}"]);
        assert_eq!(table.columns.iter().map(|of| &*of.unit).collect::<Vec<_>>(), ["ms", "ms", "", ""]);
    }
}
