//! What columns about meshes call what is summarised of them, in tables and frames alike.

use isostudy_design::record::{Distribution, Purpose};

/// What a mesh is for, as in the records' own files.
pub(crate) fn purpose_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Benchmark => "benchmark",
        Purpose::Stimulus => "stimulus",
        Purpose::Indexed => "indexed",
    }
}

/// A summary of a distribution: name in CSV and Parquet, heading, and the number.
pub(crate) type Statistic = (&'static str, &'static str, fn(&Distribution) -> f64);

pub(crate) const STATISTICS: &[Statistic] = &[
    ("mean", "mean", |d| d.mean),
    ("sd", "SD", |d| d.sd),
    ("min", "min", |d| d.min),
    ("q05", "5 %", |d| d.q05),
    ("q25", "25 %", |d| d.q25),
    ("median", "median", |d| d.median),
    ("q75", "75 %", |d| d.q75),
    ("q95", "95 %", |d| d.q95),
    ("max", "max", |d| d.max),
];
