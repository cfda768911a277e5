//! The command, run as a user runs it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// `isostudy`, to be told what to do.
pub(crate) fn isostudy() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_isostudy"));
    // What is allowed here is not allowed for whoever runs the tests.
    command.env("XDG_STATE_HOME", env!("CARGO_TARGET_TMPDIR"));
    command
}

/// What a command did.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// Runs a command to its end.
    pub(crate) fn of(command: &mut Command) -> Self {
        let output = command.output().unwrap();
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// As `of`, and it must end well.
    pub(crate) fn succeed(command: &mut Command) -> Self {
        let run = Self::of(command);
        assert_eq!(run.code, Some(0), "{command:?}: {}{}", run.stdout, run.stderr);
        run
    }
}

/// A folder of its own to run commands in.
pub(crate) struct Folder {
    folder: TempDir,
    verb: Option<&'static str>,
}

impl Folder {
    /// For any commands.
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap(), verb: None }
    }

    /// For one command, which needs not be said again.
    pub(crate) fn of(verb: &'static str) -> Self {
        Self { verb: Some(verb), ..Self::new() }
    }

    pub(crate) fn root(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    /// `isostudy` in this folder, whatever the verb.
    pub(crate) fn isostudy(&self) -> Command {
        let mut command = isostudy();
        command.current_dir(self.root()).env("XDG_STATE_HOME", self.path(".state"));
        command
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = self.isostudy();
        command.args(self.verb).args(arguments);
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        Run::of(&mut self.command(arguments))
    }

    /// As `run`, and it must end well.
    pub(crate) fn succeed(&self, arguments: &[&str]) -> Run {
        Run::succeed(&mut self.command(arguments))
    }
}
