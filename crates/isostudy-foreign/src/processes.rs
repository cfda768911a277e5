//! The processes that belong to a child: looked up in `/proc`, and ended.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use rustix::process::{
    Pid, PidfdFlags, Signal, kill_process, kill_process_group, pidfd_open, pidfd_send_signal,
};

/// The variable of the environment that a child and all that it starts have. Its value is `,A,B,`: the child A of a child B of ours.
pub(crate) const MARK: &str = "ISOSTUDY_CHILD";
/// The largest environment that is looked at.
const ENVIRONMENT_LIMIT: u64 = 1 << 20;
/// How long what was killed may take to be gone; its number may be in a system call that cannot be broken off.
const PATIENCE: Duration = Duration::from_secs(2);

/// By what the processes of a child are known: its group and session, which have its number, and its mark.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Family {
    pub(crate) first: Pid,
    pub(crate) mark: String,
}

/// A mark that no other child has, on this machine.
pub(crate) fn new_mark() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos());
    format!("{}-{}-{since_1970:x}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// What the variable is for a child of a process that may be a child itself.
pub(crate) fn marked(mark: &str) -> String {
    let outer = std::env::var(MARK).unwrap_or_default();
    format!("{}{mark},", if outer.is_empty() { "," } else { &outer })
}

impl Family {
    /// Every process of it that is alive, but for this one.
    pub(crate) fn members(&self) -> Vec<Pid> {
        let Ok(entries) = fs::read_dir("/proc") else { return Vec::new() };
        let processes = entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse::<i32>().ok());
        let found = processes.filter_map(Pid::from_raw).filter(|&process| self.has(process));
        found.filter(|process| process.as_raw_nonzero().get() as u32 != std::process::id()).collect()
    }

    /// Whether a process is of it and alive.
    pub(crate) fn has(&self, process: Pid) -> bool {
        let first = self.first.as_raw_nonzero().get();
        let Some(stat) = read(process, "stat", 4096) else { return false };
        let stat = String::from_utf8_lossy(&stat);
        // After the name, which may have spaces and parentheses of its own: state, parent, group, session.
        let Some((_, rest)) = stat.rsplit_once(')') else { return false };
        let words: Vec<&str> = rest.split_ascii_whitespace().take(4).collect();
        let [state, _, group, session] = words[..] else { return false };
        if matches!(state, "Z" | "X") {
            return false;
        }
        let is_first = |word: &str| word.parse() == Ok(first);
        process == self.first || is_first(group) || is_first(session) || self.has_mark(process)
    }

    fn has_mark(&self, process: Pid) -> bool {
        let Some(environment) = read(process, "environ", ENVIRONMENT_LIMIT) else { return false };
        let sought = format!(",{},", self.mark);
        let variables = environment.split(|&byte| byte == 0);
        variables
            .filter_map(|variable| variable.strip_prefix(MARK.as_bytes()))
            .any(|value| value.windows(sought.len()).any(|part| part == sought.as_bytes()))
    }

    /// Kills all of it, again and again until nothing is left that can be.
    pub(crate) fn kill(&self) {
        let begin = Instant::now();
        loop {
            // The first may not be the leader of its group yet.
            let _ = kill_process(self.first, Signal::KILL);
            let _ = kill_process_group(self.first, Signal::KILL);
            let members = self.members();
            members.iter().for_each(|&member| self.kill_member(member));
            if members.is_empty() || begin.elapsed() > PATIENCE {
                return;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Its number may have gone to a stranger since it was seen, so it is held while it is looked at again.
    fn kill_member(&self, member: Pid) {
        if let Ok(held) = pidfd_open(member, PidfdFlags::empty())
            && self.has(member)
        {
            let _ = pidfd_send_signal(held, Signal::KILL);
        }
    }
}

/// Resident memory of a process now, and the most that it had.
pub(crate) fn resident_and_peak(process: Pid) -> Option<[u64; 2]> {
    let status = read(process, "status", 1 << 16)?;
    let status = String::from_utf8_lossy(&status);
    let bytes = |key: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
    };
    Some([bytes("VmRSS:")?, bytes("VmHWM:")?])
}

/// CPU time of a process since it began, of all its threads, those that have ended too; and of the processes that it waited for.
///
/// The kernel keeps the first to the nanosecond. The second is what `wait4` told it, in hundredths of a second.
#[cfg(target_os = "linux")]
pub(crate) fn cpu_time(process: Pid) -> Option<Duration> {
    let clock =
        nix::time::clock_getcpuclockid(nix::unistd::Pid::from_raw(process.as_raw_nonzero().get())).ok()?;
    let own = Duration::from(clock.now().ok()?);
    let stat = read(process, "stat", 4096)?;
    let ticks = waited_for_ticks(&String::from_utf8_lossy(&stat))?;
    let per_second = rustix::param::clock_ticks_per_second();
    Some(own + Duration::from_secs_f64(ticks as f64 / per_second as f64))
}

/// No other system tells it.
#[cfg(not(target_os = "linux"))]
pub(crate) fn cpu_time(_process: Pid) -> Option<Duration> {
    None
}

/// Fields 16 and 17, user and system time of children that were waited for. The name, which may hold anything, comes before.
#[cfg(any(target_os = "linux", test))]
fn waited_for_ticks(stat: &str) -> Option<u64> {
    let mut fields = stat[stat.rfind(')')? + 1..].split_ascii_whitespace().skip(13);
    let user: u64 = fields.next()?.parse().ok()?;
    let system: u64 = fields.next()?.parse().ok()?;
    Some(user + system)
}

fn read(process: Pid, name: &str, limit: u64) -> Option<Vec<u8>> {
    let path: PathBuf = Path::new("/proc").join(process.as_raw_nonzero().to_string()).join(name);
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(limit).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_children_are_read() {
        let stat = "4242 (a) b (c)) S 1 4242 4242 0 -1 4194560 100 2000 3 40 700 30 5 6 20 0 1 0 12345";
        assert_eq!(waited_for_ticks(stat), Some(11));
        assert_eq!(waited_for_ticks("4242 (short) S 1 2"), None);
    }
}
