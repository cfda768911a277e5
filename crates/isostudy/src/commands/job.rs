//! `isostudy job`: jobs of a study, beside others on the same folder.

use super::checked_study;
use super::simulation_jobs::{PowerJob, PowerJobs};
use super::study_run::{Run, default_folder, with_page};
use crate::outcome::Outcome;
use crate::pipeline::{Pipeline, REPORT};
use crate::store::Store;
use crate::terminal::counted;
use crate::{consent, origin, recipe};
use anyhow::{Result, bail};
use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "\
A job that is up to date is not done again. Jobs may be killed at any moment, and run side by side on one
folder, on one machine or several. A job ends with 0 where a program failed: the report leaves it out.

Example:
  isostudy job configs/quick.toml mesh/benchmark/ss_bi mesh/benchmark/ss_bu")]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
    /// Jobs, as `isostudy plan` lists them; several of one object share what is found of it
    #[arg(required = true, value_name = "ID")]
    ids: Vec<String>,
    /// Refuse if a job no longer has this digest of the plan: then the study, or a file that it names, has changed. One for each ID
    #[arg(long, value_name = "HEX", value_delimiter = ',')]
    digests: Vec<String>,
}

/// Does the jobs, in this order.
///
/// # Errors
/// If there is no such job, or another digest; if a job that it needs was not done.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let Arguments { run, ids, digests } = arguments;
    if !digests.is_empty() && digests.len() != ids.len() {
        bail!(
            "--digests has {} for {}",
            counted(digests.len() as u64, "digest"),
            counted(ids.len() as u64, "job")
        );
    }
    if ids.iter().any(|id| id == REPORT) {
        if ids.len() > 1 {
            bail!("{REPORT}: it takes the whole folder, and is the only job of a command");
        }
        return with_page(run, |pipeline| {
            pipeline.check_digests(ids, digests)?;
            pipeline.report()
        });
    }
    let study = checked_study::load(&run.study)?;
    consent::ask(&study, run.allow_programs, run.sandbox)?;
    recipe::check(&study)?;
    let threads = run.threads as usize;
    if threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let out = run.out.clone().unwrap_or_else(|| default_folder(&study));
    let store = Store::open_beside(&out, run.force)?;
    origin::claim(&out, &study.path)?;
    let simulations = ids.iter().map(|id| PowerJob::of(id)).collect::<Result<Vec<_>>>()?;
    if simulations.iter().any(Option::is_some) {
        let power = PowerJobs::of(&study)?;
        for (place, (id, job)) in ids.iter().zip(&simulations).enumerate() {
            let Some(job) = job else { bail!("{id}: give simulations a command of their own") };
            let stamp = power.carry_out(*job, &store, digests.get(place))?;
            let done = if stamp.redone { "made" } else { "up to date" };
            tell!("{id}: {done}");
        }
        return Ok(Outcome::Done);
    }
    let mut pipeline = Pipeline::new(&study, store, threads);
    pipeline.check_digests(ids, digests)?;
    for id in ids {
        if let Some(why) = pipeline.job(id)? {
            tell!("left out: {why}");
        }
    }
    Ok(Outcome::Done)
}
