//! `isostudy extract` without a study: a formula, a volume or a mesh becomes a surface in a file.

use crate::args::{Run, Selection};
use crate::chosen_method::{self, Told};
use crate::source::{Inside, Source, SourceArguments, place};
use crate::store::{write_whole, write_whole_by};
use crate::{Outcome, counted, input, mesh_file, prepare, records, say, significant};
use anyhow::{Context, Result, bail};
use clap::{ArgGroup, Args};
use design::record::{Accuracy, Counts, Distribution, Quality, Topology};
use extract::{Arrangement, Clustering, Execution, Extraction, Extractor, Grid, Method, Tetrahedra};
use field::ScalarField;
use mesh::TriangleMesh;
use raster::{Camera, Look, Shading, Viewport};
use serde::de::IntoDeserializer;
use serde::de::value::{Error as NameError, StrDeserializer};
use serde::{Deserialize, Serialize};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// The version of the JSON.
const SCHEMA: u32 = 1;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("source").args(["study", "field", "volume", "mesh"]).required(true)))]
#[command(after_help = "\
Examples:
  isostudy extract --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2 --spacing 0.05 -o ball.ply
  isostudy extract --volume head.nrrd --isovalue 300.5 -o head.glb --quality
  isostudy extract --mesh scan.stl --cells 200 -o even.obj --picture even.png --method bi-relaxed
  isostudy extract configs/paper.toml --only ss_bi")]
pub(crate) struct Extract {
    /// Study file, such as configs/paper.toml: extract its meshes and measure them
    #[arg(conflicts_with_all = ["bounds", "spacing", "cells", "isovalue", "inside", "close", "allow_open", "memory"])]
    study: Option<PathBuf>,
    #[command(flatten)]
    source: SourceArguments,
    /// How sample points fill space: body-centred, simple-cubic, five-tetrahedra, face-centred
    #[arg(long, value_name = "NAME", default_value = "body-centred", value_parser = named::<Arrangement>, conflicts_with = "study")]
    arrangement: Arrangement,
    /// How vertices are merged: none, integrated, edge-collapse, integrated-collapse; the last two arrangements have no
    /// integrated clustering [default: integrated; edge-collapse where there is none]
    #[arg(long, value_name = "NAME", value_parser = named::<Clustering>, conflicts_with = "study")]
    clustering: Option<Clustering>,
    /// A method by its name instead, such as bi-relaxed; `isostudy methods` lists them
    #[arg(long, value_name = "ID", value_parser = chosen_method::preset, conflicts_with_all = ["study", "recipe", "arrangement", "clustering"])]
    method: Option<Method>,
    /// A method as a study file has it instead: '{ kind = "tetrahedra", arrangement = "body-centred", placement = "relaxed" }'
    #[arg(long, value_name = "TOML", value_parser = chosen_method::recipe, conflicts_with_all = ["study", "arrangement", "clustering"])]
    recipe: Option<Method>,
    /// Mesh to write, .obj, .ply, .stl or .glb; of a study, the folder for results [default: results/<study id>]
    #[arg(long, short, value_name = "FILE", required_unless_present = "study")]
    out: Option<PathBuf>,
    /// Draw the surface as well, z up, 800 pixels square
    #[arg(long, value_name = "PNG", conflicts_with = "study")]
    picture: Option<PathBuf>,
    /// Print what the mesh is worth: triangles, topology, distance to the surface
    #[arg(long, conflicts_with = "study")]
    quality: bool,
    /// Print that as JSON
    #[arg(long, conflicts_with = "study")]
    json: bool,
    /// Threads to work with; 0 takes every core. The mesh is the same bytes with any number
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
    /// Of a study, redo what is up to date as well
    #[arg(long, conflicts_with_all = ["field", "volume", "mesh"])]
    force: bool,
    /// Of a study, run the programs that it names as methods; they may do whatever you may do
    #[arg(long, conflicts_with_all = ["field", "volume", "mesh"])]
    allow_programs: bool,
    /// Of a study, only these configurations, such as ss_bi [default: all]
    #[arg(long, value_name = "ID", value_delimiter = ',', conflicts_with_all = ["field", "volume", "mesh"])]
    only: Vec<String>,
}

impl Extract {
    /// What is asked of a study, if one is given.
    pub(crate) fn of_study(&self) -> Option<Selection> {
        let study = self.study.clone()?;
        let run = Run {
            study,
            out: self.out.clone(),
            force: self.force,
            threads: self.threads,
            allow_programs: self.allow_programs,
        };
        Some(Selection { run, only: self.only.clone() })
    }

    fn method(&self) -> Method {
        self.method.or(self.recipe).unwrap_or_else(|| {
            let clustering = self.clustering.unwrap_or(match self.arrangement {
                Arrangement::BodyCentred | Arrangement::SimpleCubic => Clustering::Integrated,
                Arrangement::FiveTetrahedra | Arrangement::FaceCentred => Clustering::EdgeCollapse,
            });
            Method::Tetrahedra(Tetrahedra { clustering, ..Tetrahedra::new(self.arrangement) })
        })
    }
}

/// What a study calls it.
pub(crate) fn named<T: for<'de> Deserialize<'de>>(text: &str) -> Result<T, String> {
    let name: StrDeserializer<'_, NameError> = text.into_deserializer();
    T::deserialize(name).map_err(|error| error.to_string())
}

/// Extracts, writes and reports. A surface that was to be closed and is not fails the check.
///
/// # Errors
/// If the input cannot be read, has no inside, or has no surface there; if a file cannot be written.
pub(crate) fn extract(arguments: &Extract) -> Result<Outcome> {
    let out = arguments.out.as_deref().context("-o is needed")?;
    let format = mesh_file::format_to_write(out).with_context(|| out.display().to_string())?;
    check_outputs(arguments, out)?;
    let source =
        arguments.source.read()?.context("one of a study, --field, --volume and --mesh is needed")?;
    let grid = source.grid();
    let method = arguments.method();
    let execution = Execution { threads: arguments.threads as usize };
    prepare::check_limit(&method, &grid, &execution, source.held, arguments.source.limit())
        .with_context(|| source.place())?;
    let field: &dyn ScalarField = &*source.field;
    let extraction =
        method.extract(&mut Extractor::new(), field.into(), &grid, source.isovalue, &execution)?;
    if extraction.mesh.triangles.is_empty() {
        bail!(source.no_surface());
    }
    write_whole_by(out, |file| {
        let mut buffered = BufWriter::new(file);
        format.write(&extraction.mesh, &mut buffered)?;
        buffered.flush()
    })?;
    if let Some(path) = &arguments.picture {
        write_whole(path, &picture(&extraction.mesh)?)?;
    }
    if arguments.quality || arguments.json {
        let accuracy =
            extract::accuracy(&extraction.mesh, &*source.field, source.isovalue, &grid, &execution)?;
        let cells = method.cells(&grid)?;
        let report = Report::new(method, &source, (&grid, cells), &extraction, &accuracy);
        say(&if arguments.json { serde_json::to_string_pretty(&report)? } else { report.to_text()? })?;
    }
    // With --json standard output is JSON and nothing else.
    if !arguments.json {
        say(&out.display().to_string())?;
    }
    if source.is_closed
        && let Some(found) = open_edges(&extraction.mesh)
    {
        tell!("isostudy: {}: the surface was to be closed and has {found}", out.display());
        return Ok(Outcome::CheckFailed);
    }
    Ok(Outcome::Sound)
}

/// How many boundary edges a mesh has, and where one of them is; `None` if it has none.
fn open_edges(mesh: &TriangleMesh) -> Option<String> {
    let [from, to] = mesh::topology::first_boundary_edge(mesh)?;
    let edges = mesh::topology::topology(mesh).boundary_edges;
    Some(format!("{}, one from {} to {}", counted(edges, "boundary edge"), place(from), place(to)))
}

/// Nothing that was given is written over; and no output over another, since no mesh ends as pictures do.
fn check_outputs(arguments: &Extract, out: &Path) -> Result<()> {
    let outputs = [Some(out), arguments.picture.as_deref()];
    for output in outputs.into_iter().flatten() {
        if arguments.source.file().is_some_and(|file| input::is_same(file, output)) {
            bail!("{}: is the input; it would be written over", output.display());
        }
    }
    let Some(picture) = &arguments.picture else { return Ok(()) };
    if !picture.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("--picture {}: pictures are .png", picture.display());
    }
    Ok(())
}

fn picture(mesh: &TriangleMesh) -> Result<Vec<u8>> {
    let bounds = mesh.bounds().context("there is nothing to draw")?;
    let viewport = Viewport { width: 800, height: 800, supersampling: 2 };
    let picture =
        raster::render(mesh, &Camera::around(&bounds), viewport, &Shading::default(), Look::Smooth)?;
    Ok(raster::pixmap_to_png(&picture))
}

/// What a mesh is worth.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// The formula or the file.
    source: String,
    bounds: [[f32; 3]; 2],
    method: Told,
    /// What tetrahedra have; no key where the method is none of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    arrangement: Option<Arrangement>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clustering: Option<Clustering>,
    isovalue: f32,
    inside: Inside,
    spacing: f32,
    cells: [u32; 3],
    /// Wall-clock time of the extraction, seconds.
    extraction_s: f64,
    area: f64,
    /// The enclosed volume, if the mesh is closed.
    volume: Option<f64>,
    counts: Counts,
    quality: Quality,
    topology: Topology,
    boundary_loops: u64,
    accuracy: Accuracy,
}

impl Report {
    fn new(
        method: Method,
        source: &Source,
        (grid, cells): (&Grid, [u32; 3]),
        extraction: &Extraction,
        accuracy: &extract::Accuracy,
    ) -> Self {
        let topology = mesh::topology::topology(&extraction.mesh);
        let is_closed = topology.boundary_edges == 0;
        let of = match method {
            Method::Tetrahedra(of) => Some(of),
            _ => None,
        };
        Self {
            schema: SCHEMA,
            source: source.name.clone(),
            bounds: [source.bounds.min.to_array(), source.bounds.max.to_array()],
            method: Told::of(method),
            arrangement: of.map(|of| of.arrangement),
            clustering: of.map(|of| of.clustering),
            isovalue: source.asked_isovalue(),
            inside: source.inside,
            spacing: grid.spacing,
            cells,
            extraction_s: extraction.times.total().as_secs_f64(),
            area: extraction.mesh.area(),
            volume: is_closed.then(|| extraction.mesh.volume()),
            counts: records::counts(&extraction.counts),
            quality: records::quality(&mesh::quality::quality(&extraction.mesh)),
            boundary_loops: topology.boundary_loops,
            topology: records::topology(&topology),
            accuracy: records::accuracy(accuracy),
        }
    }

    fn to_text(&self) -> Result<String> {
        let [x, y, z] = self.cells;
        let (q, t) = (&self.quality, &self.topology);
        let faults = [
            ("boundary edges", t.boundary_edges),
            ("edges with more than two triangles", t.non_manifold_edges),
            ("edges between opposite sides", t.misoriented_edges),
            ("vertices with more than one fan", t.non_manifold_vertices),
            ("triangles twice", t.duplicate_faces),
        ];
        let faults: Vec<String> =
            faults.iter().filter(|f| f.1 > 0).map(|(name, count)| format!("{count} {name}")).collect();
        let state = if faults.is_empty() { "closed manifold".to_owned() } else { faults.join(", ") };
        let lattice = self.arrangement.map_or_else(String::new, |of| format!("{of}, "));
        let rows = [
            ("method", self.method.to_text()?),
            ("lattice", format!("{lattice}{x} x {y} x {z} cubes of {}", self.spacing)),
            ("clustering", self.clustering.map_or_else(|| "none".into(), |of| of.to_string())),
            ("time", format!("{:.3} s", self.extraction_s)),
            ("vertices", t.vertices.to_string()),
            ("triangles", q.triangles.to_string()),
            (
                "topology",
                format!(
                    "{state}; {}, Euler characteristic {}, {}",
                    counted(t.components, "component"),
                    t.euler_characteristic,
                    counted(self.boundary_loops, "boundary loop")
                ),
            ),
            ("area", significant(self.area)),
            ("volume", self.volume.map_or_else(|| "none: the surface is open".into(), significant)),
            (
                "radius ratio",
                format!(
                    "mean {:.4}, 5 % below {:.4}, smallest {:.4}",
                    q.radius_ratio.mean, q.radius_ratio.q05, q.radius_ratio.min
                ),
            ),
            (
                "smallest angle",
                format!("mean {:.1} deg, smallest {:.2} deg", q.min_angle_deg.mean, q.min_angle_deg.min),
            ),
            ("without area", format!("{} triangles", q.degenerate)),
            ("to the surface", way(&self.accuracy.distance) + &lost(self.accuracy.lost_points)),
            ("from it", self.accuracy.distance_to_mesh.as_ref().map_or_else(String::new, way)),
        ];
        Ok(rows.map(|(name, value)| format!("{name:<15} {value}")).join("\n"))
    }
}

/// Distances one way.
fn way(distances: &Distribution) -> String {
    format!("mean {:.3e}, largest {:.3e} (over {} points)", distances.mean, distances.max, distances.count)
}

fn lost(points: u64) -> String {
    if points == 0 { String::new() } else { format!(", {} without a distance", counted(points, "point")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_open_is_said_with_its_place() {
        let positions = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
        let mut mesh = TriangleMesh {
            positions: positions.map(glam::Vec3::from).to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
            ..TriangleMesh::default()
        };
        assert_eq!(open_edges(&mesh), None);
        mesh.triangles.remove(0);
        let want = "3 boundary edges, one from [0.0, 0.0, 0.0] to [1.5, 0.0, 0.0]";
        assert_eq!(open_edges(&mesh).as_deref(), Some(want));
    }
}
