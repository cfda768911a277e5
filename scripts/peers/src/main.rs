//! Extracts with another crate, as a program of a study: `peers-worker --method NAME`, then lines of JSON as `docs/programs.md` has
//! them. `peers-worker --list` names the methods.

mod fast_surface_nets;
mod isosurface;
mod request;
mod transvoxel;

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

const METHODS: [Method; 3] = [
    ("fast-surface-nets", "0.2.1", "normals are in its time", fast_surface_nets::extractor),
    (
        "isosurface",
        "0.0.4",
        "looking samples up is in its time; it does not join its vertices",
        isosurface::extractor,
    ),
    ("transvoxel", "2.0.0", "looking samples up and normals are in its time", transvoxel::extractor),
];

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
