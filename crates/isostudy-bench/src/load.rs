//! What the CPUs spent their time on, as Linux counts it in `/proc`. Elsewhere the files are not there.

use std::fs::read_to_string;

/// Fewer ticks than this (a hundredth of a second each, over all CPUs) are too coarse to take a share of.
pub const LEAST_TICKS: u64 = 100;

/// Ticks since the machine began, summed over the CPUs that were asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CpuTimes {
    /// All that went by.
    pub total: u64,
    /// Nothing to do.
    pub idle: u64,
    /// Given by the hypervisor to other machines.
    pub steal: u64,
    /// Spent by the processes that were asked for.
    pub own: u64,
}

/// How the time between two readings was shared out, 0 to 1 each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// Other processes, and the kernel on their behalf.
    pub others: f64,
    /// Other machines.
    pub steal: f64,
}

impl CpuTimes {
    /// Reads the times of these CPUs, or of all, and of these processes with their finished children; `None` where the
    /// system does not tell.
    pub fn read(processes: &[u32], cpus: Option<&[u32]>) -> Option<Self> {
        let mut times = parse_stat(&read_to_string("/proc/stat").ok()?, cpus)?;
        for process in processes {
            times.own += parse_process(&read_to_string(format!("/proc/{process}/stat")).ok()?)?;
        }
        Some(times)
    }

    /// How many ticks went by since an earlier reading.
    pub fn ticks_since(&self, earlier: &Self) -> u64 {
        self.total.saturating_sub(earlier.total)
    }

    /// How the time since an earlier reading was shared out; `None` if none went by.
    ///
    /// Ticks are counted by two clocks, so that one's own may exceed all that were busy; others then had nothing.
    pub fn shares_since(&self, earlier: &Self) -> Option<Shares> {
        let total = self.ticks_since(earlier);
        let of = |ticks: u64| ticks as f64 / total as f64;
        let [idle, steal, own] = [
            self.idle.saturating_sub(earlier.idle),
            self.steal.saturating_sub(earlier.steal),
            self.own.saturating_sub(earlier.own),
        ];
        (total > 0).then(|| Shares {
            others: of(total.saturating_sub(idle + steal + own)),
            steal: of(steal.min(total)),
        })
    }
}

/// Lines `cpu0 user nice system idle iowait irq softirq steal ...`; a guest's time is in `user` already.
fn parse_stat(stat: &str, cpus: Option<&[u32]>) -> Option<CpuTimes> {
    let line = |name: &str| -> Option<CpuTimes> {
        let mut fields = stat
            .lines()
            .map(str::split_whitespace)
            .find_map(|mut fields| (fields.next() == Some(name)).then_some(fields))?;
        let mut next = || fields.next().map_or(Some(0), |field| field.parse::<u64>().ok());
        let [user, nice, system, idle, iowait, irq, softirq, steal] =
            [next()?, next()?, next()?, next()?, next()?, next()?, next()?, next()?];
        let busy = user + nice + system + irq + softirq;
        Some(CpuTimes { total: busy + idle + iowait + steal, idle: idle + iowait, steal, own: 0 })
    };
    let Some(cpus) = cpus else { return line("cpu") };
    cpus.iter().try_fold(CpuTimes::default(), |sum, cpu| {
        let times = line(&format!("cpu{cpu}"))?;
        let CpuTimes { total, idle, steal, own } = sum;
        Some(CpuTimes {
            total: total + times.total,
            idle: idle + times.idle,
            steal: steal + times.steal,
            own,
        })
    })
}

/// Fields 14 to 17: its own user and system time, and those of its children that have ended. The second field is the
/// program's name in brackets, which may hold anything.
fn parse_process(stat: &str) -> Option<u64> {
    let after_name = &stat[stat.rfind(')')? + 1..];
    let times: Vec<u64> =
        after_name.split_whitespace().skip(11).take(4).map_while(|field| field.parse().ok()).collect();
    (times.len() == 4).then(|| times.iter().sum())
}

/// `VmRSS` and `VmHWM` of this process: what is resident now and what was at most, in bytes; `None` elsewhere.
pub(crate) fn resident_bytes() -> Option<[u64; 2]> {
    parse_resident(&read_to_string("/proc/self/status").ok()?)
}

fn parse_resident(status: &str) -> Option<[u64; 2]> {
    let kib = |key: &str| -> Option<u64> {
        let value = status.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'))?;
        value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
    };
    Some([kib("VmRSS")?, kib("VmHWM")?])
}

#[cfg(test)]
mod tests {
    use super::*;

    const STAT: &str = "cpu  1286928 146247 123486 1987838 9103 0 902 2058 500 0\n\
        cpu0 638518 69400 58017 1008971 1993 0 59 1028 0 0\ncpu1 648409 76846 65469 978866 7109 0 842 1029 0 0\n\
        intr 1 2 3\nctxt 99\n";

    #[test]
    fn guests_are_not_counted_twice() {
        let times = parse_stat(STAT, None).unwrap();
        assert_eq!(times.total, 1_286_928 + 146_247 + 123_486 + 1_987_838 + 9_103 + 902 + 2_058);
        assert_eq!((times.idle, times.steal, times.own), (1_987_838 + 9_103, 2_058, 0));
    }

    #[test]
    fn cpus_are_summed_and_must_be_there() {
        let one = parse_stat(STAT, Some(&[1])).unwrap();
        assert_eq!((one.idle, one.steal), (978_866 + 7_109, 1_029));
        let both = parse_stat(STAT, Some(&[0, 1])).unwrap();
        assert_eq!(both.idle, one.idle + 1_008_971 + 1_993);
        assert_eq!(parse_stat(STAT, Some(&[0, 2])), None);
        assert_eq!(parse_stat("", None), None);
        assert_eq!(parse_stat("cpu  1 2 x 4\n", None), None);
        // Kernels of long ago had four columns.
        assert_eq!(parse_stat("cpu 1 2 3 4\n", None).unwrap().total, 10);
    }

    #[test]
    fn a_process_may_have_any_name() {
        let stat = "4242 (a) b (c)) S 1 4242 4242 0 -1 4194560 1 2 3 4 700 30 5 6 20 0 1 0 12345";
        assert_eq!(parse_process(stat), Some(741));
        assert_eq!(parse_process("4242 (short) S 1 2"), None);
        assert_eq!(parse_process("no brackets"), None);
    }

    #[test]
    fn shares_of_what_went_by() {
        let before = CpuTimes { total: 1000, idle: 500, steal: 0, own: 100 };
        let after = CpuTimes { total: 1200, idle: 550, steal: 10, own: 200 };
        assert_eq!(after.ticks_since(&before), 200);
        assert_eq!(after.shares_since(&before), Some(Shares { others: 0.2, steal: 0.05 }));
        assert_eq!(before.shares_since(&before), None);
        let rounded = CpuTimes { total: 1010, idle: 500, steal: 0, own: 111 };
        assert_eq!(rounded.shares_since(&before), Some(Shares { others: 0.0, steal: 0.0 }));
    }

    #[test]
    fn resident_memory_is_in_kibibytes() {
        let status = "Name:\tx\nVmPeak:\t 900 kB\nVmHWM:\t  512 kB\nVmRSS:\t  256 kB\n";
        assert_eq!(parse_resident(status), Some([256 << 10, 512 << 10]));
        assert_eq!(parse_resident("VmRSS:\t 256 kB\n"), None);
        assert_eq!(parse_resident("VmHWM: x kB\nVmRSS: 1 kB\n"), None);
    }
}
