//! Times configurations, interleaved, and keeps every sample with the machine it was measured on.
//!
//! ```text
//! Plan ── invocations, turns ──> run ── Executor ──> Measurement ──> BenchRun ──┬── serde ──────── run.json
//!                              │        └ ProcessExecutor ── serve            ├── samples_csv ── every sample
//!                              └── Entry ──> journal ──> run                  └── machine_csv ── machine against target
//! AbPlan ── run_ab ── Executor, Executor ──> AbMeasured               two programs, in turn
//! read_machine, CpuProfile ──> compare_profile            published means ── import ──> BenchRun
//! ```
//!
//! A *round* times every configuration once, in an order of its own drawn from the plan's seed, so that a slow
//! minute of the machine falls on all configurations alike and no configuration always follows the same other. A
//! *invocation* is a process and the rounds measured in it. The *A/A block* is rounds of the same plan measured again in
//! invocations of their own: how far it lies from the rest is how far two runs of one build may lie apart. What follows from
//! the samples is worked out in `isostudy-timing`.
//!
//! # Guaranteed
//!
//! - Every measured round times every configuration exactly once. Warm-up rounds are run alike and not kept.
//! - The order depends on seed, round and number of configurations only; warm-up and A/A block do not shift it.
//! - The six stages of a sample add up to its total, exactly, when summed in their order.
//! - A configuration that fails makes the run fail with its name. No sample is left out, replaced or made up.
//! - Every sample is recorded before the next is measured; a run that goes on from a record measures nothing twice.
//! - The machine is only read: nothing in the system is changed beyond the CPUs that a measuring process keeps itself to,
//!   and what cannot be read is `None`, which never counts as a match.
//!
//! # Not guaranteed
//!
//! - Nothing here makes a machine quiet. Governor, load and what other processes had of the CPUs are recorded.
//! - Caches, cores, memory, governor, load, containers and peak memory are read on Linux only; the CPU's model name on any
//!   x86 and on Linux; pinning is for Linux.
//! - Counters beside time ([`Counters`](isostudy_design::record::Counters)) are those that the system tells: on Linux CPU time and page faults,
//!   and the CPU's own where machine and kernel permit it. Allocations are counted where the program's allocator tells them
//!   ([`count_allocations`]), in extractions that are not timed.
//! - Times are wall-clock times, and a total is the sum of the stages, not the time round the call: dropping the
//!   mesh is not in it.

mod ab;
mod allocations;
mod csv_files;
mod error;
mod import;
mod journal;
mod linux;
mod load;
mod machine;
mod meter;
mod perf;
mod pin;
mod plan;
mod planted;
mod process;
mod profile;
mod reference;
mod run;
mod stages;
mod valgrind;
mod worker;

pub use ab::{AbEntry, AbMeasured, AbPlan, LEAST_ROUNDS, read_ab_journal, run_ab};
pub use allocations::{AllocationCounts, Asked, count_allocations};
pub use csv_files::{machine_csv, samples_csv};
pub use error::BenchError;
pub use import::import;
pub use journal::{Entry, JournalError, read_journal};
pub use load::{CpuTimes, LEAST_TICKS, Shares};
pub use machine::{FEATURES, read_machine};
pub use pin::pin;
pub use plan::{Invocation, Plan, Round, Turn, order};
pub use planted::{PLANTED, Planted};
pub use process::{Allowance, ProcessExecutor};
pub use profile::{MEMORY_ALLOWANCE, ProfileRow, compare_profile, differences};
pub use reference::Reference;
pub use run::{Executor, Measurement, PeakBytes, check_journal, run, run_until};
pub use stages::{StageSeconds, Timed};
pub use valgrind::instructions;
pub use worker::{Finish, Measured, Prepared, Reply, Request, serve};
