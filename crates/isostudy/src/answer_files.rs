//! Files of answers: those that a study names, and those without a study.

use crate::input;
use crate::terminal::counted;
use anyhow::{Context, Result, bail};
use isostudy_design::Study;
use isostudy_design::config::ResponsesSection;
use isostudy_report::PARQUET_MARK;
use isostudy_responses::{
    Kind, LARGEST_FILE, LONG_COLUMNS, Mapping, Plan, Reading, Report, normalise, read_person_columns,
    read_several,
};
use std::io::Read;
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
    if section.reference.is_some() {
        bail!(
            "{}: responses.reference is of answers without a study alone; a study names its reference as \
             analysis.reference",
            study.path.display()
        );
    }
    input::regular(path)?;
    let of_pairs = study.file.forms.as_ref().is_none_or(|forms| forms.way.is_of_pairs());
    let mut reading = match of_pairs {
        true => read(path, Some(&Plan::of_study(study)), &mapping)?,
        false => read_several(path, study)?,
    };
    let wanted = study.file.analysis.person_columns();
    if !wanted.is_empty() {
        let of = study.people.as_ref().unwrap_or(path);
        let responses = &mut reading.responses;
        let found = read_person_columns(of, &wanted, &responses.participants)?;
        let (known, all) = (found.known, responses.participants.len());
        let others = match found.others {
            0 => String::new(),
            others => format!("; {others} in it did not answer"),
        };
        let columns = counted(wanted.len() as u64, "column");
        tell!("{}: {columns} about {known} of the {all} who answered{others}", of.display());
        responses.people = found.columns;
    }
    Ok(Some(reading))
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
    Ok((read(path, plan.as_ref(), &mapping)?, plan))
}

/// Reads a file of answers, which may be a Parquet file in the long format.
fn read(path: &Path, plan: Option<&Plan>, mapping: &Mapping) -> Result<Reading> {
    let mut mark = [0; PARQUET_MARK.len()];
    let begins = isostudy_foreign::open(path).is_ok_and(|mut file| file.read_exact(&mut mark).is_ok());
    if !begins || mark != PARQUET_MARK {
        return Ok(isostudy_responses::read(path, plan, mapping)?);
    }
    let bytes = isostudy_foreign::bytes(path, LARGEST_FILE)?;
    let is_wanted = |name: &str| LONG_COLUMNS.contains(&normalise(name).as_str());
    let text =
        isostudy_report::parquet_as_csv(bytes, is_wanted).with_context(|| path.display().to_string())?;
    let mut reading = isostudy_responses::parse(text.as_bytes(), path, plan, mapping)?;
    reading.report.text_rule = "Parquet".into();
    Ok(reading)
}

/// Says on standard error how a file was read, and what was not taken as it stands.
pub(crate) fn announce(report: &Report) {
    const SHOWN: usize = 20;
    let said = report.to_string();
    said.lines().take(1 + SHOWN).for_each(|line| tell!("{line}"));
    let (repaired, rejected) = (report.count(Kind::Repaired), report.count(Kind::Rejected));
    if !report.remarks.is_empty() {
        let all = counted(report.remarks.len() as u64, "remark");
        tell!("{}: {all}: {repaired} repaired, {rejected} rejected", report.file.display());
    }
}
