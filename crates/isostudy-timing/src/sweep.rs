//! What extraction costs as the work grows: resolutions and threads.
//!
//! ```text
//! SweepLevel (one BenchRun a resolution and thread count) ──┐
//! SweepMesh (one a configuration and resolution) ───────────┴── Point ──┬── exponents, speed-ups, budgets ── tables
//!                                                                       └── figures
//! ```
//!
//! # Not guaranteed
//! - Levels are measured one after the other: what changes from one minute to the next falls on some and not on others.
//!   Within a level configurations are interleaved.
//! - An exponent describes the resolutions that were measured and promises nothing beyond.

mod budgets;
mod tables;

use isostudy_design::record::{BenchRun, BenchSample, PeakMemory, SweepMesh};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::interval::{Interval, LEVEL};
use isostudy_statistics::{Median, PowerLaw, median, power_law};
use serde::Serialize;

pub use budgets::{Best, Budget};
pub use tables::sweep_tables;

/// The version of [`Sweep`] as JSON.
pub const SWEEP_SCHEMA: u32 = 1;
/// Exponents are fitted from this many cells per axis on: below, starting threads and filling caches is what costs.
pub const FIT_FROM: u32 = 32;

/// All configurations at one resolution, on so many threads.
#[derive(Debug, Clone)]
pub struct SweepLevel {
    /// Cells along the longest axis of the volume.
    pub cells: u32,
    /// Threads.
    pub threads: u32,
    /// The run.
    pub run: BenchRun,
}

/// A configuration at one resolution, on so many threads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Cells along the longest axis.
    pub cells: u32,
    /// Threads.
    pub threads: u32,
    /// Sample points that the lattice needs, vertices and triangles.
    pub samples: u64,
    /// Of the mesh.
    pub vertices: u64,
    /// Of the mesh.
    pub triangles: u64,
    /// Mean radius ratio of the triangles; `None` of no triangle.
    pub radius_ratio: Option<f64>,
    /// The total with its order-statistic interval, seconds.
    pub total_s: Median,
    /// The medians of the six stages in their order, seconds.
    pub stages_s: [f64; 6],
    /// What extraction had resident at most beyond what was there before; `None` where that cannot be seen.
    pub memory_bytes: Option<u64>,
}

/// What grows with the resolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// The time of a stage, or of all.
    Time(Stage),
    /// Peak memory.
    Memory,
    /// Triangles.
    Triangles,
    /// Sample points.
    Samples,
}

/// How a quantity of one configuration on so many threads grows with the cells per axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// Which configuration.
    pub id: ConfigurationId,
    /// On so many threads.
    pub threads: u32,
    /// What grows.
    pub quantity: Quantity,
    /// How.
    #[serde(flatten)]
    pub law: PowerLaw,
}

/// What more threads are worth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedUp {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Cells along the longest axis.
    pub cells: u32,
    /// On so many threads.
    pub threads: u32,
    /// Time on the fewest threads over time on these; ratio of medians.
    pub ratio: f64,
    /// Where it may lie, at 95 % for all configurations of a level together.
    pub interval: Option<Interval>,
}

/// Everything that a sweep says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Version of this layout; [`SWEEP_SCHEMA`].
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// The largest share of the CPU time that other processes and other machines on the host had while some of a level was
    /// measured; `None` where that is not told.
    pub others: Option<f64>,
    /// In the order of levels, then configurations.
    pub points: Vec<Point>,
    /// Exponents, from [`FIT_FROM`] cells on.
    pub growth: Vec<Growth>,
    /// Speed-ups over the fewest threads.
    pub speed_ups: Vec<SpeedUp>,
    /// Which method is the most regular for a number of triangles or for a time.
    pub budgets: Vec<Budget>,
}

/// Works out what levels and meshes say. Configurations of a level that have no mesh are left out of it.
pub fn sweep(study: &str, levels: &[SweepLevel], meshes: &[SweepMesh]) -> Sweep {
    let points: Vec<Point> = levels.iter().flat_map(|level| points_of(level, meshes)).collect();
    let growth = growth(&points);
    let budgets = budgets::budgets(&points);
    let windows =
        levels.iter().flat_map(|level| &level.run.load).filter(|window| window.invocation.is_some());
    let others = windows.map(|window| window.others + window.steal).reduce(f64::max);
    let (study, speed_ups) = (study.into(), speed_ups(levels));
    Sweep { schema: SWEEP_SCHEMA, study, others, points, growth, speed_ups, budgets }
}

impl Point {
    fn value(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Time(Stage::Total) => Some(self.total_s.median),
            Quantity::Time(stage) => {
                let place = Stage::ALL[..6].iter().position(|s| *s == stage)?;
                Some(self.stages_s[place])
            }
            Quantity::Memory => self.memory_bytes.map(|bytes| bytes as f64),
            Quantity::Triangles => Some(self.triangles as f64),
            Quantity::Samples => Some(self.samples as f64),
        }
    }
}

fn points_of(level: &SweepLevel, meshes: &[SweepMesh]) -> Vec<Point> {
    let of_level = meshes.iter().filter(|mesh| mesh.cells == level.cells);
    let point = |mesh: &SweepMesh| {
        let samples: Vec<&BenchSample> = level.run.samples.iter().filter(|s| s.id == mesh.id).collect();
        let of = |stage: Stage| median(samples.iter().map(|s| stage.of(s)).collect(), LEVEL);
        let mut stages_s = [0.0; 6];
        for (seconds, stage) in stages_s.iter_mut().zip(Stage::ALL) {
            *seconds = of(stage)?.median;
        }
        let memory = level.run.memory.iter().find(|memory| memory.id == mesh.id);
        // Below what making the field had taken before, extraction's own peak is not seen.
        Some(Point {
            id: mesh.id.clone(),
            cells: level.cells,
            threads: level.threads,
            samples: mesh.needed_samples,
            vertices: mesh.vertices,
            triangles: mesh.triangles,
            radius_ratio: (mesh.triangles > 0).then_some(mesh.radius_ratio_mean),
            total_s: of(Stage::Total)?,
            stages_s,
            memory_bytes: memory.and_then(PeakMemory::of_extraction),
        })
    };
    of_level.filter_map(point).collect()
}

/// The quantities that are fitted, in the order they are printed.
const QUANTITIES: [Quantity; 10] = [
    Quantity::Samples,
    Quantity::Triangles,
    Quantity::Memory,
    Quantity::Time(Stage::Total),
    Quantity::Time(Stage::Allocation),
    Quantity::Time(Stage::Sampling),
    Quantity::Time(Stage::Vertex),
    Quantity::Time(Stage::Geometry),
    Quantity::Time(Stage::Clustering),
    Quantity::Time(Stage::Normals),
];

fn growth(points: &[Point]) -> Vec<Growth> {
    let mut found = Vec::new();
    for (id, threads) in series(points) {
        for quantity in QUANTITIES {
            let own = points.iter().filter(|p| p.id == id && p.threads == threads && p.cells >= FIT_FROM);
            let pairs: Vec<(f64, f64)> =
                own.filter_map(|p| Some((f64::from(p.cells), p.value(quantity)?))).collect();
            let law = power_law(&pairs);
            found.extend(law.map(|law| Growth { id: id.clone(), threads, quantity, law }));
        }
    }
    found
}

/// Configurations and thread counts, in the order they come.
fn series(points: &[Point]) -> Vec<(ConfigurationId, u32)> {
    let mut seen = Vec::new();
    for point in points {
        let key = (point.id.clone(), point.threads);
        if !seen.contains(&key) {
            seen.push(key);
        }
    }
    seen
}

fn speed_ups(levels: &[SweepLevel]) -> Vec<SpeedUp> {
    let fewest = levels.iter().map(|level| level.threads).min().unwrap_or_default();
    let mut found = Vec::new();
    for level in levels.iter().filter(|level| level.threads > fewest) {
        let Some(base) = levels.iter().find(|l| l.cells == level.cells && l.threads == fewest) else {
            continue;
        };
        // B is the base: time there over time here.
        let comparison = crate::compare(&level.run, &base.run, Vec::new());
        found.extend(comparison.of_stage(Stage::Total).filter_map(|row| {
            Some(SpeedUp {
                id: row.id.clone(),
                cells: level.cells,
                threads: level.threads,
                ratio: row.ratio?,
                interval: row.interval,
            })
        }));
    }
    found
}

#[cfg(test)]
mod tests;
