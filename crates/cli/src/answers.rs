//! Files of answers: what a study or the command line declares about them, reading, and converting.

use crate::args::{Convert, ReadingRules, Target, TieRule};
use crate::input;
use anyhow::{Context, Result, bail};
use design::Study;
use design::config::ResponsesSection;
use responses::{Kind, Mapping, Plan, Reading, Report, Ties};
use std::path::Path;

/// The answers that a study names, if it names any.
///
/// # Errors
/// If they cannot be read for this study.
pub(crate) fn of_study(study: &Study) -> Result<Option<Reading>> {
    let Some(path) = &study.responses else { return Ok(None) };
    let section = study.file.responses.clone().unwrap_or_default();
    let mapping = Mapping::of(&section).with_context(|| study.path.display().to_string())?;
    if !mapping.pairs.is_empty() {
        bail!("the mapping has `pairs`; the questions are the comparisons of {}", study.path.display());
    }
    input::regular(path)?;
    Ok(Some(responses::read(path, Some(&Plan::of_study(study)), &mapping)?))
}

/// Answers without a study.
///
/// # Errors
/// If they cannot be read.
pub(crate) fn without_study(path: &Path, section: &ResponsesSection) -> Result<(Reading, Option<Plan>)> {
    let mapping = Mapping::of(section)?;
    let plan = match &mapping.pairs[..] {
        [] => None,
        pairs => {
            let plan = Plan::of_pairs(pairs);
            Some(plan.map_err(|id| anyhow::anyhow!("pairs: question {id} is declared twice"))?)
        }
    };
    input::regular(path)?;
    Ok((responses::read(path, plan.as_ref(), &mapping)?, plan))
}

/// What the command line declares on top of what the study does.
///
/// # Errors
/// If the mapping cannot be read.
pub(crate) fn section(rules: &ReadingRules, study: Option<&Study>) -> Result<ResponsesSection> {
    let declared = || study.and_then(|study| study.file.responses.clone()).unwrap_or_default();
    rules.mapping.as_deref().map_or(Ok(()), input::regular)?;
    let mut section = rules.mapping.as_deref().map_or_else(|| Ok(declared()), ResponsesSection::load)?;
    if rules.format.is_some() {
        section.format.clone_from(&rules.format);
    }
    Ok(section)
}

/// Says on standard error how a file was read, and what was not taken as it stands.
pub(crate) fn announce(report: &Report) {
    const SHOWN: usize = 20;
    let said = report.to_string();
    said.lines().take(1 + SHOWN).for_each(|line| tell!("{line}"));
    let (repaired, rejected) = (report.count(Kind::Repaired), report.count(Kind::Rejected));
    if !report.remarks.is_empty() {
        let all = number_of(report.remarks.len() as u64, "remark");
        tell!("{}: {all}: {repaired} repaired, {rejected} rejected", report.file.display());
    }
}

/// `1 row`, `2 rows`.
fn number_of(count: u64, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Writes answers in another format.
///
/// # Errors
/// If they cannot be read or written; a format without ties refuses them unless told what to do.
pub(crate) fn convert(arguments: &Convert) -> Result<()> {
    let (reading, names) = match &arguments.study {
        Some(path) => {
            let mut study = input::study(path)?;
            study.file.responses = Some(section(&arguments.reading, Some(&study))?);
            study.responses = Some(arguments.input.clone());
            let names = Plan::of_study(&study).short_names().to_vec();
            (of_study(&study)?.context("no answers")?, names)
        }
        None => {
            let (reading, plan) = without_study(&arguments.input, &section(&arguments.reading, None)?)?;
            let items = reading.responses.items.clone();
            (reading, plan.map_or(items, |plan| plan.short_names().to_vec()))
        }
    };
    announce(&reading.report);
    let ties = match arguments.ties {
        TieRule::Refuse => Ties::Refuse,
        TieRule::Split => Ties::Split,
        TieRule::Drop => Ties::Drop,
    };
    let answers = &reading.responses;
    let mut text = Vec::new();
    let written = match arguments.to {
        Target::Long => responses::write_long(answers, &mut text),
        Target::Arenakit => responses::write_arenakit(answers, &names, &mut text),
        Target::Pwcmp => responses::write_pwcmp(answers, &names, ties, &mut text),
    };
    let written = written.with_context(|| arguments.out.display().to_string())?;
    crate::store::write_whole(&arguments.out, &text)?;
    let out = arguments.out.display();
    let (rows, ties_read) = (number_of(written.rows, "row"), number_of(written.ties, "answer"));
    tell!("{out}: {rows}; {ties_read} without preference");
    if written.ties > 0 && arguments.to == Target::Pwcmp {
        match ties {
            Ties::Split => {
                tell!("{out}: each of them is one win each way; other programs may weigh it as two answers")
            }
            Ties::Drop => tell!("{out}: they are left out"),
            Ties::Refuse => {}
        }
    }
    for (left_out, which) in [(written.controls, "controls"), (written.repeats, "repeats")] {
        if left_out > 0 {
            let answers = number_of(left_out, "answer");
            tell!("{out}: left out: {answers} to {which}, which are no comparisons of their own");
        }
    }
    if !answers.sides_recorded {
        tell!("{out}: sides were not recorded: which item comes first means nothing");
    }
    Ok(())
}
