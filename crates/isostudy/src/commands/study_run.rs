//! What commands that work on a study have in common: the options that say which, and the pipeline that does the work.

use super::checked_study;
use crate::consent;
use crate::origin;
use crate::outcome::Outcome;
use crate::pipeline::Pipeline;
use crate::recipe;
use crate::store::Store;
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_design::wording::did_you_mean;
use isostudy_design::{ConfigurationId, Study};
use std::path::{Path, PathBuf};

/// Where a study is read from and written to.
#[derive(Debug, Clone, Args)]
pub(crate) struct Run {
    /// Study file, such as configs/paper.toml
    pub(super) study: PathBuf,
    /// Folder for results [default: results/<study id>]
    #[arg(long, short, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Redo what is up to date as well
    #[arg(long)]
    pub(super) force: bool,
    /// Threads to work with; 0 takes every core. Meshes and pictures are the same bytes with any number; timings
    /// take the study's own
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    pub(super) threads: u32,
    /// Run the programs that the study names as methods; they may do whatever you may do. It is remembered until one of
    /// their files changes
    #[arg(long)]
    pub(super) allow_programs: bool,
    /// Run programs by bubblewrap: without a network, in a folder of their own, the system read-only
    #[arg(long)]
    pub(super) sandbox: bool,
}

/// Some of a study's configurations, of commands that take other input than studies as well.
#[derive(Debug)]
pub(super) struct Selection {
    pub(super) run: Run,
    /// Ids, as they were given; none for all.
    pub(super) only: Vec<String>,
}

/// Work that ends with the page. A published number that differs from ours without a known reason fails the check.
///
/// # Errors
/// As [`with_pipeline`].
pub(super) fn with_page(
    run: &Run,
    work: impl FnOnce(&mut Pipeline<'_>) -> Result<Vec<String>>,
) -> Result<Outcome> {
    let mut as_published = true;
    let outcome = with_pipeline(run, |pipeline, out| {
        for difference in work(pipeline)? {
            tell!("differs from what was published: {difference}");
            as_published = false;
        }
        say(&out.join("index.html").display().to_string())
    })?;
    Ok(if as_published { outcome } else { Outcome::CheckFailed })
}

/// Work on a study that runs none of its programs.
///
/// # Errors
/// As [`with_pipeline`], but for programs.
pub(super) fn without_programs(
    run: &Run,
    work: impl FnOnce(&mut Pipeline<'_>, &Path) -> Result<()>,
) -> Result<Outcome> {
    on(run, &checked_study::load(&run.study)?, work)
}

/// Work on a study's results. A configuration whose program failed fails the check, after all else was done.
///
/// # Errors
/// If the study is wrong, or would run programs that are not allowed; if its results are held by another run; what `work` returns.
pub(super) fn with_pipeline(
    run: &Run,
    work: impl FnOnce(&mut Pipeline<'_>, &Path) -> Result<()>,
) -> Result<Outcome> {
    let study = checked_study::load(&run.study)?;
    consent::ask(&study, run.allow_programs, run.sandbox)?;
    recipe::check(&study)?;
    on(run, &study, work)
}

fn on(
    run: &Run,
    study: &Study,
    work: impl FnOnce(&mut Pipeline<'_>, &Path) -> Result<()>,
) -> Result<Outcome> {
    let threads = run.threads as usize;
    if threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let out = run.out.clone().unwrap_or_else(|| default_folder(study));
    let store = Store::open(&out, run.force)?;
    origin::claim(&out, &study.path)?;
    let mut pipeline = Pipeline::new(study, store, threads);
    work(&mut pipeline, &out)?;
    pipeline.finish()?;
    let failed: Vec<String> = pipeline.failed().iter().map(ToString::to_string).collect();
    if failed.is_empty() {
        return Ok(Outcome::Done);
    }
    tell!("failed and left out: {}", failed.join(", "));
    Ok(Outcome::CheckFailed)
}

/// The same for some configurations, or all where none is named.
///
/// # Errors
/// If the study has not got one of them; as [`with_pipeline`].
pub(super) fn with_selection(
    selection: &Selection,
    work: impl FnOnce(&mut Pipeline<'_>, &[ConfigurationId], &Path) -> Result<()>,
) -> Result<Outcome> {
    let study = checked_study::load(&selection.run.study)?;
    let mut only = Vec::new();
    for text in &selection.only {
        let id: ConfigurationId = text.parse().with_context(|| format!("--only {text}"))?;
        if !study.configurations.iter().any(|configuration| configuration.id == id) {
            let known: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
            let meant = did_you_mean(text, known.iter().map(String::as_str));
            bail!("--only {text}: this study has {}{meant}", known.join(", "));
        }
        only.push(id);
    }
    with_pipeline(&selection.run, |pipeline, out| work(pipeline, &only, out))
}

/// Where a study's results are kept, if nothing else is said.
pub(super) fn default_folder(study: &Study) -> PathBuf {
    Path::new("results").join(&study.file.study.id)
}
