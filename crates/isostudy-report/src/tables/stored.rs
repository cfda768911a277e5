//! What methods take from samples that are stored.

use crate::tables::chunks::milliseconds;
use isostudy_design::Configuration;
use isostudy_design::record::StoredTimes;
use isostudy_inference::inputs::Inputs;
use isostudy_table::{Cell, Columns, Table};

/// Times from stored samples; `None` where none were taken.
pub(super) fn stored(inputs: &Inputs<'_>) -> Option<Table> {
    let times = |of: &Configuration| inputs.stored.iter().find(|times| times.id == of.id);
    let asks = |of: &StoredTimes| if of.is_between { "values between" } else { "samples" };
    let columns = Columns::over(inputs.study.configurations.iter().filter_map(times))
        .column("id", "Id", |of| Cell::text(&of.id))
        .column("asks_for", "Asks for", |of| Cell::text(asks(of)));
    let columns = milliseconds(columns, "whole_ms", "Whole, {}", |of| &of.whole_s);
    let columns = milliseconds(columns, "chunk_ms", "Chunk, {}", |of| &of.chunk_s);
    let mut table = milliseconds(columns, "edit_ms", "Edit, {}", |of| &of.edit_s)
        .into_table("stored", "From stored samples");
    table.notes.push(
        "One thread, from the samples at the corners of the object's cubes to the mesh without normals. All methods are given the same \
         samples. Values between: the method asks for values or gradients between samples, which are interpolated in its time. Chunks and edits are \
         those of the table of chunks, with normals. A program says its own time, and makes no chunks. Median, its interval at 95 %, and the longest."
            .into(),
    );
    table.unless_empty()
}
