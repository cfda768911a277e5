//! `isostudy bench import`: a run made of a published table.

use crate::input;
use crate::outcome::Outcome;
use crate::store::write_whole;
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::Args;
use isostudy_design::machine::CpuProfile;
use isostudy_design::published::read_benchmark;
use std::path::{Path, PathBuf};

/// In the program, so that a table can be imported from any folder.
const PAPERS_MACHINE: &str = include_str!("../../../../../configs/cpu/i7-11700.toml");

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Table with the columns of study/paper/published_benchmark.csv
    table: PathBuf,
    /// Where to write the run
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Where the table is from
    #[arg(long, default_value = "Costen (2026)", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    source: String,
    /// The machine it was measured on [default: the paper's, as configs/cpu/i7-11700.toml has it]
    #[arg(long, value_name = "TOML")]
    machine: Option<PathBuf>,
    /// How many rounds each mean is of
    #[arg(long, default_value_t = 100, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// How many threads sampled
    #[arg(long, default_value_t = 16, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    threads: u32,
}

/// Writes the run that a table of means makes.
///
/// # Errors
/// If the table or the machine cannot be read, or the run not be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let machine = match &arguments.machine {
        Some(path) => {
            input::regular(path)?;
            CpuProfile::load(path)?
        }
        None => CpuProfile::parse(PAPERS_MACHINE, Path::new("configs/cpu/i7-11700.toml"))?,
    };
    input::regular(&arguments.table)?;
    let rows = read_benchmark(&arguments.table)?;
    let run =
        isostudy_bench::import(&rows, &arguments.source, arguments.iterations, arguments.threads, &machine)
            .with_context(|| arguments.table.display().to_string())?;
    let mut json = serde_json::to_vec_pretty(&run)?;
    json.push(b'\n');
    write_whole(&arguments.out, &json)?;
    say(&arguments.out.display().to_string())?;
    Ok(Outcome::Done)
}
