//! `isostudy design`: a questionnaire, judged before anyone answers, and its forms.

mod check;
mod forms;
pub(super) mod power;
mod rules;

use crate::outcome::Outcome;
use anyhow::{Context, Result};
use clap::Subcommand;
use isostudy_design::Study;
use isostudy_design::config::FormsSection;

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Say what is wrong with a questionnaire; exit code 1 if anything is
    Check(check::Arguments),
    /// Write the participants' forms, and the key to them
    Forms(forms::Arguments),
    /// Say how likely the study is to find a preference, by number of participants
    Power(power::Arguments),
    /// List what `design check` looks for
    Rules,
}

/// Does what the verb says.
///
/// # Errors
/// As the verb.
pub(crate) fn run(verb: &Verb) -> Result<Outcome> {
    match verb {
        Verb::Check(arguments) => check::run(arguments),
        Verb::Forms(arguments) => forms::run(arguments),
        Verb::Power(arguments) => power::run(arguments),
        Verb::Rules => rules::run(),
    }
}

/// What a study says of its forms.
fn forms_section(study: &Study) -> Result<&FormsSection> {
    study.file.forms.as_ref().with_context(|| {
        format!("{}: no [forms] section; configs/balanced.toml has one to copy", study.path.display())
    })
}
