//! The chain of stages from a study file to the page that shows it all.
//!
//! ```text
//! objects ─ budgets ─ meshes ─┬─ turntables ─┬─ pairs, key ─┐
//! comparisons ─ forms, key ───┼──────────────┼──────────────┤
//!                             ├─ stills ─────┼──────────────┤
//!                             └─ viewer ─────┼──────────────┤
//! objects ─ budgets ─ timings ─┤             │              ├─ page ─ manifest
//! objects ─────────── chunks ──┤             │              │
//! sweep ── cases, their times ─┤             │              │
//!              first frames ───┼─────────────┘              │
//! answers ─────────────────────┴─ tables, figures, report ──┘
//! ```

mod ab;
mod accuracies;
mod budgets;
mod bundle;
mod cases;
mod expected;
mod films;
mod formats;
mod jobs;
mod measurements;
mod meshes;
mod models;
mod pages;
mod pictures;
mod stimuli;
mod tables;
mod thread_sweep;
mod times_apart;
mod timings;
mod viewer;
mod web;
mod worker;

pub(crate) use ab::{AbChoice, Build};
use accuracies::Accuracies;
pub(crate) use bundle::forms_digest;
pub(crate) use films::Shown;
pub(crate) use jobs::{Planned, REPORT, by_kind};
pub(crate) use meshes::Meshes;
pub(crate) use models::{MOST_BYTES, library_of_models, models_folder};
pub(crate) use stimuli::MadeWith;
pub(crate) use tables::{Said, write_answers_only, write_without_study};
pub(crate) use timings::{Choice, PlanLength};
pub(crate) use web::Videos;
pub(crate) use worker::{Invocation, measure};

use crate::families::CannotMake;
use crate::fields::Fields;
use crate::made;
use crate::prepare::{Prepared, Spacings, Wanted, prepare};
use crate::store::{Inputs, Stamp, Store, Writer};
use anyhow::{Context, Result, bail};
use isostudy_design::record::Purpose;
use isostudy_design::sweep::Sweep;
use isostudy_design::{Configuration, ConfigurationId, Study};
use measurements::Times;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard};
use viewer::Viewer;

/// Stages that only commands of their own make; a whole study leaves them in place.
const ASKED_FOR: [&str; 6] = ["bench/", "bundle", "contact_sheet", "power/", "video/", "web"];

/// Which stages of meshes, animations and timings are made where they are not up to date; the others are only looked up.
#[derive(Debug, Clone, PartialEq)]
enum Making {
    All,
    None,
    /// The one with this name, which is a job.
    Only(String),
}

/// One study being worked on.
pub(crate) struct Pipeline<'a> {
    study: &'a Study,
    store: Store,
    fields: Fields<'a>,
    /// What is tried beyond objects and methods as they stand.
    sweep: Option<Sweep<'a>>,
    threads: usize,
    /// Which meshes, animations and timings are made where they are not up to date.
    making: Making,
    /// What was found for methods with a budget.
    spacings: RwLock<Spacings>,
    accuracies: Mutex<Accuracies>,
    /// Configurations whose program or front failed, and why.
    failed: RwLock<BTreeMap<ConfigurationId, String>>,
}

impl<'a> Pipeline<'a> {
    pub(crate) fn new(study: &'a Study, store: Store, threads: usize) -> Self {
        Self {
            study,
            store,
            fields: Fields::new(study),
            sweep: study.sweep(),
            threads,
            making: Making::All,
            spacings: RwLock::default(),
            accuracies: Mutex::default(),
            failed: RwLock::default(),
        }
    }

    /// The whole study. What an earlier form of it left behind goes. Returns the published
    /// numbers that ours differ from without a known reason.
    pub(crate) fn study(&self) -> Result<Vec<String>> {
        if self.study.shown_files().is_some() {
            return self.study_of_files();
        }
        let meshes = self.all_meshes(&[])?;
        let turntables = self.turntables(&meshes, &[])?;
        let pairs = self.pairs(&turntables)?;
        self.finished_videos(&pairs)?;
        let forms: Vec<Stamp> = self.forms()?.into_iter().collect();
        let stills = self.stills()?;
        let timings = self.timings(&PlanLength::Short)?;
        let chunks = self.chunk_times(None)?;
        let stored = self.stored_times(None)?;
        let times = Times { whole: &timings, chunks: &chunks, stored: &stored };
        let swept = self.sweep_cases()?;
        let shown = self.shown_first(&meshes, &times)?;
        let pictures = self.pictures(&turntables, &shown)?;
        let tables = self.tables(&meshes, &times, &pictures, (&shown, swept))?;
        let viewer = self.viewer(&meshes, &shown)?;
        let made =
            [turntables, pairs, forms, stills, pictures, chunks, stored, vec![timings, tables]].concat();
        self.page(&meshes, &made, viewer, Some(&shown))?;
        // What failed as a job may be asked for by another, until somebody does the whole study.
        let is_by_jobs = self.making != Making::All;
        self.store.retire_untouched(|stage| {
            ASKED_FOR.iter().any(|start| stage.starts_with(start))
                || is_by_jobs && stage.starts_with("failed/")
        })?;
        self.unexplained()
    }

    /// The whole of a study that shows files: what is shown, the forms, and what was answered.
    fn study_of_files(&self) -> Result<Vec<String>> {
        let Shown { meshes, turntables, pairs } = self.shown()?;
        self.finished_videos(&pairs)?;
        let forms: Vec<Stamp> = self.forms()?.into_iter().collect();
        let tables = self.tables_of_answers()?;
        let made = [turntables, pairs, forms, vec![tables]].concat();
        self.page(&meshes, &made, Viewer::NotAskedFor, None)?;
        self.store.retire_untouched(|stage| ASKED_FOR.iter().any(|start| stage.starts_with(start)))?;
        self.unexplained()
    }

    /// Tables, figures and the page again, from what is there.
    pub(crate) fn report(&mut self) -> Result<Vec<String>> {
        self.making = Making::None;
        self.study()
    }

    /// A configuration, with the spacing that was found for it.
    fn prepare(&self, configuration: &Configuration, wanted: Wanted) -> Result<Prepared<'_>> {
        prepare(self.study, &self.fields, &self.spacings(), configuration, wanted)
    }

    /// What was found for methods with a budget.
    fn spacings(&self) -> RwLockReadGuard<'_, Spacings> {
        read(&self.spacings)
    }

    /// The spacings that budgets led to.
    pub(crate) fn found_spacings(&self) -> Spacings {
        self.spacings().clone()
    }

    fn keep_spacing(&self, id: ConfigurationId, purpose: Purpose, spacing: f64) {
        self.spacings.write().unwrap_or_else(PoisonError::into_inner).keep(id, purpose, spacing);
    }

    /// Whether a configuration's program failed: the others go on without it.
    fn has_failed(&self, id: &ConfigurationId) -> bool {
        read(&self.failed).contains_key(id)
    }

    /// Keeps why a configuration failed, and says it, if its program or its front is to blame.
    ///
    /// # Errors
    /// Anything else that went wrong.
    fn fail(&self, id: &ConfigurationId, error: anyhow::Error) -> Result<()> {
        // A job that may do better another time fails, so that a scheduler starts it again.
        let is_job = matches!(self.making, Making::Only(_));
        if made::own_failure(&error).is_none() || is_job && !made::fails_again(&error) {
            return Err(error);
        }
        self.leave_out(id, format!("{error:#}"));
        Ok(())
    }

    /// Goes on without a configuration.
    fn leave_out(&self, id: &ConfigurationId, why: String) {
        tell!("{id} failed and is left out: {why}");
        self.failed.write().unwrap_or_else(PoisonError::into_inner).insert(id.clone(), why);
    }

    /// The configurations that failed, in order.
    pub(crate) fn failed(&self) -> Vec<ConfigurationId> {
        read(&self.failed).keys().cloned().collect()
    }

    /// The configurations that failed, in order, and why.
    fn left_out(&self) -> Vec<(ConfigurationId, String)> {
        read(&self.failed).iter().map(|(id, why)| (id.clone(), why.clone())).collect()
    }

    /// Clears away what is no longer part of the study, and writes the manifest of what is.
    pub(crate) fn finish(&self) -> Result<()> {
        self.store.remove_retired()?;
        crate::manifest::write(&crate::manifest::Origin::of(self.study)?, &self.store)
    }

    /// Does a stage that makes meshes, animations or timings, or looks it up: [`Making`] says which. A program or a family that
    /// failed as a job has left a word behind, so that whoever looks it up leaves it out as well.
    fn stage(
        &self,
        name: &str,
        inputs: Inputs,
        make: impl FnOnce(&mut Writer<'_>) -> Result<()>,
    ) -> Result<Stamp> {
        if self.making == Making::All {
            return self.store.stage(name, inputs, make).with_context(|| name.to_owned());
        }
        let is_job = matches!(&self.making, Making::Only(job) if job == name);
        let is_made = self.store.peek(name, inputs.clone()).filter(|_| !(is_job && self.store.forced()));
        if let Some(stamp) = is_made {
            return Ok(stamp);
        }
        let failure = format!("failed/{name}");
        if let Some(failed) = self.store.peek(&failure, inputs.clone())
            && !(is_job && self.store.forced())
        {
            let why: String = serde_json::from_slice(&self.store.read(&failed, ".json")?)
                .with_context(|| failed.file(".json").to_owned())?;
            return Err(CannotMake(why).into());
        }
        match &self.making {
            Making::Only(_) if is_job => {
                let made = self.store.stage(name, inputs.clone(), make).with_context(|| name.to_owned());
                if let Err(error) = &made
                    && made::fails_again(error)
                {
                    self.store.stage(&failure, inputs, |writer| {
                        let file = format!("failed/{}.json", name.replace('/', "."));
                        writer.write_json(&file, &format!("{error:#}"))
                    })?;
                }
                made
            }
            Making::Only(job) => bail!("{name} is not up to date, and job {job} needs it: it comes first"),
            _ => bail!("{name} is not up to date: run `isostudy study` first"),
        }
    }
}

/// Nothing is left half done where a thread panics.
fn read<T>(lock: &RwLock<T>) -> RwLockReadGuard<'_, T> {
    lock.read().unwrap_or_else(PoisonError::into_inner)
}
