//! A process and all that it starts: its end and its memory.

use std::fmt;
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::process::{self, Command, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};

use crate::interrupt;
use crate::processes::{Family, cpu_time, resident_and_peak};
use crate::wrapper;

/// How often all processes are searched for members of the group, at the most.
const SEARCH_EVERY: Duration = Duration::from_secs(1);
/// A search takes about 50 us a process, on the core that is being timed, perhaps: so many times as long there is none.
const SEARCHES_APART: u32 = 500;

/// How a process ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// With this code.
    Code(i32),
    /// By this signal.
    Signal(i32),
    /// Not at all: it closed its output and went on.
    NotYet,
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(code) => write!(f, "ended with code {code}"),
            Self::Signal(signal) => write!(f, "was ended by signal {signal}"),
            Self::NotYet => f.write_str("closed its output without ending"),
        }
    }
}

impl End {
    fn of(status: ExitStatus) -> Self {
        status.code().map(Self::Code).or(status.signal().map(Self::Signal)).unwrap_or(Self::NotYet)
    }
}

/// Memory of a child and all that it started, from outside. What processes share is counted for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Resident now.
    pub resident_bytes: u64,
    /// The most that was resident since the child started: the largest sum that was seen, or the largest of any one process,
    /// which the system keeps.
    pub peak_bytes: u64,
}

/// A child and all that it starts, which are ended when this is dropped.
#[derive(Debug)]
pub(crate) struct Group {
    child: process::Child,
    family: Family,
    members: Vec<Pid>,
    next_search: Option<Instant>,
    peak_bytes: u64,
    reaped: bool,
}

impl Group {
    /// Starts the command as the first process of a group of its own.
    pub(crate) fn spawn(command: &mut Command, memory_bytes: Option<u64>) -> io::Result<Self> {
        let (child, family) = interrupt::register(|| wrapper::spawn(command, memory_bytes))?;
        Ok(Self { child, family, members: Vec::new(), next_search: None, peak_bytes: 0, reaped: false })
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    pub(crate) fn child(&mut self) -> &mut process::Child {
        &mut self.child
    }

    /// Whether the first process has ended. It is left unreaped, so that nothing else can get its number and the group's.
    pub(crate) fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        self.reaped || !matches!(waitid(WaitId::Pid(self.family.first), options), Ok(None))
    }

    /// Waits for the first process to end.
    pub(crate) fn ends_within(&self, limit: Duration) -> bool {
        let begin = Instant::now();
        while !self.has_ended() {
            if begin.elapsed() > limit {
                return false;
            }
            thread::sleep(Duration::from_millis(2));
        }
        true
    }

    /// Ends what is left of it. Tells how the first process ended; by itself, if it had.
    pub(crate) fn kill(&mut self) -> End {
        let had_ended = self.has_ended();
        if !self.reaped {
            // While the first is not reaped its number is nobody else's.
            self.family.kill();
            interrupt::forget(&self.family);
        }
        let status = self.child.wait();
        self.reaped = true;
        match status {
            Ok(status) if had_ended => End::of(status),
            _ => End::NotYet,
        }
    }

    /// What the group has, from `/proc`.
    ///
    /// A limit on the address space (`RLIMIT_AS`) was not taken: Python and its libraries reserve many times of what they use, and it
    /// holds for each process by itself.
    pub(crate) fn memory(&mut self, search_now: bool) -> Option<Memory> {
        let found: Vec<_> = self.alive(search_now).filter_map(resident_and_peak).collect();
        if found.is_empty() {
            return None;
        }
        let resident_bytes = found.iter().map(|[resident, _]| resident).sum();
        let peak = found.iter().map(|[_, peak]| *peak).fold(resident_bytes, u64::max);
        self.peak_bytes = self.peak_bytes.max(peak);
        Some(Memory { resident_bytes, peak_bytes: self.peak_bytes })
    }

    /// CPU time of the group since it began: of those that are alive, all threads, and of those that they waited for.
    pub(crate) fn cpu(&mut self) -> Option<Duration> {
        self.alive(true).map(cpu_time).sum()
    }

    /// The first process, which may have ended, and the others, which are searched for about once a second, or now.
    fn alive(&mut self, search_now: bool) -> impl Iterator<Item = Pid> {
        let first = self.family.first;
        let begin = Instant::now();
        if search_now || self.next_search.is_none_or(|at| begin >= at) {
            self.members = self.family.members();
            self.members.retain(|&member| member != first);
            let pause = SEARCH_EVERY.max(SEARCHES_APART * begin.elapsed());
            self.next_search = Some(begin + pause);
        }
        // A member may have ended and its number gone to a stranger.
        let others = self.members.iter().copied().filter(|&member| self.family.has(member));
        [first].into_iter().chain(others)
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        if !self.reaped {
            self.kill();
        }
    }
}
