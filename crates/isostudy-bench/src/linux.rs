//! What Linux writes about the machine under `/proc` and `/sys`. Elsewhere the files are not there and all is `None`.
//!
//! Reading and parsing are apart: parsers take text, so that tests can hand them machines that are not at hand.

use std::collections::HashSet;
use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

const CPU_FOLDER: &str = "/sys/devices/system/cpu";
const POWER_FOLDER: &str = "/sys/class/powercap";
const CACHE_FOLDER: &str = "/sys/devices/system/cpu/cpu0/cache";
/// Whether the clock may rise: `1` says that it may not, and that it may.
const NO_TURBO: &str = "/sys/devices/system/cpu/intel_pstate/no_turbo";
const BOOST: &str = "/sys/devices/system/cpu/cpufreq/boost";
/// A container's CPU limit, as cgroups version 2 and 1 write it: quota and period.
const CPU_LIMIT: &str = "/sys/fs/cgroup/cpu.max";
const CPU_LIMIT_1: [&str; 2] =
    ["/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "/sys/fs/cgroup/cpu/cpu.cfs_period_us"];
/// A container's memory limit, as cgroups version 2 and 1 write it.
const MEMORY_LIMITS: [&str; 2] = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];

/// What all packages have used since a counter of theirs began, in microjoules (RAPL); `None` where it is not there or may not be
/// read.
pub(crate) fn energy_uj() -> Option<u64> {
    let package = |entry: std::fs::DirEntry| {
        // `intel-rapl:0` is a package, `intel-rapl:0:0` a part of it.
        let name = entry.file_name().into_string().ok()?;
        (name.matches(':').count() == 1).then(|| entry.path().join("energy_uj"))
    };
    let packages: Vec<PathBuf> = read_dir(POWER_FOLDER).ok()?.flatten().filter_map(package).collect();
    let used: Option<Vec<u64>> = packages.iter().map(|path| read(path)?.trim().parse().ok()).collect();
    used.filter(|used| !used.is_empty()).map(|used| used.iter().sum())
}

pub(crate) fn model() -> Option<String> {
    parse_model(&read("/proc/cpuinfo")?)
}

pub(crate) fn cores() -> Option<u32> {
    parse_cores(&read("/proc/cpuinfo")?).or_else(|| count_siblings(per_cpu("topology/thread_siblings_list")))
}

pub(crate) fn memory_bytes() -> Option<u64> {
    let total = parse_memory_bytes(&read("/proc/meminfo")?)?;
    Some(memory_limit_bytes().map_or(total, |limit| total.min(limit)))
}

/// What a container leaves; a limit above the machine's memory is none.
pub(crate) fn memory_limit_bytes() -> Option<u64> {
    let total = parse_memory_bytes(&read("/proc/meminfo")?)?;
    let limits = MEMORY_LIMITS.iter().filter_map(|path| parse_limit_bytes(&read(path)?));
    limits.filter(|limit| *limit < total).min()
}

pub(crate) fn cpu_limit() -> Option<f64> {
    let older = || Some(CPU_LIMIT_1.map(read).into_iter().collect::<Option<Vec<_>>>()?.join(" "));
    parse_cpu_limit(&read(CPU_LIMIT).or_else(older)?)
}

/// Sizes in KiB of a core's caches: level-1 data, level 2, level 3.
pub(crate) fn caches_kib() -> [Option<u32>; 3] {
    let folders = read_dir(CACHE_FOLDER).into_iter().flatten().flatten().map(|entry| entry.path());
    let caches = folders.filter_map(|folder| {
        let [level, kind, size] = ["level", "type", "size"].map(|file| read(folder.join(file)));
        Some([level?, kind?, size?])
    });
    sort_caches(caches.collect())
}

pub(crate) fn turbo() -> Option<bool> {
    let forbidden = || parse_switch(&read(NO_TURBO)?).map(|forbidden| !forbidden);
    forbidden().or_else(|| parse_switch(&read(BOOST)?))
}

pub(crate) fn smt() -> Option<bool> {
    parse_switch(&read("/sys/devices/system/cpu/smt/active")?)
}

/// The CPUs that share a core with this one, itself included, as the kernel writes them.
pub(crate) fn siblings(cpu: u32) -> Option<String> {
    read(format!("{CPU_FOLDER}/cpu{cpu}/topology/thread_siblings_list"))
}

pub(crate) fn max_mhz() -> Option<u32> {
    let khz = per_cpu("cpufreq/cpuinfo_max_freq").iter().filter_map(|text| text.trim().parse().ok()).max();
    khz.map(|khz: u32| khz / 1000)
}

pub(crate) fn governor() -> Option<String> {
    join_governors(per_cpu("cpufreq/scaling_governor"))
}

pub(crate) fn load() -> Option<f64> {
    parse_load(&read("/proc/loadavg")?)
}

/// Text with runs of blanks made one; `None` if nothing is left.
pub(crate) fn one_line(text: &str) -> Option<String> {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    (!line.is_empty()).then_some(line)
}

fn read(path: impl AsRef<Path>) -> Option<String> {
    read_to_string(path).ok()
}

/// One file of every CPU's folder, where it is there.
fn per_cpu(file: &str) -> Vec<String> {
    let is_cpu = |folder: &PathBuf| {
        let name = folder.file_name().and_then(|name| name.to_str());
        let number = name.and_then(|name| name.strip_prefix("cpu"));
        number.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
    };
    let folders = read_dir(CPU_FOLDER).into_iter().flatten().flatten().map(|entry| entry.path());
    folders.filter(is_cpu).filter_map(|folder| read(folder.join(file))).collect()
}

/// The value of the first line `key : value` with this key.
fn value<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    text.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        (name.trim() == key).then_some(value.trim())
    })
}

/// x86 has `model name`, MIPS `cpu model`, POWER `cpu`, RISC-V `uarch`. 64-bit ARM has codes only, which are given as
/// they are: a table of names would be out of date.
fn parse_model(cpuinfo: &str) -> Option<String> {
    let named = ["model name", "cpu model", "cpu", "uarch"].into_iter().find_map(|key| value(cpuinfo, key));
    if let Some(named) = named {
        return one_line(named);
    }
    let (implementer, part) = (value(cpuinfo, "CPU implementer")?, value(cpuinfo, "CPU part")?);
    Some(format!("ARM implementer {implementer} part {part}"))
}

/// Different pairs of socket and core; `None` unless every processor has both.
fn parse_cores(cpuinfo: &str) -> Option<u32> {
    let mut cores = HashSet::new();
    for processor in cpuinfo.split("\n\n").filter(|block| value(block, "processor").is_some()) {
        cores.insert((value(processor, "physical id")?, value(processor, "core id")?));
    }
    positive(cores.len())
}

/// Threads of one core list the same siblings, so different lists are different cores.
fn count_siblings(lists: Vec<String>) -> Option<u32> {
    positive(lists.iter().map(|list| list.trim()).collect::<HashSet<_>>().len())
}

fn positive(count: usize) -> Option<u32> {
    u32::try_from(count).ok().filter(|count| *count > 0)
}

/// `MemTotal`, which the kernel gives in units of 1024 bytes and calls kB.
fn parse_memory_bytes(meminfo: &str) -> Option<u64> {
    let (number, unit) = value(meminfo, "MemTotal")?.split_once(' ')?;
    if unit.trim() != "kB" {
        return None;
    }
    number.parse::<u64>().ok()?.checked_mul(1024)
}

/// A number of bytes; version 2 writes `max` where there is no limit, version 1 a number larger than any memory.
fn parse_limit_bytes(limit: &str) -> Option<u64> {
    limit.trim().parse().ok()
}

/// Quota and period in microseconds; `max` or a negative quota is no limit.
fn parse_cpu_limit(limit: &str) -> Option<f64> {
    let mut numbers = limit.split_whitespace().map(str::parse::<f64>);
    let (quota, period) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    (quota > 0.0 && period > 0.0).then_some(quota / period)
}

/// `[level, type, size]` of each cache.
fn sort_caches(caches: Vec<[String; 3]>) -> [Option<u32>; 3] {
    let find = |wanted: &str| {
        let is_data = |cache: &&[String; 3]| cache[0].trim() == wanted && cache[1].trim() != "Instruction";
        parse_kib(&caches.iter().find(is_data)?[2])
    };
    [find("1"), find("2"), find("3")]
}

/// `512K`, or `32M`.
fn parse_kib(size: &str) -> Option<u32> {
    let size = size.trim();
    let (number, factor) = match size.strip_suffix('M') {
        Some(number) => (number, 1024),
        None => (size.strip_suffix('K')?, 1),
    };
    number.parse::<u32>().ok()?.checked_mul(factor)
}

fn parse_switch(text: &str) -> Option<bool> {
    match text.trim() {
        "1" => Some(true),
        "0" => Some(false),
        _ => None,
    }
}

/// Every governor in use, sorted: CPUs may have different ones.
fn join_governors(mut governors: Vec<String>) -> Option<String> {
    governors.sort();
    governors.dedup();
    one_line(&governors.join(" "))
}

fn parse_load(loadavg: &str) -> Option<f64> {
    loadavg.split_whitespace().next()?.parse().ok().filter(|load: &f64| load.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sockets, two cores each, two threads a core; core numbers start anew on each socket.
    fn two_sockets() -> String {
        let mut text = String::new();
        for processor in 0..8 {
            let (socket, core) = (processor % 2, processor / 2 % 2);
            text += &format!(
                "processor\t: {processor}\nvendor_id\t: GenuineIntel\nmodel\t\t: 79\n\
                 model name\t: Intel(R) Xeon(R) CPU           E5-2680 v4 @ 2.40GHz\ncpu MHz\t\t: 2400.0\n\
                 physical id\t: {socket}\nsiblings\t: 4\ncore id\t\t: {core}\ncpu cores\t: 2\npower management:\n\n"
            );
        }
        text
    }

    const ARM: &str = "processor\t: 0\nBogoMIPS\t: 243.75\nFeatures\t: fp asimd evtstrm aes\n\
        CPU implementer\t: 0x41\nCPU architecture: 8\nCPU variant\t: 0x3\nCPU part\t: 0xd0c\nCPU revision\t: 1\n\n\
        processor\t: 1\nBogoMIPS\t: 243.75\nCPU implementer\t: 0x41\nCPU part\t: 0xd0c\n\n";

    #[test]
    fn two_sockets_have_cores_of_their_own() {
        assert_eq!(parse_cores(&two_sockets()), Some(4));
        let name = "Intel(R) Xeon(R) CPU E5-2680 v4 @ 2.40GHz";
        assert_eq!(parse_model(&two_sockets()).as_deref(), Some(name));
    }

    #[test]
    fn arm_tells_codes_and_no_cores() {
        assert_eq!(parse_model(ARM).as_deref(), Some("ARM implementer 0x41 part 0xd0c"));
        assert_eq!(parse_cores(ARM), None);
        let siblings = ["0\n", "1\n"].map(String::from).into();
        assert_eq!(count_siblings(siblings), Some(2));
        let siblings = ["0,4\n", "1,5\n", "0,4\n", "1,5\n"].map(String::from).into();
        assert_eq!(count_siblings(siblings), Some(2));
    }

    #[test]
    fn other_architectures_have_names_of_their_own() {
        assert_eq!(
            parse_model("processor\t: 0\ncpu\t\t: POWER9, altivec\n").as_deref(),
            Some("POWER9, altivec")
        );
        assert_eq!(parse_model("processor : 0\nuarch : sifive,u74-mc\n").as_deref(), Some("sifive,u74-mc"));
    }

    #[test]
    fn nothing_there_is_none() {
        for text in ["", "\n\n", "processor\t: 0\n", "model name\t:\n", "garbage \u{0} without a colon"] {
            assert_eq!(parse_model(text), None, "{text:?}");
            assert_eq!(parse_cores(text), None, "{text:?}");
            assert_eq!(parse_memory_bytes(text), None, "{text:?}");
            assert_eq!(parse_limit_bytes(text), None, "{text:?}");
            assert_eq!(parse_load(text), None, "{text:?}");
            assert_eq!(parse_cpu_limit(text), None, "{text:?}");
            assert_eq!(parse_kib(text), None, "{text:?}");
            assert_eq!(parse_switch(text), None, "{text:?}");
        }
        assert_eq!(count_siblings(Vec::new()), None);
        assert_eq!(join_governors(Vec::new()), None);
    }

    #[test]
    fn one_processor_without_a_core_number_makes_the_count_unknown() {
        let text = two_sockets() + "processor\t: 8\nmodel name\t: ?\n\n";
        assert_eq!(parse_cores(&text), None);
    }

    #[test]
    fn memory_is_in_kibibytes() {
        let meminfo = "MemTotal:       32637952 kB\nMemFree:         1021004 kB\n";
        assert_eq!(parse_memory_bytes(meminfo), Some(32_637_952 * 1024));
        assert_eq!(parse_memory_bytes("MemTotal: 32637952 pages\n"), None);
        assert_eq!(parse_memory_bytes("MemTotal: 99999999999999999999 kB\n"), None);
        assert_eq!(parse_memory_bytes("MemTotal: 18446744073709551615 kB\n"), None, "would overflow");
    }

    #[test]
    fn a_container_may_have_a_limit() {
        assert_eq!(parse_limit_bytes("4294967296\n"), Some(4 << 30));
        assert_eq!(parse_limit_bytes("max\n"), None);
        assert_eq!(parse_limit_bytes("9223372036854771712\n"), Some(9_223_372_036_854_771_712));
    }

    #[test]
    fn a_container_may_have_a_share_of_the_cpus() {
        assert_eq!(parse_cpu_limit("150000 100000\n"), Some(1.5));
        assert_eq!(parse_cpu_limit("max 100000\n"), None);
        // Version 1, from two files.
        assert_eq!(parse_cpu_limit("-1\n 100000\n"), None);
        assert_eq!(parse_cpu_limit("400000\n 100000\n"), Some(4.0));
        assert_eq!(parse_cpu_limit("1 0\n"), None);
    }

    #[test]
    fn caches_of_other_machines() {
        let cache = |level: &str, kind: &str, size: &str| [level, kind, size].map(|text| format!("{text}\n"));
        // Intel Core i7-11700.
        let intel = vec![
            cache("1", "Instruction", "32K"),
            cache("3", "Unified", "16384K"),
            cache("1", "Data", "48K"),
            cache("2", "Unified", "512K"),
        ];
        assert_eq!(sort_caches(intel), [Some(48), Some(512), Some(16384)]);
        // A board without a third level, and one that writes mebibytes.
        let small = vec![cache("1", "Data", "32K"), cache("2", "Unified", "1M")];
        assert_eq!(sort_caches(small), [Some(32), Some(1024), None]);
        assert_eq!(sort_caches(vec![cache("1", "Instruction", "32K")]), [None; 3]);
        assert_eq!(parse_kib("4194304M"), None, "would overflow");
    }

    #[test]
    fn switches_are_on_off_or_unknown() {
        assert_eq!(["1\n", "0\n", "on\n"].map(parse_switch), [Some(true), Some(false), None]);
    }

    #[test]
    fn load_and_governors() {
        assert_eq!(parse_load("0.52 0.58 0.59 1/467 12345\n"), Some(0.52));
        let mixed = ["powersave\n", "performance\n", "powersave\n"].map(String::from).into();
        assert_eq!(join_governors(mixed).as_deref(), Some("performance powersave"));
    }
}
