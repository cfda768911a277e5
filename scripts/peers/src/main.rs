//! isostudy beside other extractors: the same fields, sizes and core, interleaved, extraction apart from sampling, every mesh
//! measured alike. `scripts/peers.sh` sets up what is timed and starts this.

mod in_process;
mod python;
mod report;

use anyhow::{Context, Result, bail};
use bench::{CpuTimes, order};
use design::machine::Machine;
use field::{Asteroid, ScalarField, Sphere};
use glam::Vec3;
use mesh::TriangleMesh;
use std::path::PathBuf;
use std::process::Command;

const SEED: u64 = 2026;
/// The volume has room round every surface, so that none of them has to be closed at its boundary.
const REACH: f32 = 1.1;

/// A field sampled on a cubic grid, x fastest.
pub(crate) struct Grid {
    pub(crate) field: &'static str,
    pub(crate) cells: u32,
    pub(crate) spacing: f32,
    pub(crate) samples: Vec<f32>,
}

impl Grid {
    fn new(name: &'static str, cells: u32) -> Self {
        let spacing = 2.0 * REACH / cells as f32;
        let at = |i: u32| -REACH + i as f32 * spacing;
        let field = field(name);
        let mut samples = Vec::new();
        for z in 0..=cells {
            for y in 0..=cells {
                samples.extend((0..=cells).map(|x| field.sample(Vec3::new(at(x), at(y), at(z)))));
            }
        }
        Self { field: name, cells, spacing, samples }
    }
}

pub(crate) fn field(name: &str) -> Box<dyn ScalarField> {
    if name == "sphere" { Box::new(Sphere { radius: 1.0 }) } else { Box::new(Asteroid::default()) }
}

/// What one extraction took; the mesh if it was asked for.
pub(crate) struct Outcome {
    pub(crate) extraction_s: f64,
    /// Sampling that cannot be had apart, where the extractor calls the field; 0 where it is given samples.
    pub(crate) sampling_s: f64,
    pub(crate) mesh: Option<TriangleMesh>,
}

/// Something that extracts.
pub(crate) trait Peer {
    /// Name and version; after a semicolon, what else is in its time.
    fn name(&self) -> String;
    /// The process that extracts, if it is another.
    fn process(&self) -> Option<u32> {
        None
    }
    /// # Errors
    /// Whatever stopped it.
    fn extract(&mut self, grid: &Grid, with_mesh: bool) -> Result<Outcome>;
}

/// The machine, and the commit of the sources that stand here.
fn machine() -> Machine {
    let git = |arguments: &[&str]| {
        let output =
            Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let mut machine = bench::read_machine();
    machine.build.commit = git(&["rev-parse", "HEAD"]);
    machine.build.dirty = git(&["status", "--porcelain"]).map(|changes| !changes.is_empty());
    machine
}

struct Arguments {
    python: PathBuf,
    worker: PathBuf,
    out: PathBuf,
    rounds: u32,
    cells: Vec<u32>,
    date: String,
}

fn arguments() -> Result<Arguments> {
    let mut found = Arguments {
        python: "python3".into(),
        worker: "scripts/peers/worker.py".into(),
        out: "results/peers".into(),
        rounds: 11,
        cells: vec![50, 100],
        date: "a day that was not told".into(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().with_context(|| format!("{word} needs a value"))?;
        match &*word {
            "--python" => found.python = value.into(),
            "--worker" => found.worker = value.into(),
            "--out" => found.out = value.into(),
            "--date" => found.date = value,
            "--rounds" => found.rounds = value.parse().with_context(|| format!("--rounds {value}"))?,
            "--cells" => {
                let cells: Result<_, _> = value.split(',').map(str::parse).collect();
                found.cells = cells.with_context(|| format!("--cells {value}"))?;
            }
            _ => bail!("{word}: known are --python, --worker, --out, --date, --rounds, --cells"),
        }
    }
    if found.rounds < 2 || found.cells.is_empty() || found.cells.iter().any(|c| !(4..=1024).contains(c)) {
        bail!("--rounds must be at least 2, --cells 4 to 1024");
    }
    Ok(found)
}

fn main() {
    if let Err(error) = run() {
        eprintln!("peers: {error:#}");
        std::process::exit(2);
    }
}

fn run() -> Result<()> {
    let arguments = arguments()?;
    // Before the pinning, after which there is one CPU.
    let machine = machine();
    // What is started from here inherits it.
    let pinned = bench::pin(1);
    let mut peers = in_process::peers();
    let mut skipped = Vec::new();
    for library in ["manifold3d", "vtk", "scikit-image"] {
        match python::PythonPeer::start(&arguments.python, &arguments.worker, library) {
            Ok(peer) => peers.push(Box::new(peer)),
            Err(error) => skip(&mut skipped, format!("{library}: {error:#}")),
        }
    }
    let (mut rows, mut others) = (Vec::new(), Vec::new());
    let mut samples = vec!["field,cells,peer,round,place,extraction_s,sampling_s".to_owned()];
    for name in ["sphere", "asteroid"] {
        for &cells in &arguments.cells {
            let grid = Grid::new(name, cells);
            eprintln!("peers: {name}, {cells} cells per axis");
            let ours: Vec<u32> =
                peers.iter().filter_map(|peer| peer.process()).chain([std::process::id()]).collect();
            let before = CpuTimes::read(&ours, pinned.as_deref());
            let measured = measure(&mut peers, &grid, arguments.rounds, &mut samples, &mut skipped)?;
            let after = CpuTimes::read(&ours, pinned.as_deref());
            let shares = before.zip(after).and_then(|(before, after)| after.shares_since(&before));
            others.extend(shares.map(|shares| shares.others + shares.steal));
            rows.extend(report::rows(&grid, measured));
        }
    }
    let conditions = report::Conditions {
        rounds: arguments.rounds,
        pinned: pinned.is_some(),
        others: others.into_iter().reduce(f64::max),
        notes: peers.iter().map(|peer| peer.name()).collect(),
        skipped,
        machine,
        date: arguments.date,
    };
    report::write(&arguments.out, &rows, &samples, &conditions)
}

/// Says that something is not measured, and why; at once and under the table.
fn skip(skipped: &mut Vec<String>, what: String) {
    eprintln!("peers: SKIPPED: {what}");
    skipped.push(what);
}

/// Name and version alone.
fn label(name: &str) -> &str {
    name.split(';').next().unwrap_or(name)
}

/// What a peer did with a grid.
pub(crate) struct Measured {
    pub(crate) peer: String,
    pub(crate) extraction_s: Vec<f64>,
    pub(crate) sampling_s: Vec<f64>,
    pub(crate) mesh: TriangleMesh,
}

/// A warm-up that takes the mesh, then rounds in orders of their own.
fn measure(
    peers: &mut [Box<dyn Peer>],
    grid: &Grid,
    rounds: u32,
    log: &mut Vec<String>,
    skipped: &mut Vec<String>,
) -> Result<Vec<Measured>> {
    let mut found: Vec<Option<Measured>> = Vec::new();
    for peer in peers.iter_mut() {
        match peer.extract(grid, true) {
            Ok(outcome) => found.push(Some(Measured {
                peer: label(&peer.name()).to_owned(),
                extraction_s: Vec::new(),
                sampling_s: Vec::new(),
                mesh: outcome.mesh.unwrap_or_default(),
            })),
            Err(error) => {
                let Grid { field, cells, .. } = grid;
                skip(skipped, format!("{} on the {field} of {cells} cells: {error:#}", label(&peer.name())));
                found.push(None);
            }
        }
    }
    for round in 0..rounds {
        for (place, subject) in order(SEED, round, peers.len()).into_iter().enumerate() {
            let Some(measured) = &mut found[subject] else { continue };
            let Outcome { extraction_s, sampling_s, .. } = peers[subject].extract(grid, false)?;
            let (field, cells, peer) = (grid.field, grid.cells, &measured.peer);
            log.push(format!("{field},{cells},{peer},{round},{place},{extraction_s},{sampling_s}"));
            measured.extraction_s.push(extraction_s);
            measured.sampling_s.push(sampling_s);
        }
    }
    Ok(found.into_iter().flatten().collect())
}
