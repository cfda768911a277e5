//! How well meshes stand for their isosurfaces.

use super::mesh_quality::purpose_label;
use isostudy_design::record::{Distribution, MeshRecord, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_table::{Cell, Table, field};

/// A mesh, and what it is for.
type Row<'a> = (Purpose, &'a MeshRecord);

fn in_spacings((_, mesh): &Row<'_>, distance: Option<f64>) -> Cell {
    Cell::number(distance.map(|d| d / mesh.spacing), 4)
}

/// Distances in units of the spacing, and errors of the vertices' normals, for meshes of every purpose.
pub(super) fn accuracy(inputs: &Inputs<'_>) -> Option<Table> {
    fn distance(of: &Row<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        in_spacings(of, known(&of.1.accuracy.distance, statistic))
    }
    fn back(of: &Row<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        let back = of.1.accuracy.distance_to_mesh.as_ref();
        in_spacings(of, back.and_then(|back| known(back, statistic)))
    }
    fn sharp(of: &Row<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        let sharp = of.1.accuracy.sharp_edges.as_ref();
        in_spacings(of, sharp.and_then(|sharp| known(sharp, statistic)))
    }
    fn normal(of: &Row<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        Cell::number(known(&of.1.accuracy.normal_error_deg, statistic), 2)
    }
    let fields = [
        field("id", "Id", |of: &Row<'_>| Cell::text(&of.1.id)),
        field("purpose", "Mesh", |of| Cell::text(purpose_label(of.0))),
        field("spacing", "Spacing", |of| Cell::Number(of.1.spacing, 3)),
        field("distance_mean", "Distance, mean", |of| distance(of, |d| d.mean)),
        field("distance_q95", "95 %", |of| distance(of, |d| d.q95)),
        field("distance_max", "max", |of| distance(of, |d| d.max)),
        field("distance_to_mesh_mean", "From the isosurface, mean", |of| back(of, |d| d.mean)),
        field("distance_to_mesh_q95", "95 %", |of| back(of, |d| d.q95)),
        field("distance_to_mesh_max", "max", |of| back(of, |d| d.max)),
        field("hausdorff", "Hausdorff", |of| in_spacings(of, of.1.accuracy.hausdorff())),
        field("sharp_edges_mean", "From sharp edges, mean", |of| sharp(of, |d| d.mean)),
        field("sharp_edges_q95", "95 %", |of| sharp(of, |d| d.q95)),
        field("sharp_edges_max", "max", |of| sharp(of, |d| d.max)),
        field("normal_error_mean_deg", "Normal error, deg, mean", |of| normal(of, |d| d.mean)),
        field("normal_error_q95_deg", "95 %", |of| normal(of, |d| d.q95)),
        field("normal_error_max_deg", "max", |of| normal(of, |d| d.max)),
        field("lost_points", "Lost points", |of| Cell::count(of.1.accuracy.lost_points)),
        field("lost_vertices", "Lost vertices", |of| Cell::count(of.1.accuracy.lost_vertices)),
    ];
    let purposes = [Purpose::Benchmark, Purpose::Stimulus, Purpose::Indexed];
    let rows = purposes.into_iter().flat_map(|purpose| {
        let meshes = MeshSet::of(inputs, purpose);
        meshes.in_order().map(|(_, mesh)| (purpose, mesh)).collect::<Vec<_>>()
    });
    let mut table = Table::of("accuracy", "Meshes against their isosurfaces", &fields, rows);
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
