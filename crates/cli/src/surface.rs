//! `isostudy extract` without a study: a formula, a volume or a mesh becomes a surface in a file.

use crate::args::{Run, Selection};
use crate::store::write_whole;
use crate::{records, say, subject};
use anyhow::{Context, Result, bail};
use clap::{ArgGroup, Args, ValueEnum};
use design::record::{Accuracy, Counts, Quality, Topology};
use design::{Arrangement, Clustering};
use expression::Expression;
use extract::{
    Beyond, Execution, ExtractSettings, Extraction, Holes, Lattice, MeshDistance, MeshFieldError, Negated,
    ScalarField, VolumeField,
};
use glam::Vec3;
use mesh::{Bounds, MeshFormat, TriangleMesh, repair};
use raster::{Camera, Look, Shading, Viewport};
use serde::de::IntoDeserializer;
use serde::de::value::{Error as NameError, StrDeserializer};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Cells along the longest side, where neither spacing nor cells are given.
const CELLS: u32 = 100;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("source").args(["study", "field", "volume", "mesh"]).required(true)))]
#[command(after_help = "\
Examples:
  isostudy extract --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2 --spacing 0.05 -o ball.ply
  isostudy extract --volume head.nrrd --isovalue 300 -o head.glb --quality
  isostudy extract --mesh scan.stl --cells 200 -o remeshed.obj --picture remeshed.png
  isostudy extract configs/paper.toml --only ss_bi")]
pub(crate) struct Extract {
    /// Study file, such as configs/paper.toml: extract its meshes and measure them
    study: Option<PathBuf>,
    /// Formula in x, y and z, such as 'sqrt(x^2+y^2+z^2) - 1'; needs --bounds
    #[arg(long, value_name = "FORMULA", requires = "bounds", allow_hyphen_values = true)]
    field: Option<String>,
    /// Volume: .nrrd, .nhdr, .mha, .mhd, or .raw with a .toml beside it; needs --isovalue
    #[arg(long, value_name = "FILE", requires = "isovalue")]
    volume: Option<PathBuf>,
    /// Triangle mesh, of which the signed distance is taken: .obj, .ply or .stl
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Box to extract in: smallest corner, then largest [default: that of the volume, or round the mesh]
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = bounds, allow_hyphen_values = true, conflicts_with = "study")]
    bounds: Option<Bounds>,
    /// Edge of the lattice's cubes [default: that of the volume's samples; otherwise 100 cubes along the longest side]
    #[arg(long, value_name = "LENGTH", conflicts_with_all = ["study", "cells"])]
    spacing: Option<f32>,
    /// The same, as the number of cubes along the longest side
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16384), conflicts_with = "study")]
    cells: Option<u32>,
    /// Value of the surface
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, conflicts_with = "study")]
    isovalue: f32,
    /// Side of the isovalue that is inside [default: below for a formula, above for a volume; a mesh's distance is
    /// positive inside]
    #[arg(long, value_name = "SIDE", conflicts_with_all = ["study", "mesh"])]
    inside: Option<Inside>,
    /// How sample points fill space: body-centred, simple-cubic
    #[arg(long, value_name = "NAME", default_value = "body-centred", value_parser = named::<Arrangement>, conflicts_with = "study")]
    arrangement: Arrangement,
    /// How vertices are merged: none, integrated, edge-collapse, integrated-collapse
    #[arg(long, value_name = "NAME", default_value = "integrated", value_parser = named::<Clustering>, conflicts_with = "study")]
    clustering: Clustering,
    /// Close the surface where it leaves the volume
    #[arg(long, conflicts_with_all = ["study", "field", "mesh"])]
    close: bool,
    /// Take a mesh with holes: inside is what is seen from behind in most directions
    #[arg(long, conflicts_with_all = ["study", "field", "volume"])]
    allow_open: bool,
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
    /// Of a study, only these configurations, such as ss_bi [default: all]
    #[arg(long, value_name = "ID", value_delimiter = ',', conflicts_with_all = ["field", "volume", "mesh"])]
    only: Vec<String>,
}

/// Which side of the isovalue is solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Inside {
    /// Values above the isovalue, such as densities
    Above,
    /// Values below it, such as distances that are negative inside
    Below,
}

impl Extract {
    /// What is asked of a study, if one is given.
    pub(crate) fn of_study(&self) -> Option<Selection> {
        let study = self.study.clone()?;
        let run = Run { study, out: self.out.clone(), force: self.force, threads: self.threads };
        Some(Selection { run, only: self.only.clone() })
    }
}

/// What a study calls it.
fn named<T: for<'de> Deserialize<'de>>(text: &str) -> Result<T, String> {
    let name: StrDeserializer<'_, NameError> = text.into_deserializer();
    T::deserialize(name).map_err(|error| error.to_string())
}

fn bounds(text: &str) -> Result<Bounds, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|word| word.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[a, b, c, d, e, f]) => Ok(Bounds { min: Vec3::new(a, b, c), max: Vec3::new(d, e, f) }),
        _ => {
            Err("six numbers with commas between them: x,y,z of the smallest corner, then of the largest"
                .into())
        }
    }
}

/// What is extracted from, and where if nobody says.
struct Source {
    field: Box<dyn ScalarField>,
    inside: Inside,
    bounds: Bounds,
    spacing: Option<f32>,
    /// What is known of its values, for a surface that is not there.
    values: String,
}

/// Extracts, writes and reports.
///
/// # Errors
/// If the input cannot be read, has no inside, or has no surface there; if a file cannot be written.
pub(crate) fn extract(arguments: &Extract) -> Result<()> {
    let out = arguments.out.as_deref().context("-o is needed")?;
    let format = format_of(out)?;
    let source = source(arguments)?;
    let bounds = arguments.bounds.unwrap_or(source.bounds);
    let cells = || bounds.spacing_of_cells(arguments.cells.unwrap_or(CELLS));
    let given = arguments.spacing.or(source.spacing.filter(|_| arguments.cells.is_none()));
    let spacing = given.unwrap_or_else(cells);
    let lattice = subject::lattice_over(bounds, arguments.arrangement, spacing)?;
    let (field, isovalue): (Box<dyn ScalarField>, f32) = match source.inside {
        Inside::Above => (source.field, arguments.isovalue),
        Inside::Below => (Box::new(Negated(source.field)), -arguments.isovalue),
    };
    let clustering = subject::clustering(arguments.clustering);
    let settings = ExtractSettings { isovalue, clustering, ..ExtractSettings::default() };
    let execution = Execution { threads: arguments.threads as usize };
    if let Some(memory) = bench::read_machine().memory_bytes {
        subject::check_limit(&lattice, &settings, &execution, memory, "this machine has")?;
    }
    let extraction = extract::extract(&*field, &lattice, &settings, &execution)?;
    if extraction.mesh.triangles.is_empty() {
        let (isovalue, Bounds { min, max }) = (arguments.isovalue, bounds);
        bail!(
            "no surface at isovalue {isovalue} from {min} to {max} with spacing {spacing}: every sample lies on one side{}",
            source.values
        );
    }
    let mut bytes = Vec::new();
    format.write(&extraction.mesh, &mut bytes).with_context(|| out.display().to_string())?;
    write_whole(out, &bytes)?;
    if let Some(path) = &arguments.picture {
        write_whole(path, &picture(&extraction.mesh)?)?;
    }
    if arguments.quality || arguments.json {
        let accuracy = extract::accuracy(&extraction.mesh, &*field, isovalue, &lattice, &execution)?;
        let report = Report::new(arguments, source.inside, &lattice, &extraction, &accuracy);
        say(&if arguments.json { serde_json::to_string_pretty(&report)? } else { report.to_text() })?;
    }
    // With --json standard output is JSON and nothing else.
    if arguments.json { Ok(()) } else { say(&out.display().to_string()) }
}

fn format_of(path: &Path) -> Result<MeshFormat> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let known = || MeshFormat::ALL.map(|format| format!(".{}", format.extension())).join(", ");
    MeshFormat::from_extension(&extension)
        .with_context(|| format!("{}: known endings are {}", path.display(), known()))
}

fn source(arguments: &Extract) -> Result<Source> {
    if let Some(formula) = &arguments.field {
        let field: Expression = formula.parse().with_context(|| format!("--field '{formula}'"))?;
        return Ok(Source {
            field: Box::new(field),
            inside: arguments.inside.unwrap_or(Inside::Below),
            bounds: arguments.bounds.context("--bounds is needed")?,
            spacing: None,
            values: String::new(),
        });
    }
    if let Some(path) = &arguments.volume {
        return from_volume(arguments, path);
    }
    let path = arguments.mesh.as_deref().context("one of a study, --field, --volume and --mesh is needed")?;
    let (field, solid) = from_mesh(path, arguments.allow_open).with_context(|| path.display().to_string())?;
    let tight = solid.bounds().context("the mesh has no vertices")?;
    // What is thickened needs more room.
    let room = tight.spacing_of_cells(20) - arguments.isovalue.min(0.0);
    Ok(Source {
        field: Box::new(field),
        inside: Inside::Above,
        bounds: tight.grown(room),
        spacing: None,
        values: format!("; the mesh reaches from {} to {}", tight.min, tight.max),
    })
}

fn from_volume(arguments: &Extract, path: &Path) -> Result<Source> {
    let limit = bench::read_machine().memory_bytes.unwrap_or(volume::NO_LIMIT);
    let inside = arguments.inside.unwrap_or(Inside::Above);
    let beyond = match inside {
        Inside::Above => Beyond::Falling,
        Inside::Below => Beyond::Rising,
    };
    let volume::Volume { counts, values, origin, steps } = volume::read(path, limit)?;
    let mut field = VolumeField::try_new(counts, values, origin, steps, Beyond::Continued)
        .with_context(|| path.display().to_string())?;
    // A box cannot cut off what leaves a turned volume.
    let closes = arguments.close || !field.is_axis_aligned();
    let mut bounds = field.bounds();
    if closes {
        field = field.with_beyond(beyond);
        bounds = bounds.grown(1.5 * field.spacing());
        if !arguments.close {
            eprintln!(
                "{}: the grid is turned against the axes; the surface is closed where it leaves it",
                path.display()
            );
        }
    }
    let (low, high) = field.value_range();
    let values = format!("; the volume's samples run from {low} to {high}");
    Ok(Source { inside, bounds, spacing: Some(field.spacing()), field: Box::new(field), values })
}

/// The field of a mesh in a file, and the mesh. What had to be done to it is said on standard error.
fn from_mesh(path: &Path, allow_open: bool) -> Result<(MeshDistance, TriangleMesh)> {
    let file = std::fs::File::open(path)?;
    let mut mesh = format_of(path)?.read(std::io::BufReader::new(file))?;
    let mut holes = Holes::Refuse;
    let mut is_welded = false;
    loop {
        match MeshDistance::try_from_any(&mesh, holes) {
            Ok(field) => return Ok((field, mesh)),
            Err(MeshFieldError::Open { .. }) if !is_welded => {
                let before = mesh.positions.len();
                mesh = mesh::weld(&mesh);
                is_welded = true;
                if mesh.positions.len() < before {
                    eprintln!(
                        "{}: {before} vertices at {} places joined",
                        path.display(),
                        mesh.positions.len()
                    );
                }
            }
            Err(open @ MeshFieldError::Open { .. }) if allow_open => {
                eprintln!("{}: {open}", path.display());
                holes = Holes::Span;
            }
            Err(open @ MeshFieldError::Open { .. }) => bail!("{open}; --allow-open takes it nevertheless"),
            Err(MeshFieldError::InsideOut { volume }) if volume < 0.0 => {
                eprintln!("{}: its triangles face inward: turned round", path.display());
                mesh = repair::flip(&mesh);
            }
            Err(error) => return Err(error.into()),
        }
    }
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
    arrangement: Arrangement,
    clustering: Clustering,
    isovalue: f32,
    inside: Inside,
    spacing: f32,
    cells: [u32; 3],
    /// Wall-clock time of the extraction, seconds.
    extraction_s: f64,
    /// Surface area and enclosed volume; the latter means something only for a closed mesh.
    area: f64,
    volume: f64,
    counts: Counts,
    quality: Quality,
    topology: Topology,
    boundary_loops: u64,
    accuracy: Accuracy,
}

impl Report {
    fn new(
        arguments: &Extract,
        inside: Inside,
        lattice: &Lattice,
        extraction: &Extraction,
        accuracy: &extract::Accuracy,
    ) -> Self {
        let topology = mesh::topology::topology(&extraction.mesh);
        Self {
            arrangement: arguments.arrangement,
            clustering: arguments.clustering,
            isovalue: arguments.isovalue,
            inside,
            spacing: lattice.spacing(),
            cells: lattice.cells(),
            extraction_s: extraction.times.total().as_secs_f64(),
            area: extraction.mesh.area(),
            volume: extraction.mesh.volume(),
            counts: records::counts(&extraction.counts),
            quality: records::quality(&mesh::quality::quality(&extraction.mesh)),
            boundary_loops: topology.boundary_loops,
            topology: records::topology(&topology),
            accuracy: records::accuracy(accuracy),
        }
    }

    fn to_text(&self) -> String {
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
        let rows = [
            ("lattice", format!("{}, {x} x {y} x {z} cubes of {}", self.arrangement.label(), self.spacing)),
            ("clustering", self.clustering.label().to_owned()),
            ("time", format!("{:.3} s", self.extraction_s)),
            ("vertices", t.vertices.to_string()),
            ("triangles", q.triangles.to_string()),
            (
                "topology",
                format!(
                    "{state}; {} components, Euler characteristic {}, {} boundary loops",
                    t.components, t.euler_characteristic, self.boundary_loops
                ),
            ),
            ("area, volume", format!("{:.6}, {:.6}", self.area, self.volume)),
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
            (
                "to the surface",
                format!(
                    "mean {:.3e}, largest {:.3e} (over {} points, {} lost)",
                    self.accuracy.distance.mean,
                    self.accuracy.distance.max,
                    self.accuracy.distance.count,
                    self.accuracy.lost_points
                ),
            ),
        ];
        rows.map(|(name, value)| format!("{name:<15} {value}")).join("\n")
    }
}
