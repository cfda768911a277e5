//! What the samples of a benchmark say, and what they do not.
//!
//! ```text
//! BenchRun ──┬── medians, outliers ──────────────┐
//!            ├── A/A block ── NoiseFloor ── ratios ── Statements ── tables
//!            └── load windows ── quiet ───────────┘
//! BenchRun ── stage times
//! BenchRun, BenchRun ── machine differences, compare ── Comparison ──┬── tables, brief
//!                                                    Gate ── judge ──┴── GateResult, GateRecord
//! AbRun ── ab ── AbComparison
//! BenchRun of each machine ── Statements ── Machines ── tables
//! BenchRun ── export, history
//! ```
//!
//! Times are compared through the logarithm of their ratio, so that twice as slow and twice as fast are equally far from
//! alike. A verdict needs three things: an interval that lies beyond the [`NoiseFloor`], a floor in the first place, and the
//! same direction in each third of the run.
//!
//! # Guarantees
//! - No sample is left out of a median or an interval. Outliers are named, and what they do to the median is said.
//! - The same runs give the same statements: what is drawn is drawn from a seed.
//!
//! # Not guaranteed
//! - "Cannot say" is not "equally fast".
//! - What changes only from one hour to the next, and spares the reference work, is seen by no run.

mod ab;
mod allocated;
mod brief;
mod compare;
mod counted;
mod differences;
pub mod export;
mod floor;
mod gate;
pub mod history;
mod instructions;
pub mod machines;
mod outliers;
mod quiet;
mod ratios;
mod series;
mod stage_columns;
pub mod stage_times;
mod statements;
pub mod sweep;
mod tables;

#[cfg(test)]
pub mod fixture;

#[cfg(test)]
mod simulation;

pub use ab::{AB_SCHEMA, AbComparison, AbRow, AbStage, Quantity, ab};
pub use brief::brief;
pub use compare::{COMPARISON_SCHEMA, Comparison, Limits, Row, compare, would_tell};
pub use counted::InstructionRow;
pub use differences::{build_differences, machine_differences};
pub use floor::{ASSUMED_NOISE, NoiseFloor};
pub use gate::{Gate, GateRecord, GateResult, GateStatus};
pub use instructions::{CountRow, CountRun};
pub use outliers::{MAD_LIMIT, Outlier};
pub use quiet::{BUSY, beside_other_work, warnings};
pub use ratios::Ratio;
pub use series::{Judgement, Verdict};
pub use statements::{STATEMENTS_SCHEMA, StageMedian, Statements, statements};
pub use tables::{comparison_tables, statement_tables, statement_tables_in_short};
