//! The CPU a benchmark is meant for, and the machine it ran on.

use serde::{Deserialize, Serialize};

/// A target CPU profile, as written in `configs/cpu/*.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CpuProfile {
    /// Name shown in tables.
    pub name: String,
    /// Model name as the operating system reports it; matched case-insensitively as a substring. Empty matches any.
    pub model: String,
    /// Physical cores; absent matches any.
    pub cores: Option<u32>,
    /// Hardware threads; absent matches any.
    pub threads: Option<u32>,
    /// Base clock in MHz; recorded, not matched.
    pub base_mhz: Option<u32>,
    /// Boost clock in MHz; recorded, not matched.
    pub boost_mhz: Option<u32>,
    /// Memory in GiB; a machine with less does not match.
    pub memory_gib: Option<u32>,
    /// Operating system, `linux`, `windows` or `macos`; absent matches any.
    pub os: Option<String>,
    /// Instruction-set features the machine must have, such as `avx2`.
    #[serde(default)]
    pub features: Vec<String>,
}

/// The machine a benchmark ran on, as far as it tells. What could not be read is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// CPU model name.
    pub model: Option<String>,
    /// Physical cores.
    pub cores: Option<u32>,
    /// Hardware threads this process may use.
    pub threads: u32,
    /// Memory in bytes.
    pub memory_bytes: Option<u64>,
    /// Operating system.
    pub os: String,
    /// Instruction-set features among those profiles ask for.
    pub features: Vec<String>,
    /// Frequency governor.
    pub governor: Option<String>,
    /// One-minute load average when the run began.
    pub load: Option<f64>,
    /// Compiler version.
    pub compiler: String,
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
