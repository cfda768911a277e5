//! `isostudy validate`: a study file and everything it names, checked without doing any work.

use super::checked_study;
use crate::outcome::Outcome;
use crate::recipe::{self, Recipe};
use crate::terminal::{counted, say};
use crate::{answer_files, prepare};
use anyhow::Result;
use clap::Args;
use isostudy_design::record::Purpose;
use isostudy_extract::Arrangement;
use isostudy_foreign::shown_in_a_line;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Study file, such as configs/paper.toml
    study: PathBuf,
}

/// Checks, and lists the configurations.
///
/// # Errors
/// The first thing that is wrong.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let path = &arguments.study;
    let study = checked_study::load(path)?;
    for configuration in &study.configurations {
        let object = study.object(configuration);
        if let Some(shown) = study.file.stimuli.file_of(&configuration.id) {
            let label = &study.method(configuration.id.method).label;
            let line = format!("{}  {}, {label}, {}", configuration.id, object.name, shown.file);
            say(&shown_in_a_line(&line))?;
            continue;
        }
        let grid = prepare::grid(object, object.benchmark_spacing);
        let [x, y, z] = match recipe::recipe(&study, configuration.id.method, Purpose::Benchmark)? {
            Recipe::Extractor(method) => method.cells(&grid)?,
            Recipe::Program(_) | Recipe::Meshes(_) | Recipe::Family(_) => {
                grid.lattice(Arrangement::SimpleCubic)?.cells()
            }
        };
        let (name, label) = (&object.name, &study.method(configuration.id.method).label);
        let line = format!("{}  {name}, {label}, {x} x {y} x {z} cubes", configuration.id);
        say(&shown_in_a_line(&line))?;
    }
    let respondents = match answer_files::of_study(&study)? {
        None => "no answers".to_owned(),
        Some(reading) => format!("{} respondents", reading.responses.participants.len()),
    };
    let (questions, groups) = (study.comparisons.len(), study.groups.len());
    say(&format!(
        "{}: valid; {} in {}, {respondents}",
        path.display(),
        counted(questions as u64, "question"),
        counted(groups as u64, "group")
    ))?;
    Ok(Outcome::Done)
}
