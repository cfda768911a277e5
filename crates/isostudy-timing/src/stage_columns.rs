//! The six stages as columns of a table.

use isostudy_design::Stage;
use isostudy_table::{Cell, Columns};

const MS: f64 = 1e3;

/// A column for each stage, in milliseconds.
pub(crate) fn with_stages<R>(columns: Columns<R>, seconds: impl Fn(&R, usize) -> f64) -> Columns<R> {
    columns.columns_of(Stage::ALL[..6].iter().enumerate(), |all, (place, stage)| {
        let label = stage.label();
        let heading = label[..1].to_uppercase() + &label[1..];
        all.quantity(format!("{label}_ms"), &heading, "ms", |row| Cell::Number(MS * seconds(row, place), 3))
    })
}
