//! How well meshes stand for their isosurfaces.

use super::mesh_quality::purpose_label;
use isostudy_design::record::{Distribution, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_table::{Cell, Table};

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
            ("distance_to_mesh_mean", "From the isosurface, mean"),
            ("distance_to_mesh_q95", "95 %"),
            ("distance_to_mesh_max", "max"),
            ("hausdorff", "Hausdorff"),
            ("sharp_edges_mean", "From sharp edges, mean"),
            ("sharp_edges_q95", "95 %"),
            ("sharp_edges_max", "max"),
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
            let in_spacings = |distance: Option<f64>| Cell::number(distance.map(|d| d / mesh.spacing), 4);
            let back = accuracy.distance_to_mesh.as_ref();
            row.extend(statistics.map(|of| in_spacings(known(&accuracy.distance, of))));
            row.extend(statistics.map(|of| in_spacings(back.and_then(|back| known(back, of)))));
            row.push(in_spacings(accuracy.hausdorff()));
            let sharp = accuracy.sharp_edges.as_ref();
            row.extend(statistics.map(|of| in_spacings(sharp.and_then(|sharp| known(sharp, of)))));
            row.extend(statistics.map(|of| Cell::number(known(&accuracy.normal_error_deg, of), 2)));
            row.extend([accuracy.lost_points, accuracy.lost_vertices].map(Cell::count));
            table.push(row);
        }
    }
    table.notes.push(
        "Distance: from 8,192 points spread evenly over the mesh to the isosurface (exact for sphere and mesh, along the \
         gradient for other fields), and from as many of the isosurface (of a mesh: of its triangles) to the mesh, in units of \
         the spacing. Hausdorff: the larger of both maxima. From sharp edges: from points of the isosurface where its normal turns by more than \
         30 degrees within a sixteenth of the spacing, to the mesh; empty if there are none. Normal error: angle between a vertex's normal and the field's outward direction at its foot on \
         the isosurface. Lost: no surface within three spacings, or no normal; left out of the rest."
            .into(),
    );
    (!table.rows.is_empty()).then_some(table)
}
