//! The machine this runs on, as far as it tells.

use crate::linux;
use isostudy_design::machine::{Build, IsaLevel, Machine};
use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// The instruction-set features that are looked for. A profile that asks for another cannot be matched.
pub const FEATURES: [&str; 22] = [
    "sse3",
    "ssse3",
    "sse4.1",
    "sse4.2",
    "popcnt",
    "cmpxchg16b",
    "avx",
    "avx2",
    "bmi1",
    "bmi2",
    "f16c",
    "fma",
    "lzcnt",
    "movbe",
    "avx512f",
    "avx512bw",
    "avx512cd",
    "avx512dq",
    "avx512vl",
    "sha",
    "vaes",
    "gfni",
];

/// What each level of x86-64 adds to the one before, as far as compilers and this program look.
const LEVELS: [(IsaLevel, &[&str]); 3] = [
    (IsaLevel::V2, &["sse3", "ssse3", "sse4.1", "sse4.2", "popcnt", "cmpxchg16b"]),
    (IsaLevel::V3, &["avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "lzcnt", "movbe"]),
    (IsaLevel::V4, &["avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"]),
];

/// Reads what the system tells about itself: `/proc` and `/sys` on Linux, CPUID on any x86.
///
/// Threads and memory are those this process may use, where a container or an affinity mask leaves it less than the
/// machine has; cores are the machine's. What cannot be read is `None`; nothing is changed, started or waited for. The
/// commit is not known here: the program that was built from it fills it in.
pub fn read_machine() -> Machine {
    let [l1d_kib, l2_kib, l3_kib] = linux::caches_kib();
    let features = features();
    Machine {
        model: linux::model().or_else(brand),
        cores: linux::cores(),
        threads: available_parallelism().map_or(1, NonZeroUsize::get).try_into().unwrap_or(u32::MAX),
        memory_bytes: linux::memory_bytes(),
        l1d_kib,
        l2_kib,
        l3_kib,
        os: std::env::consts::OS.into(),
        isa: cfg!(target_arch = "x86_64").then(|| isa_level(&features)),
        features,
        max_mhz: linux::max_mhz(),
        governor: linux::governor(),
        turbo: linux::turbo(),
        smt: linux::smt(),
        cpu_limit: linux::cpu_limit(),
        memory_limit_bytes: linux::memory_limit_bytes(),
        load: linux::load(),
        build: Build {
            compiler: env!("BENCH_COMPILER").into(),
            profile: env!("BENCH_PROFILE").into(),
            opt_level: env!("BENCH_OPT_LEVEL").into(),
            rustflags: env!("BENCH_RUSTFLAGS").into(),
            target_cpu: env!("BENCH_TARGET_CPU").into(),
            commit: None,
            dirty: None,
            sources: None,
        },
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn features() -> Vec<String> {
    macro_rules! found {
        ($($name:tt)*) => { [$(std::arch::is_x86_feature_detected!($name)),*] };
    }
    let found = found!(
        "sse3" "ssse3" "sse4.1" "sse4.2" "popcnt" "cmpxchg16b" "avx" "avx2" "bmi1" "bmi2" "f16c" "fma" "lzcnt"
        "movbe" "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl" "sha" "vaes" "gfni"
    );
    FEATURES.iter().zip(found).filter(|(_, found)| *found).map(|(name, _)| (*name).into()).collect()
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn features() -> Vec<String> {
    Vec::new()
}

/// The highest level whose features, and those of the levels below, are all there.
fn isa_level(features: &[String]) -> IsaLevel {
    let has = |wanted: &&str| features.iter().any(|feature| feature == wanted);
    let reached = LEVELS.iter().take_while(|(_, adds)| adds.iter().all(has)).last();
    reached.map_or(IsaLevel::V1, |(level, _)| *level)
}

/// The brand string of the CPU itself, the one source that Windows and macOS leave open to safe code.
#[cfg(target_arch = "x86_64")]
fn brand() -> Option<String> {
    use std::arch::x86_64::__cpuid;
    const LAST_EXTENDED_LEAF: u32 = 0x8000_0000;
    const BRAND_LEAVES: std::ops::RangeInclusive<u32> = 0x8000_0002..=0x8000_0004;
    if __cpuid(LAST_EXTENDED_LEAF).eax < *BRAND_LEAVES.end() {
        return None;
    }
    let registers = BRAND_LEAVES.map(__cpuid).flat_map(|leaf| [leaf.eax, leaf.ebx, leaf.ecx, leaf.edx]);
    brand_text(&registers.flat_map(u32::to_le_bytes).collect::<Vec<_>>())
}

#[cfg(not(target_arch = "x86_64"))]
fn brand() -> Option<String> {
    None
}

/// Up to the first zero byte, with runs of blanks made one: Intel pads the name on the left, AMD on the right.
#[cfg(any(target_arch = "x86_64", test))]
fn brand_text(bytes: &[u8]) -> Option<String> {
    let text = bytes.split(|byte| *byte == 0).next()?;
    linux::one_line(&String::from_utf8_lossy(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_can_be_read() {
        let machine = read_machine();
        assert!(machine.threads >= 1);
        assert!(machine.build.compiler.starts_with("rustc 1."), "{}", machine.build.compiler);
        assert!(["release", "debug"].contains(&machine.build.profile.as_str()), "{}", machine.build.profile);
        assert!(!machine.build.target_cpu.is_empty());
        assert_eq!(machine.os, std::env::consts::OS);
        assert!(machine.features.iter().all(|feature| FEATURES.contains(&feature.as_str())));
        if machine.os == "linux" {
            assert!(machine.memory_bytes.is_some_and(|bytes| bytes > 0));
        }
        // Reading twice tells the same, apart from how busy it is.
        assert_eq!(Machine { load: None, ..read_machine() }, Machine { load: None, ..machine });
    }

    #[test]
    fn a_level_has_every_feature_of_those_below() {
        let with = |levels: &[usize]| -> Vec<String> {
            levels.iter().flat_map(|level| LEVELS[*level].1).map(|name| (*name).to_owned()).collect()
        };
        assert_eq!(isa_level(&[]), IsaLevel::V1);
        assert_eq!(isa_level(&with(&[0])), IsaLevel::V2);
        assert_eq!(isa_level(&with(&[0, 1])), IsaLevel::V3);
        assert_eq!(isa_level(&with(&[0, 1, 2])), IsaLevel::V4);
        assert_eq!(isa_level(&with(&[0, 2])), IsaLevel::V2, "AVX-512 alone is no level 4");
        let mut without_fma = with(&[0, 1]);
        without_fma.retain(|name| name != "fma");
        assert_eq!(isa_level(&without_fma), IsaLevel::V2);
        assert!(LEVELS.iter().flat_map(|(_, adds)| *adds).all(|name| FEATURES.contains(name)));
    }

    #[test]
    fn a_brand_string_ends_at_its_first_zero() {
        let intel = b"      Intel(R) Xeon(R) CPU   E5-2680 v4 @ 2.40GHz\0\0";
        assert_eq!(brand_text(intel).unwrap(), "Intel(R) Xeon(R) CPU E5-2680 v4 @ 2.40GHz");
        assert_eq!(brand_text(b"AMD EPYC\0junk").unwrap(), "AMD EPYC");
        assert_eq!(brand_text(&[0; 48]), None);
        assert_eq!(brand_text(b""), None);
    }
}
