//! Columns that are said once: what a column is called, and what its cell is for each row.

use crate::{Cell, Column, Table};

/// Columns over rows of any kind, which become a [`Table`].
///
/// ```
/// use isostudy_table::{Cell, Columns};
///
/// let table = Columns::over(&[("bi", 3_u64), ("mc", 4)])
///     .column("id", "Id", |row| Cell::text(row.0))
///     .column("triangles", "Triangles", |row| Cell::count(row.1))
///     .into_table("counts", "What was counted");
/// assert_eq!(table.to_csv(), "id,triangles\nbi,3\nmc,4\n");
/// ```
#[derive(Debug)]
pub struct Columns<'a, R> {
    rows: &'a [R],
    columns: Vec<Column>,
    cells: Vec<Vec<Cell>>,
}

impl<'a, R> Columns<'a, R> {
    /// No column yet.
    pub fn over(rows: &'a [R]) -> Self {
        Self { rows, columns: Vec::new(), cells: vec![Vec::new(); rows.len()] }
    }

    /// One more column: its name for scripts, its heading for people, and what it says of a row.
    #[must_use]
    pub fn column(mut self, name: &str, heading: &str, cell: impl Fn(&R) -> Cell) -> Self {
        self.columns.push(Column { name: name.into(), heading: heading.into() });
        self.cells.iter_mut().zip(self.rows).for_each(|(cells, row)| cells.push(cell(row)));
        self
    }

    /// The table, with a row for each.
    pub fn into_table(self, name: &str, caption: impl Into<String>) -> Table {
        let Self { columns, cells, .. } = self;
        let (notes, parts) = (Vec::new(), Vec::new());
        Table { name: name.into(), caption: caption.into(), columns, rows: cells, notes, parts }
    }
}
