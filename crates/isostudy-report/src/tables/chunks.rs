//! What terrain costs chunk by chunk, and whether chunks fit.

use crate::words::list;
use isostudy_design::Configuration;
use isostudy_design::record::ChunkTimes;
use isostudy_inference::inputs::Inputs;
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::median;
use isostudy_table::{Cell, Columns, Table};

/// Times of chunks and edits; `None` where none were timed.
pub(super) fn chunks(inputs: &Inputs<'_>) -> Option<Table> {
    let times = |of: &Configuration| inputs.chunks.iter().find(|times| times.id == of.id);
    let of_edit = |of: &ChunkTimes| {
        let chunks = median(of.edit_chunks.iter().map(|&count| count as f64).collect(), LEVEL);
        Cell::number(chunks.map(|of| of.median), 1)
    };
    let columns = Columns::over(inputs.study.configurations.iter().filter_map(times))
        .column("id", "Id", |of| Cell::text(&of.id))
        .column("chunks", "Chunks", |of| Cell::count(of.chunks))
        .column("chunks_timed", "Timed", |of| Cell::count(of.timed));
    let columns = milliseconds(columns, "chunk_ms", "Chunk, {}", |of| &of.chunk_s).column(
        "edit_chunks",
        "Chunks of an edit",
        |of| of_edit(of),
    );
    let mut table = milliseconds(columns, "edit_ms", "Edit, {}", |of| &of.edit_s)
        .column("open_seam_edges", "Open edges at seams", |of| Cell::text(of.open_seam_edges))
        .column("is_whole", "The whole mesh", |of| Cell::text(if of.is_whole { "yes" } else { "no" }))
        .into_table("chunks", "Chunk by chunk");
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
    table.unless_empty()
}

/// Median, both ends and the longest.
pub(super) fn milliseconds<'a, T>(
    columns: Columns<&'a T>,
    name: &str,
    heading: &str,
    seconds: fn(&T) -> &Vec<f64>,
) -> Columns<&'a T> {
    let found = |of: &T| median(seconds(of).clone(), LEVEL);
    let ends = |of: &T| found(of).and_then(|of| of.interval);
    let shown = |seconds: Option<f64>| Cell::number(seconds.map(|seconds| 1e3 * seconds), 3);
    columns
        .quantity(name, heading, "ms", |of| shown(found(of).map(|of| of.median)))
        .quantity(format!("{name}_low"), "from", "ms", |of| shown(ends(of).map(|i| i.low)))
        .quantity(format!("{name}_high"), "to", "ms", |of| shown(ends(of).map(|i| i.high)))
        .quantity(format!("{name}_longest"), "longest", "ms", |of| {
            shown(seconds(of).iter().copied().max_by(f64::total_cmp))
        })
}
