//! `isostudy new`: a study file of one's own to begin with.

use crate::outcome::Outcome;
use crate::store;
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use clap::Args;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// The study file, with the id [`ID`].
const STUDY: &str = include_str!("new/study.toml");
const ID: &str = "id = \"my-study\"";
/// What `benchmark.target` in it names.
const TARGET: &str = "cpu/x86-64-v3.toml";
const TARGET_TEXT: &str = include_str!("../../../../configs/cpu/x86-64-v3.toml");

#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  isostudy new my-study
  isostudy design check my-study/study.toml")]
pub(crate) struct Arguments {
    /// Folder to write study.toml and cpu/x86-64-v3.toml to; its name becomes the study's id
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes the files, and says what to do next.
///
/// # Errors
/// If something is there already; nothing is written over and nothing is written then. If a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let folder = &arguments.folder;
    let (study, target) = (folder.join("study.toml"), folder.join(TARGET));
    for place in [folder.as_path(), &folder.join("cpu")] {
        if fs::symlink_metadata(place).is_ok() && !place.is_dir() {
            bail!(
                "{}: is not a folder; the study goes into a folder that is new or has no study yet",
                place.display()
            );
        }
    }
    for file in [&study, &target] {
        if fs::symlink_metadata(file).is_ok() {
            bail!("{}: is there already, and is not written over; name another folder", file.display());
        }
    }
    store::write_new(&target, TARGET_TEXT.as_bytes())?;
    let id = id(folder)?;
    if let Err(error) = store::write_new(&study, STUDY.replacen(ID, &format!("id = \"{id}\""), 1).as_bytes())
    {
        store::remove_if_there(&target)?;
        return Err(error);
    }
    say(&study.display().to_string())?;
    let named = quoted(&study);
    tell!("Change it, and then:");
    for (command, what) in [
        (format!("isostudy design check {named}"), "is its questionnaire sound?"),
        (
            format!("isostudy study {named}"),
            format!("makes meshes, animations, times: results/{id}/index.html").as_str(),
        ),
        (format!("isostudy serve {named}"), "puts the questions to people (`bundle` does without a server)"),
    ] {
        tell!("  {command}\n      {what}");
    }
    Ok(Outcome::Done)
}

/// The folder's name, as far as it is one for a study.
fn id(folder: &Path) -> Result<String> {
    let whole = folder.canonicalize().with_context(|| folder.display().to_string())?;
    let name = whole.file_name().map(OsStr::to_string_lossy).unwrap_or_default().to_lowercase();
    let plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
    let words: Vec<&str> = name.split(|letter| !plain(letter)).filter(|word| !word.is_empty()).collect();
    let mut id = words.join("-");
    id.truncate(64);
    Ok(if id.is_empty() { "my-study".into() } else { id })
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_alphanumeric() || "/._-+:@%,=".contains(letter);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_study_names_the_file_that_is_written_beside_it() {
        let file: isostudy_design::config::StudyFile = toml::from_str(STUDY).unwrap();
        assert_eq!(file.benchmark.target, TARGET);
        assert_eq!(STUDY.matches(ID).count(), 1);
    }

    #[test]
    fn ids_are_made_of_what_they_may_have() {
        let folder = tempfile::tempdir().unwrap();
        for (name, want) in [
            ("hills", "hills"),
            ("Two Methods_2", "two-methods-2"),
            ("-a--b-", "a-b"),
            ("\u{e4}", "my-study"),
        ] {
            let path = folder.path().join(name);
            fs::create_dir(&path).unwrap();
            assert_eq!(id(&path).unwrap(), want);
        }
    }

    #[test]
    fn a_path_with_a_space_is_quoted() {
        assert_eq!(quoted(Path::new("a/study.toml")), "a/study.toml");
        assert_eq!(quoted(Path::new("it's a/study.toml")), "'it'\\''s a/study.toml'");
    }
}
