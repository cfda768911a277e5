//! Extracts with another crate, as a program of a study: `peers-worker --method NAME`, then lines of JSON as `docs/programs.md` has
//! them. `peers-worker --list` names the methods.

mod baby_shark;
mod fast_surface_nets;
mod ferreus_rmt;
mod isomesh;
mod isosurface;
mod mcubes;
mod polyscope_core;
mod request;
mod splashsurf_lib;
mod transvoxel;
mod trilinear;

use isostudy_mesh::{TriangleMesh, write_ply};
use request::Request;
use serde_json::{Value, json};
use std::error::Error;
use std::fs::File;
use std::io::{BufRead, Write, stdin, stdout};

/// What came of a request.
pub(crate) struct Extraction {
    /// The crate's own time.
    pub(crate) extraction_s: f64,
    /// What making its input and taking its output took.
    pub(crate) callback_s: f64,
    /// In the samples' space, facing outward.
    pub(crate) mesh: TriangleMesh,
}

/// A crate that extracts; `Err` is why it cannot.
type Extract = Box<dyn FnMut(&Request, &[f32]) -> Result<Extraction, String>>;

/// Name, version, what is in its time, extractor.
type Method = (&'static str, &'static str, &'static str, fn() -> Extract);

const METHODS: [Method; 14] = [
    (
        "baby-shark-dual-contouring",
        "0.3.12",
        "three vertices for each triangle, none shared; filling its sparse grid is not in its time",
        baby_shark::dual_contouring,
    ),
    (
        "baby-shark-marching-cubes",
        "0.3.12",
        "three vertices for each triangle, none shared; filling its sparse grid is not in its time",
        baby_shark::marching_cubes,
    ),
    ("fast-surface-nets", "0.2.1", "normals are in its time", fast_surface_nets::extractor),
    (
        "ferreus-rmt",
        "0.1.0",
        "calls of the interpolant and finding points on the surface to start from are not in its time",
        ferreus_rmt::extractor,
    ),
    (
        "isomesh-dual-contouring",
        "0.0.14",
        ISOMESH,
        isomesh::extractor::<::isomesh::dual_contouring::DualContouring<f32>>,
    ),
    (
        "isomesh-manifold-dual-contouring",
        "0.0.14",
        ISOMESH,
        isomesh::extractor::<::isomesh::manifold_dual_contouring::ManifoldDualContouring<f32>>,
    ),
    (
        "isomesh-marching-cubes",
        "0.0.14",
        ISOMESH,
        isomesh::extractor::<::isomesh::marching_cubes::MarchingCubes<f32>>,
    ),
    (
        "isomesh-marching-tetrahedra",
        "0.0.14",
        ISOMESH,
        isomesh::extractor::<::isomesh::marching_tetrahedra::MarchingTetrahedra<f32>>,
    ),
    (
        "isomesh-surface-nets",
        "0.0.14",
        ISOMESH,
        isomesh::extractor::<::isomesh::surface_nets::SurfaceNets<f32>>,
    ),
    (
        "isosurface",
        "0.0.4",
        "looking samples up is in its time; it does not join its vertices",
        isosurface::extractor,
    ),
    (
        "mcubes",
        "0.1.7",
        "three vertices for each triangle, none shared; normals are in its time",
        mcubes::extractor,
    ),
    ("polyscope-core", "0.5.10", "normals are in its time", polyscope_core::extractor),
    ("splashsurf-lib", "0.14.1", "its time is that of hash maps of cells", splashsurf_lib::extractor),
    ("transvoxel", "2.0.0", "looking samples up and normals are in its time", transvoxel::extractor),
];

/// What is in the time of each extractor of isomesh.
const ISOMESH: &str = "calls of its own interpolant of the samples, and normals, are in its time";

fn main() {
    if let Err(error) = run() {
        eprintln!("peers-worker: {error}");
        std::process::exit(2);
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let names = METHODS.map(|method| method.0).join(", ");
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let name = match words[..] {
        ["--list"] => {
            println!("{names}");
            return Ok(());
        }
        ["--method", name] => name,
        _ => return Err("usage: peers-worker --method NAME, or --list".into()),
    };
    let found = METHODS.into_iter().find(|method| method.0 == name);
    let (name, version, note, extractor) = found.ok_or(format!("--method {name}: known are {names}"))?;
    // Times of one and of many threads are not comparable.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let mut extract = extractor();
    say(&json!({ "ready": { "name": name, "version": version, "note": note } }))?;
    for line in stdin().lock().lines() {
        let request: Request = serde_json::from_str(&line?)?;
        let answer = answer(&request, &mut extract);
        say(&answer.unwrap_or_else(|failed| json!({ "id": request.id, "failed": failed })))?;
    }
    Ok(())
}

fn answer(request: &Request, extract: &mut Extract) -> Result<Value, String> {
    let samples = request.read_samples()?;
    let Extraction { extraction_s, callback_s, mesh } = extract(request, &samples)?;
    if let Some(path) = &request.mesh {
        let written = File::create(path).and_then(|file| write_ply(&mesh, file));
        written.map_err(|error| format!("{}: {error}", path.display()))?;
    }
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    Ok(json!({
        "id": request.id,
        "extraction_s": extraction_s,
        "callback_s": callback_s,
        "vertices": vertices,
        "triangles": triangles,
    }))
}

fn say(line: &Value) -> std::io::Result<()> {
    let mut out = stdout().lock();
    writeln!(out, "{line}")?;
    out.flush()
}
