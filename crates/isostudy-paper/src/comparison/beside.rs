//! The published benchmark with ours beside it: one row a configuration, two columns a quantity.

use super::Compared;
use isostudy_table::{Cell, Column, Table};

/// The paper's four blocks, by quantity; in each, what is put right follows what is as published.
const BLOCKS: [(&str, &[&str]); 4] = [
    (
        "Resolution and counts",
        &["tetrahedra", "vertices", "triangles", "discarded_as_published", "discarded_triangles"],
    ),
    (
        "Times, s",
        &[
            "total_without_normals_s",
            "sampling_s",
            "sampling_fraction",
            "vertex_s",
            "vertex_fraction",
            "geometry_s",
            "geometry_fraction",
        ],
    ),
    ("Memory, bytes", &["sample_bytes", "edge_bytes", "vertex_bytes", "index_bytes"]),
    (
        "Work and shape",
        &[
            "evaluated_fraction",
            "discard_fraction_as_published",
            "discard_fraction",
            "aspect_ratio_mean_as_published",
            "aspect_ratio_mean",
            "aspect_ratio_sd_as_published",
            "aspect_ratio_sd",
        ],
    ),
];

/// `None` if no row of the benchmark was published.
pub(super) fn table(source: &str, all: &[Compared]) -> Option<Table> {
    let all: Vec<&Compared> = all.iter().filter(|compared| compared.source == "benchmark").collect();
    let (mut rows, mut quantities) = (Vec::new(), Vec::new());
    for compared in &all {
        if !rows.contains(&compared.row.as_str()) {
            rows.push(compared.row.as_str());
        }
        if !quantities.contains(&compared.quantity.as_str()) {
            quantities.push(compared.quantity.as_str());
        }
    }
    let caption = format!("The benchmark of {source}, row by row, and ours beside it");
    let mut table = Table::new("benchmark_beside", caption, &[("id", "Id")]);
    for quantity in &quantities {
        let words = quantity.trim_end_matches("_s").replace('_', " ");
        table.columns.push(Column { name: format!("published_{quantity}"), heading: words });
        table.columns.push(Column { name: format!("ours_{quantity}"), heading: "ours".into() });
    }
    for row in &rows {
        let mut cells = vec![Cell::text(row)];
        for quantity in &quantities {
            // What is put right is there only where it makes a difference.
            let found = all.iter().find(|c| c.row == *row && c.quantity == *quantity);
            let cell = |value: Option<f64>| match (found, value) {
                (Some(compared), Some(value)) if compared.decimals == 0 => Cell::Count(value as i64),
                (Some(compared), value) => {
                    Cell::number(value, compared.decimals.min(4 + 2 * usize::from(quantity.ends_with("_s"))))
                }
                (None, _) => Cell::Missing,
            };
            cells.push(cell(found.map(|c| c.published)));
            cells.push(cell(found.and_then(|c| c.ours)));
        }
        table.push(cells);
    }
    let blocks = BLOCKS.map(|(caption, of)| {
        let pair = |quantity: &&str| [format!("published_{quantity}"), format!("ours_{quantity}")];
        let columns: Vec<String> = std::iter::once("id".into()).chain(of.iter().flat_map(pair)).collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        table.block(caption, &columns)
    });
    table.parts = blocks.into_iter().filter(|part| part.columns.len() > 1).collect();
    table.notes.push(
        "First of each pair: as published. Columns without \u{201c}as published\u{201d} in their name that have a twin with it are put \
         right: discards counted once, ratios without degenerate triangles; empty where that changes nothing. Geometry has the edge \
         collapse in it, totals and fractions leave the normals out, as published."
            .into(),
    );
    (!rows.is_empty()).then_some(table)
}
