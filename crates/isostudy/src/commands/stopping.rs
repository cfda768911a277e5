//! What a declared stopping rule says of answers that a server has.

use super::given_answers::csv;
use anyhow::{Context, Result};
use isostudy_design::Study;
use isostudy_design::config::StopWhen;
use isostudy_design::contrast::PRIMARY;
use isostudy_design::forms::{FormFile, KeyEntry};
use isostudy_inference::Answered;
use isostudy_inference::hypotheses::Hypothesis;
use isostudy_responses::{Mapping, Plan};
use isostudy_serve::Rule;
use isostudy_serve::export::Given;
use std::sync::Arc;

/// The rule of a study that has one.
pub(super) fn rule(study: &Study, file: &FormFile, key: &[KeyEntry]) -> Option<Rule> {
    let stopping = study.file.analysis.stopping.as_ref()?;
    let (study, file, key, when) = (study.clone(), file.clone(), key.to_vec(), stopping.when);
    let judge =
        move |given: &[Given]| stops(&study, &file, &key, when, given).map_err(|error| format!("{error:#}"));
    Some(Rule { looks: stopping.looks.clone(), judge: Arc::new(judge) })
}

/// Whether the primary contrasts that decide differ, by the tests of `isostudy analyse` on the same answers.
fn stops(study: &Study, file: &FormFile, key: &[KeyEntry], when: StopWhen, given: &[Given]) -> Result<bool> {
    let text = csv(file, given, key)?;
    let plan = Plan::of_study(study);
    let reading = isostudy_responses::parse(text.as_bytes(), &study.path, Some(&plan), &Mapping::default())?;
    let answered = Answered::of(study, reading.responses).context("the study compares nothing")?;
    let mut primary = answered.hypotheses.iter().filter(|of| of.family == PRIMARY);
    Ok(match when {
        StopWhen::All => primary.all(Hypothesis::differs),
        StopWhen::Any => primary.any(Hypothesis::differs),
    })
}
