//! Nothing of a program stays: no process, no folder, no more memory than it may have.

use std::time::{Duration, Instant};

use crate::programs::{ask, assert_gone, first_error, is_alive, planted};
use program::{End, Phase, Problem, Worker};

/// The process that the program started and left.
fn lingering(worker: &Worker) -> u32 {
    let number = std::fs::read_to_string(worker.folder().join("lingering")).expect("it says which");
    number.parse().expect("a number")
}

/// The system may take a moment to end what was killed.
fn assert_ends(process: u32) {
    let begin = Instant::now();
    while is_alive(process) {
        assert!(begin.elapsed() < Duration::from_secs(20), "process {process} is still there");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_dropped_worker_takes_its_processes_and_its_folder_along() {
    let mut worker = Worker::start(&planted("linger")).expect("it is ready");
    ask(&mut worker).expect("an answer");
    let (first, second, folder) = (worker.process(), lingering(&worker), worker.folder().to_owned());
    assert!(is_alive(first) && is_alive(second) && folder.is_dir());
    drop(worker);
    assert_ends(first);
    assert_ends(second);
    assert!(!folder.exists());
}

#[test]
fn a_crash_is_seen_though_something_holds_the_output_open() {
    let (error, worker) = first_error(&planted("linger-and-crash"));
    assert!(matches!(*error.problem, Problem::Ended { end: End::Code(5), .. }), "{error}");
    assert_ends(lingering(&worker));
    assert_gone(worker);
}

#[test]
fn a_program_that_ends_well_leaves_nothing_either() {
    let mut worker = Worker::start(&planted("linger")).expect("it is ready");
    ask(&mut worker).expect("an answer");
    let (first, second, folder) = (worker.process(), lingering(&worker), worker.folder().to_owned());
    worker.finish().expect("its code is 0");
    assert_ends(first);
    assert_ends(second);
    assert!(!folder.exists());
}

#[test]
fn more_memory_than_allowed_is_seen_at_the_start_in_an_answer_and_in_a_child() {
    let over = |problem: &Problem, expected: Phase| matches!(*problem, Problem::MemoryLimit { phase, bytes, limit } if phase == expected && bytes > limit);
    let error = Worker::start(&planted("memory-at-start")).expect_err("it was taken for ready");
    assert!(over(&error.problem, Phase::Start), "{error}");
    for plan in ["memory", "memory-of-a-child"] {
        let (error, worker) = first_error(&planted(plan));
        assert!(over(&error.problem, Phase::Request(1)), "{plan}: {error}");
        assert_gone(worker);
    }
}

#[test]
fn memory_without_a_limit_is_counted() {
    let program = program::Program { memory_limit_bytes: None, ..planted("good") };
    let mut worker = Worker::start(&program).expect("it is ready");
    let before = worker.memory().expect("this system has /proc");
    assert!(
        ask(&mut worker).expect("an answer").memory.expect("it is counted").peak_bytes >= before.peak_bytes
    );
}
