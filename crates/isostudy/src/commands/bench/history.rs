//! `isostudy bench history`: the runs that were kept, one after the other.

use super::baseline::HISTORY;
use crate::input;
use crate::outcome::Outcome;
use crate::store::write_whole;
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::Args;
use isostudy_timing::history::{Kept, history, history_table};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Results folder in which runs were kept
    folder: PathBuf,
}

/// Prints the history, and writes it as table and figure beside the runs.
///
/// # Errors
/// If nothing was kept there, a line of it is no run, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let path = arguments.folder.join(HISTORY);
    let missing =
        || format!("{}: `isostudy bench STUDY --save-baseline NAME` keeps runs there", path.display());
    let text = String::from_utf8(input::bytes(&path).with_context(missing)?).context("is no text")?;
    let kept: Vec<Kept> = text
        .lines()
        .zip(1..)
        .map(|(line, number)| {
            serde_json::from_str(line).with_context(|| format!("{}, line {number}", path.display()))
        })
        .collect::<Result<_>>()?;
    let steps = history(&kept);
    let table = history_table(&steps);
    let folder = arguments.folder.join("bench");
    write_whole(&folder.join("history.csv"), table.to_csv().as_bytes())?;
    if let Some(figure) = isostudy_report::history_figure(&steps)? {
        write_whole(&folder.join("history.svg"), figure.svg.as_bytes())?;
        write_whole(&folder.join("history.png"), &figure.png)?;
    }
    say(&table.to_markdown())?;
    Ok(Outcome::Done)
}
