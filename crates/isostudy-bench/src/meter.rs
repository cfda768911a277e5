//! What this process uses while it extracts: CPU time, page faults, context switches, and what the CPU counts.

use crate::linux::energy_uj;
use crate::perf::{Counts, counts};
use isostudy_design::record::Counters;

/// Readings from before an extraction.
pub(crate) struct Meter {
    usage: Option<Usage>,
    energy_uj: Option<u64>,
    counts: Counts,
}

/// What the process has used since it began: over all its threads, those that have ended too, but for context switches, which are
/// told of the first thread alone.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Usage {
    cpu_s: f64,
    page_faults: u64,
    context_switches: u64,
}

impl Meter {
    /// Reads what there is to read.
    pub(crate) fn begin() -> Self {
        // What costs least time is read last, and first again.
        Self { energy_uj: energy_uj(), usage: usage(), counts: counts() }
    }

    /// Reads it again, and says what was used in between.
    pub(crate) fn end(self) -> Counters {
        let after = counts();
        let since = |which: usize| after[which]?.checked_sub(self.counts[which]?);
        let used = self.usage.zip(usage()).map(|(before, after)| after.since(&before));
        Counters {
            cpu_s: used.map(|used| used.cpu_s),
            page_faults: used.map(|used| used.page_faults),
            context_switches: used.map(|used| used.context_switches),
            instructions: since(0),
            cache_misses: since(1),
            branch_misses: since(2),
            // A counter that began again says nothing.
            energy_j: self
                .energy_uj
                .zip(energy_uj())
                .and_then(|(before, after)| after.checked_sub(before))
                .map(|used| 1e-6 * used as f64),
            outside_s: None,
        }
    }
}

impl Usage {
    fn since(&self, before: &Self) -> Self {
        Self {
            cpu_s: (self.cpu_s - before.cpu_s).max(0.0),
            page_faults: self.page_faults.saturating_sub(before.page_faults),
            context_switches: self.context_switches.saturating_sub(before.context_switches),
        }
    }
}

/// The clock tells CPU time to the nanosecond, where `/proc` counts hundredths of a second.
#[cfg(target_os = "linux")]
fn usage() -> Option<Usage> {
    Some(Usage {
        cpu_s: cpu_s()?,
        page_faults: parse_faults(&std::fs::read_to_string("/proc/self/stat").ok()?)?,
        context_switches: parse_switches(&std::fs::read_to_string("/proc/self/status").ok()?)?,
    })
}

/// CPU time of this process since it began, in seconds.
#[cfg(target_os = "linux")]
pub(crate) fn cpu_s() -> Option<f64> {
    let cpu = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(cpu.tv_sec as f64 + 1e-9 * cpu.tv_nsec as f64)
}

#[cfg(not(target_os = "linux"))]
pub(crate) fn cpu_s() -> Option<f64> {
    None
}

/// CPU time of this thread since it began, in seconds.
#[cfg(target_os = "linux")]
pub(crate) fn thread_cpu_s() -> Option<f64> {
    let cpu = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(cpu.tv_sec as f64 + 1e-9 * cpu.tv_nsec as f64)
}

#[cfg(not(target_os = "linux"))]
pub(crate) fn thread_cpu_s() -> Option<f64> {
    None
}

#[cfg(not(target_os = "linux"))]
fn usage() -> Option<Usage> {
    None
}

/// Fields 10 and 12: faults that needed no disk, and those that did. The second field is the program's name in brackets, which may
/// hold anything.
#[cfg(any(target_os = "linux", test))]
fn parse_faults(stat: &str) -> Option<u64> {
    let mut fields = stat[stat.rfind(')')? + 1..].split_whitespace().skip(7);
    let minor: u64 = fields.next()?.parse().ok()?;
    let major: u64 = fields.nth(1)?.parse().ok()?;
    Some(minor + major)
}

#[cfg(any(target_os = "linux", test))]
fn parse_switches(status: &str) -> Option<u64> {
    let of = |key: &str| -> Option<u64> {
        let value = status.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
        value.trim().parse().ok()
    };
    Some(of("voluntary_ctxt_switches")? + of("nonvoluntary_ctxt_switches")?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::hint::black_box;

    /// 40 MiB, which no allocator keeps for later, are 10,240 pages of 4 KiB; a system with larger ones has fewer faults, but some.
    #[cfg(target_os = "linux")]
    #[test]
    fn new_memory_costs_page_faults() {
        let meter = Meter::begin();
        let memory = black_box(vec![1_u8; 40 << 20]);
        let faults = meter.end().page_faults.unwrap();
        assert!(faults >= 8 && memory[1 << 20] == 1, "{faults}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn threads_that_have_ended_count() {
        let meter = Meter::begin();
        let length = std::thread::spawn(|| black_box(vec![1_u8; 40 << 20]).len()).join().unwrap();
        let counters = meter.end();
        assert!(counters.page_faults.unwrap() >= 8 && length == 40 << 20, "{counters:?}");
        assert!(counters.cpu_s.is_some());
    }

    #[test]
    fn what_the_kernel_writes_is_read() {
        let stat = "4242 (a) b (c)) S 1 4242 4242 0 -1 4194560 100 2000 3 40 700 30 5 6 20 0 1 0 12345";
        assert_eq!(parse_faults(stat), Some(103), "not those of its children");
        assert_eq!(parse_faults("4242 (short) S 1 2"), None);
        let status = "Name:\tx\nvoluntary_ctxt_switches:\t5\nnonvoluntary_ctxt_switches:\t70\n";
        assert_eq!(parse_switches(status), Some(75));
        assert_eq!(parse_switches("voluntary_ctxt_switches:\t5\n"), None);
    }

    #[test]
    fn what_went_back_is_nothing() {
        let usage = |cpu_s, count| Usage { cpu_s, page_faults: count, context_switches: count };
        assert_eq!(usage(2.5, 7).since(&usage(1.0, 4)), usage(1.5, 3));
        assert_eq!(usage(1.0, 4).since(&usage(2.5, 7)), usage(0.0, 0));
    }
}
