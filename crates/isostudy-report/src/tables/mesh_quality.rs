//! Triangle quality, topology, and what accumulated positions change.

use isostudy_design::record::{Distribution, MeshRecord, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_table::{Cell, Column, Table};

pub(super) fn purpose_label(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Benchmark => "benchmark",
        Purpose::Stimulus => "stimulus",
        Purpose::Indexed => "indexed",
    }
}

/// A measure: name, heading, decimals for people, and the distribution.
type Measure = (&'static str, &'static str, usize, fn(&MeshRecord) -> &Distribution);

const MEASURES: &[Measure] = &[
    ("edge_ratio", "Edge ratio", 3, |m| &m.quality.edge_ratio),
    ("published_aspect_ratio", "Published ratio", 3, |m| &m.quality.published_aspect_ratio),
    ("radius_ratio", "Radius ratio", 3, |m| &m.quality.radius_ratio),
    ("min_angle_deg", "Smallest angle, deg", 1, |m| &m.quality.min_angle_deg),
    ("max_angle_deg", "Largest angle, deg", 1, |m| &m.quality.max_angle_deg),
    ("area", "Area", 6, |m| &m.quality.area),
];

type Statistic = (&'static str, &'static str, fn(&Distribution) -> f64);

const STATISTICS: &[Statistic] = &[
    ("mean", "mean", |d| d.mean),
    ("sd", "SD", |d| d.sd),
    ("min", "min", |d| d.min),
    ("q05", "5 %", |d| d.q05),
    ("q25", "25 %", |d| d.q25),
    ("median", "median", |d| d.median),
    ("q75", "75 %", |d| d.q75),
    ("q95", "95 %", |d| d.q95),
    ("max", "max", |d| d.max),
];

/// Quality of the triangles at both spacings: every statistic in CSV; for people one block a measure.
pub(super) fn quality(inputs: &Inputs<'_>) -> Option<Table> {
    let mut table = Table::new(
        "quality",
        "Quality of the triangles",
        &[
            ("id", "Id"),
            ("purpose", "Mesh"),
            ("triangles", "Triangles"),
            ("degenerate", "Degenerate"),
            ("shortest_edge", "Shortest edge"),
        ],
    );
    for (measure, heading, ..) in MEASURES {
        for (statistic, short, _) in STATISTICS {
            let (name, heading) = (format!("{measure}_{statistic}"), format!("{heading}, {short}"));
            table.columns.push(Column { name, heading });
        }
    }
    for purpose in [Purpose::Benchmark, Purpose::Stimulus] {
        for (_, mesh) in MeshSet::of(inputs, purpose).in_order() {
            let mut row = vec![
                Cell::text(&mesh.id),
                Cell::text(purpose_label(purpose)),
                Cell::count(mesh.quality.triangles),
                Cell::count(mesh.quality.degenerate),
                Cell::number(mesh.quality.shortest_edge, 6),
            ];
            for (_, _, decimals, of) in MEASURES {
                let distribution = of(mesh);
                row.extend(STATISTICS.iter().map(|s| Cell::number(known(distribution, s.2), *decimals)));
            }
            table.push(row);
        }
    }
    let blocks: Vec<(&str, Vec<String>)> = MEASURES
        .iter()
        .map(|(measure, heading, ..)| {
            let fixed = ["id", "purpose", "degenerate", "shortest_edge"].map(String::from);
            let all = STATISTICS.iter().map(|(statistic, ..)| format!("{measure}_{statistic}"));
            (*heading, fixed.into_iter().chain(all).collect())
        })
        .collect();
    for (heading, columns) in &blocks {
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let mut part = table.block(heading, &columns);
        for (column, (_, short, _)) in part.columns[4..].iter_mut().zip(STATISTICS) {
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
    (!table.rows.is_empty()).then_some(table)
}

/// Columns of the trilinear truth.
const TRUTHS: [(&str, &str); 4] = [
    ("trilinear_components", "Components of the interpolant"),
    ("trilinear_euler_characteristic", "Euler characteristic of the interpolant"),
    ("tunnel_cells", "Cells with a tunnel"),
    ("cells_otherwise", "Cells decided otherwise"),
];
const TRUTHS_NOTE: &str = "The interpolant: the level set of the samples, interpolated trilinearly in each cell, counted exactly. Cells decided \
     otherwise: those in which the method joins what the interpolant keeps apart, or the other way round. Nothing stands where the \
     method's samples are not the corners of the cells, or it does not decide by cells.";

/// Topology of the meshes at both spacings.
pub(super) fn topology(inputs: &Inputs<'_>) -> Option<Table> {
    let mut table = Table::new(
        "topology",
        "Topology of the meshes",
        &[
            ("id", "Id"),
            ("purpose", "Mesh"),
            ("vertices", "V"),
            ("edges", "E"),
            ("triangles", "T"),
            ("euler_characteristic", "Euler characteristic"),
            ("components", "Components"),
            ("boundary_edges", "Boundary edges"),
            ("non_manifold_edges", "Non-manifold edges"),
            ("non_manifold_vertices", "Non-manifold vertices"),
            ("misoriented_edges", "Misoriented edges"),
            ("duplicate_faces", "Duplicate faces"),
            ("folded_faces", "Folded faces"),
            ("self_intersections", "Intersecting pairs"),
        ],
    );
    let mut meshes: Vec<(Purpose, &MeshRecord)> = Vec::new();
    for purpose in [Purpose::Benchmark, Purpose::Stimulus] {
        meshes.extend(MeshSet::of(inputs, purpose).in_order().map(|(_, mesh)| (purpose, mesh)));
    }
    // What the samples' interpolant has, where some method's samples are those of cells.
    let has_truth = meshes.iter().any(|(_, mesh)| mesh.trilinear.is_some());
    if has_truth {
        for (name, heading) in TRUTHS {
            table.columns.push(Column { name: name.into(), heading: heading.into() });
        }
        table.notes.push(TRUTHS_NOTE.into());
    }
    for (purpose, mesh) in meshes {
        let t = &mesh.topology;
        let mut row = vec![
            Cell::text(&mesh.id),
            Cell::text(purpose_label(purpose)),
            Cell::count(t.vertices),
            Cell::count(t.edges),
            Cell::count(t.triangles),
            Cell::Count(t.euler_characteristic),
            Cell::count(t.components),
            Cell::count(t.boundary_edges),
            Cell::count(t.non_manifold_edges),
            Cell::count(t.non_manifold_vertices),
            Cell::count(t.misoriented_edges),
            Cell::count(t.duplicate_faces),
            Cell::count(t.folded_faces),
            t.self_intersections.map_or(Cell::Missing, Cell::count),
        ];
        if has_truth {
            let of = mesh.trilinear.as_ref();
            row.push(of.map_or(Cell::Missing, |of| Cell::count(of.components)));
            row.push(of.map_or(Cell::Missing, |of| Cell::Count(of.euler_characteristic)));
            row.push(of.map_or(Cell::Missing, |of| Cell::count(of.tunnel_cells)));
            row.push(of.and_then(|of| of.cells_otherwise).map_or(Cell::Missing, Cell::count));
        }
        table.push(row);
    }
    (!table.rows.is_empty()).then_some(table)
}
