//! What the original program's accumulated positions change.

use isostudy_design::record::{MeshRecord, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_table::{Cell, Table};

/// Meshes from the study's positions beside meshes from indexed positions.
pub(super) fn table(inputs: &Inputs<'_>) -> Option<Table> {
    let studied = MeshSet::of(inputs, Purpose::Benchmark);
    let indexed = MeshSet::of(inputs, Purpose::Indexed);
    let mut table = Table::new(
        "positions",
        "What accumulated lattice positions change",
        &[
            ("id", "Id"),
            ("vertices", "Vertices"),
            ("vertices_indexed", "indexed"),
            ("triangles", "Triangles"),
            ("triangles_indexed", "indexed"),
            ("boundary_edges", "Boundary edges"),
            ("boundary_edges_indexed", "indexed"),
            ("euler_characteristic", "Euler characteristic"),
            ("euler_characteristic_indexed", "indexed"),
            ("degenerate", "Degenerate"),
            ("degenerate_indexed", "indexed"),
            ("edge_ratio_mean", "Edge ratio mean"),
            ("edge_ratio_mean_indexed", "indexed"),
            ("published_aspect_ratio_mean", "Published ratio mean"),
            ("published_aspect_ratio_mean_indexed", "indexed"),
        ],
    );
    for (configuration, a) in studied.in_order() {
        let Some(b) = indexed.get(&configuration.id) else { continue };
        let mut row = vec![Cell::text(&configuration.id)];
        for of in [
            |m: &MeshRecord| Cell::count(m.counts.vertices),
            |m: &MeshRecord| Cell::count(m.counts.triangles),
            |m: &MeshRecord| Cell::count(m.topology.boundary_edges),
            |m: &MeshRecord| Cell::Count(m.topology.euler_characteristic),
            |m: &MeshRecord| Cell::count(m.quality.degenerate),
            |m: &MeshRecord| Cell::number(known(&m.quality.edge_ratio, |d| d.mean), 3),
            |m: &MeshRecord| Cell::number(known(&m.quality.published_aspect_ratio, |d| d.mean), 3),
        ] {
            row.extend([of(a), of(b)]);
        }
        table.push(row);
    }
    table.notes.push(
        "First of each pair: the study's positions, summed up in single precision as the original program does; \
         second: positions computed from indices. Where a surface touches its volume, rounding decides whether it \
         is cut open."
            .into(),
    );
    (!table.rows.is_empty()).then_some(table)
}
