//! The machine held against the CPU the numbers are meant for.

use crate::machine::FEATURES;
use isostudy_design::machine::{CpuProfile, Machine, ProfileDifference};
use serde::Serialize;

/// Share of a profile's memory that may be missing. A machine sold with 32 GiB reports less: firmware, integrated
/// graphics and the kernel keep some.
pub const MEMORY_ALLOWANCE: f64 = 0.1;

const UNKNOWN: &str = "unknown";

/// One property of the machine beside what the profile says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProfileRow {
    /// What is compared.
    pub property: String,
    /// What the profile says; empty where it says nothing.
    pub target: String,
    /// What the machine has, or `unknown`.
    pub machine: String,
    /// Whether the two agree; `None` where nothing is asked or the property is recorded only.
    pub matches: Option<bool>,
}

/// Everything that is known of the machine, beside what the profile asks for.
///
/// A model matches if it contains the profile's text, in any case; an empty text matches any. Cores, threads, caches,
/// operating system and what the program was compiled for must be equal, memory may be short by
/// [`MEMORY_ALLOWANCE`], the instruction-set level must be reached and features must be there. What the profile asks
/// for and the machine does not tell is no match. The rest is recorded only.
pub fn compare_profile(target: &CpuProfile, machine: &Machine) -> Vec<ProfileRow> {
    let mut rows = vec![
        model(target, machine),
        equal("cores", target.cores.as_ref(), machine.cores.as_ref()),
        equal("threads", target.threads.as_ref(), Some(&machine.threads)),
        equal("level-1 data cache, KiB", target.l1d_kib.as_ref(), machine.l1d_kib.as_ref()),
        equal("level-2 cache, KiB", target.l2_kib.as_ref(), machine.l2_kib.as_ref()),
        equal("level-3 cache, KiB", target.l3_kib.as_ref(), machine.l3_kib.as_ref()),
        memory(target, machine),
        equal("os", target.os.as_ref(), Some(&machine.os)),
    ];
    rows.push(isa(target, machine));
    rows.push(equal("target-cpu", target.target_cpu.as_ref(), Some(&machine.build.target_cpu)));
    rows.extend(target.features.iter().map(|feature| self::feature(feature, machine)));
    rows.push(recorded("base clock", clock(target.base_mhz), None));
    rows.push(recorded("boost clock", clock(target.boost_mhz), machine.max_mhz.map(|mhz| clock(Some(mhz)))));
    let on = |on: bool| if on { "on" } else { "off" }.to_owned();
    let build = &machine.build;
    for (property, told) in [
        ("governor", machine.governor.clone()),
        ("turbo", machine.turbo.map(on)),
        ("simultaneous multithreading", machine.smt.map(on)),
        ("load average", machine.load.map(|load| load.to_string())),
        (
            "container's CPUs",
            machine.cpu_limit.map_or(Some("no limit".into()), |cpus| Some(cpus.to_string())),
        ),
        (
            "container's memory",
            machine.memory_limit_bytes.map_or(Some("no limit".into()), |b| Some(gibibytes(b))),
        ),
        ("compiler", Some(build.compiler.clone())),
        ("profile", Some(format!("{}, opt-level {}", build.profile, build.opt_level))),
        ("compiler flags", Some(build.rustflags.clone())),
        ("commit", build.commit.clone()),
        ("uncommitted changes", build.dirty.map(|dirty| if dirty { "yes" } else { "no" }.into())),
        ("sources", build.sources.clone()),
    ] {
        rows.push(recorded(property, String::new(), told));
    }
    rows
}

/// The ways in which the machine differs from the profile; empty when it matches. Rules as in [`compare_profile`].
pub fn differences(target: &CpuProfile, machine: &Machine) -> Vec<ProfileDifference> {
    compare_profile(target, machine)
        .into_iter()
        .filter(|row| row.matches == Some(false))
        .map(|row| ProfileDifference { property: row.property, target: row.target, machine: row.machine })
        .collect()
}

fn model(target: &CpuProfile, machine: &Machine) -> ProfileRow {
    let asked = target.model.to_lowercase();
    let matches = machine.model.as_ref().is_some_and(|model| model.to_lowercase().contains(&asked));
    let matches = (!asked.is_empty()).then_some(matches);
    row("model", target.model.clone(), machine.model.clone(), matches)
}

fn isa(target: &CpuProfile, machine: &Machine) -> ProfileRow {
    let [asked, found] = [target.isa, machine.isa].map(|level| level.map(|level| level.label().to_owned()));
    let matches = target.isa.map(|asked| machine.isa >= Some(asked));
    row("instruction set", asked.unwrap_or_default(), found, matches)
}

fn gib(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}

fn gibibytes(bytes: u64) -> String {
    format!("{:.1} GiB", gib(bytes))
}

fn memory(target: &CpuProfile, machine: &Machine) -> ProfileRow {
    let enough = |asked: u32| {
        let least = f64::from(asked) * (1.0 - MEMORY_ALLOWANCE);
        machine.memory_bytes.is_some_and(|bytes| gib(bytes) >= least)
    };
    let asked = target.memory_gib.map_or_else(String::new, |asked| format!("{asked} GiB"));
    row("memory", asked, machine.memory_bytes.map(gibibytes), target.memory_gib.map(enough))
}

fn feature(feature: &str, machine: &Machine) -> ProfileRow {
    let there = machine.features.iter().any(|has| has == feature);
    // A feature that nobody looked for is not known to be missing.
    let has = (there || FEATURES.contains(&feature)).then(|| if there { "yes" } else { "no" }.into());
    row(&format!("feature {feature}"), "yes".into(), has, Some(there))
}

fn equal<T: PartialEq + ToString>(property: &str, target: Option<&T>, machine: Option<&T>) -> ProfileRow {
    let matches = target.map(|asked| machine == Some(asked));
    row(property, target.map_or_else(String::new, T::to_string), machine.map(T::to_string), matches)
}

fn recorded(property: &str, target: String, machine: Option<String>) -> ProfileRow {
    row(property, target, machine, None)
}

fn row(property: &str, target: String, machine: Option<String>, matches: Option<bool>) -> ProfileRow {
    let machine = machine.unwrap_or_else(|| UNKNOWN.into());
    ProfileRow { property: property.into(), target, machine, matches }
}

fn clock(mhz: Option<u32>) -> String {
    mhz.map_or_else(String::new, |mhz| format!("{mhz} MHz"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::tests::machine;

    fn i7_11700() -> CpuProfile {
        profile("i7-11700")
    }

    fn profile(name: &str) -> CpuProfile {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../configs/cpu");
        toml::from_str(&std::fs::read_to_string(format!("{folder}/{name}.toml")).unwrap()).unwrap()
    }

    fn properties(differences: &[ProfileDifference]) -> Vec<&str> {
        differences.iter().map(|difference| difference.property.as_str()).collect()
    }

    #[test]
    fn the_papers_machine_matches_its_profile() {
        assert_eq!(differences(&i7_11700(), &machine()), []);
        assert_eq!(differences(&profile("x86-64-v3"), &machine()), []);
    }

    #[test]
    fn another_machine_differs_in_every_property_asked_for() {
        let other = Machine {
            model: Some("AMD EPYC 7763 64-Core Processor".into()),
            cores: Some(2),
            threads: 4,
            memory_bytes: Some(24 << 30),
            os: "linux".into(),
            features: vec!["avx2".into()],
            ..machine()
        };
        let differences = differences(&i7_11700(), &other);
        assert_eq!(properties(&differences), ["model", "cores", "threads", "memory", "os", "feature fma"]);
        let [model, cores, _, memory, _, fma] = &differences[..] else { panic!() };
        assert!(model.target.contains("i7-11700") && model.machine.contains("EPYC"));
        assert_eq!((cores.target.as_str(), cores.machine.as_str()), ("8", "2"));
        assert_eq!((memory.target.as_str(), memory.machine.as_str()), ("32 GiB", "24.0 GiB"));
        assert_eq!((fma.target.as_str(), fma.machine.as_str()), ("yes", "no"));
    }

    #[test]
    fn unknown_is_no_match() {
        let silent = Machine { model: None, cores: None, memory_bytes: None, ..machine() };
        let differences = differences(&i7_11700(), &silent);
        assert_eq!(properties(&differences), ["model", "cores", "memory"]);
        assert!(differences.iter().all(|difference| difference.machine == "unknown"));
        let strange = CpuProfile { features: vec!["warp-drive".into()], ..i7_11700() };
        assert_eq!(super::differences(&strange, &machine())[0].machine, "unknown");
    }

    #[test]
    fn caches_level_and_build_are_held_against_the_profile() {
        use isostudy_design::machine::{Build, IsaLevel};
        let asking = CpuProfile {
            l1d_kib: Some(48),
            l2_kib: Some(512),
            l3_kib: Some(16384),
            isa: Some(IsaLevel::V3),
            target_cpu: Some("x86-64-v3".into()),
            ..i7_11700()
        };
        assert_eq!(differences(&asking, &machine()), []);
        let generic = Build { target_cpu: "x86-64".into(), ..machine().build };
        let other = Machine { l2_kib: Some(1024), isa: Some(IsaLevel::V2), build: generic, ..machine() };
        let found = differences(&asking, &other);
        assert_eq!(properties(&found), ["level-2 cache, KiB", "instruction set", "target-cpu"]);
        assert_eq!((found[1].target.as_str(), found[1].machine.as_str()), ("x86-64-v3", "x86-64-v2"));
        let newer = Machine { isa: Some(IsaLevel::V4), ..machine() };
        assert_eq!(differences(&asking, &newer), [], "a higher level has the lower ones");
        let foreign = Machine { isa: None, l3_kib: None, ..machine() };
        assert_eq!(properties(&differences(&asking, &foreign)), ["level-3 cache, KiB", "instruction set"]);
    }

    #[test]
    fn an_empty_profile_matches_anything() {
        let empty: CpuProfile = toml::from_str("name = \"any\"\nmodel = \"\"").unwrap();
        let silent = Machine { model: None, cores: None, memory_bytes: None, features: vec![], ..machine() };
        assert_eq!(differences(&empty, &machine()), []);
        assert_eq!(differences(&empty, &silent), []);
        assert!(compare_profile(&empty, &silent).iter().all(|row| row.matches.is_none()));
    }

    #[test]
    fn a_model_matches_in_any_case_and_memory_within_its_allowance() {
        let shouting = CpuProfile { model: "I7-11700".into(), ..i7_11700() };
        assert_eq!(differences(&shouting, &machine()), []);
        let with = |gib: f64| Machine { memory_bytes: Some((gib * f64::from(1 << 30)) as u64), ..machine() };
        assert_eq!(differences(&i7_11700(), &with(28.81)), []);
        assert_eq!(properties(&differences(&i7_11700(), &with(28.79))), ["memory"]);
        assert_eq!(differences(&i7_11700(), &with(64.0)), [], "more is no difference");
    }
}
