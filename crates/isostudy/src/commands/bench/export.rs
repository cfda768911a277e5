//! `isostudy bench export`: a run in the formats of other benchmarks, for the programs that read those.

use super::compare::run_at;
use crate::outcome::Outcome;
use crate::run_file;
use crate::store::write_whole;
use crate::terminal::say;
use anyhow::Result;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Results folder, or a run.json in it
    run: PathBuf,
    /// Whose format
    #[arg(long)]
    to: Format,
    /// File for hyperfine's, folder for criterion's
    #[arg(long, short, value_name = "PATH")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// One file: `results`, a configuration each
    Hyperfine,
    /// A folder for each configuration, as below target/criterion
    Criterion,
}

/// Writes the run's totals.
///
/// # Errors
/// If the run cannot be read or a file not be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let run = run_file::read(&run_at(&arguments.run)?)?;
    match arguments.to {
        Format::Hyperfine => write(&arguments.out, &isostudy_timing::export::hyperfine(&run))?,
        Format::Criterion => {
            for found in isostudy_timing::export::criterion(&run) {
                let folder = arguments.out.join(&found.benchmark.directory_name).join("new");
                write(&folder.join("benchmark.json"), &found.benchmark)?;
                write(&folder.join("sample.json"), &found.sample)?;
                write(&folder.join("estimates.json"), &found.estimates)?;
            }
        }
    }
    say(&arguments.out.display().to_string())?;
    Ok(Outcome::Done)
}

fn write(path: &Path, value: &impl Serialize) -> Result<()> {
    let mut json = serde_json::to_vec_pretty(value)?;
    json.push(b'\n');
    write_whole(path, &json)
}
