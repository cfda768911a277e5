//! `isostudy design check`: what is wrong with a questionnaire.

use super::forms_section;
use crate::commands::faults::{bundle_faults, faults_text, stimulus_faults};
use crate::commands::study_run::default_folder;
use crate::input;
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::Result;
use clap::Args;
use isostudy_design::lint::{Fault, Rule, lint, notices};
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Study file, such as configs/paper.toml
    study: PathBuf,
    /// Folder with the study's results; animations there are judged as well [default: results/<study id>]
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// Print the faults as JSON
    #[arg(long)]
    json: bool,
}

/// Prints the faults of a study's forms, and of its animations where they have been made.
///
/// # Errors
/// If the study or an animation cannot be read.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = input::study(&arguments.study)?;
    forms_section(&study)?;
    let mut faults = lint(&study);
    if let Some(given) = arguments.results.as_ref().filter(|given| given.exists() && !given.is_dir()) {
        anyhow::bail!("{}: not a folder", given.display());
    }
    let results = arguments.results.clone().unwrap_or_else(|| default_folder(&study));
    match stimulus_faults(&study, &results)? {
        Some(found) => faults.extend(found),
        None => tell!(
            "no animations in {}: {} not judged; `isostudy pairs` makes them",
            results.display(),
            Rule::StimuliDiffer.id()
        ),
    }
    faults.extend(bundle_faults(&study, &results.join("bundle/stimuli"))?);
    notices(&study).iter().for_each(|notice| tell!("{notice}"));
    faults.sort_by_key(|fault| fault.rule);
    if arguments.json {
        let entry = |fault: &Fault| {
            serde_json::to_value(FaultEntry {
                rule: fault.rule.id(),
                place: &fault.place,
                evidence: &fault.evidence,
            })
        };
        let entries = faults.iter().map(entry).collect::<Result<Vec<_>, _>>()?;
        say(&serde_json::to_string_pretty(&entries)?)?;
    } else {
        say(&faults_text(&study, &faults))?;
    }
    Ok(Outcome::of_check(faults.is_empty()))
}

/// A fault as JSON.
#[derive(Serialize)]
struct FaultEntry<'a> {
    rule: &'static str,
    place: &'a str,
    evidence: &'a str,
}
