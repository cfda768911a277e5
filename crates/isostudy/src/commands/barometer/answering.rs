//! `isostudy barometer engine`: a method of isostudy behind the protocol of docs/programs.md, as other programs are.

use crate::outcome::Outcome;
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_extract::{Execution, Extractor, Method, VolumeCells, presets};
use isostudy_mesh::write_ply;
use serde::Deserialize;
use serde_json::json;
use std::fs::File;
use std::io::{BufRead, BufWriter, Write};
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Method by its name, such as mc33: `isostudy methods` lists them
    method: String,
}

/// A request's line.
#[derive(Debug, Deserialize)]
struct Request {
    id: u64,
    samples: PathBuf,
    size: [usize; 3],
    origin: [f64; 3],
    spacing: [f64; 3],
    isovalue: f32,
    mesh: Option<PathBuf>,
}

/// Answers until the input ends.
///
/// # Errors
/// If there is no such method, or a line is no request.
pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let Some(preset) = presets().iter().find(|preset| preset.id == arguments.method) else {
        bail!("{}: there is no such method; `isostudy methods` lists them", arguments.method);
    };
    let (name, version) = (format!("isostudy {}", preset.id), env!("CARGO_PKG_VERSION"));
    let note = "normals are not in its time; buffers are kept from one answer to the next, as its documentation advises";
    answer(&json!({"ready": {"name": name, "version": version, "note": note}}))?;
    let mut extractor = Extractor::new();
    for line in std::io::stdin().lock().lines() {
        let request: Request =
            serde_json::from_str(&line?).context("a line of standard input is no request")?;
        let id = request.id;
        match extracted(&preset.method, &mut extractor, &request) {
            Ok(counts) => answer(&counts)?,
            Err(error) => answer(&json!({"id": id, "failed": format!("{error:#}")}))?,
        }
    }
    Ok(Outcome::Done)
}

fn answer(line: &serde_json::Value) -> Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}")?;
    Ok(out.flush()?)
}

fn extracted(method: &Method, extractor: &mut Extractor, request: &Request) -> Result<serde_json::Value> {
    let bytes = std::fs::read(&request.samples).with_context(|| request.samples.display().to_string())?;
    let values: Vec<f32> =
        bytes.chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect();
    drop(bytes);
    let step = |axis: usize| {
        let mut step = [0.0; 3];
        step[axis] = request.spacing[axis];
        step
    };
    let steps = [step(0), step(1), step(2)];
    let volume = VolumeCells { counts: request.size, values: &values, origin: request.origin, steps };
    let execution = Execution { threads: 1 };
    let start = Instant::now();
    let found = volume.extract_interpolated(method, extractor, request.isovalue, &execution)?;
    let all = start.elapsed();
    if let Some(path) = &request.mesh {
        let mut out = BufWriter::new(File::create(path).with_context(|| path.display().to_string())?);
        write_ply(&found.mesh, &mut out)?;
        out.flush()?;
    }
    Ok(json!({
        "id": request.id,
        "extraction_s": all.saturating_sub(found.times.normals).as_secs_f64(),
        "vertices": found.mesh.positions.len(),
        "triangles": found.mesh.triangles.len(),
    }))
}
