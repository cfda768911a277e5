//! The paper's extract of its benchmark.

use isostudy_design::config::FieldSection;
use isostudy_inference::inputs::Inputs;
use isostudy_report::benchmark_of_objects;
use isostudy_table::Table;

/// The asteroid alone, in fewer columns. `None` for a study without an asteroid.
pub(super) fn table(inputs: &Inputs<'_>) -> Option<Table> {
    const COLUMNS: &[&str] = &[
        "id",
        "vertex_s",
        "geometry_s",
        "vertices",
        "triangles",
        "aspect_ratio_mean",
        "aspect_ratio_sd",
        "discard_fraction",
        "discard_fraction_as_published",
    ];
    let is_asteroid = |o: usize| matches!(inputs.study.file.objects[o].field, FieldSection::Asteroid {});
    let whole = benchmark_of_objects(inputs, is_asteroid)?;
    let mut table = whole.block("Benchmark of the asteroid", COLUMNS);
    table.name = "asteroid".into();
    table.notes = whole.notes;
    Some(table)
}
