//! `isostudy new`: a study file of one's own to begin with.

use crate::input;
use crate::origin;
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
    let wanted = id(folder)?;
    let taken = taken(folder);
    let id = free(&wanted, &taken);
    if let Some((_, other)) = taken.iter().find(|(id, _)| *id == wanted) {
        tell!(
            "{} has the id {wanted}; this study is called {id}, so that neither writes over the other",
            other.display()
        );
    }
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

/// Ids that other studies have, and their files: those in folders beside this one, and those whose results are here.
fn taken(folder: &Path) -> Vec<(String, PathBuf)> {
    let own = folder.canonicalize().unwrap_or_else(|_| folder.into());
    let folders = |of: &Path| -> Vec<PathBuf> {
        let entries = fs::read_dir(of).into_iter().flatten().flatten();
        let mut folders: Vec<PathBuf> =
            entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        folders.sort();
        folders
    };
    let beside = own.parent().map(folders).unwrap_or_default().into_iter().filter(|other| *other != own);
    let beside = beside.map(|other| other.join("study.toml")).filter_map(|file| {
        let table: toml::Table = input::text(&file).ok()?.parse().ok()?;
        let id = table.get("study")?.get("id")?.as_str()?.to_owned();
        Some((id, file))
    });
    let results = folders(Path::new("results")).into_iter().filter_map(|results| {
        let owner = origin::owner(&results).filter(|owner| owner.is_file())?;
        Some((results.file_name()?.to_string_lossy().into_owned(), owner))
    });
    beside.chain(results).collect()
}

/// The id, or the first with a number behind it that nobody has.
fn free(wanted: &str, taken: &[(String, PathBuf)]) -> String {
    let is_free = |id: &String| taken.iter().all(|(other, _)| other != id);
    let numbered = (2..).map(|number| format!("{}-{number}", &wanted[..wanted.len().min(58)]));
    std::iter::once(wanted.to_owned()).chain(numbered).find(is_free).expect("numbers do not end")
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
        let (asked, forms) = (file.comparisons.len(), file.forms.unwrap());
        let pairs = asked + (forms.repeats + forms.controls) as usize;
        assert_eq!(forms.max_questions as usize, pairs);
        let told = format!(
            "judges {pairs} pairs: {asked} comparisons, {} of them asked again with the\n# sides swapped, and {} controls.",
            forms.repeats, forms.controls
        );
        assert!(STUDY.contains(&told), "{told}");
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
    fn an_id_that_another_has_gets_a_number() {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [
            ("my-study", "[study]\nid = \"my-study\"\n"),
            ("odd", "[study]\nid = \"my-study-2\"\n"),
            ("broken", "["),
        ] {
            fs::create_dir(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join("study.toml"), text).unwrap();
        }
        let own = folder.path().join("My Study");
        fs::create_dir(&own).unwrap();
        let taken = taken(&own);
        let ids: Vec<&str> = taken.iter().map(|(id, _)| id.as_str()).collect();
        assert!(ids.starts_with(&["my-study", "my-study-2"]), "{ids:?}");
        assert_eq!(free(&id(&own).unwrap(), &taken), "my-study-3");
        assert_eq!(free("other", &taken), "other");
    }

    #[test]
    fn a_path_with_a_space_is_quoted() {
        assert_eq!(quoted(Path::new("a/study.toml")), "a/study.toml");
        assert_eq!(quoted(Path::new("it's a/study.toml")), "'it'\\''s a/study.toml'");
    }
}
