//! `isostudy barometer compare`: whether two recordings agree.

use super::told::Recording;
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::{Result, bail};
use clap::Args;
use isostudy_barometer::agreement::Agreement;
use isostudy_barometer::engine::Takes;
use isostudy_barometer::ranks::Quantity;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a recording
    one: PathBuf,
    /// Folder of another
    other: PathBuf,
}

/// Compares the order of engines, quantity by quantity.
///
/// # Errors
/// If a recording cannot be read.
pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let folders = [&arguments.one, &arguments.other];
    let no_recordings: Vec<_> = folders
        .iter()
        .filter(|path| !path.join("about.toml").is_file())
        .map(|path| path.display().to_string())
        .collect();
    if !no_recordings.is_empty() {
        bail!("{}: no recording, which has a file about.toml", no_recordings.join(", "));
    }
    let [one, other] = folders.map(|folder| Recording::read(folder));
    let (one, other) = (one?, other?);
    let (mut agrees, mut told) = (true, 0);
    let profiles = [&one, &other].map(|recording| recording.about.profile.as_str());
    let are_times_comparable = profiles[0] == profiles[1] || profiles.contains(&"");
    if !are_times_comparable {
        tell!(
            "times are not compared: one recording is by a build of {}, the other of {}",
            profiles[0],
            profiles[1]
        );
    }
    say("| quantity | given | told by both, in one order | in opposite order | told by one alone |")?;
    say("|---|---|---:|---:|---:|")?;
    for takes in [Takes::Samples, Takes::Field] {
        for quantity in Quantity::ALL {
            if quantity == Quantity::Time && !are_times_comparable {
                continue;
            }
            let found = Agreement::of(&one.ranking(quantity, takes), &other.ranking(quantity, takes));
            let given = if takes == Takes::Samples { "samples" } else { "a field" };
            let (same, opposite, alone) = (found.same, found.opposite.len(), found.one_alone);
            told += same + opposite;
            if same + opposite + alone > 0 {
                say(&format!("| {} | {given} | {same} | {opposite} | {alone} |", quantity.words()))?;
            }
            for (better, worse) in &found.opposite {
                agrees = false;
                let names = [better, worse].map(|engine| one.name(engine));
                tell!(
                    "{}: {} is before {} in the first recording, and behind it in the second",
                    quantity.words(),
                    names[0],
                    names[1]
                );
            }
        }
    }
    if told == 0 {
        tell!("no pair of engines is distinguished by both recordings");
    }
    Ok(Outcome::of_check(agrees && told > 0))
}
