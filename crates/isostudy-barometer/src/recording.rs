//! What one run found, as files that anybody can read.

use std::io::{Read, Write};

use serde::{Deserialize, Serialize};

use crate::engine::Takes;
use crate::workload::Group;

/// What became of one engine on one workload.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// The mesh is right, and was timed.
    Right,
    /// The mesh is wrong. It has no time.
    Wrong,
    /// The engine gave no mesh.
    Failed,
    /// The engine says of itself that it does something else here.
    NotAsked,
}

/// A row of `measurements.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The workload.
    pub workload: String,
    /// Its group.
    pub group: Group,
    /// The surface that it is of, which others may be of too.
    pub surface: String,
    /// The engine.
    pub engine: String,
    /// What became of it.
    pub state: State,
    /// What is wrong, or why there is none: `found KIND, expected`, divided by semicolons.
    pub faults: String,
    /// Triangles of the mesh.
    pub triangles: Option<u64>,
    /// Seconds of the extraction by the engine's own clock: the median over rounds.
    pub time_s: Option<f64>,
    /// The first quartile.
    pub low_s: Option<f64>,
    /// The third.
    pub high_s: Option<f64>,
    /// How many rounds.
    pub rounds: u32,
    /// Seconds of the answer that was judged, which is not in any rank.
    pub judged_s: Option<f64>,
    /// The most resident memory of a process that was started for this workload, with all that it started, less what it had before the request;
    /// where it was measured.
    pub memory_bytes: Option<u64>,
    /// The mean radius ratio of triangles.
    pub radius_ratio: Option<f64>,
    /// The mean distance of triangles' middles to the interpolated surface, in cells.
    pub off_cells: Option<f64>,
}

/// A row of `engines.csv`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct EngineRow {
    /// As other files name it.
    pub engine: String,
    /// As its makers call it.
    pub name: String,
    /// What the running program said.
    pub version: String,
    /// An SPDX expression.
    pub license: String,
    /// Where it comes from.
    pub install: String,
    /// What kind of method it is.
    pub family: String,
    /// What it is given.
    pub takes: Takes,
    /// Whether the makers of the barometer make it.
    pub ours: bool,
    /// What a reader of its times should know; or why it could not be had.
    pub note: String,
    /// Whether it ran.
    pub ran: bool,
}

/// A row of `conformance.csv`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConformanceRow {
    /// The engine.
    pub engine: String,
    /// How many random grids it was given.
    pub grids: u64,
    /// Those with the exact topology of the trilinear interpolant, and nothing else wrong.
    pub right: u64,
    /// Those with that topology.
    pub same_topology: u64,
    /// Those whose mesh is a closed manifold.
    pub closed_manifold: u64,
    /// The first wrong grids: volume and number, such as `0:17`.
    pub wrong: String,
    /// Why there is nothing, if it failed.
    pub failed: String,
}

/// What is known of the machine, and of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Of these files.
    pub schema: u32,
    /// When it was.
    pub date: String,
    /// The processor.
    pub cpu: String,
    /// How many CPUs the system has.
    pub cpus: u32,
    /// The commit of isostudy.
    pub commit: String,
    /// How isostudy was built: other optimisation, other times of its own engines. Empty where that was not recorded.
    #[serde(default)]
    pub profile: String,
    /// Rounds of each time.
    pub rounds: u32,
    /// One engine in two processes: its time over its time, from the 5th to the 95th percentile over workloads. What is nearer to 1 than that
    /// is noise.
    pub noise: [f64; 2],
    /// The same of the engine's scores over all workloads: engines nearer to each other are not distinguished by time.
    pub noise_of_scores: f64,
    /// Random grids of the conformance table.
    pub grids: u64,
    /// Those that have a cell with a tunnel.
    pub grids_with_tunnels: u64,
}

/// Writes rows.
///
/// # Errors
/// What the writer reports.
pub fn write<T: Serialize>(rows: &[T], to: impl Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(to);
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    writer.flush()?;
    Ok(())
}

/// Reads rows.
///
/// # Errors
/// The line that is none.
pub fn read<T: for<'a> Deserialize<'a>>(from: impl Read) -> Result<Vec<T>, csv::Error> {
    csv::Reader::from_reader(from).into_deserialize().collect()
}
