//! Instructions of an extraction, counted by valgrind's cachegrind, which needs no counters of the CPU.

use crate::error::BenchError;
use crate::process::{Allowance, Worker};
use crate::worker::Request;
use isostudy_foreign::Told;
use std::process::Command;

/// Of `valgrind`: count instructions alone, and keep no file.
const OPTIONS: [&str; 3] = ["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"];
/// A request for allocations extracts so often. One for times or memory reads the CPU's counters, which valgrind does not stand.
const EXTRACTIONS: u64 = 3;

/// How many instructions an extraction takes in a process that has extracted before: what the process does to begin and to end is
/// not in it. `command` ends up in [`serve`](crate::serve), and must sample on one thread. Two counts of one program may differ by some
/// thousand: where memory lies decides how it is copied.
///
/// # Errors
/// If valgrind cannot be started, the process does not answer as it must, or nothing was counted.
pub fn instructions(
    command: &dyn Fn() -> Command,
    subject: usize,
    allowance: Allowance,
) -> Result<u64, BenchError> {
    let [once, twice] = [1, 2].map(|times| counted(command(), subject, times, allowance));
    let (once, twice) = (once?, twice?);
    twice.checked_sub(once).filter(|more| *more > 0).map(|more| more / EXTRACTIONS).ok_or_else(|| {
        BenchError::Process(format!("more extractions took {twice} instructions, and fewer took {once}"))
    })
}

/// Of the whole process, which is asked so often.
fn counted(program: Command, subject: usize, times: u32, allowance: Allowance) -> Result<u64, BenchError> {
    let mut command = Command::new("valgrind");
    command.args(OPTIONS).arg(program.get_program()).args(program.get_args());
    let quiet: Option<Told> = None;
    let (mut worker, _) = Worker::start(command, quiet, allowance)?;
    for _ in 0..times {
        worker.ask(Request::Allocations(subject))?.allocations()?;
    }
    let said = worker.finish();
    parse(&said).ok_or_else(|| BenchError::Process(format!("valgrind counted nothing: it said `{said}`")))
}

/// `==4242== I   refs:      1,234,567`.
fn parse(said: &str) -> Option<u64> {
    let line = said.lines().rev().find(|line| line.contains("refs:") && line.contains(" I "))?;
    let digits: String = line.rsplit(':').next()?.chars().filter(char::is_ascii_digit).collect();
    digits.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn valgrinds_count_is_read() {
        let said = "==7== Cachegrind, a cache and branch-prediction profiler\n==7== \n==7== I   refs:      12,345,678\n";
        assert_eq!(parse(said), Some(12_345_678));
        // Since version 3.21 there are no spaces.
        assert_eq!(parse("==7== I refs:        1,000\n"), Some(1000));
        assert_eq!(parse("==7== nothing\n"), None);
    }
}
