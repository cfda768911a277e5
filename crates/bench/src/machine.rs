//! The machine this runs on, as far as it tells.

use crate::linux;
use design::machine::Machine;
use std::num::NonZeroUsize;
use std::thread::available_parallelism;

/// The instruction-set features that are looked for. A profile that asks for another cannot be matched.
pub const FEATURES: [&str; 4] = ["avx2", "bmi1", "bmi2", "fma"];

/// Reads what the system tells about itself: `/proc` and `/sys` on Linux, CPUID on any x86.
///
/// Threads and memory are those this process may use, where a container or an affinity mask leaves it less than the
/// machine has; cores are the machine's. What cannot be read is `None`; nothing is changed, started or waited for.
pub fn read_machine() -> Machine {
    Machine {
        model: linux::model().or_else(brand),
        cores: linux::cores(),
        threads: available_parallelism().map_or(1, NonZeroUsize::get).try_into().unwrap_or(u32::MAX),
        memory_bytes: linux::memory_bytes(),
        os: std::env::consts::OS.into(),
        features: features(),
        governor: linux::governor(),
        load: linux::load(),
        compiler: env!("BENCH_COMPILER").into(),
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn features() -> Vec<String> {
    let found = [
        std::arch::is_x86_feature_detected!("avx2"),
        std::arch::is_x86_feature_detected!("bmi1"),
        std::arch::is_x86_feature_detected!("bmi2"),
        std::arch::is_x86_feature_detected!("fma"),
    ];
    FEATURES.iter().zip(found).filter(|(_, found)| *found).map(|(name, _)| (*name).into()).collect()
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn features() -> Vec<String> {
    Vec::new()
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
        assert!(machine.compiler.starts_with("rustc 1."), "{}", machine.compiler);
        assert!(machine.compiler.ends_with(" build"), "{}", machine.compiler);
        assert_eq!(machine.os, std::env::consts::OS);
        assert!(machine.features.iter().all(|feature| FEATURES.contains(&feature.as_str())));
        if machine.os == "linux" {
            assert!(machine.memory_bytes.is_some_and(|bytes| bytes > 0));
        }
        // Reading twice tells the same, apart from how busy it is.
        assert_eq!(Machine { load: None, ..read_machine() }, Machine { load: None, ..machine });
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
