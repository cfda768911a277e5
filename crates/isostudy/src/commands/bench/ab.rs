//! `isostudy bench ab`: two builds in the same rounds.

use super::compare::share;
use crate::commands::study_run::{Run, Selection, with_selection};
use crate::input;
use crate::outcome::Outcome;
use crate::pipeline::{AbChoice, Build};
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use isostudy_design::record::AbRun;
use isostudy_timing::{AbComparison, Quantity};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Two builds, and the study that both are asked for.
#[derive(Debug, Args)]
pub(super) struct Builds {
    /// The program that the other is compared with: an isostudy of an earlier commit, or a folder of links of it
    old: PathBuf,
    /// The program that is judged, or a folder of links of it
    new: PathBuf,
    #[command(flatten)]
    run: Run,
    /// Take this configuration alone, such as ss_bi; may be given several times
    #[arg(long, value_name = "ID")]
    only: Vec<String>,
}

impl Builds {
    /// OLD and NEW.
    ///
    /// # Errors
    /// If either is not there, or both are folders of unequal size.
    pub(super) fn found(&self) -> Result<[Build; 2]> {
        let (old, new) = (build(&self.old)?, build(&self.new)?);
        let (a, b) = (old.links.len(), new.links.len());
        if a > 1 && b > 1 && a != b {
            let [old, new] = [&self.old, &self.new].map(|path| path.display());
            bail!(
                "{old} has {a} links and {new} has {b}: both need as many, or one of them a single program"
            );
        }
        Ok([old, new])
    }

    pub(super) fn selection(&self) -> Selection {
        Selection { run: self.run.clone(), only: self.only.clone() }
    }
}

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    builds: Builds,
    /// Measure for so many seconds
    #[arg(long, default_value_t = 170, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    seconds: u32,
    /// Measure in so many pairs of processes; the more there are, the less chance gives either program
    #[arg(long, default_value_t = 16, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    processes: u32,
    /// End either program if an answer takes longer than so many seconds
    #[arg(long, default_value_t = 600, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    time_limit: u32,
    /// What decides. CPU time and instructions hardly change beside other work, but do not show threads that wait
    #[arg(long, default_value = "time")]
    by: By,
    /// Slower is a regression beyond this share: 0.01, or 1%
    #[arg(long, default_value = "0.01", value_name = "SHARE", value_parser = share)]
    relative: f64,
    /// Exit 3 if growth of all totals together by this share would not have been told
    #[arg(long, value_name = "SHARE", value_parser = share)]
    must_tell: Option<f64>,
    /// Print every row as a table, in place of ten lines
    #[arg(long)]
    all: bool,
    /// Print every row in this format
    #[arg(long)]
    format: Option<Format>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum By {
    Time,
    CpuTime,
    Instructions,
}

impl From<By> for Quantity {
    fn from(by: By) -> Self {
        match by {
            By::Time => Self::Time,
            By::CpuTime => Self::CpuTime,
            By::Instructions => Self::Instructions,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Markdown,
    Csv,
    Json,
}

/// What a program reads.
#[derive(Serialize)]
struct Record<'a> {
    exit_status: u8,
    by: Quantity,
    relative: f64,
    must_tell: Option<f64>,
    regressions: Vec<&'a isostudy_timing::AbRow>,
    #[serde(flatten)]
    comparison: &'a AbComparison,
}

/// Measures both, and says whether the new one is slower.
///
/// # Errors
/// If a program or the study is wrong, or a measurement fails.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let [old, new] = arguments.builds.found()?;
    let selection = arguments.builds.selection();
    let mut judged = Outcome::Done;
    let done = with_selection(&selection, |pipeline, only, _| {
        let choice = AbChoice {
            old,
            new,
            only: only.to_vec(),
            processes: arguments.processes,
            seconds: f64::from(arguments.seconds),
            time_limit: Duration::from_secs(arguments.time_limit.into()),
        };
        let run = pipeline.ab(&choice)?;
        judged = answer(arguments, &run)?;
        Ok(())
    })?;
    Ok(if done == Outcome::Done { judged } else { done })
}

fn answer(arguments: &Arguments, run: &AbRun) -> Result<Outcome> {
    let comparison = isostudy_timing::ab(run);
    let by = Quantity::from(arguments.by);
    if comparison.of(by).next().is_none() {
        bail!("--by {}: not every sample has it, on this system or of these programs", by.label());
    }
    let regressions = comparison.regressions(by, arguments.relative);
    let blind = arguments.must_tell.is_some_and(|share| !comparison.would_tell(by, share));
    let outcome = match () {
        () if !(regressions.is_empty() && run.failed.is_empty()) => Outcome::CheckFailed,
        () if blind => Outcome::Blind,
        () => Outcome::Done,
    };
    match arguments.format.or(arguments.all.then_some(Format::Markdown)) {
        None => {
            for line in comparison.brief(run) {
                say(&line)?;
            }
        }
        Some(Format::Markdown) => say(&comparison.table().to_markdown())?,
        Some(Format::Csv) => say(&comparison.table().to_csv())?,
        Some(Format::Json) => {
            let record = Record {
                exit_status: outcome.status(),
                by,
                relative: arguments.relative,
                must_tell: arguments.must_tell,
                regressions,
                comparison: &comparison,
            };
            say(&serde_json::to_string_pretty(&record)?)?;
        }
    }
    Ok(outcome)
}

/// A program, or every file in a folder, in the order of their names.
fn build(path: &Path) -> Result<Build> {
    if !path.is_dir() {
        return Ok(Build { path: path.to_owned(), links: vec![program(path)?] });
    }
    let listed = || path.display().to_string();
    let mut links = Vec::new();
    for entry in std::fs::read_dir(path).with_context(listed)? {
        links.push(program(&entry.with_context(listed)?.path())?);
    }
    links.sort();
    if links.is_empty() {
        bail!("{}: a folder of links of one program, and it is empty", path.display());
    }
    Ok(Build { path: path.to_owned(), links })
}

/// A file, wherever it is started from.
fn program(path: &Path) -> Result<PathBuf> {
    input::regular(path)?;
    let found = std::fs::canonicalize(path);
    let found = found.with_context(|| format!("cannot find the program {}", path.display()))?;
    Ok(found)
}
