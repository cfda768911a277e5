//! The published benchmark with ours beside it: one row a configuration, two columns a quantity.

use super::Compared;
use isostudy_table::{Cell, Columns, Table};

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
    let find = |row: &str, quantity: &str| all.iter().find(|c| c.row == *row && c.quantity == quantity);
    let cell = |compared: &Compared, value: Option<f64>| match value {
        Some(value) if compared.decimals == 0 => Cell::Count(value as i64),
        _ => {
            let most = 4 + 2 * usize::from(compared.quantity.ends_with("_s"));
            Cell::number(value, compared.decimals.min(most))
        }
    };
    let unit = |quantity: &str| match quantity {
        quantity if quantity.ends_with("_s") => "s",
        quantity if quantity.ends_with("_bytes") => "bytes",
        _ => "",
    };
    let mut table = Columns::over(&rows)
        .column("id", "Id", |row| Cell::text(row))
        // What is put right is there only where it makes a difference.
        .columns_of(&quantities, |all, quantity| {
            let words = quantity.trim_end_matches("_s").replace('_', " ");
            let [published, ours] = ["published", "ours"].map(|side| format!("{side}_{quantity}"));
            all.quantity(published, &words, unit(quantity), |row| {
                find(row, quantity).map_or(Cell::Missing, |c| cell(c, Some(c.published)))
            })
            .quantity(ours, "ours", unit(quantity), |row| {
                find(row, quantity).map_or(Cell::Missing, |c| cell(c, c.ours))
            })
        })
        .into_table("benchmark_beside", caption);
    let blocks = BLOCKS.map(|(caption, of)| {
        let pair = |quantity: &&str| [format!("published_{quantity}"), format!("ours_{quantity}")];
        let columns: Vec<String> = std::iter::once("id".into()).chain(of.iter().flat_map(pair)).collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        table.block(caption, &columns)
    });
    table.parts = blocks.into_iter().filter(|part| part.columns.len() > 1).collect();
    let table = table.with_note(
        "First of each pair: as published. Columns without \u{201c}as published\u{201d} in their name that have a twin with it are put \
         right: discards counted once, ratios without degenerate triangles; empty where that changes nothing. Geometry has the edge \
         collapse in it, totals and fractions leave the normals out, as published.",
    );
    table.unless_empty()
}
