//! A benchmark run read back, and checked before anything is made of it.

use crate::input;
use anyhow::{Context, Result, bail};
use design::record::BenchRun;
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
#[serde(expecting = "a run, as `isostudy bench` writes it")]
struct Versioned {
    schema: u32,
}

/// Reads a run. Errors name the file and the place in it.
pub(crate) fn read(path: &Path) -> Result<BenchRun> {
    let name = || path.display().to_string();
    let text = input::bytes(path)?;
    let Versioned { schema } = serde_json::from_slice(&text).with_context(name)?;
    if schema != BenchRun::SCHEMA {
        bail!("{}: schema = {schema}: this version reads {}", name(), BenchRun::SCHEMA);
    }
    let run: BenchRun = serde_json::from_slice(&text).with_context(name)?;
    run.check().with_context(name)?;
    Ok(run)
}
