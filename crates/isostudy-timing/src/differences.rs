//! How the machines and the builds of two runs differ.

use isostudy_design::machine::{Build, Machine};
use isostudy_design::record::BenchRun;
use std::fmt::Display;

/// What differs between the machines of two runs, their settings, or the ways they were used, a line each; empty if nothing
/// does. Load is not among it, being part of the noise, nor how the program was built, which is what one compares.
pub fn machine_differences(a: &BenchRun, b: &BenchRun) -> Vec<String> {
    let (x, y) = (&a.machine, &b.machine);
    let gib = |machine: &Machine| {
        machine.memory_bytes.map(|bytes| format!("{:.1} GiB", bytes as f64 / (1u64 << 30) as f64))
    };
    let on = |on: Option<bool>| on.map(|on| if on { "on" } else { "off" });
    // Of a published table it is not known.
    let pinned = |run: &BenchRun| match run.imported_from {
        Some(_) => None,
        None => Some(if run.pinned.is_some() { "yes" } else { "no" }),
    };
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
        differ("highest clock, MHz", x.max_mhz, y.max_mhz),
        differ("turbo", on(x.turbo), on(y.turbo)),
        differ("governor", x.governor.as_ref(), y.governor.as_ref()),
        differ("pinned", pinned(a), pinned(b)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// What is known to differ between the programs of two runs and their plans, a line each. Of a published table nothing is known
/// but where it is from.
pub fn build_differences(a: &BenchRun, b: &BenchRun) -> Vec<String> {
    let (x, y) = (&a.machine.build, &b.machine.build);
    if a.imported_from.is_some() || b.imported_from.is_some() {
        let program = |run: &BenchRun| match &run.imported_from {
            Some(source) => Some(format!("that of {source}")),
            None => Some("isostudy".into()),
        };
        return differ("program", program(a), program(b)).into_iter().collect();
    }
    // That only one was pinned is no difference of builds.
    let both_pinned = a.pinned.is_some() && b.pinned.is_some();
    let cpus = |run: &BenchRun| {
        let cpus = run.pinned.as_ref().filter(|_| both_pinned)?;
        Some(cpus.iter().map(u32::to_string).collect::<Vec<_>>().join(" "))
    };
    let [aa_of_a, aa_of_b] = [a, b].map(|run| Some(run.aa_iterations));
    [
        differ("commit", commit(x), commit(y)),
        differ("sources", sources(x), sources(y)),
        differ("compiler", told(&x.compiler), told(&y.compiler)),
        differ("profile", told(&x.profile), told(&y.profile)),
        differ("optimisation level", told(&x.opt_level), told(&y.opt_level)),
        differ("compiler flags", told(&x.rustflags).or(Some("none")), told(&y.rustflags).or(Some("none"))),
        differ("target-cpu", told(&x.target_cpu), told(&y.target_cpu)),
        differ("rounds", Some(a.iterations), Some(b.iterations)),
        differ("rounds of the A/A block", aa_of_a, aa_of_b),
        differ("rounds of warm-up", Some(a.warmup), Some(b.warmup)),
        differ("CPUs pinned to", cpus(a), cpus(b)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The first digits of their digest, as many as tell two apart.
pub(super) fn sources(build: &Build) -> Option<&str> {
    build.sources.as_deref().map(|digest| digest.get(..12).unwrap_or(digest))
}

/// The commit, and whether more than that was compiled.
pub(super) fn commit(build: &Build) -> Option<String> {
    let commit = build.commit.as_ref()?;
    let changed = if build.dirty == Some(true) { " with uncommitted changes" } else { "" };
    Some(format!("{commit}{changed}"))
}

/// What an imported run leaves empty is not known.
fn told(text: &str) -> Option<&str> {
    (!text.is_empty()).then_some(text)
}

fn differ<T: PartialEq + Display>(property: &str, a: Option<T>, b: Option<T>) -> Option<String> {
    let told = |value: &Option<T>| value.as_ref().map_or_else(|| "unknown".to_owned(), T::to_string);
    (a != b).then(|| format!("{property}: {} in A, {} in B", told(&a), told(&b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn load_may_differ_and_machines_and_their_settings_may_not() {
        let a = fixture::bench(&fixture::study());
        let mut b = a.clone();
        b.machine.load = Some(9.0);
        b.machine.build = Build { compiler: "rustc 2".into(), ..Build::default() };
        assert_eq!(machine_differences(&a, &b), [] as [String; 0]);
        b.machine.model = None;
        b.threads = 16;
        let want = ["model: Example CPU in A, unknown in B", "sampling threads: 2 in A, 16 in B"];
        assert_eq!(machine_differences(&a, &b), want);
        let mut b = a.clone();
        (b.machine.turbo, b.machine.governor) = (Some(false), Some("powersave".into()));
        (b.machine.max_mhz, b.pinned) = (Some(2000), Some(vec![0, 2]));
        let want = [
            "highest clock, MHz: unknown in A, 2000 in B",
            "turbo: unknown in A, off in B",
            "governor: unknown in A, powersave in B",
            "pinned: no in A, yes in B",
        ];
        assert_eq!(machine_differences(&a, &b), want);
    }

    #[test]
    fn builds_are_told_apart() {
        let mut a = fixture::bench(&fixture::study());
        a.machine.build = Build {
            commit: Some("abc".into()),
            dirty: Some(false),
            compiler: "rustc 1".into(),
            profile: "release".into(),
            opt_level: "3".into(),
            target_cpu: "x86-64".into(),
            ..Build::default()
        };
        let mut b = a.clone();
        assert_eq!(build_differences(&a, &b), [] as [String; 0]);
        b.machine.build.dirty = Some(true);
        b.machine.build.sources = Some("0123456789abcdef".into());
        b.machine.build.rustflags = "-C target-cpu=native".into();
        b.machine.build.target_cpu = "native".into();
        b.iterations = 10;
        b.pinned = Some(vec![0, 2]);
        assert_eq!(build_differences(&a, &b).len(), 5, "that one is not pinned is not about builds");
        a.pinned = Some(vec![1]);
        let want = [
            "commit: abc in A, abc with uncommitted changes in B",
            "sources: unknown in A, 0123456789ab in B",
            "compiler flags: none in A, -C target-cpu=native in B",
            "target-cpu: x86-64 in A, native in B",
            "rounds: 5 in A, 10 in B",
            "CPUs pinned to: 1 in A, 0 2 in B",
        ];
        assert_eq!(build_differences(&a, &b), want);
        b.imported_from = Some("a table".into());
        let want = ["program: isostudy in A, that of a table in B"];
        assert_eq!(build_differences(&a, &b), want);
    }
}
