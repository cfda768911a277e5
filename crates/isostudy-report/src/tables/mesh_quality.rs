//! Triangle quality, topology, and what accumulated positions change.

use crate::distribution::{STATISTICS, purpose_name};
use crate::tables::parts::{PART, parts};
use isostudy_design::record::{
    Distribution, MOST_INTERSECTIONS, MeshRecord, Purpose, Quality, Topology, Trilinear,
};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_table::{Cell, Columns, Table};

/// A measure: name, heading, unit, decimals for people, and the distribution.
type Measure = (&'static str, &'static str, &'static str, usize, for<'a> fn(&'a Quality) -> &'a Distribution);

const MEASURES: &[Measure] = &[
    ("edge_ratio", "Edge ratio", "", 3, |q| &q.edge_ratio),
    ("published_aspect_ratio", "Published ratio", "", 3, |q| &q.published_aspect_ratio),
    ("radius_ratio", "Radius ratio", "", 3, |q| &q.radius_ratio),
    ("min_angle_deg", "Smallest angle, {}", "deg", 1, |q| &q.min_angle_deg),
    ("max_angle_deg", "Largest angle, {}", "deg", 1, |q| &q.max_angle_deg),
    ("area", "Area", "", 6, |q| &q.area),
];

/// The meshes at both spacings, with what they are for.
fn meshes<'a>(inputs: &Inputs<'a>) -> Vec<(Purpose, &'a MeshRecord)> {
    let of = |purpose| MeshSet::of(inputs, purpose).in_order().map(|(_, mesh)| (purpose, mesh)).collect();
    [Purpose::Benchmark, Purpose::Stimulus].into_iter().flat_map::<Vec<_>, _>(of).collect()
}

/// Quality of the triangles at both spacings: every statistic in CSV; for people one block a measure.
pub(super) fn quality(inputs: &Inputs<'_>) -> Option<Table> {
    let rows = parts(inputs, &[Purpose::Benchmark, Purpose::Stimulus]);
    let has_regions = rows.iter().any(|of| of.judged.region.is_some());
    let mut table = Columns::over(rows)
        .column("id", "Id", |of| Cell::text(&of.mesh.id))
        .column("purpose", "Mesh", |of| Cell::text(purpose_name(of.purpose)))
        .columns_if(has_regions, |all| {
            all.column("part", "Part", |of| Cell::text(of.name())).column(
                "area_share",
                "Share of the area",
                |of| Cell::number(of.area_share(), 3),
            )
        })
        .column("triangles", "Triangles", |of| Cell::count(of.judged.quality.triangles))
        .column("degenerate", "Degenerate", |of| Cell::count(of.judged.quality.degenerate))
        .column("shortest_edge", "Shortest edge", |of| Cell::number(of.judged.quality.shortest_edge, 6))
        .columns_of(MEASURES, |all, (measure, heading, unit, decimals, of)| {
            all.columns_of(STATISTICS, |all, (statistic, short, value)| {
                let (name, heading) = (format!("{measure}_{statistic}"), format!("{heading}, {short}"));
                all.quantity(name, &heading, unit, |row| {
                    Cell::number(known(of(row.judged.quality), *value), *decimals)
                })
            })
        })
        .into_table("quality", "Quality of the triangles");
    for (measure, heading, unit, ..) in MEASURES {
        let own = STATISTICS.iter().map(|(statistic, ..)| format!("{measure}_{statistic}"));
        let own: Vec<String> = own.collect();
        let fixed: &[&str] = match has_regions {
            true => &["id", "purpose", "part", "degenerate", "shortest_edge"],
            false => &["id", "purpose", "degenerate", "shortest_edge"],
        };
        let columns: Vec<&str> = fixed.iter().copied().chain(own.iter().map(String::as_str)).collect();
        let mut part = table.block(&heading.replace("{}", unit), &columns);
        for (column, (_, short, _)) in part.columns[fixed.len()..].iter_mut().zip(STATISTICS) {
            column.heading = (*short).into();
        }
        table.parts.push(part);
    }
    table.notes.push(
        "Edge ratio: longest over shortest edge. Published ratio: longer over shorter of the two edges at the first \
         corner. Radius ratio: twice the inscribed over the circumscribed radius, 1 for an equilateral triangle. \
         SD: population standard deviation. Degenerate triangles are left out of everything but the area and \
         the shortest edge, which is in scene units."
            .into(),
    );
    table.notes.extend(has_regions.then(|| PART.into()));
    table.unless_empty()
}

const TRUTHS_NOTE: &str = "The interpolant: the level set of the samples, interpolated trilinearly in each cell, counted exactly. Cells decided \
     otherwise: those in which the method joins what the interpolant keeps apart, or the other way round. Nothing stands where the \
     method's samples are not the corners of the cells, or it does not decide by cells.";

/// Where meshes have too many intersections to be counted.
const INTERSECTIONS_NOTE: &str = "Counting of intersecting pairs ends at 1,000,000: that number means at least as many. Nothing stands \
     where triangles lie so close to each other that the search was given up.";

/// Topology of the meshes at both spacings.
pub(super) fn topology(inputs: &Inputs<'_>) -> Option<Table> {
    let meshes = meshes(inputs);
    // What the samples' interpolant has, where some method's samples are those of cells.
    let has_regions = meshes.iter().any(|(_, mesh)| mesh.region.is_some());
    let has_truth = meshes.iter().any(|(_, mesh)| mesh.trilinear.is_some());
    let is_uncounted = meshes
        .iter()
        .any(|(_, mesh)| mesh.topology.self_intersections.is_none_or(|pairs| pairs >= MOST_INTERSECTIONS));
    let count = |count: fn(&Topology) -> u64| {
        move |(_, mesh): &(Purpose, &MeshRecord)| Cell::count(count(&mesh.topology))
    };
    let truth = |truth: fn(&Trilinear) -> Option<i64>| {
        move |(_, mesh): &(Purpose, &MeshRecord)| {
            mesh.trilinear.as_ref().and_then(truth).map_or(Cell::Missing, Cell::Count)
        }
    };
    let mut table = Columns::over(meshes)
        .column("id", "Id", |(_, mesh)| Cell::text(&mesh.id))
        .column("purpose", "Mesh", |(purpose, _)| Cell::text(purpose_name(*purpose)))
        .column("vertices", "V", count(|t| t.vertices))
        .column("edges", "E", count(|t| t.edges))
        .column("triangles", "T", count(|t| t.triangles))
        .column("euler_characteristic", "Euler characteristic", |(_, mesh)| {
            Cell::Count(mesh.topology.euler_characteristic)
        })
        .column("components", "Components", count(|t| t.components))
        .column("boundary_edges", "Boundary edges", count(|t| t.boundary_edges))
        .column("non_manifold_edges", "Non-manifold edges", count(|t| t.non_manifold_edges))
        .column("non_manifold_vertices", "Non-manifold vertices", count(|t| t.non_manifold_vertices))
        .column("misoriented_edges", "Misoriented edges", count(|t| t.misoriented_edges))
        .column("duplicate_faces", "Duplicate faces", count(|t| t.duplicate_faces))
        .column("folded_faces", "Folded faces", count(|t| t.folded_faces))
        .column("self_intersections", "Intersecting pairs", |(_, mesh)| {
            mesh.topology.self_intersections.map_or(Cell::Missing, Cell::count)
        })
        .columns_if(has_regions, |all| {
            all.column("self_intersections_judged", "Intersecting pairs in the region", |(_, mesh)| {
                mesh.judged().self_intersections.map_or(Cell::Missing, Cell::count)
            })
        })
        .columns_if(has_truth, |all| {
            all.column(
                "trilinear_components",
                "Components of the interpolant",
                truth(|of| i64::try_from(of.components).ok()),
            )
            .column(
                "trilinear_euler_characteristic",
                "Euler characteristic of the interpolant",
                truth(|of| Some(of.euler_characteristic)),
            )
            .column("tunnel_cells", "Cells with a tunnel", truth(|of| i64::try_from(of.tunnel_cells).ok()))
            .column(
                "cells_otherwise",
                "Cells decided otherwise",
                truth(|of| i64::try_from(of.cells_otherwise?).ok()),
            )
        })
        .into_table("topology", "Topology of the meshes");
    table.notes.extend(has_truth.then(|| TRUTHS_NOTE.into()));
    table.notes.extend(is_uncounted.then(|| INTERSECTIONS_NOTE.into()));
    table.unless_empty()
}
