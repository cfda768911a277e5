//! Whose results a folder holds. Two study files may have one id, and would write one folder.

use crate::input;
use crate::store::{write_new, write_whole};
use anyhow::{Result, bail};
use std::path::{Component, Path, PathBuf};

/// Beside the stamps of stages, and none of them.
const FILE: &str = ".stages/study";

/// Takes a folder of results for a study file, or a file of answers, unless it is another's that is still there. A file that was moved
/// or renamed keeps its results, and so does a workspace that was moved as a whole: what is kept is the way from the folder to the file.
///
/// # Errors
/// If the folder is another file's, naming both, and what to do; if it cannot be written.
pub(crate) fn claim(folder: &Path, source: &Path) -> Result<()> {
    let kept = folder.join(FILE);
    let way = way(folder, source);
    if let Some(other) = owner(folder) {
        if input::is_same(&other, source) {
            return Ok(());
        }
        if other.is_file() {
            bail!(
                "{}: these are results of {}, not of {}. Give one of the two another study.id, or name another folder with --out. \
                 To give the folder to {2}, delete {}",
                folder.display(),
                other.display(),
                source.display(),
                kept.display()
            );
        }
        tell!(
            "{}: was made from {}, which is gone; goes on with {}",
            folder.display(),
            other.display(),
            source.display()
        );
    }
    // Whole or not at all: others may claim the folder at this moment.
    let bytes = way.to_string_lossy();
    let written = if kept.exists() {
        write_whole(&kept, bytes.as_bytes())
    } else {
        write_new(&kept, bytes.as_bytes()).or_else(|error| match owner(folder) {
            Some(other) if input::is_same(&other, source) => Ok(()),
            Some(other) => bail!("{}: {} has just taken it", folder.display(), other.display()),
            None => Err(error),
        })
    };
    match written {
        // Where nothing can be written, nothing is written over.
        Err(error) if folder.is_dir() && error.chain().any(is_read_only) => Ok(()),
        written => written,
    }
}

/// The file whose results a folder holds, as a path from here; `None` if nobody wrote it down.
pub(crate) fn owner(folder: &Path) -> Option<PathBuf> {
    let way = std::fs::read_to_string(folder.join(FILE)).ok()?;
    // The file may be gone, and the folder is there.
    let mut whole = folder.canonicalize().ok()?;
    for step in Path::new(way.trim_end()).components() {
        match step {
            Component::ParentDir => drop(whole.pop()),
            step => whole.push(step),
        }
    }
    let here = std::env::current_dir().ok().and_then(|here| here.canonicalize().ok());
    Some(here.and_then(|here| whole.strip_prefix(here).ok().map(Path::to_path_buf)).unwrap_or(whole))
}

fn is_read_only(error: &(dyn std::error::Error + 'static)) -> bool {
    use std::io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
    let kind = error.downcast_ref().map(std::io::Error::kind);
    kind.is_some_and(|kind| matches!(kind, PermissionDenied | ReadOnlyFilesystem))
}

/// The way from a folder to a file.
fn way(folder: &Path, file: &Path) -> PathBuf {
    let (Ok(from), Ok(to)) = (folder.canonicalize(), file.canonicalize()) else { return file.into() };
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return to.into_iter().collect();
    }
    let up = from[common..].iter().map(|_| Component::ParentDir);
    up.chain(to[common..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_folder_belongs_to_one_file_as_long_as_it_is_there() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        for folder in ["a", "b", "results/s"] {
            fs::create_dir_all(at(folder)).unwrap();
        }
        fs::write(at("a/study.toml"), "a").unwrap();
        fs::write(at("b/study.toml"), "b").unwrap();
        let results = at("results/s");
        assert_eq!(owner(&results), None);
        claim(&results, &at("a/study.toml")).unwrap();
        claim(&results, &at("b/../a/study.toml")).unwrap();
        assert_eq!(fs::read_to_string(results.join(FILE)).unwrap(), "../../a/study.toml");
        let refused = claim(&results, &at("b/study.toml")).unwrap_err().to_string();
        for part in ["a/study.toml", "b/study.toml", "results/s/.stages/study", "--out", "study.id"] {
            assert!(refused.contains(part), "{part}: {refused}");
        }
        // Moved: the results go with it.
        fs::rename(at("a/study.toml"), at("a/moved.toml")).unwrap();
        claim(&results, &at("a/moved.toml")).unwrap();
        assert!(claim(&results, &at("b/study.toml")).is_err());
        // The whole workspace, too.
        let elsewhere = tempfile::tempdir().unwrap();
        for place in ["a", "b", "results"] {
            fs::rename(at(place), elsewhere.path().join(place)).unwrap();
        }
        claim(&elsewhere.path().join("results/s"), &elsewhere.path().join("a/moved.toml")).unwrap();
        assert!(claim(&elsewhere.path().join("results/s"), &elsewhere.path().join("b/study.toml")).is_err());
    }
}
