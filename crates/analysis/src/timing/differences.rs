//! How the machines of two runs differ.

use design::machine::Machine;
use design::record::BenchRun;
use std::fmt::Display;

/// What differs between the machines of two runs, or between what they were asked to do there, a line each; empty if
/// nothing does. Load, governor and how the program was built are not among it: the first are part of the noise, the last is
/// what one compares.
pub fn machine_differences(a: &BenchRun, b: &BenchRun) -> Vec<String> {
    let (x, y) = (&a.machine, &b.machine);
    let gib = |machine: &Machine| {
        machine.memory_bytes.map(|bytes| format!("{:.1} GiB", bytes as f64 / (1u64 << 30) as f64))
    };
    let on = |on: Option<bool>| on.map(|on| if on { "on" } else { "off" });
    let isa = |machine: &Machine| machine.isa.map(|level| level.label());
    let features = |machine: &Machine| {
        let mut features = machine.features.clone();
        features.sort();
        Some(features.join(" "))
    };
    [
        differ("model", x.model.as_ref(), y.model.as_ref()),
        differ("cores", x.cores, y.cores),
        differ("threads", Some(x.threads), Some(y.threads)),
        differ("sampling threads", Some(a.threads), Some(b.threads)),
        differ("level-1 data cache, KiB", x.l1d_kib, y.l1d_kib),
        differ("level-2 cache, KiB", x.l2_kib, y.l2_kib),
        differ("level-3 cache, KiB", x.l3_kib, y.l3_kib),
        differ("memory", gib(x), gib(y)),
        differ("os", Some(&x.os), Some(&y.os)),
        differ("instruction set", isa(x), isa(y)),
        differ("features", features(x), features(y)),
        differ("simultaneous multithreading", on(x.smt), on(y.smt)),
        differ("container's CPUs", x.cpu_limit, y.cpu_limit),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn differ<T: PartialEq + Display>(property: &str, a: Option<T>, b: Option<T>) -> Option<String> {
    let told = |value: &Option<T>| value.as_ref().map_or_else(|| "unknown".to_owned(), T::to_string);
    (a != b).then(|| format!("{property}: {} in A, {} in B", told(&a), told(&b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use design::machine::Build;

    #[test]
    fn builds_may_differ_and_machines_may_not() {
        let a = fixture::bench(&fixture::study());
        let mut b = a.clone();
        b.machine.load = Some(9.0);
        b.machine.governor = Some("powersave".into());
        b.machine.build =
            Build { commit: Some("abc".into()), compiler: "rustc 2".into(), ..Build::default() };
        assert_eq!(machine_differences(&a, &b), [] as [String; 0]);
        b.machine.model = None;
        b.threads = 16;
        let want = ["model: Example CPU in A, unknown in B", "sampling threads: 2 in A, 16 in B"];
        assert_eq!(machine_differences(&a, &b), want);
    }
}
