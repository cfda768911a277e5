//! Nothing of a program stays: no process, no folder, no more memory than it may have.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::programs::{ask, assert_gone, first_error, is_alive, planted};
use isostudy_program::{End, Phase, Problem, Worker};

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

/// Threads and processes that have ended count, and waiting does not. Other work on the machine adds nothing to CPU time.
#[test]
fn its_cpu_time_is_that_of_its_threads_and_processes() {
    let mut worker = Worker::start(&planted("busy")).expect("it is ready");
    for (who, least, most) in [("a thread", 0.3, 0.6), ("nobody", 0.0, 0.1), ("a process", 0.28, 0.9)] {
        let cpu = ask(&mut worker).expect("an answer").cpu.expect("this system tells it").as_secs_f64();
        assert!((least..most).contains(&cpu), "{who}: {cpu}");
    }
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

/// Set for a process that this test starts of itself: the file into which it says whom it started.
const KILLED: &str = "PROGRAM_TEST_KILLED";

/// Two, so that one could hold the other's input open.
#[test]
fn programs_end_when_their_caller_is_killed() {
    if let Some(file) = std::env::var_os(KILLED) {
        let workers = [(); 2].map(|()| Worker::start(&planted("good")).expect("it is ready"));
        let folders = workers.each_ref().map(|worker| worker.folder().display().to_string());
        let started = workers.each_ref().map(|worker| worker.process().to_string());
        std::fs::write(&file, [started, folders].concat().join("\n") + "\n").expect("a file");
        std::thread::sleep(Duration::from_secs(1000));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("started");
    let mut caller = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "planted::processes::programs_end_when_their_caller_is_killed"])
        .env(KILLED, &file)
        .stdout(Stdio::null())
        .spawn()
        .expect("this test starts itself");
    let begin = Instant::now();
    let words = loop {
        let words = std::fs::read_to_string(&file).unwrap_or_default();
        if words.lines().count() == 4 && words.ends_with('\n') {
            break words;
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "it starts nothing: {:?}", caller.try_wait());
        std::thread::sleep(Duration::from_millis(10));
    };
    let lines: Vec<&str> = words.lines().collect();
    let started = [0, 1].map(|i| lines[i].parse().expect("a number"));
    assert!(started.iter().all(|&process| is_alive(process)));
    caller.kill().expect("it runs");
    caller.wait().expect("it is killed");
    started.into_iter().for_each(assert_ends);
    // A process that is killed removes nothing.
    lines[2..].iter().for_each(|folder| std::fs::remove_dir_all(folder).expect("its folder"));
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
    let program = isostudy_program::Program { memory_limit_bytes: None, ..planted("good") };
    let mut worker = Worker::start(&program).expect("it is ready");
    let before = worker.memory().expect("this system has /proc");
    assert!(
        ask(&mut worker).expect("an answer").memory.expect("it is counted").peak_bytes >= before.peak_bytes
    );
}
