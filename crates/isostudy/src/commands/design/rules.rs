//! `isostudy design rules`: what `design check` looks for.

use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::Result;
use isostudy_design::lint::Rule;

/// Prints the rules.
///
/// # Errors
/// If standard output cannot be written.
pub(crate) fn run() -> Result<Outcome> {
    for rule in Rule::ALL {
        say(&format!("{}\n  {}\n  remedy: {}", rule.id(), rule.meaning(), rule.remedy()))?;
    }
    Ok(Outcome::Done)
}
