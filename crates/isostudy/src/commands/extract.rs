//! `isostudy extract`: the meshes of a study, or the surface of a formula, or of a volume, a mesh, points or soup in a file.

mod chosen_method;
mod finished;
mod frames;
mod grid;
mod isovalues;
mod labels;
mod own_cells;
mod quality_report;

use super::named::named;
use super::source_arguments::SourceArguments;
use super::study_run::{Run, Selection, with_selection};
use super::turntable::crease;
use crate::memory::Held;
use crate::outcome::Outcome;
use crate::place::place;
use crate::source::Source;
use crate::store::{write_whole, write_whole_by};
use crate::terminal::{counted, grouped, say};
use crate::{finishing, input, mesh_file, records, seeds};
use anyhow::{Context, Result, bail};
use clap::{ArgGroup, Args};
use isostudy_design::record::Counts;
use isostudy_extract::{Arrangement, Clustering, Execution, Extraction, Extractor, Method, Tetrahedra};
use isostudy_field::{Counted, FieldCache, StudyField};
use isostudy_finish::Step;
use isostudy_mesh::{MeshFormat, TriangleMesh, corner_normals};
use isostudy_raster::{Camera, Look, Shading, Viewport};
use isovalues::Isovalues;
use own_cells::OfOwnCells;
use quality_report::{Cells, QualityReport};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("source").args(["study", "field", "volume", "mesh", "points", "soup", "grid", "frames", "labels"]).required(true)))]
#[command(after_help = "\
Examples:
  isostudy extract --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2 --spacing 0.05 -o ball.ply
  isostudy extract --volume head.nrrd --isovalue 300.5 -o head.glb --quality
  isostudy extract --grid flow.vtu --array pressure --isovalue 0.5 -o pressure.ply
  isostudy extract --frames beating.nrrd --isovalue 300 --time 1.25 -o heart.ply
  isostudy extract --volume head.nrrd --between 300,500 -o tissue.vtk
  isostudy extract --labels organs.seg.nrrd --only 2,5 -o organs.glb
  isostudy extract --volume head.nrrd --isovalues 100:1500:15 -o 'head-{isovalue}.ply' --method mc
  isostudy extract --field 'max(abs(x), max(abs(y), abs(z))) - 1' --bounds=-2,-2,-2,2,2,2 -o box.glb --method dc-in-cell --crease-deg 40
  isostudy extract --volume head.nrrd --isovalue 300.5 -o few.glb --finish decimate:ratio=0.1
  isostudy extract --mesh scan.stl --cells 200 -o even.obj --picture even.png --method bi-relaxed
  isostudy extract --points scan.ply --cells 80 -o surface.glb
  isostudy extract configs/paper.toml --only ss_bi")]
pub(crate) struct Arguments {
    /// Study file, such as configs/paper.toml: extract its meshes and measure them
    #[arg(conflicts_with_all = ["bounds", "spacing", "cells", "isovalue", "isovalues", "inside", "close", "allow_open", "memory"])]
    study: Option<PathBuf>,
    #[command(flatten)]
    source: SourceArguments,
    /// Grid of tetrahedra or other cells: .vtu, .vts, .vtk, .node or .ele; its own cells are extracted on. Needs --isovalue
    #[arg(long, value_name = "FILE", requires = "isovalue", conflicts_with_all = ["study", "bounds", "spacing", "cells", "close", "allow_open",
        "arrangement", "clustering", "method", "recipe"])]
    grid: Option<PathBuf>,
    /// Array of a grid, with a value on each of its points; of TetGen's files, the number of an attribute [default: the only one]
    #[arg(long, value_name = "NAME", requires = "grid")]
    array: Option<String>,
    /// Volumes of one size, one after the other, as a surface in space-time; or one .nrrd with four axes. Needs --isovalue. Without --time and
    /// --times, -o is a .vtk of tetrahedra
    #[arg(long, value_name = "FILE,FILE,...", value_delimiter = ',', requires = "isovalue", conflicts_with_all = ["study", "bounds", "spacing",
        "cells", "close", "allow_open", "isovalues", "arrangement", "clustering", "method", "recipe", "finish", "quality", "json"])]
    frames: Vec<PathBuf>,
    /// Time of a slice of --frames: that of the first frame is 0, and that of the next is 1
    #[arg(long, value_name = "T", requires = "frames", conflicts_with = "times", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Number of slices of --frames from the first frame to the last, each a file: mesh.ply becomes mesh_0000.ply and so on
    #[arg(long, value_name = "N", requires = "frames", conflicts_with = "picture", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    times: Option<u32>,
    /// Two isovalues of a --volume: -o is a .vtk of the tetrahedra between them
    #[arg(long, value_name = "LOW,HIGH", value_parser = frames::between, allow_hyphen_values = true, group = "level", requires = "volume",
        conflicts_with_all = ["study", "bounds", "spacing", "cells", "close", "inside", "arrangement", "clustering", "method", "recipe", "finish",
        "quality", "json", "picture"])]
    between: Option<[f32; 2]>,
    /// Volume of labels, whole numbers of which 0 is the background: the boundaries between every two of them, by surface nets
    #[arg(long, value_name = "FILE", conflicts_with_all = ["study", "bounds", "spacing", "cells", "isovalue", "inside", "allow_open", "arrangement", "clustering"])]
    labels: Option<PathBuf>,
    /// Values of several surfaces of a volume, which is read once: numbers, and ranges FROM:TO:COUNT, with commas between them. -o must
    /// have {isovalue} in it
    #[arg(long, value_name = "LIST", value_parser = Isovalues::parse, allow_hyphen_values = true, group = "level", requires = "volume",
        conflicts_with_all = ["study", "quality", "picture"])]
    isovalues: Option<Isovalues>,
    /// Marching tetrahedra, by how sample points fill space: body-centred, simple-cubic, five-tetrahedra, face-centred
    #[arg(long, value_name = "NAME", value_parser = named::<Arrangement>, conflicts_with = "study")]
    arrangement: Option<Arrangement>,
    /// Marching tetrahedra, by how vertices are merged: none, integrated, edge-collapse, integrated-collapse, warp; the last two arrangements have no
    /// integrated clustering, and warp is for the first [default: integrated; edge-collapse where there is none]
    #[arg(long, value_name = "NAME", value_parser = named::<Clustering>, conflicts_with = "study")]
    clustering: Option<Clustering>,
    /// A method by its name, such as bi-relaxed; `isostudy methods` lists them [default: mc33]
    #[arg(long, value_name = "ID", value_parser = chosen_method::preset, conflicts_with_all = ["study", "recipe", "arrangement", "clustering"])]
    method: Option<Method>,
    /// A method as a study file has it instead: '{ kind = "tetrahedra", arrangement = "body-centred", placement = "relaxed" }'
    #[arg(long, value_name = "TOML", value_parser = chosen_method::recipe, conflicts_with_all = ["study", "arrangement", "clustering"])]
    recipe: Option<Method>,
    /// What is done to the mesh afterwards, in the order given: merge-by-distance, coplanar, decimate or re-tile with its settings, such
    /// as decimate:ratio=0.5 or re-tile:points=5000,by=curvature
    #[arg(long, value_name = "STEP:KEY=VALUE,...", value_parser = finishing::step_of_text, conflicts_with_all = ["study", "labels", "isovalues"])]
    finish: Vec<Step>,
    /// Mesh to write, .obj, .ply, .stl or .glb; of a study, the folder for results [default: results/<study id>]
    #[arg(long, short, value_name = "FILE", required_unless_present = "study")]
    out: Option<PathBuf>,
    /// Draw the surface as well, z up, 800 pixels square
    #[arg(long, value_name = "PNG", conflicts_with = "study")]
    picture: Option<PathBuf>,
    /// Keep edges sharp at which triangles turn by so many degrees or more, such as 40: in a .glb, where their vertices are split,
    /// and in the picture [default: all normals are smooth]
    #[arg(long, value_name = "DEGREES", value_parser = crease, conflicts_with_all = ["study", "labels", "isovalues"])]
    crease_deg: Option<f32>,
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
    #[arg(long, conflicts_with_all = ["field", "volume", "mesh", "points", "soup", "grid", "frames", "labels"])]
    force: bool,
    /// Of a study, run the programs that it names as methods; they may do whatever you may do
    #[arg(long, conflicts_with_all = ["field", "volume", "mesh", "points", "soup", "grid", "frames", "labels"])]
    allow_programs: bool,
    /// Of a study, run programs by bubblewrap: without a network, in a folder of their own, the system read-only
    #[arg(long, conflicts_with_all = ["field", "volume", "mesh", "points", "soup", "grid", "frames", "labels"])]
    sandbox: bool,
    /// Of a study, only these configurations, such as ss_bi; of labels, only these, such as 2,5 [default: all]
    #[arg(long, value_name = "ID", value_delimiter = ',', conflicts_with_all = ["field", "volume", "mesh", "points", "soup", "grid", "frames"])]
    only: Vec<String>,
}

impl Arguments {
    /// What is asked of a study, if one is given.
    fn of_study(&self) -> Option<Selection> {
        let study = self.study.clone()?;
        let run = Run {
            study,
            out: self.out.clone(),
            force: self.force,
            threads: self.threads,
            allow_programs: self.allow_programs,
            sandbox: self.sandbox,
        };
        Some(Selection { run, only: self.only.clone() })
    }

    fn method(&self) -> Method {
        let tetrahedra = || {
            if self.arrangement.is_none() && self.clustering.is_none() {
                return None;
            }
            let arrangement = self.arrangement.unwrap_or(Arrangement::BodyCentred);
            let clustering = self.clustering.unwrap_or(match arrangement {
                Arrangement::BodyCentred | Arrangement::SimpleCubic => Clustering::Integrated,
                Arrangement::FiveTetrahedra | Arrangement::FaceCentred => Clustering::EdgeCollapse,
            });
            Some(Method::Tetrahedra(Tetrahedra::new(arrangement).with_clustering(clustering)))
        };
        let chosen = self.method.or(self.recipe).or_else(tetrahedra);
        chosen.unwrap_or_else(|| chosen_method::preset(DEFAULT).expect("a preset"))
    }
}

/// What the documents recommend to whoever does not know: docs/methods.md.
const DEFAULT: &str = "mc33";

/// Extracts a study's meshes, or one surface.
///
/// # Errors
/// If the input is wrong or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let Some(selection) = arguments.of_study() else {
        return extract(arguments);
    };
    with_selection(&selection, |pipeline, only, out| {
        pipeline.all_meshes(only)?;
        say(&out.join("meshes").display().to_string())
    })
}

/// Extracts, writes and reports. A surface that was to be closed and is not fails the check.
///
/// # Errors
/// If the input cannot be read, has no inside, or has no surface there; if a file cannot be written.
fn extract(arguments: &Arguments) -> Result<Outcome> {
    if let Some(path) = &arguments.labels {
        return labels::extract(arguments, path);
    }
    if let Some(path) = &arguments.grid {
        return grid::extract(arguments, path);
    }
    if !arguments.frames.is_empty() {
        return frames::extract(arguments);
    }
    let out = arguments.out.as_deref().context("-o is needed")?;
    if let Some(between) = arguments.between {
        return frames::extract_between(arguments, out, between);
    }
    if let Some(isovalues) = &arguments.isovalues {
        return isovalues.extract(arguments, out);
    }
    let format = format(arguments, out)?;
    let method = arguments.method();
    let execution = Execution { threads: arguments.threads as usize };
    let volume = arguments.source.volume_alone().filter(|_| method.is_of_cubes());
    let is_measured = arguments.quality || arguments.json;
    let (mut extraction, source, cells, mut counts) = match volume {
        Some(path) => {
            let OfOwnCells { extraction, source, cells } =
                own_cells::extract(&arguments.source, path, &method, &execution, is_measured)?;
            let counts = records::counts(&extraction.counts);
            (extraction, source, cells, counts)
        }
        None => {
            let (extraction, source, cells, counts) = on_a_grid(arguments, &method, &execution)?;
            (extraction, Some(source), cells, counts)
        }
    };
    if let Some(source) = source.as_ref().filter(|_| extraction.mesh.triangles.is_empty()) {
        bail!(source.no_surface_of(&method));
    }
    let made = [extraction.counts.triangles, extraction.counts.vertices];
    let finishing = finished::finish(&mut extraction, &mut counts, &arguments.finish)?;
    write(arguments, out, format, &extraction.mesh)?;
    // With --json the report has it all.
    if !arguments.json
        && let Cells::Own { is_turned: true, .. } = &cells
        && let Some(found) = open_edges(&extraction.mesh)
    {
        let name = volume.unwrap_or(out).display();
        tell!(
            "{name}: the grid is turned against the axes, and this method extracts on the volume's own cells. So the surface is open \
             where it leaves them ({found}). --close closes it"
        );
    }
    if !arguments.json {
        let [triangles, vertices] = made;
        tell_made(out, triangles, vertices, extraction.times.total());
    }
    finishing.iter().for_each(|step| tell!("{}: {}", out.display(), step.to_line()));
    if let Some(source) = source.as_ref().filter(|_| is_measured) {
        let (field, isovalue, grid) = (&*source.field, source.isovalue, source.grid());
        let accuracy = isostudy_extract::accuracy(&extraction.mesh, field, isovalue, &grid, &execution);
        let accuracy = source.vouch(accuracy.map_err(anyhow::Error::from))?;
        let report = QualityReport::new(method, source, cells, &extraction, counts, &accuracy)
            .with_finishing(finishing);
        say(&if arguments.json { serde_json::to_string_pretty(&report)? } else { report.to_text()? })?;
    }
    // With --json standard output is JSON and nothing else.
    if !arguments.json {
        say(&out.display().to_string())?;
    }
    if source.is_some_and(|source| source.is_closed)
        && let Some(found) = open_edges(&extraction.mesh)
    {
        tell!("isostudy: {}: the surface was to be closed and has {found}", out.display());
        return Ok(Outcome::CheckFailed);
    }
    Ok(Outcome::Done)
}

/// The format of the mesh, if all that is to be written can be.
fn format(arguments: &Arguments, out: &Path) -> Result<MeshFormat> {
    let format = mesh_file::format_to_write(out).with_context(|| out.display().to_string())?;
    check_outputs(arguments, out)?;
    if arguments.crease_deg.is_some() && format != MeshFormat::Glb && arguments.picture.is_none() {
        bail!("--crease-deg is for .glb and --picture: in {} vertices are not split", out.display());
    }
    Ok(format)
}

/// Writes the mesh, and draws it if that is asked for.
fn write(arguments: &Arguments, out: &Path, format: MeshFormat, mesh: &TriangleMesh) -> Result<()> {
    write_whole_by(out, |file| {
        let mut buffered = BufWriter::new(file);
        match arguments.crease_deg.filter(|_| format == MeshFormat::Glb) {
            Some(crease) => format.write(&corner_normals(mesh, crease).split(mesh), &mut buffered)?,
            None => format.write(mesh, &mut buffered)?,
        }
        buffered.flush()
    })?;
    if let Some(path) = &arguments.picture {
        write_whole(path, &picture(mesh, arguments.crease_deg)?)?;
    }
    Ok(())
}

/// Says on standard error how large a mesh is, and how long it took to make from what was read.
fn tell_made(out: &Path, triangles: u64, vertices: u64, time: Duration) {
    let [triangles, vertices] = [(triangles, "triangle"), (vertices, "vertex")].map(|(number, word)| {
        let many = if word == "vertex" { "vertices" } else { "triangles" };
        format!("{} {}", grouped(number), if number == 1 { word } else { many })
    });
    let ms = 1e3 * time.as_secs_f64();
    let time = if ms < 1000.0 { format!("{ms:.1} ms") } else { format!("{:.2} s", 1e-3 * ms) };
    tell!("{}: {triangles}, {vertices}, extracted in {time}", out.display());
}

/// The surface of a field on a grid of cubes.
fn on_a_grid(
    arguments: &Arguments,
    method: &Method,
    execution: &Execution,
) -> Result<(Extraction, Source, Cells, Counts)> {
    let before = Held::now();
    let source = arguments
        .source
        .read_in_file_for(method, execution)?
        .context("one of a study, --field, --volume, --mesh, --points and --soup is needed")?;
    let execution = &source.execution(execution);
    let grid = source.grid();
    let limit = arguments.source.limit();
    // It names the box itself.
    seeds::check(method, &grid.bounds)?;
    limit.check_method(method, &grid, execution, source.held).with_context(|| source.place())?;
    let mut kept = FieldCache::default();
    let field = Counted::new(&*source.field, &mut kept);
    let study: &dyn StudyField = &field;
    let extract =
        || Ok(method.extract(&mut Extractor::new(), study.into(), &grid, source.isovalue, execution)?);
    let extraction = source.vouch(limit.hold(before, extract))?;
    let counts = records::with_calls(records::counts(&extraction.counts), &field);
    Ok((extraction, source, Cells::Cubes(method.cells(&grid)?), counts))
}

/// How many boundary edges a mesh has, and where one of them is; `None` if it has none.
fn open_edges(mesh: &TriangleMesh) -> Option<String> {
    let [from, to] = isostudy_mesh::topology::first_boundary_edge(mesh)?;
    let edges = isostudy_mesh::topology::topology(mesh).boundary_edges;
    Some(format!("{}, one from {} to {}", counted(edges, "boundary edge"), place(from), place(to)))
}

/// Nothing that was given is written over; and no output over another, since no mesh ends as pictures do.
fn check_outputs(arguments: &Arguments, out: &Path) -> Result<()> {
    let outputs = [Some(out), arguments.picture.as_deref()];
    let given = arguments.labels.as_deref().or(arguments.grid.as_deref()).or(arguments.source.file());
    for output in outputs.into_iter().flatten() {
        if given.is_some_and(|file| input::is_same(file, output)) {
            bail!("{}: is the input; it would be written over", output.display());
        }
    }
    let Some(picture) = &arguments.picture else { return Ok(()) };
    if !picture.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("--picture {}: pictures are .png", picture.display());
    }
    Ok(())
}

fn picture(mesh: &TriangleMesh, crease_deg: Option<f32>) -> Result<Vec<u8>> {
    let bounds = mesh.bounds().context("there is nothing to draw")?;
    let viewport = Viewport { width: 800, height: 800, supersampling: 2 };
    let (shading, look) = match crease_deg {
        None => (Shading::default(), Look::Smooth),
        Some(crease_deg) => (Shading { crease_deg, ..Shading::default() }, Look::Creased),
    };
    let picture = isostudy_raster::render(mesh, &Camera::around(&bounds), viewport, &shading, look)?;
    Ok(isostudy_raster::pixmap_to_png(&picture))
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
