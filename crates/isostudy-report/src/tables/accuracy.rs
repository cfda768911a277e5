//! How well meshes stand for their isosurfaces.

use crate::distribution::purpose_name;
use crate::tables::parts::{PART, Part, parts};
use isostudy_design::record::{Distribution, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::known;
use isostudy_table::{Cell, Columns, Table};

fn in_spacings(of: &Part<'_>, distance: Option<f64>) -> Cell {
    Cell::number(distance.map(|d| d / of.mesh.spacing), 4)
}

/// Distances in units of the spacing, and errors of the vertices' normals, for meshes of every purpose.
pub(super) fn accuracy(inputs: &Inputs<'_>) -> Option<Table> {
    fn distance(of: &Part<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        in_spacings(of, known(&of.judged.accuracy.distance, statistic))
    }
    fn back(of: &Part<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        let back = of.judged.accuracy.distance_to_mesh.as_ref();
        in_spacings(of, back.and_then(|back| known(back, statistic)))
    }
    fn sharp(of: &Part<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        let sharp = of.judged.accuracy.sharp_edges.as_ref();
        in_spacings(of, sharp.and_then(|sharp| known(sharp, statistic)))
    }
    fn normal(of: &Part<'_>, statistic: fn(&Distribution) -> f64) -> Cell {
        Cell::number(known(&of.judged.accuracy.normal_error_deg, statistic), 2)
    }
    let purposes = [Purpose::Benchmark, Purpose::Stimulus, Purpose::Indexed];
    let rows = parts(inputs, &purposes);
    let has_regions = rows.iter().any(|of| of.judged.region.is_some());
    let mut table = Columns::over(rows)
        .column("id", "Id", |of| Cell::text(&of.mesh.id))
        .column("purpose", "Mesh", |of| Cell::text(purpose_name(of.purpose)))
        .columns_if(has_regions, |all| all.column("part", "Part", |of| Cell::text(of.name())))
        .column("spacing", "Spacing", |of| Cell::Number(of.mesh.spacing, 3))
        .column("distance_mean", "Distance, mean", |of| distance(of, |d| d.mean))
        .column("distance_q95", "95 %", |of| distance(of, |d| d.q95))
        .column("distance_max", "max", |of| distance(of, |d| d.max))
        .column("distance_to_mesh_mean", "From the isosurface, mean", |of| back(of, |d| d.mean))
        .column("distance_to_mesh_q95", "95 %", |of| back(of, |d| d.q95))
        .column("distance_to_mesh_max", "max", |of| back(of, |d| d.max))
        .column("hausdorff", "Hausdorff", |of| in_spacings(of, of.judged.accuracy.hausdorff()))
        .column("sharp_edges_mean", "From sharp edges, mean", |of| sharp(of, |d| d.mean))
        .column("sharp_edges_q95", "95 %", |of| sharp(of, |d| d.q95))
        .column("sharp_edges_max", "max", |of| sharp(of, |d| d.max))
        .quantity("normal_error_mean_deg", "Normal error, {}, mean", "deg", |of| normal(of, |d| d.mean))
        .quantity("normal_error_q95_deg", "95 %", "deg", |of| normal(of, |d| d.q95))
        .quantity("normal_error_max_deg", "max", "deg", |of| normal(of, |d| d.max))
        .column("lost_points", "Lost points", |of| Cell::count(of.judged.accuracy.lost_points))
        .column("lost_vertices", "Lost vertices", |of| Cell::count(of.judged.accuracy.lost_vertices))
        .into_table("accuracy", "Meshes against their isosurfaces");
    table.notes.push(
        "Distance: from 65,536 points spread evenly over the mesh to the isosurface (exact for sphere and mesh, along the \
         gradient for other fields), and from about 131,072 of the isosurface (of a mesh: of its triangles; else where evenly spread lines cross it) to the mesh, in units of \
         the spacing. Hausdorff: the larger of both maxima. From sharp edges: from points of the isosurface where its normal turns by more than \
         30 degrees within a sixteenth of the spacing, to the mesh; empty if there are none. Normal error: angle between a vertex's normal and the field's outward direction at its foot on \
         the isosurface. Lost: no surface within three spacings, or no normal; left out of the rest."
            .into(),
    );
    table.notes.extend(has_regions.then(|| PART.into()));
    (!table.rows.is_empty()).then_some(table)
}
