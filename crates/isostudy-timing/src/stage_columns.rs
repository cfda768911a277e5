//! The six stages as columns of a table.

use isostudy_design::Stage;
use isostudy_table::{Cell, Columns};

const MS: f64 = 1e3;

/// A column for each stage, in milliseconds.
pub(crate) fn with_stages<'a, R>(
    mut columns: Columns<'a, R>,
    seconds: impl Fn(&R, usize) -> f64,
) -> Columns<'a, R> {
    for (place, stage) in Stage::ALL[..6].iter().enumerate() {
        let label = stage.label();
        let heading = label[..1].to_uppercase() + &label[1..];
        columns =
            columns.column(&format!("{label}_ms"), &heading, |row| Cell::Number(MS * seconds(row, place), 3));
    }
    columns
}
