//! How well meshes stand for their isosurfaces.

use super::mesh_quality::purpose_label;
use crate::inputs::Inputs;
use crate::mesh_set::{MeshSet, known};
use crate::table::{Cell, Table};
use design::record::{Distribution, Purpose};

/// Distances in units of the spacing, and errors of the vertices' normals, for meshes of every purpose.
pub(super) fn accuracy(inputs: &Inputs<'_>) -> Option<Table> {
    let mut table = Table::new(
        "accuracy",
        "Meshes against their isosurfaces",
        &[
            ("id", "Id"),
            ("purpose", "Mesh"),
            ("spacing", "Spacing"),
            ("distance_mean", "Distance, mean"),
            ("distance_q95", "95 %"),
            ("distance_max", "max"),
            ("normal_error_mean_deg", "Normal error, deg, mean"),
            ("normal_error_q95_deg", "95 %"),
            ("normal_error_max_deg", "max"),
            ("lost_points", "Lost points"),
            ("lost_vertices", "Lost vertices"),
        ],
    );
    for purpose in [Purpose::Benchmark, Purpose::Stimulus, Purpose::Indexed] {
        for (_, mesh) in MeshSet::of(inputs, purpose).in_order() {
            let accuracy = &mesh.accuracy;
            let mut row =
                vec![Cell::text(&mesh.id), Cell::text(purpose_label(purpose)), Cell::Number(mesh.spacing, 3)];
            let statistics: [fn(&Distribution) -> f64; 3] = [|d| d.mean, |d| d.q95, |d| d.max];
            row.extend(statistics.map(|of| {
                let distance = known(&accuracy.distance, of);
                Cell::number(distance.map(|distance| distance / mesh.spacing), 4)
            }));
            row.extend(statistics.map(|of| Cell::number(known(&accuracy.normal_error_deg, of), 2)));
            row.extend([accuracy.lost_points, accuracy.lost_vertices].map(Cell::count));
            table.push(row);
        }
    }
    table.notes.push(
        "Distance: from points spread evenly over the mesh to the isosurface along the field's gradient, in units of \
         the spacing. Normal error: angle between a vertex's normal and the field's outward direction at its foot on \
         the isosurface. Lost: no surface within three spacings, or no normal; left out of the rest."
            .into(),
    );
    (!table.rows.is_empty()).then_some(table)
}
