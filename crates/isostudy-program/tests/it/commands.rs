//! What is wrong with a command is found before any work is done.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::time::Duration;

use isostudy_program::{Problem, Program, Worker};

fn program(base: &Path, command: &[&str]) -> Program {
    Program {
        command: command.iter().map(|word| (*word).to_owned()).collect(),
        base: base.to_owned(),
        time_limit: Duration::from_secs(60),
        memory_limit_bytes: None,
        sandbox: false,
    }
}

fn problem(base: &Path, command: &[&str]) -> (Problem, String) {
    let program = program(base, command);
    let error = program.check().expect_err("the command was accepted");
    let start = Worker::start(&program).expect_err("the command was started");
    assert_eq!(error.to_string(), start.to_string(), "both say the same");
    (*error.problem, start.to_string())
}

#[test]
fn a_program_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let (found, said) = problem(folder.path(), &["no-such-extractor", "--fast"]);
    assert!(matches!(found, Problem::NotFound { path: None, .. }), "{found:?}");
    assert!(said.starts_with("no-such-extractor --fast: ") && said.contains("PATH"), "{said}");
    let (found, _) = problem(folder.path(), &["./extract"]);
    let expected = folder.path().join("./extract");
    assert!(matches!(found, Problem::NotFound { path: Some(path), .. } if path == expected));
}

#[test]
fn a_file_without_the_right_to_be_executed_is_no_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("extract");
    fs::write(&file, "#!/bin/sh\n").expect("a file");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o644)).expect("rights");
    let (found, said) = problem(folder.path(), &["./extract"]);
    assert!(matches!(found, Problem::NotExecutable { .. }) && said.contains("not executable"), "{said}");
    // Nor is a folder, though it has the right.
    assert!(matches!(problem(folder.path(), &["../"]).0, Problem::NotExecutable { .. }));
    fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).expect("rights");
    program(folder.path(), &["./extract"]).check().expect("now it is one");
}

#[test]
fn a_file_that_cannot_be_started_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("extract");
    fs::write(&file, "#!/no/such/interpreter\n").expect("a file");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).expect("rights");
    let error = Worker::start(&program(folder.path(), &["./extract"])).expect_err("it started");
    assert!(matches!(*error.problem, Problem::Start(_)), "{error}");
}

#[test]
fn arguments_that_are_paths_start_from_the_studys_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("study")).expect("a folder");
    fs::write(folder.path().join("worker.py"), "").expect("a file");
    let base = folder.path().join("study");
    let (found, said) = problem(&base, &["sh", "./worker.py"]);
    assert!(matches!(found, Problem::NoSuchFile { .. }) && said.contains("`./worker.py`"), "{said}");
    let good = program(&base, &["sh", "../worker.py", "--fast", ".."]);
    let files = good.files().expect("a good command");
    assert_eq!(
        files,
        [base.join("../worker.py")],
        "words, folders and programs of the system are no files of the study's"
    );
}

#[test]
fn a_word_that_is_also_a_file_has_to_be_made_clear() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("worker.py"), "").expect("a file");
    let (found, said) = problem(folder.path(), &["sh", "worker.py"]);
    assert!(matches!(found, Problem::Ambiguous { .. }) && said.contains("`./worker.py`"), "{said}");
}

#[test]
fn empty_commands_and_limits_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(matches!(problem(folder.path(), &[]).0, Problem::NoCommand));
    assert!(matches!(problem(folder.path(), &[""]).0, Problem::NoCommand));
    let error = Program { time_limit: Duration::ZERO, ..program(folder.path(), &["sh"]) }.check();
    assert!(matches!(*error.expect_err("no time").problem, Problem::NoTime));
}
