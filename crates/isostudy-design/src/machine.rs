//! The CPU a benchmark is meant for, and the machine it ran on.

use crate::check::ConfigError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A target CPU profile, as written in `configs/cpu/*.toml`. What is absent or empty matches any machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CpuProfile {
    /// Name shown in tables.
    pub name: String,
    /// Model name as the operating system reports it; matched case-insensitively as a substring. Empty matches any.
    pub model: String,
    /// Physical cores.
    pub cores: Option<u32>,
    /// Hardware threads.
    pub threads: Option<u32>,
    /// Base clock in MHz; recorded, not matched.
    pub base_mhz: Option<u32>,
    /// Boost clock in MHz; recorded, not matched.
    pub boost_mhz: Option<u32>,
    /// Level-1 data cache of a core in KiB.
    pub l1d_kib: Option<u32>,
    /// Level-2 cache of a core in KiB.
    pub l2_kib: Option<u32>,
    /// Level-3 cache that a core sees in KiB.
    pub l3_kib: Option<u32>,
    /// Memory in GiB; a machine with less does not match.
    pub memory_gib: Option<u32>,
    /// Operating system: `linux`, `windows` or `macos`.
    pub os: Option<String>,
    /// Least instruction-set level; a machine of a higher one matches.
    pub isa: Option<IsaLevel>,
    /// What the program must have been compiled for: rustc's `-C target-cpu`.
    pub target_cpu: Option<String>,
    /// Instruction-set features the machine must have, such as `avx2`.
    #[serde(default)]
    pub features: Vec<String>,
}

impl CpuProfile {
    /// Reads a profile.
    ///
    /// # Errors
    /// If the file cannot be read, a key is unknown or a value is not of its kind, naming file and key.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let text = crate::read::text(path)?;
        Self::parse(&text, path)
    }

    /// Parses a profile; `path` is what errors name.
    ///
    /// # Errors
    /// As [`CpuProfile::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, ConfigError> {
        crate::read::parse_toml(text, path)
    }

    /// That of a study that times nothing.
    pub(crate) fn any() -> Self {
        Self::parse("name = \"any\"\nmodel = \"\"", Path::new("")).expect("a profile with what it needs")
    }
}

/// A level of the x86-64 instruction set (x86-64 psABI, "micro-architecture levels"); each includes those before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum IsaLevel {
    /// Every x86-64 CPU.
    #[serde(rename = "x86-64")]
    V1,
    /// SSE 4.2, POPCNT.
    #[serde(rename = "x86-64-v2")]
    V2,
    /// AVX2, BMI, FMA.
    #[serde(rename = "x86-64-v3")]
    V3,
    /// AVX-512 F, BW, CD, DQ and VL.
    #[serde(rename = "x86-64-v4")]
    V4,
}

impl IsaLevel {
    /// The name that compilers use.
    pub fn label(self) -> &'static str {
        match self {
            Self::V1 => "x86-64",
            Self::V2 => "x86-64-v2",
            Self::V3 => "x86-64-v3",
            Self::V4 => "x86-64-v4",
        }
    }
}

/// The machine a benchmark ran on, as far as it tells. What could not be read is `None`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Machine {
    /// CPU model name.
    pub model: Option<String>,
    /// Physical cores.
    pub cores: Option<u32>,
    /// Hardware threads this process may use.
    pub threads: u32,
    /// Memory in bytes, or what a container leaves of it.
    pub memory_bytes: Option<u64>,
    /// Level-1 data cache of a core in KiB.
    pub l1d_kib: Option<u32>,
    /// Level-2 cache of a core in KiB.
    pub l2_kib: Option<u32>,
    /// Level-3 cache that a core sees in KiB.
    pub l3_kib: Option<u32>,
    /// Operating system.
    pub os: String,
    /// Instruction-set level; `None` on other than x86-64.
    pub isa: Option<IsaLevel>,
    /// Instruction-set features among those profiles ask for.
    pub features: Vec<String>,
    /// Highest clock in MHz that the frequency driver names.
    pub max_mhz: Option<u32>,
    /// Frequency governor.
    pub governor: Option<String>,
    /// Whether the clock may rise above its base.
    pub turbo: Option<bool>,
    /// Whether cores run several hardware threads.
    pub smt: Option<bool>,
    /// How many CPUs' worth of time a container leaves; `None` for no limit.
    pub cpu_limit: Option<f64>,
    /// How much memory a container leaves, in bytes; `None` for no limit.
    pub memory_limit_bytes: Option<u64>,
    /// One-minute load average when the run began.
    pub load: Option<f64>,
    /// The program that was run.
    pub build: Build,
}

/// How the program was built.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Build {
    /// Compiler version.
    pub compiler: String,
    /// Cargo's profile, `release` or `debug`.
    pub profile: String,
    /// Optimisation level of the extractor.
    pub opt_level: String,
    /// Flags given to the compiler beside the profile's, by spaces.
    pub rustflags: String,
    /// What it was compiled for: `-C target-cpu`, or the target's default.
    pub target_cpu: String,
    /// The commit of the sources; `None` if they were not under version control.
    pub commit: Option<String>,
    /// Whether the sources had changes that were not committed.
    pub dirty: Option<bool>,
    /// Digest of the sources that what is timed was compiled from; `None` if it is not known, as of runs from before it was
    /// recorded.
    #[serde(default)]
    pub sources: Option<String>,
}

impl Machine {
    /// The machine without what changes from one hour or commit to the next: load, governor, turbo, commit. Results
    /// depend on the rest.
    pub fn lasting(&self) -> Self {
        let build = Build { commit: None, dirty: None, sources: None, ..self.build.clone() };
        Self { load: None, governor: None, turbo: None, build, ..self.clone() }
    }
}

/// One way in which the machine differs from the target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProfileDifference {
    /// What differs.
    pub property: String,
    /// What the profile says.
    pub target: String,
    /// What the machine has.
    pub machine: String,
}
