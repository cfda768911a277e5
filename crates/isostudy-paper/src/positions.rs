//! What the original program's accumulated positions change.

use isostudy_design::record::{MeshRecord, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_table::{Cell, Columns, Table};

/// Name, heading, and the number of a mesh.
type Measure = (&'static str, &'static str, fn(&MeshRecord) -> Cell);

const MEASURES: [Measure; 7] = [
    ("vertices", "Vertices", |m| Cell::count(m.counts.vertices)),
    ("triangles", "Triangles", |m| Cell::count(m.counts.triangles)),
    ("boundary_edges", "Boundary edges", |m| Cell::count(m.topology.boundary_edges)),
    ("euler_characteristic", "Euler characteristic", |m| Cell::Count(m.topology.euler_characteristic)),
    ("degenerate", "Degenerate", |m| Cell::count(m.quality.degenerate)),
    ("edge_ratio_mean", "Edge ratio mean", |m| Cell::number(known(&m.quality.edge_ratio, |d| d.mean), 3)),
    ("published_aspect_ratio_mean", "Published ratio mean", |m| {
        Cell::number(known(&m.quality.published_aspect_ratio, |d| d.mean), 3)
    }),
];

/// Meshes from the study's positions beside meshes from indexed positions.
pub(super) fn table(inputs: &Inputs<'_>) -> Option<Table> {
    let studied = MeshSet::of(inputs, Purpose::Benchmark);
    let indexed = MeshSet::of(inputs, Purpose::Indexed);
    let both = studied
        .in_order()
        .filter_map(|(configuration, a)| Some((&configuration.id, [a, indexed.get(&configuration.id)?])));
    let table = Columns::over(both)
        .column("id", "Id", |(id, _)| Cell::text(id))
        .columns_of(MEASURES, |all, (name, heading, of)| {
            all.column(name, heading, move |(_, [studied, _])| of(studied)).column(
                format!("{name}_indexed"),
                "indexed",
                move |(_, [_, indexed])| of(indexed),
            )
        })
        .into_table("positions", "What accumulated lattice positions change");
    let table = table.with_note(
        "First of each pair: the study's positions, summed up in single precision as the original program does; \
         second: positions computed from indices. Where a surface touches its volume, rounding decides whether it \
         is cut open.",
    );
    table.unless_empty()
}
