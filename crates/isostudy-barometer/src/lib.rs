//! A barometer of isosurface extractors: workloads whose truth is known, engines that are judged before they are timed, and ranks.
//!
//! - [`workload`]: what is extracted, and what is known of it.
//! - [`engine`]: who extracts, and what its adapter says of it.
//! - [`judge`](judge()): a mesh held against a workload's truth. A mesh that is wrong gives no time to any rank.
//! - [`packed`]: many small random grids in one volume, each held against its exact trilinear topology.
//! - [`recording`]: what one run found, as CSV files.
//! - [`ranks`]: engines in order, with intervals over workloads; those that are not distinguished share a rank.
//! - [`agreement`]: whether two recordings agree in all that both tell.
//!
//! Nothing here starts a program or reads a clock: the command does.

pub mod agreement;
pub mod engine;
mod judge;
pub mod packed;
pub mod ranks;
pub mod recording;
pub mod workload;

pub use judge::{Fault, Grid, Kind, Measures, Verdict, judge};
