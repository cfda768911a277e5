//! A study that work can begin on.

use crate::{answer_files, fields, input, prepare, recipe, shown_files, work_time};
use anyhow::Result;
use isostudy_design::Study;
use std::path::Path;

/// Reads and checks a study and everything it names: lattices, memory and time, mesh files, answers.
///
/// # Errors
/// If something in it is wrong, or not there.
pub(super) fn load(path: &Path) -> Result<Study> {
    let machine_bytes = isostudy_bench::read_machine().memory_bytes;
    let study = input::study_with(path, &|study| {
        prepare::check(study, machine_bytes)?;
        fields::check(study)
    })?;
    if study.shown_files().is_some() {
        shown_files::check(&study)?;
    } else {
        recipe::check(&study)?;
        prepare::check(&study, machine_bytes)?;
        prepare::check_cases(&study, machine_bytes)?;
        fields::check(&study)?;
        work_time::check(&study)?;
    }
    if let Some(reading) =
        answer_files::of_study(&study)?.filter(|reading| !reading.report.remarks.is_empty())
    {
        answer_files::announce(&reading.report);
    }
    Ok(study)
}
