//! Times configurations, interleaved, and keeps every sample with the machine it was measured on.
//!
//! ```text
//! Plan ── turns ──> run ── Executor ──> StageSeconds ──> BenchRun ──┬── serde ──────── run.json
//! read_machine ── Machine ──┬───────────────────────────────┘      ├── samples_csv ── every sample
//! CpuProfile ───────────────┴── compare_profile                    ├── machine_csv ── machine against target
//!                                                                  └── summarise, caption ── terminal
//! ```
//!
//! A *round* times every configuration once, in an order of its own drawn from the plan's seed, so that a slow
//! minute of the machine falls on all configurations alike and no configuration always follows the same other.
//!
//! # Guaranteed
//!
//! - Every measured round times every configuration exactly once. Warm-up rounds are run alike and not kept.
//! - The order depends on seed, round and number of configurations only; warm-up does not shift it.
//! - The five stages of a sample add up to its total, exactly, when summed in their order.
//! - A configuration that fails makes the run fail with its name. No sample is left out, replaced or made up.
//! - The machine is only read: nothing in the system is changed, no process is started, and what cannot be read is
//!   `None`, which never counts as a match.
//!
//! # Not guaranteed
//!
//! - Nothing here makes a machine quiet. Governor and load are recorded, not judged.
//! - Cores, memory, governor and load are read on Linux only; the CPU's model name on any x86 and on Linux.
//! - Times are wall-clock times, and a total is the sum of the stages, not the time round the call: dropping the
//!   mesh is not in it.

mod csv_files;
mod error;
mod executor;
mod linux;
mod machine;
mod plan;
mod profile;
mod run;
mod stages;
mod summary;

pub use csv_files::{machine_csv, samples_csv};
pub use error::BenchError;
pub use executor::{ExtractExecutor, Subject};
pub use machine::{FEATURES, read_machine};
pub use plan::{Plan, Round, Turn, order};
pub use profile::{MEMORY_ALLOWANCE, ProfileRow, compare_profile, differences};
pub use run::{Executor, run};
pub use stages::{Stage, StageSeconds};
pub use summary::{Summary, caption, summarise};
