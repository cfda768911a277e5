//! A process and all that it starts: its end and its memory.

use std::fs;
use std::io;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{
    Pid, Signal, WaitId, WaitIdOptions, kill_process_group, test_kill_process_group, waitid,
};

use crate::error::End;

/// How often all processes are searched for members of the group, at the most.
const SEARCH_EVERY: Duration = Duration::from_secs(1);
/// A search takes about 25 us a process, on the core that is being timed, perhaps: so many times as long there is none.
const SEARCHES_APART: u32 = 500;

/// Memory of a program and all that it started, from outside. What processes share is counted for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Resident now.
    pub resident_bytes: u64,
    /// The most that was resident since the program started: the largest sum that was seen, or the largest of any one process,
    /// which the system keeps.
    pub peak_bytes: u64,
}

/// A process group that is ended when this is dropped.
#[derive(Debug)]
pub(crate) struct Group {
    child: Child,
    id: Pid,
    members: Vec<i32>,
    next_search: Option<Instant>,
    peak_bytes: u64,
    reaped: bool,
}

impl Group {
    /// Starts the command as the first process of a group of its own.
    pub(crate) fn spawn(command: &mut Command) -> io::Result<Self> {
        let child = command.process_group(0).spawn()?;
        let id = Pid::from_child(&child);
        Ok(Self { child, id, members: Vec::new(), next_search: None, peak_bytes: 0, reaped: false })
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    pub(crate) fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Whether the first process has ended. It is left unreaped, so that nothing else can get its number and the group's.
    pub(crate) fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        self.reaped || !matches!(waitid(WaitId::Pid(self.id), options), Ok(None))
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

    /// Ends what is left of the group. Tells how the first process ended; by itself, if it had.
    pub(crate) fn kill(&mut self) -> End {
        let had_ended = self.has_ended();
        if !self.reaped {
            let _ = kill_process_group(self.id, Signal::KILL);
        }
        let status = self.child.wait();
        self.reaped = true;
        // The others die a little later, and must not write into a folder that is being removed.
        let begin = Instant::now();
        while test_kill_process_group(self.id).is_ok() && begin.elapsed() < Duration::from_millis(200) {
            thread::sleep(Duration::from_millis(1));
        }
        match status {
            Ok(status) if had_ended => {
                status.code().map(End::Code).or(status.signal().map(End::Signal)).unwrap_or(End::NotYet)
            }
            _ => End::NotYet,
        }
    }

    /// What the group has, from `/proc`. The first process is looked at each time, others are searched for about
    /// once a second, or now.
    ///
    /// A limit on the address space (`RLIMIT_AS`, which could be set from outside) was not taken: Python and its libraries
    /// reserve many times of what they use, and it holds for each process by itself.
    pub(crate) fn memory(&mut self, search_now: bool) -> Option<Memory> {
        let first = self.id.as_raw_nonzero().get();
        let begin = Instant::now();
        if search_now || self.next_search.is_none_or(|at| begin >= at) {
            self.members = members(first);
            let pause = SEARCH_EVERY.max(SEARCHES_APART * begin.elapsed());
            self.next_search = Some(begin + pause);
        }
        // A member may have ended and its number gone to a stranger.
        let others = self.members.iter().copied().filter(|&m| m != first && group_of(m) == Some(first));
        let found: Vec<_> = [first].into_iter().chain(others).filter_map(resident_and_peak).collect();
        if found.is_empty() {
            return None;
        }
        let resident_bytes = found.iter().map(|[resident, _]| resident).sum();
        let peak = found.iter().map(|[_, peak]| *peak).fold(resident_bytes, u64::max);
        self.peak_bytes = self.peak_bytes.max(peak);
        Some(Memory { resident_bytes, peak_bytes: self.peak_bytes })
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        if !self.reaped {
            self.kill();
        }
    }
}

fn members(group: i32) -> Vec<i32> {
    let Ok(entries) = fs::read_dir("/proc") else { return Vec::new() };
    let processes = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse::<i32>().ok());
    processes.filter(|&process| group_of(process) == Some(group)).collect()
}

/// The third word after the name, which may have spaces and parentheses of its own.
fn group_of(process: i32) -> Option<i32> {
    let stat = fs::read_to_string(Path::new("/proc").join(process.to_string()).join("stat")).ok()?;
    stat.rsplit_once(')')?.1.split_ascii_whitespace().nth(2)?.parse().ok()
}

fn resident_and_peak(process: i32) -> Option<[u64; 2]> {
    let status = fs::read_to_string(Path::new("/proc").join(process.to_string()).join("status")).ok()?;
    let bytes = |key: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
    };
    Some([bytes("VmRSS:")?, bytes("VmHWM:")?])
}
