//! `isostudy bench count`: the instructions of two builds.

use super::ab::Builds;
use super::compare::share;
use crate::commands::study_run::with_selection;
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::Result;
use clap::Args;
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    builds: Builds,
    /// End either program if an answer takes longer than so many seconds; valgrind makes it some 30 times slower
    #[arg(long, default_value_t = 3600, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    time_limit: u32,
    /// More instructions are a regression beyond this share: 0.01, or 1%
    #[arg(long, default_value = "0.01", value_name = "SHARE", value_parser = share)]
    relative: f64,
    /// Print every row as a table
    #[arg(long)]
    all: bool,
}

/// Counts both, the first of a build's links, and says whether the new one takes more.
///
/// # Errors
/// If a program or the study is wrong, or valgrind is not there.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let builds = arguments.builds.found()?;
    let selection = arguments.builds.selection();
    let mut judged = Outcome::Done;
    let done = with_selection(&selection, |pipeline, only, _| {
        let time_limit = Duration::from_secs(arguments.time_limit.into());
        let found = pipeline.counted(&builds, only, time_limit)?;
        if !found.dearer(arguments.relative).is_empty() {
            judged = Outcome::CheckFailed;
        }
        if arguments.all {
            say(&found.table().to_markdown())?;
        }
        found.brief(arguments.relative).iter().try_for_each(|line| say(line))
    })?;
    Ok(if done == Outcome::Done { judged } else { done })
}
