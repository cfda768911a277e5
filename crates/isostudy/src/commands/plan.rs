//! `isostudy plan`: the jobs of a study, for a scheduler.

use super::checked_study;
use super::simulation_jobs::PowerJobs;
use super::study_run::default_folder;
use crate::outcome::Outcome;
use crate::pipeline::{Pipeline, Planned, by_kind};
use crate::store::{Store, sha256};
use crate::terminal::{counted, say};
use crate::{input, recipe};
use anyhow::Result;
use clap::Args;
use isostudy_inference::series::Part;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  isostudy plan configs/quick.toml --json > plan.json
  isostudy job configs/quick.toml mesh/benchmark/ss_bi")]
pub(crate) struct Arguments {
    /// Study file, such as configs/paper.toml
    study: PathBuf,
    /// Folder for results [default: results/<study id>]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Add the jobs of `isostudy design power` in so many parts, with its default arguments
    #[arg(long, value_name = "PARTS", value_parser = clap::value_parser!(u64).range(1..=Part::MOST))]
    power: Option<u64>,
    /// Print JSON: every job with what it needs, leaves, depends on and is expected to take
    #[arg(long)]
    json: bool,
}

/// What a scheduler reads.
#[derive(Serialize)]
struct Plan {
    schema: u32,
    study: PathBuf,
    /// Of the study file.
    sha256: String,
    out: PathBuf,
    jobs: Vec<Planned>,
}

/// Lists the jobs; nothing is made but trials on few cells.
///
/// # Errors
/// If the study is wrong.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = checked_study::load(&arguments.study)?;
    recipe::check(&study)?;
    let out = arguments.out.clone().unwrap_or_else(|| default_folder(&study));
    let mut jobs = Pipeline::new(&study, Store::nowhere(&out), 1).planned()?;
    if let Some(parts) = arguments.power {
        jobs.extend(PowerJobs::of(&study)?.planned(parts));
    }
    if arguments.json {
        let sha256 = sha256(&input::bytes(&study.path)?);
        let plan = Plan { schema: 1, study: arguments.study.clone(), sha256, out, jobs };
        say(&serde_json::to_string_pretty(&plan)?)?;
        return Ok(Outcome::Done);
    }
    for (kind, of) in by_kind(&jobs) {
        let known = counted(of.jobs - of.unknown, "job");
        let unknown = format!("{} of unknown time", counted(of.unknown, "job"));
        let said = match (of.jobs - of.unknown, of.unknown) {
            (0, _) => unknown,
            (_, 0) => format!("{known}, about {:.0} s on one core", of.seconds),
            _ => format!("{known}, about {:.0} s on one core, and {unknown}", of.seconds),
        };
        say(&format!("{kind:<12} {said}"))?;
    }
    say(&format!("{} in all; --json lists them", counted(jobs.len() as u64, "job")))?;
    Ok(Outcome::Done)
}
