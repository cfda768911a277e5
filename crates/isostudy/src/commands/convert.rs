//! `isostudy convert`: answers in the long format or in another program's.

use super::reading_rules::ReadingRules;
use crate::outcome::Outcome;
use crate::store::write_whole;
use crate::terminal::counted;
use crate::{answer_files, input};
use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use isostudy_responses::{Plan, Ties};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// File of answers in any format that is read
    input: PathBuf,
    /// Format to write
    #[arg(long, value_name = "FORMAT")]
    to: Target,
    /// File to write
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Study whose questions were asked; needed where columns are questions
    #[arg(long, value_name = "TOML")]
    study: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingRules,
    /// For pwcmp, which has no ties: refuse, write one win each way, or leave them out
    #[arg(long, value_name = "RULE", default_value = "refuse")]
    ties: TieRule,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    #[value(help = isostudy_responses::LONG_WRITTEN.join(", "))]
    Long,
    /// model_a, model_b, winner, item_id, voter_id
    Arenakit,
    /// observer, session, scene, condition_A, condition_B, is_A_selected
    Pwcmp,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TieRule {
    Refuse,
    Split,
    Drop,
}

/// Writes answers in another format.
///
/// # Errors
/// If they cannot be read or written; a format without ties refuses them unless told what to do.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let (reading, names) = match &arguments.study {
        Some(path) => {
            let mut study = input::study(path)?;
            study.file.responses = Some(arguments.reading.section(Some(&study))?);
            study.responses = Some(arguments.input.clone());
            let names = Plan::of_study(&study).short_names().to_vec();
            (answer_files::of_study(&study)?.context("no answers")?, names)
        }
        None => {
            let (reading, plan) =
                answer_files::without_study(&arguments.input, &arguments.reading.section(None)?)?;
            let items = reading.responses.items.clone();
            (reading, plan.map_or(items, |plan| plan.short_names().to_vec()))
        }
    };
    answer_files::announce(&reading.report);
    let ties = match arguments.ties {
        TieRule::Refuse => Ties::Refuse,
        TieRule::Split => Ties::Split,
        TieRule::Drop => Ties::Drop,
    };
    let answers = &reading.responses;
    let mut text = Vec::new();
    let written = match arguments.to {
        Target::Long => isostudy_responses::write_long(answers, &mut text),
        Target::Arenakit => isostudy_responses::write_arenakit(answers, &names, &mut text),
        Target::Pwcmp => isostudy_responses::write_pwcmp(answers, &names, ties, &mut text),
    };
    let written = written.with_context(|| arguments.out.display().to_string())?;
    write_whole(&arguments.out, &text)?;
    let out = arguments.out.display();
    let (rows, ties_read) = (counted(written.rows, "row"), counted(written.ties, "answer"));
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
            let answers = counted(left_out, "answer");
            tell!("{out}: left out: {answers} to {which}, which are no comparisons of their own");
        }
    }
    if !answers.sides_recorded {
        tell!("{out}: sides were not recorded: which item comes first means nothing");
    }
    Ok(Outcome::Done)
}
