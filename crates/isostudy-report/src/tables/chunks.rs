//! What terrain costs chunk by chunk, and whether chunks fit.

use crate::words::list;
use isostudy_design::Configuration;
use isostudy_inference::inputs::Inputs;
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::median;
use isostudy_table::{Cell, Table};

/// Times of chunks and edits; `None` where none were timed.
pub(super) fn chunks(inputs: &Inputs<'_>) -> Option<Table> {
    let columns = [
        ("id", "Id"),
        ("chunks", "Chunks"),
        ("chunks_timed", "Timed"),
        ("chunk_ms", "Chunk, ms"),
        ("chunk_ms_low", "from"),
        ("chunk_ms_high", "to"),
        ("chunk_ms_longest", "longest"),
        ("edit_chunks", "Chunks of an edit"),
        ("edit_ms", "Edit, ms"),
        ("edit_ms_low", "from"),
        ("edit_ms_high", "to"),
        ("edit_ms_longest", "longest"),
        ("open_seam_edges", "Open edges at seams"),
        ("is_whole", "The whole mesh"),
    ];
    let mut table = Table::new("chunks", "Chunk by chunk", &columns);
    let times = |of: &Configuration| inputs.chunks.iter().find(|times| times.id == of.id);
    let in_order = inputs.study.configurations.iter().filter_map(times);
    for times in in_order {
        let mut row = vec![Cell::text(&times.id), Cell::count(times.chunks), Cell::count(times.timed)];
        row.extend(milliseconds(&times.chunk_s));
        let of_edit = median(times.edit_chunks.iter().map(|&count| count as f64).collect(), LEVEL);
        row.push(Cell::number(of_edit.map(|of| of.median), 1));
        row.extend(milliseconds(&times.edit_s));
        row.push(Cell::text(times.open_seam_edges));
        row.push(Cell::text(if times.is_whole { "yes" } else { "no" }));
        table.push(row);
    }
    let cells = inputs.chunks.first()?.cells;
    table.notes.push(format!(
        "One thread, from the field, with chunks of {cells} cells per side. Timed: chunks of full size that have triangles. An edit is a change within 5 cube \
         edges of a point of the surface, at the same points for all methods: the chunks that it touches are extracted again. Median, its interval at 95 %, and the longest. \
         The whole mesh: whether the chunks, welded, are the mesh that is made at once, to the bit."
    ));
    let study = inputs.study;
    let has_none = |method: &&isostudy_design::Method| {
        method.budget.is_none() && inputs.chunks.iter().all(|times| times.id.method != method.id)
    };
    let none: Vec<String> =
        study.methods.iter().filter(has_none).map(|method| method.id.to_string()).collect();
    if !none.is_empty() {
        table.notes.push(format!("No chunks are made by {}.", list(&none)));
    }
    (!table.rows.is_empty()).then_some(table)
}

/// Median, both ends and the longest.
fn milliseconds(seconds: &[f64]) -> [Cell; 4] {
    let found = median(seconds.to_vec(), LEVEL);
    let ends = found.and_then(|of| of.interval);
    let longest = seconds.iter().copied().max_by(f64::total_cmp);
    [found.map(|of| of.median), ends.map(|of| of.low), ends.map(|of| of.high), longest]
        .map(|seconds| Cell::number(seconds.map(|seconds| 1e3 * seconds), 3))
}
