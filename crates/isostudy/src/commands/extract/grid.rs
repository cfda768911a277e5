//! The surface of a grid on its own cells, of `--grid`.

use super::quality_report::{intersecting, state_of};
use super::{Arguments, format, tell_made, write};
use crate::outcome::Outcome;
use crate::source::Inside;
use crate::terminal::{counted, grouped, say, significant};
use crate::{grid_file, records};
use anyhow::{Context, Result, bail};
use isostudy_design::record::{Quality, Topology};
use isostudy_grid::{Grid, Surface};
use serde::Serialize;
use std::path::Path;
use std::time::{Duration, Instant};

/// The version of the JSON.
const SCHEMA: u32 = 1;

/// Extracts, writes and reports.
///
/// # Errors
/// If the grid cannot be read or has no surface there, or a file cannot be written.
pub(super) fn extract(arguments: &Arguments, path: &Path) -> Result<Outcome> {
    let out = arguments.out.as_deref().context("-o is needed")?;
    let format = format(arguments, out)?;
    let options = arguments.source.options();
    let grid = grid_file::read(path, arguments.array.as_deref(), arguments.source.limit())?;
    let inside = options.inside.unwrap_or(Inside::Above);
    let (grid, isovalue) = match inside {
        Inside::Above => (grid, options.isovalue),
        Inside::Below => (grid.negated(), -options.isovalue),
    };
    let began = Instant::now();
    let surface = grid.extract(f64::from(isovalue));
    let time = began.elapsed();
    if surface.mesh.triangles.is_empty() {
        bail!(
            "{}: no surface at isovalue {}: {}",
            path.display(),
            options.isovalue,
            values_of(&grid, inside)
        );
    }
    write(arguments, out, format, &surface.mesh)?;
    if !arguments.json {
        tell_made(out, surface.mesh.triangles.len() as u64, surface.mesh.positions.len() as u64, time);
    }
    if arguments.quality || arguments.json {
        let name = path.display().to_string();
        let report =
            Report::new((name, arguments.array.clone()), &grid, (options.isovalue, inside), &surface, time);
        say(&if arguments.json { serde_json::to_string_pretty(&report)? } else { report.to_text() })?;
    }
    if !arguments.json {
        say(&out.display().to_string())?;
    }
    Ok(Outcome::Done)
}

/// What is known of the values, for a surface that is not there.
fn values_of(grid: &Grid, inside: Inside) -> String {
    match (grid.value_range(), inside) {
        (None, _) => "no tetrahedron has values".to_owned(),
        (Some([low, high]), Inside::Above) => format!("the values run from {low} to {high}"),
        // They were turned round.
        (Some([low, high]), Inside::Below) => format!("the values run from {} to {}", -high, -low),
    }
}

/// What the surface is worth.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// The file.
    source: String,
    /// The array, if it was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    array: Option<String>,
    points: u64,
    /// Those of the file that were cut into tetrahedra.
    cells: u64,
    tetrahedra: u64,
    crossed_tetrahedra: u64,
    isovalue: f32,
    inside: Inside,
    /// Wall-clock time of the extraction, seconds.
    extraction_s: f64,
    area: f64,
    /// The enclosed volume, if the mesh is closed.
    volume: Option<f64>,
    quality: Quality,
    topology: Topology,
    boundary_loops: u64,
}

impl Report {
    fn new(
        (source, array): (String, Option<String>),
        grid: &Grid,
        (isovalue, inside): (f32, Inside),
        surface: &Surface,
        time: Duration,
    ) -> Self {
        let mesh = &surface.mesh;
        let topology = isostudy_mesh::topology::topology(mesh);
        Self {
            schema: SCHEMA,
            source,
            array,
            points: grid.points().len() as u64,
            cells: grid.cells().solid,
            tetrahedra: grid.tetrahedra().len() as u64,
            crossed_tetrahedra: surface.crossed_tetrahedra,
            isovalue,
            inside,
            extraction_s: time.as_secs_f64(),
            area: mesh.area(),
            volume: (topology.boundary_edges == 0).then(|| mesh.volume()),
            quality: records::quality(&isostudy_mesh::quality::quality(mesh)),
            boundary_loops: topology.boundary_loops,
            topology: records::topology(&topology, mesh),
        }
    }

    /// As lines for people.
    fn to_text(&self) -> String {
        let (q, t) = (&self.quality, &self.topology);
        let [points, cells, tetrahedra, crossed] =
            [self.points, self.cells, self.tetrahedra, self.crossed_tetrahedra].map(grouped);
        let rows = [
            (
                "grid",
                format!("{points} points, {cells} cells, {tetrahedra} tetrahedra, {crossed} of them crossed"),
            ),
            ("time", format!("{:.3} s", self.extraction_s)),
            ("vertices", t.vertices.to_string()),
            ("triangles", q.triangles.to_string()),
            (
                "topology",
                format!(
                    "{}; {}, Euler characteristic {}, {}",
                    state_of(t),
                    counted(t.components, "component"),
                    t.euler_characteristic,
                    counted(self.boundary_loops, "boundary loop")
                ),
            ),
            ("intersections", intersecting(t.self_intersections)),
            ("area", significant(self.area)),
            ("volume", self.volume.map_or_else(|| "none: the surface is open".into(), significant)),
            ("radius ratio", format!("mean {:.4}, smallest {:.4}", q.radius_ratio.mean, q.radius_ratio.min)),
            ("without area", format!("{} triangles", q.degenerate)),
        ];
        rows.map(|(name, value)| format!("{name:<15} {value}")).join("\n")
    }
}
