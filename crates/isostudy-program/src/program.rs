//! What a study says of a program, and whether it can be run.

use std::env;
use std::ffi::OsString;
use std::fs::Metadata;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use isostudy_foreign::shown_in_a_line;

use crate::error::{Problem, ProgramError};
use crate::sandbox;

/// A program that extracts, as a study names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// The program, then its arguments. No shell reads them.
    ///
    /// A program with a `/` is a file, relative to `base`; one without is searched for in the folders of `PATH`. An argument
    /// that begins with `./` or `../` is a file or folder, relative to `base`, and must be there. Other arguments are words.
    pub command: Vec<String>,
    /// The folder of the study file, from which paths in `command` start.
    pub base: PathBuf,
    /// How long it may take to be ready, and to answer one request, mesh included.
    pub time_limit: Duration,
    /// How much memory the program and all that it starts may have resident; `None` for no limit.
    pub memory_limit_bytes: Option<u64>,
    /// Whether bubblewrap confines it: no network, nothing to write but its own folder.
    pub sandbox: bool,
}

impl Program {
    /// Whether it can be started: run this before any work is done.
    ///
    /// # Errors
    /// [`Problem::NoCommand`], [`Problem::NotFound`], [`Problem::NotExecutable`], [`Problem::NoSuchFile`],
    /// [`Problem::Ambiguous`], [`Problem::NoTime`], [`Problem::NotWatched`], [`Problem::NoSandbox`].
    pub fn check(&self) -> Result<(), ProgramError> {
        let sandbox = || if self.sandbox { sandbox::check() } else { Ok(()) };
        self.resolved().and_then(|_| sandbox()).map_err(|problem| self.error(problem))
    }

    /// The words that are started: the program as an absolute path, and absolute paths for arguments that are paths.
    ///
    /// # Errors
    /// As [`Program::check`], but for the sandbox.
    pub fn words(&self) -> Result<Vec<OsString>, ProgramError> {
        self.resolved().map_err(|problem| self.error(problem))
    }

    /// The files that the command names: the program, unless it was found by `PATH`, and arguments that are paths to files.
    /// They decide what it does, so digest them; what they import is not among them.
    ///
    /// # Errors
    /// As [`Program::check`].
    pub fn files(&self) -> Result<Vec<PathBuf>, ProgramError> {
        let resolved = self.resolved().map_err(|problem| self.error(problem))?;
        let named = |word: &str| if word == self.command[0] { word.contains('/') } else { is_path(word) };
        let files = self.command.iter().zip(resolved).filter(|(word, _)| named(word));
        Ok(files.map(|(_, file)| file.into()).filter(|file: &PathBuf| file.is_file()).collect())
    }

    /// The command with every path absolute.
    pub(crate) fn resolved(&self) -> Result<Vec<OsString>, Problem> {
        if self.time_limit.is_zero() {
            return Err(Problem::NoTime);
        }
        if self.memory_limit_bytes.is_some() && !Path::new("/proc/self/status").exists() {
            return Err(Problem::NotWatched);
        }
        let base = std::path::absolute(&self.base).map_err(Problem::io(&self.base))?;
        let Some((name, arguments)) = self.command.split_first().filter(|(name, _)| !name.is_empty()) else {
            return Err(Problem::NoCommand);
        };
        let mut words = vec![executable(&base, name)?.into_os_string()];
        for argument in arguments {
            words.push(resolved_argument(&base, argument)?);
        }
        Ok(words)
    }

    pub(crate) fn error(&self, problem: Problem) -> ProgramError {
        let program = shown_in_a_line(&self.command.join(" ")).into_owned();
        ProgramError { program, problem: Box::new(problem), stderr: String::new() }
    }
}

fn executable(base: &Path, name: &str) -> Result<PathBuf, Problem> {
    if name.contains('/') {
        let path = base.join(name);
        return match path.metadata() {
            Ok(data) if is_executable(&data) => Ok(path),
            Ok(_) => Err(Problem::NotExecutable { path }),
            Err(_) => Err(Problem::NotFound { name: name.to_owned(), path: Some(path) }),
        };
    }
    let folders = env::var_os("PATH").unwrap_or_default();
    let mut found = None;
    for path in env::split_paths(&folders).map(|folder| folder.join(name)) {
        match path.metadata() {
            // An entry of PATH may be relative, and the program starts in another folder.
            Ok(data) if is_executable(&data) => {
                return std::path::absolute(&path).map_err(Problem::io(&path));
            }
            Ok(_) => found = found.or(Some(path)),
            Err(_) => {}
        }
    }
    Err(match found {
        Some(path) => Problem::NotExecutable { path },
        None => Problem::NotFound { name: name.to_owned(), path: None },
    })
}

fn is_executable(data: &Metadata) -> bool {
    data.is_file() && data.permissions().mode() & 0o111 != 0
}

fn is_path(argument: &str) -> bool {
    argument.starts_with("./") || argument.starts_with("../")
}

fn resolved_argument(base: &Path, argument: &str) -> Result<OsString, Problem> {
    let path = base.join(argument);
    if is_path(argument) {
        return match path.exists() {
            true => Ok(path.into_os_string()),
            false => Err(Problem::NoSuchFile { argument: argument.to_owned(), path }),
        };
    }
    // A path that forgot its `./` would be looked for in the worker's own folder, and not be found.
    if !Path::new(argument).is_absolute() && path.is_file() {
        return Err(Problem::Ambiguous { argument: argument.to_owned() });
    }
    Ok(argument.into())
}
