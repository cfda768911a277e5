//! The chain of stages from a study file to the page that shows it all.
//!
//! ```text
//! objects ─ meshes ─┬─ turntables ─ pairs, key ─┐
//! comparisons ─ forms, key ─────────────────────┤
//!                   └─ stills ──────────────────┤
//! objects ─ timings ─┐                          ├─ page ─ manifest
//! answers ───────────┴─ tables, figures, report ┘
//! ```

mod bundle;
mod meshes;
mod page;
mod report;
mod stimuli;
mod sweep;
mod tables;
mod timings;

pub(crate) use bundle::forms_digest;
pub(crate) use meshes::Meshes;
pub(crate) use stimuli::MadeWith;
pub(crate) use tables::{write_answers_only, write_without_study};
pub(crate) use timings::{PlanLength, measure};

use crate::fields::Fields;
use crate::store::{Inputs, Stamp, Store, Writer};
use anyhow::{Context, Result};
use design::Study;

/// Stages that only commands of their own make; a whole study leaves them in place.
const ASKED_FOR: [&str; 4] = ["bench/", "bundle", "contact_sheet", "video/"];

/// One study being worked on.
pub(crate) struct Pipeline<'a> {
    study: &'a Study,
    store: Store,
    fields: Fields<'a>,
    threads: usize,
    /// Meshes, animations and timings are only looked up, never made.
    frozen: bool,
}

impl<'a> Pipeline<'a> {
    pub(crate) fn new(study: &'a Study, store: Store, threads: usize) -> Self {
        Self { study, store, fields: Fields::new(study), threads, frozen: false }
    }

    /// The whole study. What an earlier form of it left behind goes. Returns the published
    /// numbers that ours differ from without a known reason.
    pub(crate) fn study(&self) -> Result<Vec<String>> {
        let meshes = self.all_meshes(&[])?;
        let turntables = self.turntables(&meshes, &[])?;
        let pairs = self.pairs(&turntables)?;
        self.finished_videos(&pairs)?;
        let forms: Vec<Stamp> = self.forms()?.into_iter().collect();
        let stills = self.stills()?;
        let timings = self.timings(PlanLength::Short)?;
        let tables = self.tables(&meshes, &timings)?;
        self.page(&meshes, &[turntables, pairs, forms, stills, vec![timings, tables]].concat())?;
        self.store.retire_untouched(|stage| ASKED_FOR.iter().any(|start| stage.starts_with(start)))?;
        self.unexplained()
    }

    /// Tables, figures and the page again, from what is there.
    pub(crate) fn report(&mut self) -> Result<Vec<String>> {
        self.frozen = true;
        self.study()
    }

    /// Clears away what is no longer part of the study, and writes the manifest of what is.
    pub(crate) fn finish(&self) -> Result<()> {
        self.store.remove_retired()?;
        crate::manifest::write(&crate::manifest::Subject::of(self.study)?, &self.store)
    }

    /// Does a stage that makes meshes, animations or timings; when frozen, only looks it up.
    fn stage(
        &self,
        name: &str,
        inputs: Inputs,
        make: impl FnOnce(&mut Writer<'_>) -> Result<()>,
    ) -> Result<Stamp> {
        if self.frozen {
            let missing = || format!("{name} is not up to date: run `isostudy study` first");
            return self.store.peek(name, inputs).with_context(missing);
        }
        self.store.stage(name, inputs, make).with_context(|| name.to_owned())
    }
}
