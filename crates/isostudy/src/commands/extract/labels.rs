//! The boundaries between labels, of `--labels`.

use super::{Arguments, check_outputs, tell_made};
use crate::memory::{Held, OfVolume};
use crate::mesh_file;
use crate::outcome::Outcome;
use crate::store::{write_whole, write_whole_by};
use crate::terminal::{say, significant};
use anyhow::{Context, Result, bail};
use isostudy_extract::{Execution, LabelSettings, LabelSurface, LabelVolume, Method, SurfaceNets};
use isostudy_mesh::LabelledMesh;
use isostudy_mesh::topology::topology;
use isostudy_raster::{Camera, Colouring, Look, Scale, Shading, Values, Viewport};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

/// The version of the JSON.
const SCHEMA: u32 = 1;

/// Extracts, writes and reports.
///
/// # Errors
/// If the volume cannot be read or holds no labels, the method is none for them, or a file cannot be written.
pub(super) fn extract(arguments: &Arguments, path: &Path) -> Result<Outcome> {
    let out = arguments.out.as_deref().context("-o is needed")?;
    let format = mesh_file::format_to_write(out).with_context(|| out.display().to_string())?;
    if !format.has_labels() {
        bail!("{}: .{} has no place for labels; .ply, .obj and .glb have", out.display(), format.extension());
    }
    check_outputs(arguments, out)?;
    let name = || path.display().to_string();
    let smoothing = smoothing(arguments.method.or(arguments.recipe))?;
    let only = only(&arguments.only)?;
    let settings = LabelSettings::default()
        .with_only(&only)
        .with_smoothing(smoothing)
        .with_close(arguments.source.options().close);
    let (limit, before) = (arguments.source.limit(), Held::now());
    let unread = isostudy_volume::open(path)?;
    let held = OfVolume::samples(&unread).with("the labels", unread.memory_bytes());
    let volume = limit.read(unread, held)?;
    let labels = volume.labels().with_context(name)?;
    let isostudy_volume::Volume { counts, origin, steps, values } = volume;
    drop(values);
    let volume = LabelVolume { counts, labels: &labels, origin, steps };
    let execution = Execution { threads: arguments.threads as usize };
    let began = Instant::now();
    let surface = limit.hold(before, || Ok(volume.extract(&settings, &execution)?)).with_context(name)?;
    let time = began.elapsed();
    write_whole_by(out, |file| {
        let mut buffered = BufWriter::new(file);
        format.write_labelled(&surface.labelled, &mut buffered)?;
        buffered.flush()
    })?;
    if let Some(path) = &arguments.picture {
        write_whole(path, &picture(&surface.labelled)?)?;
    }
    let mesh = &surface.labelled.mesh;
    if !arguments.json {
        tell_made(out, mesh.triangles.len() as u64, mesh.positions.len() as u64, time);
    }
    if arguments.quality || arguments.json {
        let report = Report::new(name(), smoothing, counts, &surface);
        say(&if arguments.json { serde_json::to_string_pretty(&report)? } else { report.to_text() })?;
    }
    if !arguments.json {
        say(&out.display().to_string())?;
    }
    Ok(Outcome::Done)
}

/// Steps of smoothing, which is all that a method may say.
fn smoothing(method: Option<Method>) -> Result<u32> {
    let why = match method {
        None => return Ok(0),
        Some(Method::SurfaceNets(SurfaceNets { patches: false, smoothing, edge_clamp: 0.0, .. })) => {
            return Ok(smoothing);
        }
        Some(Method::SurfaceNets(SurfaceNets { patches: true, .. })) => {
            "patches = true is refused, since boundaries of labels have a vertex per cell".to_owned()
        }
        Some(Method::SurfaceNets(SurfaceNets { edge_clamp, .. })) => format!(
            "edge_clamp = {edge_clamp:?} is refused, since crossings of labels are in the middles of edges"
        ),
        Some(_) => "boundaries of labels are surface nets with a vertex per cell".to_owned(),
    };
    bail!("--labels: {why}; take --method nets, or --recipe '{{ kind = \"surface-nets\", smoothing = 8 }}'")
}

/// The labels of `--only`.
fn only(texts: &[String]) -> Result<Vec<u32>> {
    let label = |text: &String| {
        let label = text.trim().parse().ok().filter(|&label| label < isostudy_volume::LABELS_END);
        label.with_context(|| {
            format!("--only {text}: labels are whole numbers from 1 to {}", isostudy_volume::LABELS_END - 1)
        })
    };
    texts.iter().map(label).collect()
}

/// All boundaries, each in the colour of its inside label.
fn picture(labelled: &LabelledMesh) -> Result<Vec<u8>> {
    let apart = labelled.apart();
    let bounds = apart.mesh.bounds().context("there is nothing to draw")?;
    let mut inside: Vec<u32> = apart.sides.iter().map(|&[inside, _]| inside).collect();
    let of_triangles = inside.clone();
    inside.sort_unstable();
    inside.dedup();
    let place = |label| inside.partition_point(|&other| other < label) as f32;
    let values = Values::PerTriangle(of_triangles.into_iter().map(place).collect());
    let bright = (inside.len() as f32 - 1.0).max(1.0);
    let scale = Scale { title: "label".into(), dark: 0.0, bright, marks: Vec::new() };
    let viewport = Viewport { width: 800, height: 800, supersampling: 2 };
    let camera = Camera::around(&bounds);
    let (colouring, shading) = (Colouring { values, scale }, Shading::default());
    let picture =
        isostudy_raster::render_coloured(&apart.mesh, &colouring, &camera, viewport, &shading, Look::Smooth)?;
    Ok(isostudy_raster::pixmap_to_png(&picture))
}

/// What the boundaries are.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// The file.
    source: String,
    samples: [usize; 3],
    smoothing: u32,
    vertices: usize,
    triangles: usize,
    /// Edges between samples with different labels.
    crossings: u64,
    labels: Vec<OfLabel>,
    boundaries: Vec<Boundary>,
}

#[derive(Serialize)]
struct OfLabel {
    label: u32,
    samples: u64,
    triangles: usize,
    area: f64,
    /// What its boundary encloses, if it is closed; the background has none.
    volume: Option<f64>,
    /// Sides of triangles that no other triangle has.
    open_edges: u64,
    /// Sides that more than two have: there two parts of it touch.
    shared_edges: u64,
}

#[derive(Serialize)]
struct Boundary {
    inside: u32,
    outside: u32,
    triangles: usize,
}

impl Report {
    fn new(source: String, smoothing: u32, samples: [usize; 3], surface: &LabelSurface) -> Self {
        let LabelSurface { labelled, counts, crossings } = surface;
        let of_label = |of: &isostudy_extract::LabelCount| {
            let boundary = labelled.boundary_of(of.label);
            let topology = topology(&boundary);
            let is_closed = topology.boundary_edges == 0 && of.label > 0;
            OfLabel {
                label: of.label,
                samples: of.samples,
                triangles: boundary.triangles.len(),
                area: boundary.area(),
                volume: is_closed.then(|| boundary.volume()),
                open_edges: topology.boundary_edges,
                shared_edges: topology.non_manifold_edges,
            }
        };
        let mut pairs: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        labelled.sides.iter().for_each(|&pair| *pairs.entry(pair).or_default() += 1);
        let boundary =
            |([inside, outside], triangles): ([u32; 2], usize)| Boundary { inside, outside, triangles };
        Self {
            schema: SCHEMA,
            source,
            samples,
            smoothing,
            vertices: labelled.mesh.positions.len(),
            triangles: labelled.mesh.triangles.len(),
            crossings: *crossings,
            labels: counts.iter().map(of_label).collect(),
            boundaries: pairs.into_iter().map(boundary).collect(),
        }
    }

    /// As lines for people.
    fn to_text(&self) -> String {
        let [x, y, z] = self.samples;
        let mut lines = vec![
            format!("{:<15} {x} x {y} x {z}", "samples"),
            format!("{:<15} {}", "smoothing", self.smoothing),
            format!("{:<15} {}", "vertices", self.vertices),
            format!("{:<15} {}", "triangles", self.triangles),
        ];
        for of in &self.labels {
            let volume = match (of.label, of.volume) {
                (_, Some(volume)) => format!("volume {}", significant(volume)),
                (0, None) => "the background".to_owned(),
                (_, None) => format!("open at {} edges", of.open_edges),
            };
            let shared = match of.shared_edges {
                0 => String::new(),
                edges => format!(", touches itself at {edges} edges"),
            };
            lines.push(format!(
                "{:<15} {} samples, {} triangles, area {}, {volume}{shared}",
                format!("label {}", of.label),
                of.samples,
                of.triangles,
                significant(of.area)
            ));
        }
        let pairs = self.boundaries.iter();
        let pairs: Vec<String> =
            pairs.map(|of| format!("{}/{}: {}", of.inside, of.outside, of.triangles)).collect();
        lines.push(format!("{:<15} inside/outside: triangles {}", "boundaries", pairs.join(", ")));
        lines.join("\n")
    }
}
